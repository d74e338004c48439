// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/policy/hydraulic_concept.hpp>

namespace vadose::drag {

/// Darcy's law as an interphase force: n S gamma_l / k per unit *liquid* volume and relative
/// velocity, [Zhan] Eq. (2). Times n S it is the force per unit mixture volume.
/// DEVIATION: gamma_l is a reference 9.81 rho_l, the one k was measured with, so that Darcy's flux
/// grows with the gravity of a centrifuge.
struct Darcy {
  void validate() const noexcept {}

  /// Drag coefficient [kg m^-3 s^-1] from porosity [-], degree of saturation [-], hydraulic
  /// conductivity [m/s] > 0 and reference unit weight [N/m3].
  template <class T>
  T coefficient(T porosity, T saturation, T conductivity, T unit_weight) const noexcept {
    return porosity * saturation * unit_weight / conductivity;
  }
};

static_assert(DragLaw<Darcy>);

}  // namespace vadose::drag
