// SPDX-License-Identifier: MIT
#pragma once

// A drag law: Darcy's, for water of another temperature than the 20 degrees that k was measured at.
//
// The coefficient is the drag per unit volume of liquid and relative velocity [kg m^-3 s^-1]. A second
// member, quadratic(), would add a term in |w| w as Forchheimer has.

#include <cmath>

#include <vadose/policy/hydraulic.hpp>

struct ColdWater {
  vadose::Real temperature = vadose::unset;  ///< [degrees Celsius], in (0, 100)

  void validate() const { vadose::check::inside("temperature", temperature, 0, 100, "C"); }

  // Viscosity over that at 20 degrees (Vogel's formula).
  vadose::Real viscosity_ratio() const noexcept {
    return std::exp(578.919 / (temperature + 273.15 - 137.546) - 578.919 / (293.15 - 137.546));
  }
  template <class T>
  T coefficient(T porosity, T saturation, T conductivity, T unit_weight) const noexcept {
    return T(viscosity_ratio()) * porosity * saturation * unit_weight / conductivity;
  }
};
static_assert(vadose::DragLaw<ColdWater>);
