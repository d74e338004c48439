// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Steps 5 to 7 at eight nodes at once. Most nodes are inside the soil: all cells around them hold soil and
/// water, all faces pass water, nothing is held or prescribed. The formulas are those of single nodes.

#include <vadose/kernel/node_motion.hpp>

namespace vadose::kernel {

/// Records of eight nodes by lane: row[i] holds lane i of all of them.
using NodeRows = Lanes[lane_count];

/// Reads the records of eight nodes that follow each other.
VADOSE_INLINE void read_rows(const AlignedVector<Record>& records, std::size_t first,
                             NodeRows& rows) noexcept {
  for (std::size_t l = 0; l < lane_count; ++l) rows[l] = Lanes::load(records[first + l].value);
  transpose(rows);
}

/// Writes the records of those of eight nodes that are marked.
VADOSE_INLINE void write_rows(NodeRows& rows, unsigned marked, std::size_t first,
                              AlignedVector<Record>& records) noexcept {
  transpose(rows);
  for (std::size_t l = 0; l < lane_count; ++l)
    if (marked >> l & 1) rows[l].store(records[first + l].value);
}

/// The sums around eight nodes by lane.
template <int Dim>
struct RowsAround {
  NodeRows value, plain, slope[Dim];  ///< see CellSums
  NodeRows flow, head;                ///< see FaceSums

  VADOSE_INLINE explicit RowsAround(const SumsAround<Dim> (&sums)[lane_count]) noexcept {
    for (int l = 0; l < lane_count; ++l) {
      value[l] = sums[l].cells.value;
      plain[l] = sums[l].cells.plain;
      for (int d = 0; d < Dim; ++d) slope[d][l] = sums[l].cells.slope[d];
      flow[l] = sums[l].faces.flow;
      head[l] = sums[l].faces.head;
    }
    transpose(value);
    transpose(plain);
    for (auto& s : slope) transpose(s);
    transpose(flow);
    transpose(head);
  }

