// SPDX-License-Identifier: MIT
#pragma once

// A hydraulic conductivity: a matrix with root holes that conduct only when they are nearly full.

#include <cmath>

#include <vadose/policy/hydraulic.hpp>

struct MacroPores {
  vadose::Real matrix_conductivity = vadose::unset;  ///< of the full matrix [m/s]
  vadose::Real exponent = 4;                         ///< of S_e in the matrix [-]
  vadose::Real hole_conductivity = 0;                ///< of the full holes, in addition [m/s]
  vadose::Real holes_open = 0.9;                     ///< S_e at which they begin to conduct [-]

  void validate() const {
    vadose::check::positive("matrix_conductivity", matrix_conductivity, "m/s");
    vadose::check::positive("exponent", exponent, "-");
    vadose::check::non_negative("hole_conductivity", hole_conductivity, "m/s");
    vadose::check::inside("holes_open", holes_open, 0, 1, "-");
  }

  // k [m/s], > 0, of the effective saturation in [0, 1] and the porosity. A template for plain
  // numbers and lanes.
  template <class T>
  T conductivity(T effective_saturation, T /*porosity*/) const noexcept {
    using vadose::max;
    using vadose::pow;
    const T holes = max(effective_saturation - T(holes_open), T(0.0)) * T(1 / (1 - holes_open));
    return T(matrix_conductivity) * max(pow(effective_saturation, exponent), T(1e-12)) +
           T(hole_conductivity) * holes;
  }
};
static_assert(vadose::ConductivityLaw<MacroPores>);
