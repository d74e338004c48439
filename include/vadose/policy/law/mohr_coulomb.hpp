// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include <vadose/policy/law/linear_elastic.hpp>
#include <vadose/policy/law/principal_stress.hpp>
#include <vadose/policy/law/strength.hpp>

namespace vadose::law {

namespace detail {

/// Exchanges the values where they are out of order (a < b).
template <class T>
struct Exchange {
  decltype(T(0.0) < T(0.0)) done{};
  VADOSE_INLINE void sort(T& a, T& b) noexcept {
    done = a < b;
    undo(a, b);
  }
  VADOSE_INLINE void undo(T& a, T& b) const noexcept {
    const T old = a;
    a = select(done, b, a);
    b = select(done, old, b);
  }
};

/// Return to the planes and edges of a Mohr-Coulomb pyramid in ordered principal stresses
/// s1 >= s2 >= s3 (tension +), with f = (1 + sin phi) s1 - (1 - sin phi) s3 - 2 c cos phi.
struct PyramidReturn {
  Real major = 0, middle = 0, minor = 0;  ///< elastic stress per multiplier of the plane [Pa]
  Real plane = 0;                         ///< fall of f per multiplier [Pa]
  Real at_compression = 0;                ///< fall of f per multiplier of the plane across s1 = s2
  Real at_extension = 0;                  ///< fall of f per multiplier of the plane across s2 = s3

  PyramidReturn() = default;
  /// With bulk_modulus = 0 the return keeps the mean stress.
  PyramidReturn(Real sin_phi, Real sin_psi, Real bulk_modulus, Real shear_modulus) noexcept {
    const Real isotropic = 2 * sin_psi * (bulk_modulus - 2 * shear_modulus / 3);
    major = 2 * shear_modulus * (1 + sin_psi) + isotropic;
    middle = isotropic;
    minor = -2 * shear_modulus * (1 - sin_psi) + isotropic;
    plane = (1 + sin_phi) * major - (1 - sin_phi) * minor;
    at_compression = (1 + sin_phi) * middle - (1 - sin_phi) * minor;
    at_extension = (1 + sin_phi) * major - (1 - sin_phi) * middle;
  }

  /// True when plane and edge returns have a solution.
  bool solvable() const noexcept {
    return plane > 0 && plane + at_compression > 0 && plane + at_extension > 0;
  }

  /// Moves s to the pyramid. up = 1 + sin phi, down = 1 - sin phi, strength = 2 c cos phi.
  template <class T>
  VADOSE_INLINE void move(Real up, Real down, Real strength, T (&s)[3]) const noexcept {
    const T zero(0.0);
    const auto excess = [&](const T& a, const T& b) {
      return T(up) * a - T(down) * b - T(strength);
    };
    const T f = excess(s[0], s[2]);
    const T single = max(f, zero) * T(1 / plane);
    const T p[3] = {s[0] - single * T(major), s[1] - single * T(middle), s[2] - single * T(minor)};
    const auto over_compression = p[1] > p[0];
    const auto over_extension = p[2] > p[1];
    const auto [c1, c2] = multipliers(f, excess(s[1], s[2]), at_compression);
    const T c[3] = {s[0] - c1 * T(major) - c2 * T(middle), s[1] - c1 * T(middle) - c2 * T(major),
                    s[2] - (c1 + c2) * T(minor)};
    const auto [e1, e2] = multipliers(f, excess(s[0], s[1]), at_extension);
    const T e[3] = {s[0] - (e1 + e2) * T(major), s[1] - e1 * T(middle) - e2 * T(minor),
                    s[2] - e1 * T(minor) - e2 * T(middle)};
    for (int i = 0; i < 3; ++i)
      s[i] = select(over_compression, c[i], select(over_extension, e[i], p[i]));
  }

