// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The order of a step, [Zhan] 3.4. Kernels know their task; only this file knows the order.

#include <vadose/kernel/carried_nodes.hpp>
#include <vadose/kernel/exchange.hpp>
#include <vadose/kernel/time_step.hpp>
#include <vadose/kernel/update_points.hpp>

namespace vadose::scheme {

/// Passes of an explicit step, in their order.
enum class Pass : unsigned char {
  pressures,        ///< cells and their pressures
  limits,           ///< the stable step
  faces,            ///< conductivities and head gradients between cells
  liquid_to_nodes,  ///< mass and momentum of the water
  solid_to_nodes,   ///< mass, momentum, stress and volume of the skeleton; loads
  nodes,            ///< forces, drag, walls, velocities
  exchange,         ///< fluxes and gains of cells
  nodes_to_solid,   ///< strain, stress, motion
  nodes_to_liquid,  ///< motion, water, pressure
};

/// Explicit step with implicit drag and one water ledger.
///
/// DEVIATION: [Zhan] moves liquid points with v^l and integrates p on them (Eq. 9). Here pore
/// water rides with the skeleton, relative flow moves mass between the points of neighbouring
/// cells, and the pressure follows from the mass in the cell: fronts do not smear, water is
/// conserved to round-off, rest stays at rest.
struct Explicit {
  static constexpr const char* name = "explicit";

  /// One step of at most dt_limit [s]; returns the stable step that was used.
  template <class M>
  static kernel::StableStep step(State<M>& state, Real dt_limit);

  /// The same; calls watch(pass) after each pass.
  template <class M, class Watch>
  static kernel::StableStep watched(State<M>& state, Real dt_limit, Watch&& watch);
};

template <class M, class Watch>
kernel::StableStep Explicit::watched(State<M>& state, Real dt_limit, Watch&& watch) {
  if constexpr (has_liquid<M>) {
    kernel::find_pressures(state);  // (g) of the last step: water in the cells, p, S
    watch(Pass::pressures);
  }
  kernel::StableStep stable = kernel::stable_step(state);
  stable.take(dt_limit, StepLimit::end);
  kernel::begin_step(state, stable.dt);
  watch(Pass::limits);
  if constexpr (has_liquid<M>) {
    if constexpr (has_skeleton<M>) kernel::find_faces(state);  // (c) k and S between cells
    watch(Pass::faces);
    kernel::map_liquid(state);  // (a) liquid to nodes
    watch(Pass::liquid_to_nodes);
  }
  if constexpr (is_deformable<M>) {
    kernel::map_solid(state);  // (a) solid to nodes
    kernel::map_loads(state);  //     traction
    if constexpr (has_liquid<M>) kernel::unload_carried_nodes(state);
    watch(Pass::solid_to_nodes);
  }
  kernel::advance_nodes(state);  // (b), (d), (e): porosity, forces, drag, walls, velocities
  watch(Pass::nodes);
  if constexpr (has_liquid<M>) {
    kernel::exchange_water(state);  // fluxes and gains of cells
    watch(Pass::exchange);
  }
  if constexpr (is_deformable<M>) {
    if constexpr (has_liquid<M>) kernel::move_carried_nodes(state);
    kernel::move_loads(state);
    kernel::update_solid(state);  // (f), (h): positions, stress, volume
    watch(Pass::nodes_to_solid);
  }
  if constexpr (has_liquid<M>) {
    kernel::update_liquid(state);  // (f), (g): positions, water, p
    watch(Pass::nodes_to_liquid);
  }
  return stable;
}

// Not inline, so that a program can compile it once for a model (see Solver).
template <class M>
kernel::StableStep Explicit::step(State<M>& state, Real dt_limit) {
  return watched(state, dt_limit, [](Pass) {});
}

}  // namespace vadose::scheme
