// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// How the water at a face answers to what drives it: the drag law of the soil, and inertia.

#include <vadose/kernel/cells.hpp>

namespace vadose::kernel {

/// Linear drag coefficient A at a face whose conductivity is not 0, per volume of liquid [kg/(m3 s)].
template <class M>
Real face_drag(const State<M>& state, const FaceFlux& face,
               const Cell<State<M>::dim>& soil) noexcept {
  const auto& material = state.soils[soil.material].material;
  return drag::coefficient<Real>(material.drag, soil.porosity, face.saturation, face.conductivity,
                                 material.unit_weight);
}

/// Answer of the water at a face to a head gradient over one step, with linear drag and `inertia` times
/// its inertia: flux per area M H, M = n S [inertia rho / dt + A]^-1 [m3 s/kg]. In the limit of Darcy's
/// drag it is k / gamma.
template <class M>
Real face_mobility(const State<M>& state, const FaceFlux& face, const Cell<State<M>::dim>& soil,
                   Real inertia) noexcept {
  if (!(face.saturation > 0) || !(face.conductivity > 0)) return 0;
  return soil.porosity * face.saturation /
         (inertia * state.water.density / state.dt + face_drag(state, face, soil));
}

/// What a quadratic drag term divides the flux at a face by: with a = n S / M and the root of
/// a w + B |w| w = H, (1 + sqrt(1 + 4 B |H| / a^2)) / 2; 1 without one.
template <class M>
Real quadratic_face_factor(const State<M>& state, const FaceFlux& face,
                           const Cell<State<M>::dim>& soil, Real mobility, Real drive) noexcept {
  if constexpr (!QuadraticDrag<typename M::Drag>) {
    return 1;
  } else {
    if (!(mobility > 0)) return 1;
    const auto& material = state.soils[soil.material].material;
    const Real b =
        drag::quadratic<Real>(material.drag, soil.porosity, face.saturation, face.conductivity,
                              material.unit_weight, state.water.density);
    const Real over_a = mobility / (soil.porosity * face.saturation);
    return 0.5 * (1 + std::sqrt(1 + 4 * b * std::fabs(drive) * over_a * over_a));
  }
}

/// A flux per area [m/s] and its derivative in what drives it [m/s per Pa/m].
struct DrivenFlux {
  Real value = 0;
  Real slope = 0;
};

/// Flux per area at a face driven by `drive` [Pa/m] over one step, with the whole drag law of the soil and
/// `inertia` times the inertia of its water (0: steady).
template <class M>
DrivenFlux driven_flux(const State<M>& state, const FaceFlux& face, const Cell<State<M>::dim>& soil,
                       Real drive, Real inertia) noexcept {
  const Real mobility = face_mobility(state, face, soil, inertia);
  const Real factor = quadratic_face_factor(state, face, soil, mobility, drive);
  return {mobility * drive / factor, mobility / (2 * factor - 1)};
}

}  // namespace vadose::kernel