 private:
  template <class T>
  struct Pair {
    T first, second;
  };
  /// Multipliers of two planes whose excesses are f1 and f2.
  template <class T>
  VADOSE_INLINE Pair<T> multipliers(const T& f1, const T& f2, Real coupling) const noexcept {
    const Real scale = 1 / (plane * plane - coupling * coupling);
    const T own(plane * scale), other(coupling * scale);
    return {own * f1 - other * f2, own * f2 - other * f1};
  }
};

}  // namespace detail

/// Perfect plasticity with the Mohr-Coulomb pyramid, not associated, and a cut-off on the mean
/// stress. Principal stresses s1 >= s2 >= s3, tension positive:
///   f = (s1 - s3)/2 + (s1 + s3)/2 sin(phi) - c cos(phi) <= 0,
///   sigma_m <= min(tensile_strength, c cot(phi)),
///   g = (s1 - s3)/2 + (s1 + s3)/2 sin(psi).
/// Backward Euler in principal stresses, closed form: plane, the edges s1 = s2 (triaxial
/// compression) and s2 = s3 (triaxial extension), and their corners with the cut-off; the apex is
/// the cut-off at c cot(phi).
/// DEVIATION: the cut-off bounds the mean stress, as in DruckerPrager, not the major stress.
struct MohrCoulomb {
  LinearElastic elastic;               ///< below the strength
  Real cohesion = 0;                   ///< c [Pa], >= 0
  Real friction_angle = unset;         ///< phi [rad], in [0, pi/2)
  Real dilation_angle = 0;             ///< psi [rad], in (-pi/2, phi]
  Real tensile_strength = no_cut_off;  ///< largest mean stress [Pa], >= 0

  /// Internal variables.
  template <class T>
  struct State {
    T plastic_shear_strain{0.0};  ///< accumulated int sqrt(2 de:de), de deviatoric plastic [-]
  };

  /// State variables that files show.
  static constexpr std::array<StateOutput, 1> outputs() noexcept {
    return {{{"plastic_shear_strain", "-", 0}}};
  }

  /// Numbers derived once; its update is that of the law.
  class Prepared;
  /// See Prepared.
  Prepared prepared() const noexcept;

  /// Oedometric modulus [Pa], the elastic one.
  Real p_wave_modulus(const State<Real>& /*state*/) const noexcept {
    return elastic.p_wave_modulus();
  }
  /// Shear modulus [Pa], the elastic one.
  Real shear_modulus(const State<Real>& /*state*/) const noexcept {
    return elastic.shear_modulus();
  }

  /// Throws SetupError on the first value outside its range.
  void validate() const {
    elastic.validate();
    detail::validate_strength("", {cohesion, friction_angle, dilation_angle});
    detail::validate_tensile_strength(tensile_strength);
    const detail::PyramidReturn pyramid(std::sin(friction_angle), std::sin(dilation_angle),
                                        elastic.bulk_modulus(), elastic.shear_modulus());
    if (!pyramid.solvable())
      check::fail("dilation_angle", dilation_angle,
                  "values for which the contraction of yielding stays below the elastic swelling",
                  "rad");
  }

  /// Stress at the end of a step; see the class.
  template <class T, int N>
  Status update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                State<T>& state) const noexcept;
};

/// MohrCoulomb with its numbers derived.
class MohrCoulomb::Prepared {
 public:
  /// That of the law.
  template <class T>
  using State = MohrCoulomb::State<T>;

  /// Derives the numbers.
  explicit Prepared(const MohrCoulomb& law) noexcept
      : bulk_modulus_(law.elastic.bulk_modulus()),
        shear_modulus_(law.elastic.shear_modulus()),
        sin_phi_(std::sin(law.friction_angle)),
        strength_(2 * law.cohesion * std::cos(law.friction_angle)),
        inscribed_(std::sqrt(1 + sin_phi_ * sin_phi_ / 3)),
        pyramid_(sin_phi_, std::sin(law.dilation_angle), bulk_modulus_, shear_modulus_),
        at_cut_off_(sin_phi_, std::sin(law.dilation_angle), 0, shear_modulus_) {
    const Real apex = strength_ / (2 * std::max(sin_phi_, 1e-30));
    mean_limit_ = std::min(law.tensile_strength, apex);
  }

