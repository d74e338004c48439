// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Cell pressures at the end of a step from the water ledger, by Newton's method: in every cell
/// M_c / rho_l0 + dt (inflow) = sum V j theta(p', n'), j = exp(dt div v^s), n' = 1 - (1 - n) / j, with
/// fluxes and velocities at the new pressures. The residual is the ledger itself: what a solution
/// leaves is found again in the next step, and exchanged water is conserved whatever its error.

#include <algorithm>
#include <numeric>
#include <vector>

#include <vadose/kernel/exchange.hpp>
#include <vadose/kernel/implicit_skeleton.hpp>

namespace vadose::kernel {

/// Pressure over volume strain of free water under tension [Pa]: a soft gap, so that water that
/// parts closes again where it parted.
inline constexpr Real gap_modulus = 2e4;

/// Newton's method has found the pressures when no cell has more water unbalanced than this part of
/// its pores.
inline constexpr Real balance_tolerance = 1e-13;
/// More than this part and the step is given up.
inline constexpr Real balance_limit = 1e-7;
inline constexpr int max_newton = 25;

/// Corner number of a cube index of zeros and ones.
template <int Dim>
constexpr int corner_number(const Index<Dim>& corner) noexcept {
  int number = 0;
  for (int d = 0; d < Dim; ++d) number += corner[d] << d;
  return number;
}

/// Lists the unknowns: cells that own a pressure and are part of a body of soil or water.
template <class M>
void list_unknowns(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& system = state.system;
  system.unknowns.clear();
  system.row_of.assign(state.grid.size(), -1);
  for_cells(state.grid, 1, [&](std::int32_t e, const Index<dim>& local, int slot, int) {
    const auto i = static_cast<std::size_t>(e);
    if (state.nodes.dof[i] != e || state.nodes.cell[i].drop) return;
    const auto& cell = state.nodes.cell[i];
    if (cell.kind == CellKind::soil && !(cell.pore_volume > 0)) return;
    PressureUnknown<dim> u;
    u.entry = e;
    u.start = u.pressure = cell.pressure;
    u.head = hydrostatic(state, cell.centroid, cell.quad_point);
    u.start_quad = cell.quad_pressure;
    u.free = cell.kind == CellKind::free;
    Real xi[dim];
    quad_coordinates(state, CellView<M>(state, local, slot).cell, cell, xi);
    for_cube<dim>(0, 2, [&](const Index<dim>& corner) {
      CornerFunction<dim> shape(xi, corner, 1 / state.grid.cell_size());
      if constexpr (State<M>::Kinematics::axisymmetric)
        shape.gradient[0] += shape.value / cell.quad_point[0];
      for (int d = 0; d < dim; ++d)
        u.weight[corner_number(corner)][d] = cell.quad_volume * shape.gradient[d];
    });
    system.row_of[i] = static_cast<std::int32_t>(system.unknowns.size());
    system.unknowns.push_back(u);
  });
}

/// Calls f(row, unknown, cell) for every unknown.
template <class M, class F>
void for_unknowns(State<M>& state, F&& f) {
  constexpr std::size_t chunk = 256;
  auto& unknowns = state.system.unknowns;
  parallel_for(
      (unknowns.size() + chunk - 1) / chunk, state.options.threads, [&](std::size_t c, int) {
        for (std::size_t i = c * chunk; i < std::min(unknowns.size(), (c + 1) * chunk); ++i)
          f(i, unknowns[i], state.nodes.cell[static_cast<std::size_t>(unknowns[i].entry)]);
      });
}

/// The block and local coordinates of an entry.
template <class M>
CellView<M> view_of(const State<M>& state, std::int32_t entry) noexcept {
  constexpr int dim = State<M>::dim;
  const int slot = entry / Block<dim>::cells;
  int rest = entry % Block<dim>::cells;
  Index<dim> local;
  for (int d = 0; d < dim; ++d) {
    local[d] = rest % Block<dim>::edge;
    rest /= Block<dim>::edge;
  }
  return CellView<M>(state, local, slot);
}

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

/// Calls f(corner number, entry) for the cells around a node; f(., -1) outside the box.
template <class M, class F>
void for_cells_around(const CellView<M>& node, F&& f) {
  constexpr int dim = State<M>::dim;
  for_cube<dim>(0, 2, [&](const Index<dim>& corner) {
    int at = node.at;
    bool inside = true;
    for (int d = 0; d < dim; ++d) {
      at -= corner[d] * BlockGrid<dim>::tile_stride(d);
      const int c = node.cell[d] - corner[d];
      inside = inside && c >= 0 && c < node.state.grid.cells()[d];
    }
    f(corner_number(corner), inside ? node.tile[at] : -1);
  });
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

/// Unknown of a cell around a node if it is its own, else nullptr.
template <class M>
const PressureUnknown<State<M>::dim>* own_unknown(const State<M>& state, std::int32_t e) noexcept {
  if (e < 0) return nullptr;
  const std::int32_t row = state.system.row_of[static_cast<std::size_t>(e)];
  return row < 0 ? nullptr : &state.system.unknowns[static_cast<std::size_t>(row)];
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

/// Impulses by the changes of pressure at the nodes of the skeleton, as the system takes them.
template <class M>
void find_impulses(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& skeleton = state.system.skeleton;
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<dim>& local, int slot, int) {
              const auto& node = skeleton.node[static_cast<std::size_t>(e)];
              if (node.row < 0) return;
              Real liquid[dim], solid[dim];
              force_changes(state, CellView<M>(state, local, slot), liquid, solid);
              for (int d = 0; d < dim; ++d) {
                Real force = solid[d];
                for (int j = 0; j < dim; ++j) force += node.coupling[d][j] * liquid[j];
                skeleton.impulse[row_of_axis<dim>(node, d)] = state.dt * force;
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
  for_cells(
      state.grid, state.options.threads,
      [&](std::int32_t e, const Index<dim>& local, int slot, int) {
        const CellView<M> view(state, local, slot);
        for (int d = 0; d < dim; ++d) {
          FaceFlux& face =
              state.nodes.face[static_cast<std::size_t>(e) * dim + static_cast<std::size_t>(d)];
          if (switches(face)) {
            const Real in = switched_flux(state, soil_cell(view, d, face), d, face).value;
            face.flux = face.soil_below ? -in : in;
          } else if (face.kind == FaceKind::closed || face.is_shut()) {
            face.flux = 0;
          } else if (face.kind == FaceKind::surface) {
            const SurfaceFlux flux = surface_flux(state, view, d, face);
            face.flux = face.area * flux.value;
            state.system
                .surface_slope[static_cast<std::size_t>(e) * dim + static_cast<std::size_t>(d)] = {
                flux.head_slope, flux.grain_slope};
          } else {
            face.flux = face.area * nodal_flux(state, view, d, face);
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
    sum_content<true>(state);
  }
  return find_residuals(state);
}

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
  const SurfaceSlope& slopes_of(int axis, int k) const {
    return state.system.surface_slope[faces.face[axis][k]];
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
          add_flux(d, k, column, area * slopes_of(d, k).grain * solid[d]);
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
          (surface ? -slopes_of(axis, k).head
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

/// Calls f(node entry, corner number of the cell in the node's block) for the nodes of a cell and of
/// the slivers that share its pressure.
template <class M, class F>
void for_nodes_of(const CellView<M>& view, F&& f) {
  constexpr int dim = State<M>::dim;
  for_members(view, [&](std::int32_t, const Index<dim>& step) {
    int at = view.at;
    for (int d = 0; d < dim; ++d) at += step[d] * BlockGrid<dim>::tile_stride(d);
    for_cube<dim>(0, 2, [&](const Index<dim>& corner) {
      int node = at;
      for (int d = 0; d < dim; ++d) node += corner[d] * BlockGrid<dim>::tile_stride(d);
      f(view.tile[node], corner_number(corner));
    });
  });
}

/// Unknown of the cell at a corner of a node's block, -1: none.
template <class M>
int row_at(const State<M>& state, std::int32_t entry) noexcept {
  if (entry < 0) return -1;
  const std::int32_t owner = state.nodes.dof[static_cast<std::size_t>(entry)];
  return owner < 0 ? -1 : state.system.row_of[static_cast<std::size_t>(owner)];
}

/// Makes the pattern of the matrix anew where cells or slivers changed.
template <class M>
void update_pattern(State<M>& state) {
  auto& system = state.system;
  if (system.row_of == system.last_row_of && state.nodes.dof == system.last_dof) return;
  system.last_row_of = system.row_of;
  system.last_dof = state.nodes.dof;
  std::vector<std::vector<int>> columns(system.unknowns.size());
  for (std::size_t row = 0; row < columns.size(); ++row) {
    auto& own = columns[row];
    own.push_back(static_cast<int>(row));
    for_nodes_of(view_of(state, system.unknowns[row].entry), [&](std::int32_t node, int) {
      if (node == state.grid.outside()) return;
      for_cells_around(view_of(state, node), [&](int, std::int32_t e) {
        const int column = row_at(state, e);
        if (column >= 0) own.push_back(column);
      });
    });
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
  }
  system.matrix.set_pattern(columns);
}

/// Derivatives of all residuals (times -1).
template <class M>
void assemble_matrix(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& system = state.system;
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<dim>& local, int slot, int) {
              const CellView<M> view(state, local, slot);
              NodeAssembly<M> assembly(state, view, system.blocks[static_cast<std::size_t>(e)]);
              if (assembly.skeleton_node())
                assembly.couple(system.skeleton.node[static_cast<std::size_t>(e)]);
              assembly.run();
            });
  for_unknowns(state, [&](std::size_t i, auto& u, auto& cell) {
    const int row = static_cast<int>(i);
    system.matrix.clear(row);
    system.matrix.add(row, row, u.held ? 1 : u.storage);
    if (u.held) return;
    const CellView<M> view = view_of(state, u.entry);
    for_nodes_of(view, [&](std::int32_t node, int corner) {
      if (node == state.grid.outside()) return;
      const auto& block = system.blocks[static_cast<std::size_t>(node)];
      for_cells_around(view_of(state, node), [&](int other, std::int32_t e) {
        const int column = row_at(state, e);
        if (column >= 0 && block.value[corner][other] != 0)
          system.matrix.add(row, column, block.value[corner][other]);
      });
    });
    if constexpr (has_skeleton<M>) {
      if (u.free || !cell.has_reference) return;
      for_faces(view, [&](int axis, const FaceFlux& face) {
        if (switches(face))
          system.matrix.add(row, row, -state.dt * switched_flux(state, cell, axis, face).slope);
      });
    }
  });
}

/// Adds what the balances take of pressures x through the motion of the skeleton to y.
template <class M>
void add_skeleton_product(State<M>& state, const std::vector<Real>& x, std::vector<Real>& y) {
  constexpr int dim = State<M>::dim;
  auto& skeleton = state.system.skeleton;
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<dim>& local, int slot, int) {
              const auto& node = skeleton.node[static_cast<std::size_t>(e)];
              if (node.row < 0) return;
              Real sum[dim] = {};
              for_cells_around(CellView<M>(state, local, slot), [&](int corner, std::int32_t c) {
                const int column = row_at(state, c);
                if (column < 0) return;
                for (int d = 0; d < dim; ++d)
                  sum[d] += node.force[corner][d] * x[static_cast<std::size_t>(column)];
              });
              for (int d = 0; d < dim; ++d) skeleton.impulse[row_of_axis<dim>(node, d)] = sum[d];
            });
  respond_skeleton(skeleton, state.options.threads);
  for_unknowns(state, [&](std::size_t row, auto& u, auto&) {
    if (u.held) return;
    for_nodes_of(view_of(state, u.entry), [&](std::int32_t e, int corner) {
      if (e == state.grid.outside()) return;
      const auto& node = skeleton.node[static_cast<std::size_t>(e)];
      if (node.row < 0) return;
      for (int d = 0; d < dim; ++d)
        y[row] += node.rate[corner][d] * skeleton.velocity[row_of_axis<dim>(node, d)];
    });
  });
}

/// What cells give way by the stiffness of their own soil alone, added to the matrix: with it its
/// factorisation stands for the whole one.
template <class M>
void add_own_compliance(State<M>& state) {
  auto& system = state.system;
  system.compliance.assign(system.unknowns.size(), 0);
  for_unknowns(state, [&](std::size_t i, auto& u, auto& cell) {
    if (u.held || u.free) return;
    system.compliance[i] = u.squeeze * u.bishop_slope / state.soils[cell.material].p_wave_modulus;
    system.matrix.add(static_cast<int>(i), static_cast<int>(i), system.compliance[i]);
  });
}

/// Changes of pressure from residuals; returns iterations.
template <class M>
int solve_linear(State<M>& state) {
  constexpr Real tolerance = 1e-8;
  constexpr int most = 1000;
  auto& system = state.system;
  const int threads = state.options.threads;
  if constexpr (is_deformable<M>) {
    if (system.skeleton.on) {
      add_own_compliance(state);
      return system.solver
          .solve(system.matrix, system.residual, system.change, tolerance, most, threads,
                 [&](const std::vector<Real>& x, std::vector<Real>& y) {
                   SparseSolver::multiply(system.matrix, x, y, threads);
                   for (std::size_t i = 0; i < x.size(); ++i) y[i] -= system.compliance[i] * x[i];
                   add_skeleton_product(state, x, y);
                 })
          .iterations;
    }
  }
  return system.solver
      .solve(system.matrix, system.residual, system.change, tolerance, most, threads)
      .iterations;
}

/// A step of Newton's method on one pressure. Storage changes a thousandfold where p crosses 0, and
/// that at one suction says nothing about that at ten times as much.
inline Real safe_change(Real pressure, Real change, Real floor, bool early) noexcept {
  if (pressure < 0) {
    const Real most = max(3e4, 0.5 * std::fabs(pressure));
    change = min(max(change, -most), max(most, -pressure));
    if (early && pressure < -1 && pressure + change > 0) change = -0.9 * pressure;
  } else if (pressure + change < -100) {
    change = -100 - pressure;
  }
  return max(change, floor - pressure);
}

/// The same between the last pressures that left too much water and too little: a change past one of them
/// would go to and fro between a full cell and one whose highest points drain. Their chord then (Illinois: the
/// residual of an end that stays counts half).
template <int Dim>
Real bracketed_change(PressureUnknown<Dim>& u, Real residual, Real change) noexcept {
  auto& own = residual > 0 ? u.low : u.high;
  auto& other = residual > 0 ? u.high : u.low;
  if (u.last_residual * residual > 0) other.residual *= 0.5;
  u.last_residual = residual;
  own = {u.pressure, residual, true};
  const Real back = other.pressure - u.pressure;
  if (!other.known || change * back <= 0 || std::fabs(change) < 0.99 * std::fabs(back))
    return change;
  return back * residual / (residual - other.residual);
}

/// Adds the solution of the linear system to the pressures; returns the largest change in relation to
/// 1e-9 of the pressure and 1e-6 Pa.
template <class M>
Real change_pressures(State<M>& state, int iteration) {
  auto& system = state.system;
  system.worst.assign(system.unknowns.size(), 0);
  for_unknowns(state, [&](std::size_t row, auto& u, auto& cell) {
    Real change = system.change[row];
    if constexpr (has_skeleton<M>)
      if (!u.free) {
        const Real floor = is_unsaturated<M> ? state.soils[cell.material].pressure_floor : -1e30;
        if (is_unsaturated<M>)
          change = bracketed_change(u, system.residual[row],
                                    safe_change(u.pressure, change, floor, iteration < 12));
      }
    u.pressure += change;
    system.worst[row] = std::fabs(change) / (1e-6 + 1e-9 * std::fabs(u.pressure));
  });
  Real worst = 0;
  for (const Real w : system.worst) worst = is_finite(w) ? max(worst, w) : 1e300;
  return worst;
}

/// Largest change of saturation in a cell over the step.
template <class M>
Real saturation_change(State<M>& state) {
  if constexpr (!is_unsaturated<M>) {
    return 0;
  } else {
    auto& system = state.system;
    system.worst.assign(system.unknowns.size(), 0);
    for_unknowns(state, [&](std::size_t row, auto& u, auto& cell) {
      if (u.free) return;
      const Record sums = member_sums(view_of(state, u.entry), state.nodes.content);
      const Real bulk = cell.pore_volume / max(cell.porosity, 1e-6);
      const Real pores = cell.pore_volume + bulk * (std::exp(state.dt * cell.skeleton_rate) - 1);
      const Real compression = std::exp(u.pressure / state.water.bulk_modulus);
      const Real saturation = min(1.0, sums[lane::content] / (pores * compression));
      system.worst[row] = std::fabs(saturation - cell.saturation);
    });
    return std::accumulate(system.worst.begin(), system.worst.end(), 0.0,
                           [](Real a, Real b) { return max(a, b); });
  }
}

/// DEVIATION: [Zhan] steps through slow periods by dynamics too.
/// Chooses how the skeleton stands a step longer than that of its waves: its motion is solved for, or the
/// grains have more inertia, (dt / dt_wave)^2 of their own.
template <class M>
void choose_skeleton(State<M>& state) {
  auto& system = state.system;
  const Real ratio = state.dt / system.wave_dt;
  const bool slow = state.options.quasi_static.on && !state.frozen && ratio > 1;
  const bool solves = slow && state.options.quasi_static.skeleton == SlowSkeleton::implicit;
  system.report.inertia = slow && !solves ? ratio * ratio : 1;
  if constexpr (is_deformable<M>) {
    system.report.skeleton = system.skeleton.on = solves;
    if (solves) system.skeleton.node.assign(state.grid.size(), {});
  }
}

/// All weights and loads, as lengths [N].
template <class M>
Real weights_and_loads(const State<M>& state, Real mass) noexcept {
  Real sum = mass * state.gravity.norm();
  for (const auto& load : state.loads)
    sum += load.force.norm() * std::fabs(state.factor_values[load.factor]);
  return sum;
}

/// Measures the share of forces out of balance in the weights and loads, where the skeleton is solved for.
template <class M>
void find_unbalanced_share(State<M>& state) {
  const auto& system = state.system;
  Real mass = 0, unbalanced = 0;
  for (std::size_t i = 0; i < system.skeleton.node.size(); ++i) {
    const auto& node = system.skeleton.node[i];
    if (!(node.inertia[0][0] > 0)) continue;
    mass += state.nodes.solid_in[i][lane::mass] + state.nodes.liquid_in[i][lane::mass];
    unbalanced += node.unbalanced;
  }
  const Real forces = weights_and_loads(state, mass);
  state.system.report.inertia_share = forces > 0 ? unbalanced / forces : 1;
}

/// Measures the share of inertia in the weights and loads in a step that may be quasi-static.
template <class M>
void find_inertia_share(State<M>& state) {
  constexpr int dim = State<M>::dim;
  if (!state.options.quasi_static.on) return;
  if constexpr (is_deformable<M>) {
    const auto slots = static_cast<std::size_t>(state.grid.slots());
    auto& sums = state.system.worst;
    sums.assign(2 * slots, 0);
    for_cells(state.grid, state.options.threads,
              [&](std::int32_t e, const Index<dim>&, int slot, int) {
                const auto i = static_cast<std::size_t>(e), s = static_cast<std::size_t>(slot);
                const Real mass = state.nodes.solid_in[i][lane::mass];
                Real change2 = 0;
                for (int d = 0; d < dim; ++d)
                  change2 += power<2>(state.nodes.solid_out[i][lane::increment + d]);
                sums[2 * s] += mass * std::sqrt(change2);
                sums[2 * s + 1] += mass + state.nodes.liquid_in[i][lane::mass];
              });
    Real change = 0, mass = 0;
    for (std::size_t s = 0; s < slots; ++s) {
      change += sums[2 * s];
      mass += sums[2 * s + 1];
    }
    auto& report = state.system.report;
    const Real forces = weights_and_loads(state, mass);
    report.inertia_share = forces > 0 ? report.inertia * change / (state.dt * forces) : 1;
  }
}

/// The share of inertia as the next steps are to see it: highest values count on for a while. (A step that
/// followed each swing of a wave would add inertia where the grains are fastest, and so drive the wave.)
template <class M>
void remember_inertia(State<M>& state) noexcept {
  constexpr Real keeps = 0.97;  // of the last value, per step
  auto& share = state.system.inertia_share;
  if (state.system.report.skeleton)  // damps waves by itself
    share = state.system.report.inertia_share;
  else
    share = max(state.system.report.inertia_share, keeps * share);
}

/// What the length of a quasi-static step is to be multiplied by to bring a share of inertia to what the
/// options ask for, as it grows with the square of the step; infinite in other steps.
template <class M>
Real inertia_factor(const State<M>& state, Real share) noexcept {
  if (!state.options.quasi_static.on || !(share > 0)) return 1e300;
  return 0.9 * std::sqrt(state.options.quasi_static.inertia / share);
}

/// Gives the cells their pressures of the start of the step back.
template <class M>
void restore_pressures(State<M>& state) {
  for_unknowns(state, [&](std::size_t, auto& u, auto& cell) {
    cell.pressure = u.start;
    cell.quad_pressure = u.start_quad;
  });
}

/// Adds what no phase takes of the changes of pressure, as advance_nodes does of the pressures
/// before the step.
template <class M>
void count_open_impulse(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& open = state.nodes.open_impulse;
  open.assign(static_cast<std::size_t>(state.grid.slots() * dim), 0);
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<dim>& local, int slot, int) {
              const auto& r = state.system.response[static_cast<std::size_t>(e)];
              if (!r.active) return;
              Real force[dim], bishop[dim];
              gradient_changes(state, CellView<M>(state, local, slot), force, bishop);
              for (int d = 0; d < dim; ++d) {
                const Real full = bishop[d] - r.liquid_part * force[d];
                const Real taken =
                    r.grains ? r.bishop_part * bishop[d] - r.pore_part[d] * force[d] : 0;
                open[static_cast<std::size_t>(slot * dim + d)] += state.dt * (full - taken);
              }
            });
  for (std::size_t i = 0; i < open.size(); ++i)
    state.open_impulse[static_cast<int>(i % dim)] += open[i];
}

/// What the points need to know of the solution.
template <class M>
void accept_pressures(State<M>& state) {
  for_unknowns(state, [&](std::size_t, auto& u, auto& cell) {
    cell.change = u.pressure - u.start;
    cell.solved = true;
  });
  restore_pressures(state);
}

/// Newton's method; whether it found the pressures. On the way cells hold trial pressures.
template <class M>
bool solve_pressures(State<M>& state) {
  auto& system = state.system;
  SolveReport& report = system.report;
  list_unknowns(state);
  if constexpr (is_deformable<M>)
    if (system.skeleton.on && !predict_skeleton(state)) return false;
  if (system.unknowns.empty()) {
    if (system.skeleton.on) respond_nodes(state);
    return true;
  }
  update_pattern(state);
  system.blocks.resize(state.grid.size());
  system.start_gradient.resize(state.nodes.face.size());
  system.surface_slope.resize(state.nodes.face.size());
  for (std::size_t i = 0; i < state.nodes.face.size(); ++i)
    system.start_gradient[i] = state.nodes.face[i].head_gradient;
  Real change = 1e300;
  for (int iteration = 0;; ++iteration) {
    report.residual = evaluate_trial(state);
    report.newton += iteration > 0;
    if (report.residual <= balance_tolerance) break;
    if (report.residual <= balance_limit && change <= 1) break;
    if (iteration == max_newton || !(report.residual < 1e100)) break;
    assemble_matrix(state);
    report.linear += solve_linear(state);
    change = change_pressures(state, iteration);
  }
  return report.residual <= balance_limit;
}

}  // namespace vadose::kernel
