// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <limits>

#include <vadose/core/error.hpp>
#include <vadose/policy/hydraulic_concept.hpp>

namespace vadose::swrc {

/// Exponential retention S_e = exp(-alpha s / gamma_l), S = S_res + (1 - S_res) S_e. Together with
/// conductivity::Gardner it makes Richards' equation linear (Gardner 1958; Srivastava and Yeh 1991).
struct Gardner {
  Real residual_saturation = 0;  ///< S_res [-], in [0, 1)
  Real alpha = unset;            ///< inverse capillary length [1/m], > 0
  Real unit_weight = unset;      ///< reference gamma_l = 9.81 rho_l [N/m3], not scene gravity

  /// Takes the unit weight from the material where unset.
  void adopt(const SharedParameters& shared) noexcept {
    detail::fill(unit_weight, shared.liquid_unit_weight);
  }

  void validate() const {
    if (!(residual_saturation >= 0 && residual_saturation < 1))
      check::fail("residual_saturation", residual_saturation, "[0, 1)", "-");
    check::positive("alpha", alpha, "1/m");
    check::positive("unit_weight", unit_weight, "N/m3");
  }

  /// x = suction_scale s [1/Pa]; the curve depends on x only.
  Real suction_scale(Real /*porosity*/) const noexcept { return alpha / unit_weight; }

  /// S [-] and dS/ds [1/Pa] at suction [Pa]; negative suction counts as 0.
  template <class T>
  SaturationAndSlope<T> saturation_and_slope(T suction, T /*porosity*/) const noexcept {
    const Real scale = alpha / unit_weight;
    const T part = T(1 - residual_saturation) * exp(T(-scale) * max(suction, T(0.0)));
    return {T(residual_saturation) + part, T(-scale) * part};
  }
  /// Degree of saturation [-].
  template <class T>
  T saturation(T suction, T porosity) const noexcept {
    return saturation_and_slope<T>(suction, porosity).saturation;
  }
  /// dS/ds [1/Pa], < 0.
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
    if (!(effective < 1)) return 0;
    if (!(effective > 0)) return std::numeric_limits<Real>::infinity();
    return -std::log(effective) / suction_scale(porosity);
  }
};

static_assert(ScalingRetention<Gardner>);

}  // namespace vadose::swrc
