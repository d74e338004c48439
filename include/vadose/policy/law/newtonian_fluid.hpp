// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/core/error.hpp>
#include <vadose/core/sym_tensor.hpp>

namespace vadose::law {

/// Liquid with a shear viscosity and no bulk viscosity.
struct NewtonianFluid {
  static constexpr bool inviscid = false;  ///< has viscous stress

  Real dynamic_viscosity = unset;  ///< mu [Pa s], > 0; water at 20 C: 1.0e-3

  /// Refuses mu <= 0; for mu = 0 there is InviscidWater.
  void validate() const { check::positive("dynamic_viscosity", dynamic_viscosity, "Pa s"); }

  /// Deviatoric stress 2 mu dev(d) [Pa, tension +] of the rate of deformation d [1/s].
  template <class T, int N>
  VADOSE_INLINE SymTensor<T, N> viscous_stress(const SymTensor<T, N>& rate) const noexcept {
    return T(2 * dynamic_viscosity) * rate.deviator();
  }
};

}  // namespace vadose::law