  /// Where all cells around hold soil and nothing else, and all faces pass water between them.
  VADOSE_INLINE LaneMask are_inside() const noexcept {
    constexpr int corners = 1 << Dim;
    LaneMask inside = plain[cell_lane::counts] == Lanes(corners * cell_count::soil);
    for (int d = 0; d < Dim; ++d)
      inside = inside & (head[face_lane::counts + d] == Lanes(corners / 2));
    return inside;
  }
};

/// Which of eight nodes nothing holds and no special motion is given to, and whose soil is that of the first,
/// returned in `material`.
template <class M>
LaneMask are_ordinary(const State<M>& state, int slot, int first, std::uint8_t& material) noexcept {
  constexpr int dim = State<M>::dim;
  const auto& nodes = state.nodes;
  const std::int32_t* tile = state.grid.tile(slot);
  const auto entry = static_cast<std::size_t>(slot * Block<dim>::cells + first);
  const auto material_at = [&](int l) {
    int at = BlockGrid<dim>::tile_index(BlockGrid<dim>::local_at(first + l));
    for (int d = 0; d < dim; ++d) at -= BlockGrid<dim>::tile_stride(d);
    return nodes.cell[static_cast<std::size_t>(tile[at])].material;
  };
  const bool several = state.soils.size() > 1;
  material = several ? material_at(0) : std::uint8_t{0};
  return lanes_of([&](int l) -> Real {
           return nodes.node_flags[entry + static_cast<std::size_t>(l)] == 0 &&
                  (!several || material_at(l) == material);
         }) > Lanes(0.5);
}

/// Eight nodes that follow each other in a block, some of them inside the soil.
template <int Dim>
struct InnerNodes {
  std::size_t entry;  ///< of the first
  LaneMask inside;    ///< which are; the numbers of the others mean nothing
  NodeSums<Dim, Lanes> sums;
  NodeMotion<Dim, Lanes> before, node;
  Lanes skeleton_volume;  ///< bulk volume that the solid points brought [m3]
  Lanes liquid_volume;    ///< of the liquid in the soil [m3]
};

/// What points, cells and faces brought to eight nodes.
template <class M>
VADOSE_INLINE void load_inner_nodes(const State<M>& state, const RowsAround<State<M>::dim>& around,
                                    InnerNodes<State<M>::dim>& nodes) noexcept {
  constexpr int dim = State<M>::dim;
  auto& sums = nodes.sums;
  take_cells(around.value, around.plain, around.slope, sums);
  for (int d = 0; d < dim; ++d)
    take_faces(around.flow, around.head, d, Lanes(1 / power<dim - 1>(2.0)), sums);
  find_drag(state, sums);
  auto& node = nodes.node;
  NodeRows rows;
  read_rows(state.nodes.solid_in, nodes.entry, rows);
  load_solid(rows, state.gravity, node);
  nodes.skeleton_volume = rows[lane::volume];
  read_rows(state.nodes.liquid_in, nodes.entry, rows);
  load_liquid(rows, state.gravity, node);
  nodes.liquid_volume = node.liquid_mass * Lanes(1 / state.water.density) * sums.soil_share();
  nodes.before = node;
  const Lanes zero(0.0);
  nodes.inside =
      nodes.inside & (node.solid_mass > zero) & (nodes.liquid_volume > zero) & (sums.volume > zero);
}

/// Writes the results of those of eight nodes that are inside the soil; returns them, one bit each.
template <class M>
VADOSE_INLINE unsigned store_inner_nodes(State<M>& state,
                                         const InnerNodes<State<M>::dim>& nodes) noexcept {
  unsigned done = 0;
  for (int l = 0; l < lane_count; ++l) done |= nodes.inside[l] ? 1u << l : 0u;
  NodeRows rows, more;
  const auto clear_rows = [&] {
    for (int i = 0; i < lane_count; ++i) rows[i] = more[i] = Lanes(0.0);
  };
  clear_rows();
  set_velocities(nodes.before.solid, nodes.node.solid, rows);
  set_velocities(nodes.before.liquid, nodes.node.liquid, more);
  write_rows(rows, done, nodes.entry, state.nodes.solid_out);
  write_rows(more, done, nodes.entry, state.nodes.liquid_out);
  clear_rows();
  set_fluxes(state, nodes.sums, nodes.sums.porosity, nodes.node, rows, more);
  write_rows(rows, done, nodes.entry, state.nodes.mixture);
  write_rows(more, done, nodes.entry, state.nodes.relative);
  return done;
}

/// Advances those of eight nodes of a block, from number `first` on, that are inside the soil; returns them,
/// one bit each.
template <class M>
unsigned advance_inner_nodes(State<M>& state, int slot, int first,
                             const SumsAround<State<M>::dim> (&sums)[lane_count]) {
  constexpr int dim = State<M>::dim;
  const RowsAround<dim> around(sums);
  InnerNodes<dim> nodes;
  nodes.entry = static_cast<std::size_t>(slot * Block<dim>::cells + first);
  nodes.inside = around.are_inside();
  if (!any(nodes.inside)) return 0;
  nodes.inside = nodes.inside & are_ordinary(state, slot, first, nodes.sums.material);
  load_inner_nodes(state, around, nodes);

  auto& node = nodes.node;
  Lanes open[dim];
  for (int d = 0; d < dim; ++d) node.solid_force[d] += nodes.sums.skeleton_force[d];
  pressure_forces(nodes.sums, nodes.skeleton_volume, state.water.density, node, open);
  for (int d = 0; d < dim; ++d)
    state.nodes.open_impulse[static_cast<std::size_t>(slot * dim + d)] +=
        state.dt * sum(select(nodes.inside, open[d], Lanes(0.0)));
  if (state.options.damping > 0) damp(state.options.damping, false, node);
  advance_free_pair(state, nodes.sums, nodes.liquid_volume, node);
  return store_inner_nodes(state, nodes);
}

}  // namespace vadose::kernel
