// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include <vadose/core/error.hpp>
#include <vadose/policy/hydraulic_concept.hpp>
#include <vadose/policy/swrc/van_genuchten.hpp>

namespace vadose::swrc {

/// Retention curve of Tarantino (2009), [Zhan] Eq. (12) and (13): van Genuchten's with a void-ratio
/// factor, S_e = [1 + (a s e^b / gamma_l)^(1/(1-lambda))]^-lambda, e = n/(1-n), b = (1-lambda)/lambda,
/// S = S_res + (1 - S_res) S_e. At high suction (S_res = 0) the gravimetric water content, e S,
/// does not depend on e.
/// DEVIATION: the unit weight is a reference 9.81 rho_l. Read as rho_l times the scene's gravity, a
/// 30 g centrifuge model of [Zhan] Table 3 would be saturated at its measured suction.
struct Tarantino {
  Real residual_saturation = 0;     ///< S_res [-], in [0, 1)
  Real a = unset;                   ///< [1/m], > 0; a e^b is van Genuchten's alpha at void ratio e
  Real lambda = unset;              ///< [-], in (0, 1)
  Real unit_weight = unset;         ///< reference gamma_l = 9.81 rho_l [N/m3], not scene gravity
  bool porosity_dependent = true;   ///< false freezes e at reference_porosity
  Real reference_porosity = unset;  ///< porosity of the frozen curve [-], (0, 1)

  /// Takes unit weight, lambda and reference porosity from the material where unset.
  void adopt(const SharedParameters& shared) noexcept {
    detail::fill(unit_weight, shared.liquid_unit_weight);
    detail::fill(lambda, shared.lambda);
    detail::fill(reference_porosity, shared.reference_porosity);
  }

  void validate() const {
    if (!(residual_saturation >= 0 && residual_saturation < 1))
      check::fail("residual_saturation", residual_saturation, "[0, 1)", "-");
    check::positive("a", a, "1/m");
    check::inside("lambda", lambda, 0, 1, "-");
    check::positive("unit_weight", unit_weight, "N/m3");
    if (!porosity_dependent) check::inside("reference_porosity", reference_porosity, 0, 1, "-");
  }

  /// x = suction_scale s [1/Pa], a e^b / gamma_l; the curve depends on x only.
  template <class T>
  T suction_scale(T porosity) const noexcept {
    const T n = porosity_dependent ? porosity : T(reference_porosity);
    return T(a / unit_weight) *
           exp(T((1 - lambda) / lambda) * detail::limited_log<T>(n / (T(1.0) - n)));
  }

  /// S [-] and dS/ds [1/Pa] at suction [Pa]; negative suction counts as 0.
  template <class T>
  SaturationAndSlope<T> saturation_and_slope(T suction, T porosity) const noexcept {
    const T s = max(suction, T(0.0));
    // log x^N with N = 1/(1-lambda) and N b = 1/lambda: one exponential for both powers
    const T log_power = T(1 / (1 - lambda)) * detail::limited_log<T>(s * T(a / unit_weight)) +
                        T(1 / lambda) * log_void_ratio<T>(porosity);
    const auto effective = detail::van_genuchten<T>(s, log_power, lambda);
    const T range(1 - residual_saturation);
    return {T(residual_saturation) + range * effective.saturation, range * effective.slope};
  }
  /// Degree of saturation [-].
  template <class T>
  T saturation(T suction, T porosity) const noexcept {
    return saturation_and_slope<T>(suction, porosity).saturation;
  }
  /// dS/ds at constant porosity [1/Pa], <= 0; 0 at zero suction.
  template <class T>
  T saturation_slope(T suction, T porosity) const noexcept {
    return saturation_and_slope<T>(suction, porosity).slope;
  }
  /// dS/dn at constant suction [-], <= 0: s dS/ds b / (n (1-n)).
  template <class T>
  T saturation_porosity_slope(T suction, T porosity) const noexcept {
    if (!porosity_dependent) return T(0.0);
    const T s = max(suction, T(0.0));
    const T shift = T((1 - lambda) / lambda) / (porosity * (T(1.0) - porosity));
    return s * saturation_slope<T>(s, porosity) * shift;
  }
  /// Suction [Pa] at degree of saturation S; 0 for S >= 1, infinite for S <= S_res.
  Real suction(Real saturation_value, Real porosity) const noexcept {
    const Real effective = (saturation_value - residual_saturation) / (1 - residual_saturation);
    return detail::van_genuchten_inverse(effective, lambda) / suction_scale(porosity);
  }

 private:
  template <class T>
  T log_void_ratio(T porosity) const noexcept {
    if (!porosity_dependent) return T(std::log(reference_porosity / (1 - reference_porosity)));
    return detail::limited_log<T>(porosity / (T(1.0) - porosity));
  }
};

static_assert(ScalingRetention<Tarantino>);

}  // namespace vadose::swrc
