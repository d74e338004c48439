// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Node-local implicit drag in closed form: unconditionally stable, conserves momentum to round-off,
/// exact for k -> 0 (both phases move as one) and k -> infinity (no interaction).

#include <vadose/core/lanes.hpp>

namespace vadose {
namespace detail {

/// m_l m_s / (m_l + m_s) with the phases' shares of the mass; all 0 where a mass is 0.
template <class T>
struct ReducedMass {
  T liquid_share;
  T solid_share;
  T mass;

  ReducedMass(T liquid, T solid) noexcept {
    const T total = max(liquid + solid, T(1e-300));
    const auto both = (liquid > T(0.0)) & (solid > T(0.0));
    liquid_share = select(both, liquid / total, T(0.0));
    solid_share = select(both, solid / total, T(0.0));
    mass = liquid * solid_share;
  }
};

}  // namespace detail

namespace drag {

/// One velocity component under linear drag: solves
/// m_l (v_l' - v_l) = -dt D (v_l' - v_s'), m_s (v_s' - v_s) = dt D (v_l' - v_s').
/// Masses [kg] >= 0, time step times nodal drag dt D [kg] >= 0, velocities [m/s] before and after.
/// With either mass 0 the velocities stay as they are.
template <class T>
VADOSE_INLINE void implicit_drag(T liquid_mass, T solid_mass, T dt_drag, T& liquid_velocity,
                                 T& solid_velocity) noexcept {
  const detail::ReducedMass<T> reduced(liquid_mass, solid_mass);
  const T lost =
      (liquid_velocity - solid_velocity) * (dt_drag / max(reduced.mass + dt_drag, T(1e-300)));
  liquid_velocity -= reduced.solid_share * lost;
  solid_velocity += reduced.liquid_share * lost;
}

/// All components under linear and quadratic drag, m_l dv_l/dt = -(D + Q |w|) w with w = v_l - v_s
/// at the end of the step; |w'| is the root of (m + dt D) w' + dt Q w'^2 = m |w|, m the reduced mass.
/// dt Q [kg s/m] >= 0.
template <class T, int Dim>
VADOSE_INLINE void implicit_drag(T liquid_mass, T solid_mass, T dt_drag, T dt_quadratic,
                                 T (&liquid_velocity)[Dim], T (&solid_velocity)[Dim]) noexcept {
  const detail::ReducedMass<T> reduced(liquid_mass, solid_mass);
  T square(0.0);
  for (int d = 0; d < Dim; ++d) {
    const T w = liquid_velocity[d] - solid_velocity[d];
    square += w * w;
  }
  const T linear = reduced.mass + dt_drag;
  const T product = T(4.0) * reduced.mass * dt_quadratic * sqrt(square);
  const T sum = max(linear + sqrt(linear * linear + product), T(1e-300));
  const T fraction = (T(2.0) * dt_drag + product / sum) / sum;  // lost part of w
  for (int d = 0; d < Dim; ++d) {
    const T lost = (liquid_velocity[d] - solid_velocity[d]) * fraction;
    liquid_velocity[d] -= reduced.solid_share * lost;
    solid_velocity[d] += reduced.liquid_share * lost;
  }
}

}  // namespace drag
}  // namespace vadose
