// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Velocities of the nodes at the trial pressures of an implicit solution.

#include <vadose/kernel/implicit_skeleton.hpp>
#include <vadose/kernel/trial_pressure.hpp>

namespace vadose::kernel {

/// Changes of velocity by forces on the two phases of a node.
template <int Dim>
void respond(const NodeResponse<Dim>& r, const Real (&liquid_force)[Dim],
             const Real (&solid_force)[Dim], Real (&liquid)[Dim], Real (&solid)[Dim]) noexcept {
  Real relative = 0;
  for (int d = 0; d < Dim; ++d) {
    liquid[d] = r.liquid_liquid[d] * liquid_force[d] + r.liquid_solid[d] * solid_force[d];
    solid[d] = r.liquid_solid[d] * liquid_force[d] + r.solid_solid[d] * solid_force[d];
    relative += (liquid[d] - solid[d]) * r.normal[d];
  }
  for (int d = 0; d < Dim; ++d) {
    liquid[d] -= r.liquid_share * relative * r.normal[d];
    solid[d] += (1 - r.liquid_share) * relative * r.normal[d];
    if (r.liquid_held & (1 << d)) liquid[d] = 0;
    if (r.solid_held & (1 << d)) solid[d] = 0;
    if (r.follows) liquid[d] = solid[d];
  }
}

/// Faces along every axis through a node that count in its mean head gradient: position of the face
/// and corner numbers of the cells above and below it; -1: not around the node.
template <int Dim>
struct NodeFaces {
  int count[Dim] = {};
  std::size_t face[Dim][1 << (Dim - 1)];
  int above[Dim][1 << (Dim - 1)], below[Dim][1 << (Dim - 1)];
};

template <class M>
NodeFaces<State<M>::dim> faces_of_node(const CellView<M>& node) {
  constexpr int dim = State<M>::dim;
  NodeFaces<dim> faces;
  for_cube<dim>(0, 2, [&](const Index<dim>& corner) {
    int at = node.at;
    for (int d = 0; d < dim; ++d) at -= corner[d] * BlockGrid<dim>::tile_stride(d);
    const auto e = static_cast<std::size_t>(node.tile[at]);
    for (int d = 0; d < dim; ++d) {
      if (corner[d]) continue;
      const std::size_t i = face_at_node(node.state, node.tile, at, d);
      const FaceFlux& f = node.state.nodes.face[i];
      if (f.kind == FaceKind::closed || f.is_shut()) continue;
      const int k = faces.count[d]++;
      const int upper = corner_number(corner), lower = upper | (1 << d);
      faces.face[d][k] = i;
      faces.above[d][k] = upper;
      faces.below[d][k] = lower;
      if (i == e * dim + static_cast<std::size_t>(d)) continue;
      // On the far side of a sliver, which lies between the node's plane and it.
      faces.above[d][k] = f.soil_below ? -1 : lower;
      faces.below[d][k] = f.soil_below ? upper : -1;
    }
  });
  return faces;
}

/// Changes of the pressure gradients at a node, G of the pressure and G_S of S p [N].
template <class M>
void gradient_changes(const State<M>& state, const CellView<M>& view, Real (&force)[State<M>::dim],
                      Real (&bishop)[State<M>::dim]) {
  constexpr int dim = State<M>::dim;
  const auto& r = state.system.response[static_cast<std::size_t>(view.entry())];
  Real reference[dim] = {};
  for (int d = 0; d < dim; ++d) force[d] = bishop[d] = 0;
  for_cells_around(view, [&](int corner, std::int32_t e) {
    const auto* u = own_unknown(state, e);
    if (!u) return;
    for (int d = 0; d < dim; ++d) {
      force[d] += u->quad_change * u->weight[corner][d];
      bishop[d] += u->bishop_change * u->weight[corner][d];
    }
    const auto& cell = state.nodes.cell[static_cast<std::size_t>(e)];
    if (cell.has_reference)
      for (int d = 0; d < dim; ++d)
        reference[d] += cell.reference_share[d] * (u->pressure - u->start);
  });
  if (r.references > 0)
    for (int d = 0; d < dim; ++d) force[d] -= reference[d] / r.references * r.gradient[d];
}

/// Changes of the forces on both phases of a node by the trial pressures.
template <class M>
void force_changes(const State<M>& state, const CellView<M>& view,
                   Real (&liquid_force)[State<M>::dim], Real (&solid_force)[State<M>::dim]) {
  constexpr int dim = State<M>::dim;
  const auto& r = state.system.response[static_cast<std::size_t>(view.entry())];
  Real force[dim], bishop[dim];
  gradient_changes(state, view, force, bishop);
  for (int d = 0; d < dim; ++d) {
    liquid_force[d] = r.liquid_part * force[d];
    solid_force[d] = r.bishop_part * bishop[d] - r.pore_part[d] * force[d];
  }
}

/// Calls f(view, node) for the nodes that move as the system of the skeleton says.
template <class M, class F>
void for_skeleton_nodes(State<M>& state, F&& f) {
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<State<M>::dim>& local, int slot, int) {
              const auto& node = state.system.skeleton.node[static_cast<std::size_t>(e)];
              if (node.row >= 0) f(CellView<M>(state, local, slot), node);
            });
}

