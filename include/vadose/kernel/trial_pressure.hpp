// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// What trial pressures of an implicit solution do to the forces of cells and to the heads at faces.

#include <cmath>

#include <vadose/kernel/pressure_unknowns.hpp>

namespace vadose::kernel {

/// What a trial pressure does to the forces of its cell.
template <class M>
void set_trial(const State<M>& state, PressureUnknown<State<M>::dim>& u,
               Cell<State<M>::dim>& cell) {
  cell.pressure = u.pressure;
  const Real quad = u.pressure + u.head;
  if (u.free) {
    cell.quad_pressure = max(0.0, quad);
    u.quad_slope = quad > 0 ? 1 : 0;
    u.quad_change = u.bishop_change = cell.quad_pressure - u.start_quad;
    u.bishop_slope = u.quad_slope;
    return;
  }
  cell.quad_pressure = quad;
  u.quad_change = quad - u.start_quad;
  Real saturation = cell.saturation, slope = 0;
  if constexpr (is_unsaturated<M>) {
    const auto& retention = state.soils[cell.material].material.retention;
    const auto at = [&](Real p) {
      return swrc::saturation_and_slope<Real>(retention, max(0.0, -p), cell.porosity);
    };
    // The mean saturation of the cell is not that of its pressure quite; it keeps the difference,
    // less and less as the pressure goes away.
    const auto now = at(u.pressure);
    const Real span = state.water.density * state.gravity.norm() * state.grid.cell_size() + 1;
    const Real keep = max(0.0, 1 - std::fabs(u.pressure - u.start) / span);
    saturation = min(1.0, now.saturation + keep * (cell.saturation - at(u.start).saturation));
    if (u.pressure < 0) slope = -now.slope;
  }
  u.bishop_change = saturation * quad - cell.saturation * u.start_quad;
  u.bishop_slope = saturation + slope * quad;
}

/// Change of the pressure on one side of a face since the start of the step.
template <class M>
Real pressure_change(const State<M>& state, std::int32_t owner) noexcept {
  if (owner < 0) return 0;
  const std::int32_t row = state.system.row_of[static_cast<std::size_t>(owner)];
  if (row < 0) return 0;
  const auto& u = state.system.unknowns[static_cast<std::size_t>(row)];
  return u.pressure - u.start;
}

/// Pressure of free water at the middle of a face to soil, before it is limited to 0 [Pa].
template <class M>
Real free_side_pressure(const State<M>& state, const CellView<M>& view, int axis,
                        const Cell<State<M>::dim>& soil, const Cell<State<M>::dim>& free) {
  Real at[State<M>::dim];
  for (int d = 0; d < State<M>::dim; ++d) at[d] = soil.centroid[d];
  at[axis] = face_centre(view, axis)[axis];
  return free.pressure + hydrostatic(state, free.centroid, at);
}

/// Head gradient of a face at the trial pressures.
template <class M>
void update_head(State<M>& state, const CellView<M>& view, int axis, std::size_t at) {
  FaceFlux& face = state.nodes.face[at];
  if (face.kind == FaceKind::closed || !(face.distance > 0)) return;
  const auto owner = [&](std::int32_t e) { return state.nodes.dof[static_cast<std::size_t>(e)]; };
  const std::int32_t above = owner(view.entry()), below = owner(view.neighbour(axis, -1));
  Real upper = pressure_change(state, above), lower = pressure_change(state, below);
  if (face.kind == FaceKind::to_free) {
    const auto& soil = state.nodes.cell[static_cast<std::size_t>(face.soil_below ? below : above)];
    const auto& free = state.nodes.cell[static_cast<std::size_t>(face.soil_below ? above : below)];
    Real& change = face.soil_below ? upper : lower;
    const Real now = free_side_pressure(state, view, axis, soil, free);
    change = max(0.0, now) - face.held_pressure;
  } else if (face.kind == FaceKind::surface) {
    (face.soil_below ? upper : lower) = 0;
  }
  face.head_gradient = state.system.start_gradient[at] + (upper - lower) / face.distance;
}

/// Head gradients of all faces at the trial pressures.
template <class M>
void update_heads(State<M>& state) {
  constexpr int dim = State<M>::dim;
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<dim>& local, int slot, int) {
              const CellView<M> view(state, local, slot);
              for (int d = 0; d < dim; ++d)
                update_head(state, view, d,
                            static_cast<std::size_t>(e) * dim + static_cast<std::size_t>(d));
            });
}

}  // namespace vadose::kernel
