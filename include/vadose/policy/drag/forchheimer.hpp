// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include <vadose/core/error.hpp>
#include <vadose/policy/hydraulic_concept.hpp>

namespace vadose::drag {

/// Forchheimer's law with Ergun's constants, for coarse soil and fast flow. Per unit mixture
/// volume F = [n_l^2 mu/kappa + F_E rho_l n_l^3/sqrt(kappa) |w|] w, n_l = n S, kappa = k mu/gamma_l,
/// F_E = B / sqrt(A n^3); the members return it per unit *liquid* volume, that is divided by n_l.
/// On a saturated bed of spheres it is Ergun's equation. kappa is the intrinsic permeability times
/// the relative one.
struct Forchheimer {
  Real viscosity = 1.0e-3;      ///< dynamic viscosity mu of the liquid [Pa s], > 0
  Real ergun_linear = 150;      ///< A [-], > 0
  Real ergun_quadratic = 1.75;  ///< B [-], >= 0

  void validate() const {
    check::positive("viscosity", viscosity, "Pa s");
    check::positive("ergun_linear", ergun_linear, "-");
    check::non_negative("ergun_quadratic", ergun_quadratic, "-");
  }

  /// Linear part n S gamma_l / k [kg m^-3 s^-1].
  template <class T>
  T coefficient(T porosity, T saturation, T conductivity, T unit_weight) const noexcept {
    return porosity * saturation * unit_weight / conductivity;
  }
  /// Factor of |w| w, F_E rho_l (n S)^2 / sqrt(kappa) [kg m^-4]; liquid density [kg/m3].
  template <class T>
  T quadratic(T porosity, T saturation, T conductivity, T unit_weight,
              T liquid_density) const noexcept {
    const T liquid = porosity * saturation;
    const T permeability = conductivity * T(viscosity) / unit_weight;
    return T(ergun_quadratic / std::sqrt(ergun_linear)) * liquid_density * liquid * liquid /
           sqrt(porosity * porosity * porosity * permeability);
  }
};

static_assert(QuadraticDrag<Forchheimer>);

}  // namespace vadose::drag
