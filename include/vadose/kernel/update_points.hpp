// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Steps 7 and 8 on the points, [Zhan] 3.4 (f) to (h): velocities, positions, strains, stresses,
/// volumes, exchanged water, pressures.

#include <vadose/kernel/update_liquid.hpp>
#include <vadose/kernel/update_solid.hpp>

namespace vadose::kernel {

/// Carries the loads with the ground (hat functions).
template <class M>
void move_loads(State<M>& state) {
  constexpr int dim = State<M>::dim;
  for (auto& load : state.loads) {
    Vec<dim> v = Vec<dim>::Zero();
    for_hat_nodes(state.grid, load.position, [&](std::size_t node, Real w) {
      for (int d = 0; d < dim; ++d) v[d] += w * state.nodes.solid_out[node][d];
    });
    load.position += state.dt * v;
  }
}

}  // namespace vadose::kernel
