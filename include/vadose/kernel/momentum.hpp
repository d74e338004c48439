// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Steps 5 to 7, [Zhan] 3.4 (d), (e): forces, drag, walls and new velocities of every node.

#include <optional>

#include <vadose/kernel/inner_nodes.hpp>
#include <vadose/kernel/recorded_node.hpp>

namespace vadose::kernel {

/// Local damping of this step: in quasi-static periods more, less and less as inertia begins to matter.
template <bool Recorded, class M>
Real damping_now(const State<M>& state) noexcept {
  const auto& choice = state.options.quasi_static;
  if (!Recorded || !choice.on || state.system.skeleton.on) return state.options.damping;
  const Real still = max(0.0, 1 - state.system.inertia_share / choice.dynamic);
  return max(state.options.damping, still * choice.damping);
}

/// One node: forces, drag, boundaries, new velocities. `Recorded`: for an implicit solution.
template <bool Recorded = false, class M>
void advance_node(State<M>& state, const CellView<M>& view,
                  [[maybe_unused]] const SumsAround<State<M>::dim>& around) {
  constexpr int dim = State<M>::dim;
  const auto i = static_cast<std::size_t>(view.entry());
  const std::uint16_t flags = state.nodes.node_flags[i];
  NodeMotion<dim> node = load_node(state, i);
  NodeSums<dim> sums;
  Real porosity = 1;
  if (node.solid_mass + node.liquid_mass <= 0) {
    if constexpr (Recorded) state.system.response[i] = {};
    store_node(state, i, sums, porosity, node, node);
    return;
  }
  NodeMotion<dim> before = node;
  Real skeleton_volume = 0;
  if constexpr (has_liquid<M>) {
    sums = gather_node(state, view, around);
    if constexpr (is_deformable<M>)
      skeleton_volume = state.nodes.solid_in[i][lane::volume];
    else if constexpr (has_skeleton<M>)
      skeleton_volume = sums.soil_volume;
    porosity = sums.porosity;
    for (int d = 0; d < dim; ++d) node.solid_force[d] += sums.skeleton_force[d];
    Real open[dim] = {};
    if (sums.volume > 0) pressure_forces(sums, skeleton_volume, state.water.density, node, open);
    for (int d = 0; d < dim; ++d)
      state.nodes.open_impulse[static_cast<std::size_t>(view.slot * dim + d)] += state.dt * open[d];
  }
  const Real damping = damping_now<Recorded>(state);
  if (damping > 0 && node.solid_mass > 0) damp(damping, !(sums.soil_share() > 0), node);
  if constexpr (Recorded) node.solid_mass *= state.system.report.inertia;
  if constexpr (has_liquid<M> && has_skeleton<M>) {
    Real prescribed[dim];
    find_prescribed(state, view.entry(), flags, prescribed);
    advance_pair(state, sums, prescribed, node);
  } else {
    for (int d = 0; d < dim; ++d) {
      if (node.solid_mass > 0) node.solid[d] += state.dt * node.solid_force[d] / node.solid_mass;
      if (node.liquid_mass > 0)
        node.liquid[d] += state.dt * node.liquid_force[d] / node.liquid_mass;
    }
  }
  apply_boundaries(state, sums, view.entry(), flags, node);
  // Free water hits walls, and drops carry no pressure that could stop them: there the wall does.
  if (!has_liquid<M> || (sums.volume > 0 && !sums.has_free)) mirror_at_walls(flags, before);
  if constexpr (Recorded) record_response(state, i, sums, porosity, skeleton_volume, before, node);
  store_node(state, i, sums, porosity, before, node);
}

/// Whether points brought mass to one of eight nodes that follow each other.
template <class M>
bool have_mass(const State<M>& state, std::size_t first) noexcept {
  Real mass = 0;
  for (std::size_t i = first; i < first + lane_count; ++i) {
    if constexpr (is_deformable<M>) mass += state.nodes.solid_in[i][lane::mass];
    if constexpr (has_liquid<M>) mass += state.nodes.liquid_in[i][lane::mass];
  }
  return !(mass <= 0);  // true for NaN, which is not to be hidden
}

/// The nodes of a block.
template <bool Recorded, class M>
void advance_block(State<M>& state, int slot, [[maybe_unused]] int thread) {
  constexpr int dim = State<M>::dim;
  using Sums = SumsAround<dim>;
  const auto one_by_one = [&](int first, unsigned done, auto&& sums_of) {
    for (int l = 0; l < lane_count; ++l)
      if (!(done >> l & 1))
        advance_node<Recorded>(state, CellView<M>(state, BlockGrid<dim>::local_at(first + l), slot),
                               sums_of(l));
  };
  const Sums none;
  [[maybe_unused]] std::optional<CellParts<M>> parts;  // blocks around the soil need none
  for (int first = 0; first < Block<dim>::cells; first += lane_count) {
    const auto entry = static_cast<std::size_t>(slot * Block<dim>::cells + first);
    if (!has_liquid<M> || !have_mass(state, entry)) {
      one_by_one(first, 0, [&](int) -> const Sums& { return none; });
    } else if constexpr (has_liquid<M>) {
      if (!parts) parts.emplace(state, slot, thread);
      Sums around[lane_count];
      for (int l = 0; l < lane_count; ++l) {
        const int at = BlockGrid<dim>::tile_index(BlockGrid<dim>::local_at(first + l));
        around[l] = Sums(*parts, at, 1 / state.grid.cell_size());
      }
      unsigned done = 0;
      if constexpr (is_deformable<M> && !Recorded)
        done = advance_inner_nodes(state, slot, first, around);
      one_by_one(first, done, [&](int l) -> const Sums& { return around[l]; });
    }
  }
}

/// All nodes.
template <bool Recorded = false, class M>
void advance_nodes(State<M>& state) {
  constexpr int dim = State<M>::dim;
  if constexpr (has_liquid<M>)
    state.nodes.open_impulse.assign(static_cast<std::size_t>(state.grid.slots() * dim), 0);
  parallel_for(static_cast<std::size_t>(state.grid.slots()), state.options.threads,
               [&](std::size_t s, int thread) {
                 advance_block<Recorded>(state, static_cast<int>(s), thread);
               });
  if constexpr (has_liquid<M>)
    for (std::size_t i = 0; i < state.nodes.open_impulse.size(); ++i)
      state.open_impulse[static_cast<int>(i % dim)] += state.nodes.open_impulse[i];
}

}  // namespace vadose::kernel
