// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Material routines written for the UMAT interface, in Fortran or C, as constitutive laws.

#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

#include <vadose/policy/law/law_concept.hpp>

namespace vadose::law {

extern "C" {
/// The argument list of a UMAT as compilers of Fortran pass it: everything by reference, the length of
/// cmname last.
typedef void UmatRoutine(double* stress, double* statev, double* ddsdde, double* sse, double* spd,
                         double* scd, double* rpl, double* ddsddt, double* drplde, double* drpldt,
                         const double* stran, const double* dstran, const double* time,
                         const double* dtime, const double* temp, const double* dtemp,
                         const double* predef, const double* dpred, const char* cmname,
                         const int* ndi, const int* nshr, const int* ntens, const int* nstatv,
                         const double* props, const int* nprops, const double* coords,
                         const double* drot, double* pnewdt, const double* celent,
                         const double* dfgrd0, const double* dfgrd1, const int* noel,
                         const int* npt, const int* layer, const int* kspt, const int* kstep,
                         const int* kinc, std::size_t cmname_length);
}

namespace detail {

template <int Count>
struct UmatState {
  Real number[Count] = {};
};
template <>
struct UmatState<0> {};

/// Position of UMAT's components 11 22 33 12 13 23 among ours, xx yy zz xy yz zx.
inline constexpr int umat_order[6] = {0, 1, 2, 3, 5, 4};

}  // namespace detail

/// A UMAT as the law of a skeleton, with StateVariables numbers of STATEV per point. It gets the Bishop
/// stress, tension positive as ours, components 11 22 33 12 13 23 (NTENS = 6) or 11 22 33 12 (NTENS =
/// 4: plane strain and axisymmetric; one dimension too, without shear), engineering shear strains.
///
/// The stress comes rotated already (Jaumann), so DROT is the identity; tensors in STATEV are not
/// rotated. STRAN is zero: the routine must work by increments. DFGRD0 is the identity, DFGRD1 adds
/// DSTRAN. TEMP, COORDS and the like are 0, CELENT and all counters 1. PNEWDT < 1 counts as a failed
/// step. DDSDDE is not used. A routine with common blocks or saved variables runs in one thread only.
template <int StateVariables>
struct Umat {
  static_assert(StateVariables >= 0, "vadose: law::Umat<n> needs n >= 0 state variables");

  UmatRoutine* routine = nullptr;     ///< e.g. `extern "C" law::UmatRoutine umat_;`
  std::vector<Real> properties = {};  ///< PROPS, in the routine's units
  /// E_c [Pa], > 0: an upper bound of the stiffness in uniaxial strain; it limits the time step.
  Real modulus = unset;
  std::string name = "MATERIAL";   ///< CMNAME
  std::vector<Real> initial = {};  ///< STATEV of a new point; missing ones are 0

  using State = detail::UmatState<StateVariables>;  ///< STATEV
  static constexpr bool scalar_only = true;         ///< called point by point

  /// Refuses a missing routine or modulus and too many start values.
  void validate() const {
    if (routine == nullptr) throw SetupError("routine = (missing), allowed: a UMAT [-]");
    check::positive("modulus", modulus, "Pa");
    check::within("number of initial state variables", static_cast<Real>(initial.size()), 0,
                  StateVariables, "-");
  }

  /// E_c [Pa], as given.
  Real p_wave_modulus(const State&) const noexcept { return modulus; }

  /// STATEV of a new point.
  State initial_state() const noexcept {
    State state;
    if constexpr (StateVariables > 0)
      for (std::size_t i = 0; i < initial.size(); ++i) state.number[i] = initial[i];
    return state;
  }

  /// Calls the routine for one point.
  template <int N>
  Status update(const StrainStep<Real, N>& step, SymTensor<Real, N>& stress,
                State& state) const noexcept {
    constexpr int ntens = N == 6 ? 6 : 4, ndi = 3, nshr = ntens - ndi;
    double sigma[6] = {}, dstran[6] = {};
    for (int i = 0; i < ntens; ++i) {
      const int at = detail::umat_order[i];
      if (at >= N) continue;
      sigma[i] = stress[at];
      dstran[i] = (i < ndi ? 1 : 2) * step.increment[at];
    }
    double no_state = 0;
    double* statev = &no_state;
    if constexpr (StateVariables > 0) statev = state.number;
    const double accepted = call(step.dt, ntens, ndi, nshr, sigma, dstran, statev);
    for (int i = 0; i < ntens; ++i)
      if (detail::umat_order[i] < N) stress[detail::umat_order[i]] = sigma[i];
    for (int i = 0; i < N; ++i)
      if (!is_finite(stress[i])) return Status::failed;
    return accepted < 1 ? Status::failed : Status::ok;
  }

 private:
  /// Returns PNEWDT.
  double call(double dt, int ntens, int ndi, int nshr, double* sigma, const double* dstran,
              double* statev) const noexcept {
    const int nstatv = StateVariables, one = 1, nprops = static_cast<int>(properties.size());
    const double zeros[6] = {}, time[2] = {}, unit = 1, no_property = 0;
    const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double gradient[9] = {};
    deform(ntens, dstran, gradient);
    double tangent[36] = {}, heat[6] = {}, heat2[6] = {}, sse = 0, spd = 0, scd = 0, rpl = 0;
    double drpldt = 0, pnewdt = 1;
    const int step[4] = {1, 1, 1, 1};  // KSTEP, or JSTEP(4) of newer routines
    char label[80];
    std::memset(label, ' ', sizeof label);
    std::memcpy(label, name.data(), name.size() < sizeof label ? name.size() : sizeof label);
    routine(sigma, statev, tangent, &sse, &spd, &scd, &rpl, heat, heat2, &drpldt, zeros, dstran,
            time, &dt, zeros, zeros, zeros, zeros, label, &ndi, &nshr, &ntens, &nstatv,
            nprops > 0 ? properties.data() : &no_property, &nprops, zeros, identity, &pnewdt, &unit,
            identity, gradient, &one, &one, &one, &one, step, &one, sizeof label);
    return pnewdt;
  }
  /// I + DSTRAN as a matrix (symmetric, so that the order of storage does not matter).
  static void deform(int ntens, const double* dstran, double* f) noexcept {
    for (int i = 0; i < 3; ++i) f[4 * i] = 1 + dstran[i];
    f[1] = f[3] = 0.5 * dstran[3];
    if (ntens < 6) return;
    f[2] = f[6] = 0.5 * dstran[4];
    f[5] = f[7] = 0.5 * dstran[5];
  }
};

}  // namespace vadose::law
