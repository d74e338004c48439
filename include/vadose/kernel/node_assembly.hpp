// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Derivatives of the balances of the cells around one node.

#include <vadose/kernel/cell_balance.hpp>

namespace vadose::kernel {

/// Derivative of a head gradient at a node to the pressure of a cell beside the face; 0 where that
/// pressure is held or has no effect.
template <class M>
Real head_slope([[maybe_unused]] const State<M>& state, const FaceFlux& face, bool above) noexcept {
  const bool soil_side = face.kind == FaceKind::inside || face.soil_below != above;
  if (!soil_side && face.kind == FaceKind::surface) return 0;
  if (!soil_side && !(face.held_pressure > 0)) return 0;
  return (above ? 1 : -1) / face.distance;
}

/// Adds the derivatives of the balances of the cells around a node through its velocities and its
/// share of the faces.
template <class M>
struct NodeAssembly {
  static constexpr int dim = State<M>::dim;
  static constexpr int corners = 1 << dim;
  using Block_ = typename PressureSystem<dim>::NodeBlock;

  const State<M>& state;
  const CellView<M>& view;
  const NodeResponse<dim>& response;
  std::int32_t cell[corners];                ///< around the node, -1: outside
  const PressureUnknown<dim>* own[corners];  ///< those that own their pressure
  NodeFaces<dim> faces;
  Block_& block;

  NodeAssembly(const State<M>& s, const CellView<M>& v, Block_& b)
      : state(s),
        view(v),
        response(s.system.response[static_cast<std::size_t>(v.entry())]),
        block(b) {
    block = {};
    for_cells_around(view, [&](int corner, std::int32_t e) {
      cell[corner] = e;
      own[corner] = own_unknown(state, e);
    });
    if constexpr (has_skeleton<M>) faces = faces_of_node(view);
  }

  /// Forces per pressure of the cell at a corner.
  void force_slopes(int column, Real (&liquid_force)[dim], Real (&solid_force)[dim]) const {
    const auto& u = *own[column];
    const auto& c = state.nodes.cell[static_cast<std::size_t>(u.entry)];
    for (int d = 0; d < dim; ++d) {
      Real force = u.quad_slope * u.weight[column][d];
      if (response.references > 0 && c.has_reference)
        force -= c.reference_share[d] / response.references * response.gradient[d];
      liquid_force[d] = response.liquid_part * force;
      solid_force[d] = response.bishop_part * u.bishop_slope * u.weight[column][d] -
                       response.pore_part[d] * force;
    }
  }

  /// Velocities per pressure of the cell at a corner; where the skeleton is solved for, with its grains
  /// at rest.
  void velocity_slopes(int column, Real (&liquid)[dim], Real (&solid)[dim]) const {
    Real liquid_force[dim], solid_force[dim];
    force_slopes(column, liquid_force, solid_force);
    const SkeletonNode<dim>* node = skeleton_node();
    if (!node) return respond(response, liquid_force, solid_force, liquid, solid);
    for (int d = 0; d < dim; ++d) {
      liquid[d] = solid[d] = 0;
      if (response.follows || (response.liquid_held & (1 << d))) continue;
      for (int j = 0; j < dim; ++j) liquid[d] += node->liquid_mobility[d][j] * liquid_force[j];
    }
  }

  /// The node in the system of the skeleton, null where none is solved.
  const SkeletonNode<dim>* skeleton_node() const {
    if (!state.system.skeleton.on) return nullptr;
    const auto& node = state.system.skeleton.node[static_cast<std::size_t>(view.entry())];
    return node.row < 0 ? nullptr : &node;
  }

  /// Impulses of the skeleton's node per pressure of the cells around, and what their balances take from
  /// its velocity.
  void couple(SkeletonNode<dim>& node) {
    for (int c = 0; c < corners; ++c) {
      for (int d = 0; d < dim; ++d) node.force[c][d] = node.rate[c][d] = 0;
      if (!own[c]) continue;
      Real liquid[dim], solid[dim];
      force_slopes(c, liquid, solid);
      for (int d = 0; d < dim; ++d) {
        node.force[c][d] = state.dt * solid[d];
        for (int j = 0; j < dim; ++j)
          node.force[c][d] += state.dt * node.coupling[d][j] * liquid[j];
      }
    }
    for (int axis = 0; axis < dim; ++axis) {
      if (node.held & (1 << axis)) continue;
      Real liquid[dim], solid[dim] = {};
      solid[axis] = 1;
      for (int d = 0; d < dim; ++d) {
        liquid[d] = response.liquid_held & (1 << d) ? 0 : node.coupling[d][axis];
        if (response.follows) liquid[d] = solid[d];
      }
      block = {};
      for (int row = 0; row < corners; ++row)
        if (own[row]) add_rates(row, 0, liquid, solid);
      if constexpr (has_skeleton<M>) add_fluxes(0, liquid, solid);
      for (int c = 0; c < corners; ++c) node.rate[c][axis] = block.value[c][0];
    }
    block = {};
  }