  /// Stress at the end of a step.
  template <class T, int N>
  VADOSE_INLINE Status update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                              State<T>& state) const noexcept {
    T opening;
    return update(step, stress, state, opening);
  }

  /// The same; opening: volume strain beyond what the cut-off lets the soil carry [-], else 0.
  template <class T, int N>
  VADOSE_INLINE Status update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                              State<T>& state, T& opening) const noexcept {
    detail::add_elastic_stress(step.increment, bulk_modulus_, shear_modulus_, stress);
    opening = T(0.0);
    if (any(may_yield(stress))) return_principal(stress, state, opening);
    return Status::ok;
  }

 private:
  /// Return in principal stresses; out of line, as most batches never come here.
  template <class T, int N>
  void return_principal(SymTensor<T, N>& stress, State<T>& state, T& opening) const noexcept {
    const detail::PrincipalStress<T, N> trial(stress);
    T s[3] = {trial[0], trial[1], trial[2]};
    detail::Exchange<T> upper, lower, last;
    upper.sort(s[0], s[1]);
    lower.sort(s[1], s[2]);
    last.sort(s[0], s[1]);
    T change[3] = {s[0], s[1], s[2]};
    opening = T(1 / bulk_modulus_) * return_ordered(s);
    for (int i = 0; i < 3; ++i) change[i] = s[i] - change[i];
    state.plastic_shear_strain += plastic_shear(change);
    last.undo(change[0], change[1]);
    lower.undo(change[1], change[2]);
    upper.undo(change[0], change[1]);
    trial.add(change, stress);
  }

  /// False only where the stress is inside the inscribed cone and below the cut-off.
  template <class T, int N>
  VADOSE_INLINE auto may_yield(const SymTensor<T, N>& stress) const noexcept {
    const SymTensor<T, N> deviator = stress.deviator();
    const T mean = stress.mean();
    const T shear = sqrt(T(0.5) * contract(deviator, deviator));
    return (T(inscribed_) * shear + T(sin_phi_) * mean > T(0.5 * strength_)) |
           (mean > T(mean_limit_));
  }

  /// Return of ordered principal stresses; where the mean stress then exceeds the cut-off, return
  /// of the trial at the cut-off instead. Returns what the cut-off took from the mean stress [Pa].
  template <class T>
  VADOSE_INLINE T return_ordered(T (&s)[3]) const noexcept {
    const T third(1.0 / 3.0), limit(mean_limit_);
    const T shift = limit - (s[0] + s[1] + s[2]) * third;
    T cut[3] = {s[0] + shift, s[1] + shift, s[2] + shift};
    pyramid_.move(1 + sin_phi_, 1 - sin_phi_, strength_, s);
    const auto over = (s[0] + s[1] + s[2]) * third > limit;
    if (!any(over)) return T(0.0);
    at_cut_off_.move(1 + sin_phi_, 1 - sin_phi_, strength_, cut);
    for (int i = 0; i < 3; ++i) s[i] = select(over, cut[i], s[i]);
    return select(over, -shift, T(0.0));
  }

  /// sqrt(2 de:de) of the deviatoric plastic strain de = -dev(change) / (2 G).
  template <class T>
  VADOSE_INLINE T plastic_shear(const T (&change)[3]) const noexcept {
    const T mean = (change[0] + change[1] + change[2]) * T(1.0 / 3.0);
    const T a = change[0] - mean, b = change[1] - mean, c = change[2] - mean;
    return T(1 / (std::numbers::sqrt2 * shear_modulus_)) * sqrt(a * a + b * b + c * c);
  }

  Real bulk_modulus_, shear_modulus_;
  Real sin_phi_;
  Real strength_;   ///< 2 c cos(phi) [Pa]
  Real inscribed_;  ///< sqrt(J2) of the inscribed cone times this is c cos(phi) - sin(phi) sigma_m
  Real mean_limit_ = 0;
  detail::PyramidReturn pyramid_, at_cut_off_;
};

inline MohrCoulomb::Prepared MohrCoulomb::prepared() const noexcept {
  return Prepared(*this);
}

template <class T, int N>
Status MohrCoulomb::update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                           State<T>& state) const noexcept {
  return prepared().update(step, stress, state);
}

}  // namespace vadose::law
