// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <limits>

#include <vadose/core/error.hpp>
#include <vadose/policy/hydraulic_concept.hpp>

namespace vadose {
namespace detail {

/// Natural logarithm, with numbers beyond 1e-300 and 1e300 counted as these.
template <class T>
T limited_log(const T& x) noexcept {
  return log_in_range(min(max(x, T(1e-300)), T(1e300)));
}

/// S_e = (1 + X)^-lambda and dS_e/ds [1/Pa] with X = exp(log_power) = x^(1/(1-lambda)).
/// At s = 0 S_e = 1, slope 0.
template <class T>
swrc::SaturationAndSlope<T> van_genuchten(T suction, T log_power, Real lambda) noexcept {
  const T one(1.0), zero(0.0);
  const T over_suction = select(suction > zero, one / max(suction, T(1e-300)), zero);
  const T power_of_x = exp_in_range(min(max(log_power, T(-690.0)), T(690.0)));
  const T sum = one + power_of_x;
  const T fraction = power_of_x / sum;
  const T effective = exp_in_range(T(-lambda) * log_in_range(sum));
  return {effective, T(-lambda / (1 - lambda)) * over_suction * fraction * effective};
}

/// x at which S_e(x) has the given value; infinite for S_e <= 0.
inline Real van_genuchten_inverse(Real effective, Real lambda) noexcept {
  if (!(effective < 1)) return 0;
  if (!(effective > 0)) return std::numeric_limits<Real>::infinity();
  return std::pow(std::expm1(-std::log(effective) / lambda), 1 - lambda);
}

}  // namespace detail

namespace swrc {

/// Retention curve of van Genuchten (1980) with Mualem's restriction m = 1 - 1/N = lambda:
/// S_e = [1 + (a s / gamma_l)^(1/(1-lambda))]^-lambda, S = S_res + (1 - S_res) S_e.
/// Independent of porosity; Tarantino adds the void ratio.
struct VanGenuchten {
  Real residual_saturation = 0;  ///< S_res [-], in [0, 1)
  Real a = unset;                ///< inverse air-entry head, van Genuchten's alpha [1/m], > 0
  Real lambda = unset;           ///< van Genuchten's m [-], in (0, 1)
  Real unit_weight = unset;      ///< reference gamma_l = 9.81 rho_l [N/m3], not scene gravity

  /// Takes unit weight and lambda from the material where unset.
  void adopt(const SharedParameters& shared) noexcept {
    detail::fill(unit_weight, shared.liquid_unit_weight);
    detail::fill(lambda, shared.lambda);
  }

  void validate() const {
    if (!(residual_saturation >= 0 && residual_saturation < 1))
      check::fail("residual_saturation", residual_saturation, "[0, 1)", "-");
    check::positive("a", a, "1/m");
    check::inside("lambda", lambda, 0, 1, "-");
    check::positive("unit_weight", unit_weight, "N/m3");
  }

  /// x = suction_scale s [1/Pa]; the curve depends on x only.
  Real suction_scale(Real /*porosity*/) const noexcept { return a / unit_weight; }

  /// S [-] and dS/ds [1/Pa] at suction [Pa]; negative suction counts as 0.
  template <class T>
  SaturationAndSlope<T> saturation_and_slope(T suction, T /*porosity*/) const noexcept {
    const T s = max(suction, T(0.0));
    const T log_power = T(1 / (1 - lambda)) * detail::limited_log<T>(s * T(a / unit_weight));
    const auto effective = detail::van_genuchten<T>(s, log_power, lambda);
    const T range(1 - residual_saturation);
    return {T(residual_saturation) + range * effective.saturation, range * effective.slope};
  }
  /// Degree of saturation [-].
  template <class T>
  T saturation(T suction, T porosity) const noexcept {
    return saturation_and_slope<T>(suction, porosity).saturation;
  }
  /// dS/ds [1/Pa], <= 0; 0 at zero suction.
  template <class T>
  T saturation_slope(T suction, T porosity) const noexcept {
    return saturation_and_slope<T>(suction, porosity).slope;
  }
  /// dS/dn = 0 [-].
  template <class T>
  T saturation_porosity_slope(T /*suction*/, T /*porosity*/) const noexcept {
    return T(0.0);
  }
  /// Suction [Pa] at degree of saturation S; 0 for S >= 1, infinite for S <= S_res.
  Real suction(Real saturation_value, Real porosity) const noexcept {
    const Real effective = (saturation_value - residual_saturation) / (1 - residual_saturation);
    return detail::van_genuchten_inverse(effective, lambda) / suction_scale(porosity);
  }
};

static_assert(ScalingRetention<VanGenuchten>);

}  // namespace swrc
}  // namespace vadose