  /// Balance of a cell through the volume rates at its quadrature point.
  void add_rates(int row, int column, const Real (&liquid)[dim], const Real (&solid)[dim]) {
    const auto& u = *own[row];
    const auto& c = state.nodes.cell[static_cast<std::size_t>(u.entry)];
    Real rate = 0;
    for (int d = 0; d < dim; ++d)
      rate +=
          u.weight[row][d] *
          (u.free ? response.porosity * liquid[d] + (1 - response.porosity) * solid[d] : solid[d]);
    block.value[row][column] += state.dt * rate *
                                (u.free              ? 1
                                 : c.quad_volume > 0 ? u.squeeze / c.quad_volume
                                                     : 0);
  }

  /// Balance of the cells on both sides of a face: flux per pressure of the cell at `column`.
  void add_flux(int axis, int k, int column, Real flux) {
    const int above = faces.above[axis][k], below = faces.below[axis][k];
    if (above >= 0) block.value[above][column] -= state.dt * flux;
    if (below >= 0) block.value[below][column] += state.dt * flux;
  }

  /// The soil whose water passes a face of the node.
  const Cell<dim>& soil_of(int axis, int k) const {
    const FaceFlux& face = state.nodes.face[faces.face[axis][k]];
    const int above = faces.above[axis][k], below = faces.below[axis][k];
    const int corner = below < 0 || (above >= 0 && face.is_from_above()) ? above : below;
    const auto owner = state.nodes.dof[static_cast<std::size_t>(cell[corner])];
    return state.nodes.cell[static_cast<std::size_t>(owner)];
  }

  /// How a face of the ground or a wall answers, by the last trial.
  const SurfaceFlux& surface_flux_of(int axis, int k) const {
    return state.system.surface_flux[faces.face[axis][k]];
  }

  /// Flux through faces by the velocities of the node.
  void add_fluxes(int column, const Real (&liquid)[dim], const Real (&solid)[dim]) {
    const Record& resistances = state.nodes.mixture[static_cast<std::size_t>(view.entry())];
    for (int d = 0; d < dim; ++d)
      for (int k = 0; k < faces.count[d]; ++k) {
        const FaceFlux& face = state.nodes.face[faces.face[d][k]];
        if (switches(face)) continue;
        const Real area = face.area / (corners / 2);
        if (face.kind == FaceKind::to_free) {
          add_flux(d, k, column,
                   area * face.saturation * response.porosity * (liquid[d] - solid[d]));
          continue;
        }
        if (face.kind == FaceKind::surface) {
          add_flux(d, k, column, area * surface_flux_of(d, k).grain_slope * solid[d]);
          continue;
        }
        add_flux(d, k, column,
                 area * face_mobility(state, face, soil_of(d, k), 1) * resistances[4 + d] *
                     response.porosity * (liquid[d] - solid[d]));
      }
  }

  /// Flux through faces by the departure of their head gradients from the mean at the node, through
  /// the ground and walls by the head gradients themselves.
  void add_departures(int axis) {
    const int count = faces.count[axis];
    for (int k = 0; k < count; ++k) {
      const FaceFlux& face = state.nodes.face[faces.face[axis][k]];
      if (face.kind == FaceKind::to_free || switches(face)) continue;
      const bool surface = face.kind == FaceKind::surface;
      const Real mobility =
          face.area / (corners / 2) *
          (surface ? -surface_flux_of(axis, k).head_slope
                   : face_mobility(state, face, soil_of(axis, k), checkerboard_inertia));
      for (int j = 0; j < count; ++j) {
        const FaceFlux& other = state.nodes.face[faces.face[axis][j]];
        const Real weight = mobility * ((j == k ? 1.0 : 0.0) - (surface ? 0.0 : 1.0 / count));
        const int above = faces.above[axis][j], below = faces.below[axis][j];
        if (above >= 0) add_flux(axis, k, above, -weight * head_slope(state, other, true));
        if (below >= 0) add_flux(axis, k, below, -weight * head_slope(state, other, false));
      }
    }
  }

  void run() {
    if (!response.active) return;
    for (int column = 0; column < corners; ++column) {
      if (!own[column]) continue;
      Real liquid[dim], solid[dim];
      velocity_slopes(column, liquid, solid);
      for (int row = 0; row < corners; ++row)
        if (own[row]) add_rates(row, column, liquid, solid);
      if constexpr (has_skeleton<M>) add_fluxes(column, liquid, solid);
    }
    if constexpr (has_skeleton<M>)
      for (int d = 0; d < dim; ++d) add_departures(d);
  }
};

}  // namespace vadose::kernel
