// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Walls and prescribed motion, from conditions to node flags. Faces of the box that nothing is
/// said of are smooth and let no water through.

#include <vadose/kernel/state.hpp>
#include <vadose/scene/scene.hpp>

namespace vadose::detail {

/// Walls of a scene, kept to be turned into node flags whenever blocks come or go.
template <int Dim>
struct Walls {
  std::vector<bc::Fixed> fixed;
  std::vector<bc::Roller> roller;
  std::vector<bc::Frictional> frictional;
  std::vector<bc::PrescribedVelocity<Dim>> moving;
  std::vector<std::size_t> moving_factor;  ///< time factor of each
};

/// Whether a node lies on a face of the box.
template <int Dim>
bool on_face(const BlockGrid<Dim>& grid, const Index<Dim>& node, Face face) {
  const int a = axis(face, Dim);
  if (a < 0 || a >= Dim) return false;  // no such face in this dimension
  return node[a] == (side(face) == 0 ? 0 : grid.cells()[a]);
}

/// Position of a node.
template <int Dim>
Vec<Dim> node_position(const BlockGrid<Dim>& grid, const Index<Dim>& node) {
  Vec<Dim> x;
  for (int d = 0; d < Dim; ++d) x[d] = grid.origin()[d] + node[d] * grid.cell_size();
  return x;
}

/// Region membership of a node, with a little slack against round-off at region edges.
template <int Dim>
bool reaches(const AnyRegion& region, const Vec<Dim>& x, Real slack) {
  if (region.contains(x)) return true;
  for (int d = 0; d < Dim; ++d)
    for (int sign = -1; sign <= 1; sign += 2) {
      Vec<Dim> y = x;
      y[d] += sign * slack;
      if (region.contains(y)) return true;
    }
  return false;
}

/// Flags of one node; adds to `special` where friction or prescribed motion applies.
template <class M>
std::uint16_t flag_node(const State<M>& state, const Walls<State<M>::dim>& walls,
                        const Index<State<M>::dim>& node, std::int32_t entry,
                        std::vector<SpecialNode<State<M>::dim>>& special) {
  constexpr int dim = State<M>::dim;
  const auto& grid = state.grid;
  const Vec<dim> x = node_position(grid, node);
  const Real slack = 1e-6 * grid.cell_size();
  std::uint16_t flags = 0;
  SpecialNode<dim> extra;
  extra.entry = entry;
  for (int d = 0; d < dim; ++d) {
    if (node[d] > grid.cells()[d]) return 0;  // beyond the box: no mass
    for (int s = 0; s < 2; ++s) {
      if (node[d] != (s == 0 ? 0 : grid.cells()[d])) continue;
      bool friction = false, open = false;
      for (const auto& f : walls.frictional)
        if (axis(f.face, dim) == d && side(f.face) == s && reaches(f.region, x, slack)) {
          friction = true;
          extra.friction_axis = d;
          extra.friction_side = s;
          extra.friction = f.friction_coefficient;
        }
      for (const auto& h : state.held)
        open = open || (h.kind != HeldKind::closed && h.is_at(d, s, x));
      if (!friction) flags |= static_cast<std::uint16_t>(node_flag::solid_fixed << d);
      if (!open) flags |= static_cast<std::uint16_t>(node_flag::liquid_fixed << d);
    }
  }
  for (const auto& f : walls.fixed)
    if (on_face(grid, node, f.face) && reaches(f.region, x, slack))
      for (int d = 0; d < dim; ++d)
        flags |= static_cast<std::uint16_t>(node_flag::solid_fixed << d);
  bool moving = false;
  for (std::size_t i = 0; i < walls.moving.size(); ++i) {
    if (!reaches(walls.moving[i].region, x, slack)) continue;
    moving = true;
    extra.factor = walls.moving_factor[i];
    for (int d = 0; d < dim; ++d)
      if (walls.moving[i].prescribes(d)) {
        extra.prescribed[d] = true;
        extra.velocity[d] = walls.moving[i].velocity[d];
      }
  }
  if (moving || extra.friction_axis >= 0) {
    flags |= node_flag::special;
    special.push_back(extra);
  }
  return flags;
}

/// Flags of all nodes of the existing blocks.
template <class M>
void flag_nodes(State<M>& state, const Walls<State<M>::dim>& walls) {
  constexpr int dim = State<M>::dim;
  state.special.clear();
  state.nodes.node_flags.assign(state.grid.size(), 0);
  for (int s = 0; s < state.grid.slots(); ++s) {
    const Index<dim> first = state.grid.first_cell(s);
    std::int32_t e = s * Block<dim>::cells;
    for_cube<dim>(0, Block<dim>::edge, [&](const Index<dim>& i) {
      Index<dim> node = first;
      for (int d = 0; d < dim; ++d) node[d] += i[d];
      state.nodes.node_flags[static_cast<std::size_t>(e)] =
          flag_node(state, walls, node, e, state.special);
      ++e;
    });
  }
}

}  // namespace vadose::detail
