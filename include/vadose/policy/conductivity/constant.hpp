// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/core/error.hpp>
#include <vadose/policy/hydraulic_concept.hpp>

namespace vadose::conductivity {

/// The same hydraulic conductivity at any porosity and saturation.
struct Constant {
  Real saturated_conductivity = unset;  ///< [m/s], > 0

  void validate() const {
    check::positive("saturated_conductivity", saturated_conductivity, "m/s");
  }

  /// k_sat [m/s].
  template <class T>
  T saturated(T /*porosity*/) const noexcept {
    return T(saturated_conductivity);
  }
  /// 1 [-].
  template <class T>
  T relative(T /*effective_saturation*/) const noexcept {
    return T(1.0);
  }
  /// k_sat [m/s].
  template <class T>
  T conductivity(T /*effective_saturation*/, T /*porosity*/) const noexcept {
    return T(saturated_conductivity);
  }
};

static_assert(FactorisingConductivity<Constant>);

}  // namespace vadose::conductivity
