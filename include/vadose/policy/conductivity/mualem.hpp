// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include <vadose/core/error.hpp>
#include <vadose/policy/conductivity/kozeny_carman.hpp>
#include <vadose/policy/hydraulic_concept.hpp>

namespace vadose::conductivity {

/// Conductivity of Mualem and van Genuchten over that of Kozeny and Carman:
/// k = k_sat(n) k_r, k_r = sqrt(S_e) [1 - (1 - S_e^(1/lambda))^lambda]^2, [Zhan] Eq. (14) to (16).
/// DEVIATION: Eq. (15) prints S_e^(1/n) and an inner exponent 2. Mualem's integral over Eq. (12)
/// gives the exponents 1/lambda and lambda; n is the porosity there, and with it k would depend on
/// porosity twice (k_r(0.86) = 0.753 instead of 3.17e-4 for Table 1).
///
/// Regularisation. With lambda < 1/2 dk_r/ds is infinite at saturation (Table 1: k_r = 0.24 at
/// 49 Pa), which no mesh resolves. For S_e above S_c k_r is the straight line from (S_c, k_r(S_c))
/// to (1, 1), S_c = (1 + x^(1/(1-lambda)))^-lambda at the scaled suction x = linear_below =
/// a e^b s / gamma_l. The default 1e-3 acts below 49 Pa for Table 1 (changes 100 s of infiltration
/// by 0.2 %) and not at all, to round-off, for the sands of Tables 2 and 3.
struct Mualem {
  Real saturated_conductivity = unset;  ///< k_sat at reference_porosity [m/s], > 0
  Real reference_porosity = unset;      ///< [-], (0, 1)
  Real lambda = unset;                  ///< exponent of the retention curve [-], (0, 1)
  bool porosity_dependent = true;       ///< false: k_sat at any porosity
  Real linear_below = 1e-3;     ///< scaled suction x of the regularisation [-], [0, 1); 0: none
  Real relative_floor = 1e-12;  ///< smallest k_r [-], [0, 1): keeps drag finite in dry soil
  /// S_c [-]; adopt() derives it from linear_below once, else every call does.
  Real linear_from = unset;

  /// Takes lambda and the reference porosity from the material where unset.
  void adopt(const SharedParameters& shared) noexcept {
    detail::fill(lambda, shared.lambda);
    detail::fill(reference_porosity, shared.reference_porosity);
    detail::fill(linear_from, limit_of_line());
  }

  void validate() const {
    detail::check_saturated_conductivity(porosity_dependent, saturated_conductivity,
                                         reference_porosity);
    check::inside("lambda", lambda, 0, 1, "-");
    if (!(linear_below >= 0 && linear_below < 1))
      check::fail("linear_below", linear_below, "[0, 1)", "-");
    if (!(relative_floor >= 0 && relative_floor < 1))
      check::fail("relative_floor", relative_floor, "[0, 1)", "-");
    if (is_finite(linear_from)) check::within("linear_from", linear_from, 0, 1, "-");
  }

  /// S_c: effective saturation above which k_r is a straight line [-].
  Real limit_of_line() const noexcept {
    if (is_finite(linear_from)) return linear_from;
    return std::pow(1 + std::pow(linear_below, 1 / (1 - lambda)), -lambda);
  }

  /// k_sat(n) [m/s].
  template <class T>
  T saturated(T porosity) const noexcept {
    return detail::saturated_conductivity<T>(porosity_dependent, saturated_conductivity,
                                             reference_porosity, porosity);
  }
  /// k_r [-], relative_floor to 1; S_e is limited to [0, 1].
  template <class T>
  T relative(T effective_saturation) const noexcept {
    const Real limit = limit_of_line();
    const T se = min(max(effective_saturation, T(0.0)), T(1.0));
    const T on_curve = min(se, T(limit));
    const T curve = mualem<T>(on_curve);
    const T line = (T(1.0) - curve) * (se - on_curve) * T(1 / std::fmax(1 - limit, 1e-300));
    return max(curve + line, T(relative_floor));
  }
  /// k(S_e, n) [m/s].
  template <class T>
  T conductivity(T effective_saturation, T porosity) const noexcept {
    return saturated<T>(porosity) * relative<T>(effective_saturation);
  }

 private:
  /// k_r without cancellation: u = S_e^(1/lambda) is small in dry soil, 1 - u near saturation.
  template <class T>
  T mualem(T se) const noexcept {
    const T one(1.0);
    const T log_u = log_in_range(max(se, T(1e-300))) * T(1 / lambda);
    const auto u = exponentials_in_range(max(log_u, T(-690.0)));
    const auto dry = u.value < T(0.5);
    const T rest = max(select(dry, one - u.value, -u.less_one), T(1e-300));
    const T lost = select(dry, (one - rest) - u.value, T(0.0));  // what rounding took from it
    const T log_rest = log_in_range(rest) + lost / rest;
    const T bracket = exponentials_in_range(T(lambda) * log_rest).less_one;
    return sqrt(se) * bracket * bracket;
  }
};

static_assert(FactorisingConductivity<Mualem>);

}  // namespace vadose::conductivity
