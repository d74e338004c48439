// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Fluxes and water balances of the cells at the trial pressures of an implicit solution.

#include <algorithm>
#include <cmath>

#include <vadose/kernel/node_response.hpp>

namespace vadose::kernel {

/// Pressure over volume strain of free water under tension [Pa]: a soft gap, so that water that
/// parts closes again where it parted.
inline constexpr Real gap_modulus = 2e4;

/// A surface whose flux switches: rain and films enter as supplied or as the soil takes them, seepage
/// leaves or does not. It follows from the trial pressure of the cell alone.
inline bool switches(const FaceFlux& face) noexcept {
  return face.kind == FaceKind::surface && (face.fed || face.one_way);
}

/// Flux into the soil through a face that switches [m3/s] and its derivative to the pressure of the
/// cell [m3/(s Pa)].
struct SwitchedFlux {
  Real value = 0;
  Real slope = 0;
};

template <class M>
SwitchedFlux switched_flux(const State<M>& state, const Cell<State<M>::dim>& soil, int axis,
                           const FaceFlux& face) {
  const Real inward = face.soil_below ? face.head_gradient : -face.head_gradient;
  if (face.one_way && inward >= 0) return {};
  const bool full = inward > 0 || soil.pressure >= 0;
  FaceFlux trial = face;
  trial.saturation = full ? 1 : soil.saturation;
  trial.conductivity =
      face.outward * face_conductivity(state, soil.material,
                                       full ? soil.saturated_conductivity : soil.conductivity,
                                       soil.pressure, face.held_pressure, soil.soil_porosity,
                                       gravity_head(state, axis, face.distance));
  const auto flux = driven_flux(state, trial, soil, inward, 0);
  if (face.fed && face.area * flux.value >= face.supply) return {face.supply, 0};
  return {face.area * flux.value, -face.area * flux.slope / face.distance};
}

/// All face fluxes at the trial pressures.
template <class M>
void find_implicit_fluxes(State<M>& state) {
  constexpr int dim = State<M>::dim;
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<dim>& local, int slot, int) {
              const CellView<M> view(state, local, slot);
              const FaceHeads<M> heads = find_face_heads(state, view);
              for (int d = 0; d < dim; ++d) {
                const std::size_t f =
                    static_cast<std::size_t>(e) * dim + static_cast<std::size_t>(d);
                FaceFlux& face = state.nodes.face[f];
                if (switches(face)) {
                  const Real in = switched_flux(state, soil_cell(view, d, face), d, face).value;
                  face.flux = face.soil_below ? -in : in;
                } else if (face.kind == FaceKind::closed || face.is_shut()) {
                  face.flux = 0;
                } else if (face.kind == FaceKind::surface) {
                  const SurfaceFlux flux = surface_flux(state, view, d, face);
                  face.flux = face.area * flux.value;
                  state.system.surface_flux[f] = flux;
                } else {
                  face.flux = face.area * nodal_flux(state, view, d, face, heads);
                }
              }
            });
}

/// Clears content and storage of all cells.
template <class M>
void clear_trial_content(State<M>& state) {
  std::fill(state.nodes.retry.begin(), state.nodes.retry.end(), char{1});
  parallel_for(
      static_cast<std::size_t>(state.grid.slots()), state.options.threads, [&](std::size_t s, int) {
        constexpr std::size_t cells = Block<State<M>::dim>::cells;
        for (std::size_t i = s * cells; i < (s + 1) * cells; ++i)
          state.nodes.content[i][lane::content] = state.nodes.content[i][lane::storage] = 0;
      });
}