/// Impulses by the changes of pressure at the nodes of the skeleton, as the system takes them.
template <class M>
void find_impulses(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& impulse = state.system.skeleton.impulse;
  for_skeleton_nodes(state, [&](const CellView<M>& view, const SkeletonNode<dim>& node) {
    Real liquid[dim], solid[dim];
    force_changes(state, view, liquid, solid);
    for (int d = 0; d < dim; ++d) {
      Real force = solid[d];
      for (int j = 0; j < dim; ++j) force += node.coupling[d][j] * liquid[j];
      impulse[row_of_axis<dim>(node, d)] = state.dt * force;
    }
  });
}

/// The answer of a node whose grains move as the system of the skeleton says.
template <class M>
void respond_with_skeleton(const State<M>& state, std::size_t i,
                           const Real (&liquid_force)[State<M>::dim], Real (&liquid)[State<M>::dim],
                           Real (&solid)[State<M>::dim]) noexcept {
  constexpr int dim = State<M>::dim;
  const auto& skeleton = state.system.skeleton;
  const auto& node = skeleton.node[i];
  const auto& r = state.system.response[i];
  for (int d = 0; d < dim; ++d) solid[d] = skeleton.velocity[row_of_axis<dim>(node, d)];
  for (int d = 0; d < dim; ++d) {
    liquid[d] = 0;
    for (int j = 0; j < dim; ++j)
      liquid[d] += node.liquid_mobility[d][j] * liquid_force[j] + node.coupling[d][j] * solid[j];
    if (r.liquid_held & (1 << d)) liquid[d] = 0;
    if (r.follows) liquid[d] = solid[d];
  }
}

/// Velocities of one node at the trial pressures.
template <class M>
void respond_node(State<M>& state, const CellView<M>& view) {
  constexpr int dim = State<M>::dim;
  auto& nodes = state.nodes;
  const auto i = static_cast<std::size_t>(view.entry());
  const auto& r = state.system.response[i];
  if (!r.active) return;
  Real liquid_force[dim], solid_force[dim], liquid[dim], solid[dim];
  force_changes(state, view, liquid_force, solid_force);
  if (state.system.skeleton.on && state.system.skeleton.node[i].row >= 0)
    respond_with_skeleton(state, i, liquid_force, liquid, solid);
  else
    respond(r, liquid_force, solid_force, liquid, solid);
  for (int d = 0; d < dim; ++d) {
    liquid[d] += r.liquid[d];
    solid[d] += r.solid[d];
    nodes.liquid_out[i][lane::velocity + d] = liquid[d];
    nodes.liquid_out[i][lane::increment + d] = liquid[d] - r.liquid_before[d];
    if constexpr (is_deformable<M>) {
      nodes.solid_out[i][lane::velocity + d] = solid[d];
      nodes.solid_out[i][lane::increment + d] = solid[d] - r.solid_before[d];
    }
    nodes.mixture[i][d] = r.porosity * liquid[d] + (1 - r.porosity) * solid[d];
    nodes.relative[i][d] = r.porosity * (liquid[d] - solid[d]);
  }
  if constexpr (has_skeleton<M>) {
    const NodeFaces<dim> faces = faces_of_node(view);
    for (int d = 0; d < dim; ++d) {
      if (faces.count[d] == 0) continue;
      Real sum = 0;
      for (int k = 0; k < faces.count[d]; ++k) sum += nodes.face[faces.face[d][k]].head_gradient;
      nodes.relative[i][4 + d] = sum / faces.count[d];
    }
  }
}

/// Velocities of all nodes at the trial pressures.
template <class M>
void respond_nodes(State<M>& state) {
  if (state.system.skeleton.on) {
    find_impulses(state);
    respond_skeleton(state.system.skeleton, state.options.threads);
  }
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t, const Index<State<M>::dim>& local, int slot, int) {
              respond_node(state, CellView<M>(state, local, slot));
            });
}

}  // namespace vadose::kernel
