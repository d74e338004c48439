// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include <vadose/policy/hydraulic.hpp>

/// Soil-water retention curve of Brooks and Corey (1964): a complete plug-in in plain doubles. The
/// library calls it lane by lane, inverts it by bisection and differences it to porosity.
struct BrooksCorey {
  vadose::Real residual_saturation = 0;     ///< [-]
  vadose::Real air_entry = vadose::unset;   ///< air-entry suction s_b [Pa]
  vadose::Real pore_index = vadose::unset;  ///< pore-size index lambda_BC [-]

  void validate() const {
    vadose::check::positive("air_entry", air_entry, "Pa");
    vadose::check::positive("pore_index", pore_index, "-");
  }
  vadose::Real saturation(vadose::Real s, vadose::Real /*porosity*/) const noexcept {
    if (s <= air_entry) return 1;
    return residual_saturation + (1 - residual_saturation) * std::pow(air_entry / s, pore_index);
  }
  vadose::Real saturation_slope(vadose::Real s, vadose::Real n) const noexcept {  // dS/ds [1/Pa]
    return s <= air_entry ? 0 : -pore_index / s * (saturation(s, n) - residual_saturation);
  }
};
static_assert(vadose::RetentionCurve<BrooksCorey>);