/// Water that is in a soil cell after the step at its trial pressure, and its derivatives.
template <class M>
Real trial_content(const State<M>& state, const CellView<M>& view, const Cell<State<M>::dim>& cell,
                   PressureUnknown<State<M>::dim>& u) {
  const Real compression = std::exp(u.pressure / state.water.bulk_modulus);
  const Real bulk = cell.pore_volume / max(cell.porosity, 1e-6);
  const Real stretch = std::exp(state.dt * cell.skeleton_rate);
  const Real pores = cell.pore_volume + bulk * (stretch - 1);
  if constexpr (is_unsaturated<M>) {
    const Record sums = member_sums(view, state.nodes.content);
    u.storage = max(sums[lane::storage], 1e-14 * pores / state.water.bulk_modulus);
    const Real saturation = sums[lane::content] / (pores * compression);
    const Real n = pores / (bulk * stretch);
    Real slope = 0;
    if (is_deformable<M> && u.pressure < 0)
      slope =
          swrc::porosity_slope<Real>(state.soils[cell.material].material.retention, -u.pressure, n);
    u.squeeze = bulk * stretch * compression * (saturation + n * (1 - n) * slope);
    return sums[lane::content];
  } else {
    const Real content = pores * compression;
    u.storage = content / state.water.bulk_modulus;
    u.squeeze = bulk * stretch * compression;
    return content;
  }
}

/// Volume strain of free water at a pressure; below 0 along the gap.
template <class M>
Real free_strain(const State<M>& state, Real p) noexcept {
  return p / (p > 0 ? state.water.bulk_modulus : gap_modulus);
}

/// Water volume that a trial leaves unbalanced in a cell [m3], > 0: too much water.
template <class M>
Real find_residual(State<M>& state, PressureUnknown<State<M>::dim>& u, Cell<State<M>::dim>& cell) {
  constexpr int dim = State<M>::dim;
  u.held = false;
  if (u.free) {
    const Real quad = u.pressure + u.head;
    u.storage = cell.quad_volume / (quad > 0 ? state.water.bulk_modulus : gap_modulus);
    return -cell.quad_volume *
           (state.dt * cell.rate + free_strain(state, quad) - free_strain(state, u.start + u.head));
  }
  const CellView<M> view = view_of(state, u.entry);
  Real inflow = 0;
  if constexpr (has_skeleton<M>)
    for_inflows(state, view, [&](const Inflow<dim>& f) { inflow += f.flux; });
  Real residual = cell.water / state.water.density + state.dt * inflow;
  if constexpr (has_skeleton<M>) residual -= trial_content(state, view, cell, u);
  if constexpr (is_unsaturated<M>)
    u.held = residual < 0 && u.pressure <= state.soils[cell.material].pressure_floor;
  return u.held ? 0 : residual;
}

/// Residuals of all cells; returns the largest over the pores of its cell.
template <class M>
Real find_residuals(State<M>& state) {
  auto& system = state.system;
  system.residual.resize(system.unknowns.size());
  system.worst.assign(system.unknowns.size(), 0);
  for_unknowns(state, [&](std::size_t row, auto& u, auto& cell) {
    system.residual[row] = find_residual(state, u, cell);
    const Real volume = u.free ? cell.quad_volume : cell.pore_volume;
    system.worst[row] = volume > 0 ? std::fabs(system.residual[row]) / volume : 0;
  });
  Real worst = 0;
  for (const Real r : system.worst) worst = is_finite(r) ? max(worst, r) : 1e300;
  return worst;
}

/// Everything that follows from the trial pressures; returns the largest residual.
template <class M>
Real evaluate_trial(State<M>& state) {
  for_unknowns(state, [&](std::size_t, auto& u, auto& cell) { set_trial(state, u, cell); });
  if constexpr (has_skeleton<M>) update_heads(state);
  respond_nodes(state);
  find_rates(state);
  if constexpr (has_skeleton<M>) find_implicit_fluxes(state);
  if constexpr (is_unsaturated<M>) {
    clear_trial_content(state);
    find_heads(state, state.nodes.retry);
    sum_content<true>(state);
  }
  return find_residuals(state);
}

}  // namespace vadose::kernel
