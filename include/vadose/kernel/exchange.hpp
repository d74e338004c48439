// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Steps 4 and 8: water fluxes through faces and what each cell gains. Each flux leaves one cell
/// and enters another (or a counted boundary), so water is conserved to round-off.

#include <algorithm>
#include <limits>

#include <vadose/kernel/momentum.hpp>

namespace vadose::kernel {

/// Divergence at the middle of a cell of what its nodes hold in lanes 0 .. Dim - 1.
template <class M>
Real divergence(const CellView<M>& view, const AlignedVector<Record>& records) noexcept {
  constexpr int dim = State<M>::dim;
  Lanes all(0.0), low(0.0);
  for_cube<dim>(0, 2, [&](const Index<dim>& corner) {
    int at = view.at;
    for (int d = 0; d < dim; ++d) at += corner[d] * BlockGrid<dim>::tile_stride(d);
    const Lanes r = Lanes::load(records[static_cast<std::size_t>(view.tile[at])].value);
    all += r;
    low += lower_faces_at(corner) * r;
  });
  Real rise = 0;
  for (int d = 0; d < dim; ++d) rise += all[d] - 2 * low[d];
  return rise / (power<dim - 1>(2.0) * view.state.grid.cell_size());
}

/// The same at the quadrature point of a cell.
template <class M>
Real divergence_at_quad(const CellView<M>& view, const AlignedVector<Record>& records) noexcept {
  constexpr int dim = State<M>::dim;
  const auto& c = view.state.nodes.cell[static_cast<std::size_t>(view.entry())];
  Real xi[dim], rate = 0;
  quad_coordinates(view.state, view.cell, c, xi);
  for_cube<dim>(0, 2, [&](const Index<dim>& corner) {
    int at = view.at;
    for (int d = 0; d < dim; ++d) at += corner[d] * BlockGrid<dim>::tile_stride(d);
    CornerFunction<dim> shape(xi, corner, 1 / view.state.grid.cell_size());
    if constexpr (State<M>::Kinematics::axisymmetric)
      shape.gradient[0] += shape.value / c.quad_point[0];
    for (int d = 0; d < dim; ++d)
      rate += shape.gradient[d] * records[static_cast<std::size_t>(view.tile[at])][d];
  });
  return rate;
}

/// Volume rates of a cell at its quadrature point: div v^s of the skeleton, div q of free water.
/// The gradients are those of the pressure force, so that force and rate are adjoint. (They must
/// be: a mismatch of 1e-3 lets undrained soil grow by 1e-3 of its highest frequency.)
template <class M>
void find_rates(State<M>& state, const CellView<M>& view) noexcept {
  const auto& nodes = state.nodes;
  auto& c = state.nodes.cell[static_cast<std::size_t>(view.entry())];
  const bool in_middle = !State<M>::Kinematics::axisymmetric && !c.at_air && c.members == 1;
  const auto rate = [&](const AlignedVector<Record>& records) {
    return in_middle ? divergence(view, records) : divergence_at_quad(view, records);
  };
  c.rate = c.skeleton_rate = 0;
  if (c.drop) return;
  if (c.kind == CellKind::free) c.rate = rate(nodes.mixture);
  if constexpr (is_deformable<M>) c.skeleton_rate = rate(nodes.solid_out);
}

/// The same of all cells.
template <class M>
void find_rates(State<M>& state) {
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<State<M>::dim>& local, int slot, int) {
              if (state.nodes.dof[static_cast<std::size_t>(e)] == e)
                find_rates(state, CellView<M>(state, local, slot));
            });
}

/// Inertia in the mobility that acts against the head gradient which nodal means do not see: this much
/// keeps its explicit use stable in three dimensions at the default step (amplification of the
/// checkerboard 1 - 4 dim (c dt / h)^2 / 4).
inline constexpr Real checkerboard_inertia = 4;

/// Part of the liquid's velocity at a boundary face that is left after a step of drag alone:
/// [1 + dt A / rho]^-1, 0 in the drag limit.
template <class M>
Real inertia_share(const State<M>& state, const FaceFlux& face,
                   const Cell<State<M>::dim>& soil) noexcept {
  if (!(face.conductivity > 0)) return 0;
  return 1 / (1 + state.dt / state.water.density * face_drag(state, face, soil));
}

/// Entry of the node that gives the velocity at a corner of a face. At the surface of a sliver it is
/// the nearest node of the cell whose pressure the sliver shares: those beyond it hold no water (see
/// into_pressure_cell), and the water of the sliver would not pass.
template <class M>
std::int32_t flux_node(const State<M>& state, const CellView<M>& view, int axis,
                       const FaceFlux& face, const Index<State<M>::dim>& corner) noexcept {
  constexpr int dim = State<M>::dim;
  int at = view.at;
  for (int d = 0; d < dim; ++d) at += corner[d] * BlockGrid<dim>::tile_stride(d);
  if (face.kind == FaceKind::inside) return view.tile[at];
  const std::int32_t soil = soil_at(view, axis, face);
  const std::int32_t owner = state.nodes.dof[static_cast<std::size_t>(soil)];
  if (owner == soil) return view.tile[at];
  Index<dim> sliver = view.cell, node = view.cell;
  if (face.soil_below) --sliver[axis];
  for_cube<dim>(-1, 2, [&](const Index<dim>& step) {
    Index<dim> cell = sliver;
    for (int d = 0; d < dim; ++d) cell[d] += step[d];
    if (state.grid.entry(cell) != owner) return;
    for (int d = 0; d < dim; ++d)
      node[d] = std::clamp(view.cell[d] + corner[d], cell[d], cell[d] + 1);
  });
  return state.grid.entry(node);
}

/// Flux per area through the ground or a wall: drag and inertia of the water at the face itself, which
/// goes on with the velocity of its nodes before the step: q [rho / (n S dt) + gamma / k] =
/// rho (v^l_old - v^s) / dt - H. The new velocities of the nodes answer to all the faces around them; on a
/// staircase of cells the ground's side would drink what flows down behind it. Water that enters
/// through the ground is driven by its head and by no more inertia than the water itself has, not by grains
/// that fly off (they would draw water after them, more of it the faster they are). Without its inertia it
/// rings from step to step where the drag is slower than a step.
template <class M>
SurfaceFlux surface_flux(const State<M>& state, const CellView<M>& view, int axis,
                         const FaceFlux& face) {
  constexpr int dim = State<M>::dim;
  const auto& nodes = state.nodes;
  Real water = 0, grains = 0;
  for_cube<dim>(0, 2, [&](const Index<dim>& corner) {
    if (corner[axis]) return;
    const auto i = static_cast<std::size_t>(flux_node(state, view, axis, face, corner));
    const Record& liquid = nodes.liquid_out[i];
    water += liquid[lane::velocity + axis] - liquid[lane::increment + axis];
    if constexpr (is_deformable<M>) grains += nodes.solid_out[i][lane::velocity + axis];
  });
  constexpr Real corners = power<dim - 1>(2.0);
  const auto& soil = soil_cell(view, axis, face);
  const Real per_velocity = state.water.density / state.dt;
  const auto passes = [&](Real velocity, Real inertia, bool by_grains) -> SurfaceFlux {
    const Real drive = per_velocity * velocity / corners - face.head_gradient;
    const auto flux = driven_flux(state, face, soil, drive, inertia);
    return {flux.value, -flux.slope, by_grains ? -per_velocity * flux.slope : 0};
  };
  const Real into = face.soil_below ? -1 : 1;
  const SurfaceFlux flux = passes(water - grains, 1, true);
  const bool wall = view.cell[axis] == 0 || view.cell[axis] == state.grid.cells()[axis];
  const Real own = into * min(into * (water - grains), max(0.0, into * water));
  if (wall || into * flux.value <= 0 || own == water - grains) return flux;
  const SurfaceFlux steady = passes(0, 0, false), coasting = passes(own, 1, false);
  const SurfaceFlux most = into * steady.value > into * coasting.value ? steady : coasting;
  if (into * most.value <= 0) return {};
  return into * flux.value < into * most.value ? flux : most;
}

/// Part of the flux at a held pressure that passes [-]: all of it down its head gradient, else what drag
/// leaves of its inertia where it enters, or may pass both ways anywhere. (Stopped at once where it
/// enters a dam from its reservoir, it rings from step to step, by 1 kPa of 10.)
template <class M>
Real leaving_share(const State<M>& state, const CellView<M>& view, int axis, const FaceFlux& face,
                   Real flux) noexcept {
  if (flux * face.head_gradient <= 0) return 1;
  if (face.held < 0 || face.fed || face.one_way) return 0;
  const bool enters = face.soil_below ? flux < 0 : flux > 0;
  const bool both =
      enters || state.held[static_cast<std::size_t>(face.held)].kind == HeldKind::open;
  return both ? inertia_share(state, face, soil_cell(view, axis, face)) : 0;
}

/// What the nodes around the lower faces of a cell say of the water there, summed over those of each face.
/// Along an axis: the head gradient that drives it, as the velocities say, and the mean of the faces around
/// each node [Pa/m].
template <class M>
struct FaceHeads {
  static constexpr int dim = State<M>::dim;
  Real driving[dim] = {};
  Real mean[dim] = {};

  FaceHeads() = default;
  FaceHeads(const State<M>& state, const CellView<M>& view) noexcept {
    const auto& nodes = state.nodes;
    Lanes drives(0.0), means(0.0);  // in lanes 0 .. 2, in lanes 4 .. 6
    for_cube<dim>(0, 2, [&](const Index<dim>& corner) {
      int at = view.at;
      for (int d = 0; d < dim; ++d) at += corner[d] * BlockGrid<dim>::tile_stride(d);
      const auto i = static_cast<std::size_t>(view.tile[at]);
      const Lanes touches = lower_faces_at(corner);
      const Lanes relative = Lanes::load(nodes.relative[i].value);
      drives += swap_halves(Lanes::load(nodes.mixture[i].value)) * touches * relative;
      means += touches * relative;
    });
    for (int d = 0; d < dim; ++d) {
      driving[d] = drives[d];
      mean[d] = means[4 + d];
    }
  }
};

/// Flux per area between two soil cells: the head gradient that drives the water at the nodes of the face,
/// as their velocities say, times the mobility of the face. (A node's own is a mean over its faces, wet and
/// dry, inside and at the ground; across a slope they lie side by side, and the dry one would carry several
/// times what it can.) The departure of the head gradient between the cells from its nodal mean adds to it
/// and removes the checkerboard that nodes do not see. In the drag limit this is the two-point flux of the
/// face.
template <class M>
Real inside_flux(const State<M>& state, const CellView<M>& view, int axis, const FaceFlux& face,
                 const FaceHeads<M>& heads) noexcept {
  const auto& nodes = state.nodes;
  if (!(face.saturation > 0) || !(face.conductivity > 0)) return 0;
  constexpr Real corners = power<State<M>::dim - 1>(2.0);
  const std::int32_t side = face.is_from_above() ? view.entry() : view.neighbour(axis, -1);
  const auto& soil =
      nodes.cell[static_cast<std::size_t>(nodes.dof[static_cast<std::size_t>(side)])];
  const Real drag = face_drag(state, face, soil), inertia = state.water.density / state.dt;
  return soil.porosity * face.saturation *
         (heads.driving[axis] / corners / (inertia + drag) -
          (face.head_gradient - heads.mean[axis] / corners) /
              (checkerboard_inertia * inertia + drag));
}

/// The heads at the lower faces of a cell; zero where none of them lies between soil cells.
template <class M>
FaceHeads<M> find_face_heads(const State<M>& state, const CellView<M>& view) noexcept {
  constexpr int dim = State<M>::dim;
  const FaceFlux* face = &state.nodes.face[static_cast<std::size_t>(view.entry()) * dim];
  bool any = false;
  for (int d = 0; d < dim; ++d) any = any || face[d].kind == FaceKind::inside;
  return any ? FaceHeads<M>(state, view) : FaceHeads<M>();
}

/// Flux per area through the lower face of a cell along an axis. Free water passes as its points do, with
/// the velocity of the nodes.
template <class M>
Real nodal_flux(const State<M>& state, const CellView<M>& view, int axis, const FaceFlux& face,
                const FaceHeads<M>& heads) {
  constexpr int dim = State<M>::dim;
  if (face.kind == FaceKind::inside) return inside_flux(state, view, axis, face, heads);
  if (face.kind == FaceKind::surface) return surface_flux(state, view, axis, face).value;
  Real velocity = 0;
  for_cube<dim>(0, 2, [&](const Index<dim>& corner) {
    if (corner[axis]) return;
    velocity +=
        state.nodes
            .relative[static_cast<std::size_t>(flux_node(state, view, axis, face, corner))][axis];
  });
  return face.saturation * velocity / power<dim - 1>(2.0);
}

/// Flux through the lower face of a cell along an axis.
template <class M>
void find_flux(const State<M>& state, const CellView<M>& view, int axis, const FaceHeads<M>& heads,
               FaceFlux& face) {
  face.flux = 0;
  if (face.kind == FaceKind::closed) return;
  if (face.is_shut()) {
    face.flux = face.soil_below ? -face.supply : face.supply;
    return;
  }
  Real flux = nodal_flux(state, view, axis, face, heads);
  if (face.kind == FaceKind::surface) flux *= leaving_share(state, view, axis, face, flux);
  face.flux = face.area * flux;
  if (face.fed)  // no more than there is
    face.flux = face.soil_below ? max(face.flux, -face.supply) : min(face.flux, face.supply);
}

/// Fluxes through the lower faces of a cell.
template <class M>
void find_fluxes(State<M>& state, const CellView<M>& view) {
  constexpr int dim = State<M>::dim;
  const std::size_t first = static_cast<std::size_t>(view.entry()) * dim;
  const FaceHeads<M> heads = find_face_heads(state, view);
  for (int d = 0; d < dim; ++d) {
    const std::size_t i = first + static_cast<std::size_t>(d);
    find_flux(state, view, d, heads, state.nodes.face[i]);
    state.nodes.flux[i] = state.nodes.face[i].flux;
  }
}

/// One face of a pressure cell as seen from it and the cell beyond.
template <int Dim>
struct Inflow {
  Real flux = 0;                    ///< into the cell [m3/s], or water that passed [kg]
  const Cell<Dim>* from = nullptr;  ///< other side, nullptr: boundary
  const FaceFlux* face = nullptr;
  int axis = 0;    ///< across the face
  Real place = 0;  ///< of the face on that axis [m]
};

/// Calls f(inflow) for every face of a pressure cell and its slivers; flux_at(i) is the flux through face
/// i of the grid.
template <class M, class Flux, class F>
void for_inflows(const State<M>& state, const CellView<M>& view, Flux&& flux_at, F&& f) {
  constexpr int dim = State<M>::dim;
  const auto& nodes = state.nodes;
  const auto other = [&](std::int32_t e) -> const Cell<dim>* {
    const std::int32_t owner = nodes.dof[static_cast<std::size_t>(e)];
    return owner < 0 ? nullptr : &nodes.cell[static_cast<std::size_t>(owner)];
  };
  const auto face = [&](std::int32_t e, int axis) {
    return static_cast<std::size_t>(e) * dim + static_cast<std::size_t>(axis);
  };
  const auto visit = [&](std::int32_t e, std::int32_t below, std::int32_t above, int axis,
                         int step) {
    const std::size_t low = face(e, axis), high = face(above, axis);
    const Real flux_low = flux_at(low), flux_high = flux_at(high);
    const Real h = state.grid.cell_size();
    const Real place = state.grid.origin()[axis] + (view.cell[axis] + step) * h;
    if (flux_low != 0) f(Inflow<dim>{flux_low, other(below), &nodes.face[low], axis, place});
    if (flux_high != 0)
      f(Inflow<dim>{-flux_high, other(above), &nodes.face[high], axis, place + h});
  };
  for_members(view, [&](std::int32_t e, const Index<dim>& step) {
    if (e == view.entry()) {
      for (int d = 0; d < dim; ++d) visit(e, view.neighbour(d, -1), view.neighbour(d, 1), d, 0);
      return;
    }
    for (int d = 0; d < dim; ++d) {  // a sliver may lie at the rim of the tile
      Index<dim> below = view.cell, above = view.cell;
      for (int a = 0; a < dim; ++a) {
        below[a] += step[a] - (a == d ? 1 : 0);
        above[a] += step[a] + (a == d ? 1 : 0);
      }
      visit(e, state.grid.entry(below), state.grid.entry(above), d, step[d]);
    }
  });
}

/// The same of the faces as they are.
template <class M, class F>
void for_inflows(const State<M>& state, const CellView<M>& view, F&& f) {
  for_inflows(
      state, view, [&](std::size_t i) { return state.nodes.face[i].flux; }, f);
}

/// The same of the collected fluxes, of which loops read 8 bytes; of passed water once that is found.
template <class M, class F>
void for_collected_inflows(const State<M>& state, const CellView<M>& view, F&& f) {
  for_inflows(
      state, view, [&](std::size_t i) { return state.nodes.flux[i]; }, f);
}

/// Collects the fluxes of all faces.
template <class M>
void collect_fluxes(State<M>& state) {
  constexpr std::size_t faces = Block<State<M>::dim>::cells * State<M>::dim;
  parallel_for(static_cast<std::size_t>(state.grid.slots()), state.options.threads,
               [&](std::size_t s, int) {
                 for (std::size_t i = s * faces; i < (s + 1) * faces; ++i)
                   state.nodes.flux[i] = state.nodes.face[i].flux;
               });
}

/// A cell gives at most this part of its water in an explicit step.
inline constexpr Real largest_outflow = 0.5;

/// Limits the outflow of every cell to half the water it holds (soil cells of an implicit solution:
/// to what it holds and receives); on a sound scheme this does nothing, and what it holds back is
/// counted.
template <class M>
void limit_donors(State<M>& state) {
  constexpr int dim = State<M>::dim;
  state.nodes.limited.assign(static_cast<std::size_t>(state.grid.slots()), 0);
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<dim>& local, int slot, int) {
              const auto i = static_cast<std::size_t>(e);
              if (state.nodes.dof[i] != e) return;
              const auto& cell = state.nodes.cell[i];
              Real out = 0, in = 0;
              for_collected_inflows(state, CellView<M>(state, local, slot),
                                    [&](const Inflow<dim>& f) {
                                      out += max(0.0, -f.flux);
                                      in += max(0.0, f.flux);
                                    });
              out *= state.dt * state.water.density;
              const Real most = cell.solved && cell.kind == CellKind::soil
                                    ? cell.water + in * state.dt * state.water.density
                                    : largest_outflow * cell.water;
              state.nodes.donor[i] = {out > most ? most / out : 1, cell.water};
              if (out > most) state.nodes.limited[static_cast<std::size_t>(slot)] += out - most;
            });
  for (const Real held_back : state.nodes.limited) state.limited_water += held_back;
}

/// What passes between two cells counts if it is more than this part of what each holds: less is lost
/// in the last digits of the masses of their points, and at rest always to one side.
inline constexpr Real least_exchange = 16 * std::numeric_limits<Real>::epsilon();

/// Water that a collected flux carries through a face in the step, upwards > 0 [kg].
/// above, below: cells that own the pressures on both sides, -1: boundary.
template <class M>
Real passed_water(const State<M>& state, Real flux, std::int32_t above,
                  std::int32_t below) noexcept {
  const auto& donors = state.nodes.donor;
  const auto at = [&](std::int32_t e) -> const Donor& {
    return donors[static_cast<std::size_t>(e)];
  };
  const std::int32_t donor = flux < 0 ? above : below;
  const Real dm = state.dt * state.water.density * (donor < 0 ? 1 : at(donor).limit) * flux;
  const bool counts = above < 0 || below < 0 ||
                      std::fabs(dm) >= least_exchange * min(at(above).water, at(below).water);
  return counts ? dm : 0;
}

/// Turns the collected fluxes into the water that passes every face.
template <class M>
void find_passed_water(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& nodes = state.nodes;
  const auto owner = [&](std::int32_t e) { return nodes.dof[static_cast<std::size_t>(e)]; };
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<dim>& local, int slot, int) {
              const std::int32_t* tile = state.grid.tile(slot);
              const int at = BlockGrid<dim>::tile_index(local);
              Real* flux = &nodes.flux[static_cast<std::size_t>(e) * dim];
              for (int d = 0; d < dim; ++d)
                if (flux[d] != 0)
                  flux[d] = passed_water(state, flux[d], owner(e),
                                         owner(tile[at - BlockGrid<dim>::tile_stride(d)]));
            });
}

/// Water gained by a cell; what passes held boundaries is added to the ledger of its block.
template <class M>
void find_gain(State<M>& state, const CellView<M>& view, Cell<State<M>::dim>& cell) {
  auto& ledger = state.nodes.ledger_in;
  const std::size_t first = static_cast<std::size_t>(view.slot) * state.held.size();
  Real gain = 0, most = 0;
  cell.ground_axis = -1;
  for_collected_inflows(state, view, [&](const Inflow<State<M>::dim>& f) {
    gain += f.flux;
    if (cell.kind == CellKind::free && std::fabs(f.flux) > most &&
        f.face->kind == FaceKind::to_free) {
      most = std::fabs(f.flux);
      cell.ground_axis = static_cast<std::int8_t>(f.axis);
      cell.ground = f.place;
    }
    if (!f.from && f.face->held >= 0 && !f.face->fed)
      ledger[(first + static_cast<std::size_t>(f.face->held)) * 2 + (f.flux > 0 ? 0 : 1)] +=
          std::fabs(f.flux);
  });
  cell.gain = gain;
}

/// Pores of soil that free water fills for the most part (a free cell) stay full: what they lack or
/// have too much passes between them and the free points of the cell.
template <class M>
void fill_submerged_pores(const State<M>& state, Cell<State<M>::dim>& cell) noexcept {
  cell.pore_gain = 0;
  if (cell.kind != CellKind::free || !(cell.soil_pores > 0)) return;
  const Real full = state.water.density * cell.soil_pores *
                    std::exp(max(0.0, cell.pressure) / state.water.bulk_modulus);
  const Real wanted = full - cell.soil_water;
  cell.pore_gain = min(wanted, 0.5 * max(0.0, cell.water + cell.gain));
  cell.gain -= cell.pore_gain;
}

/// How fast the air-filled pores of a cell close: the next step must see their end coming.
template <class M>
void find_closing(const State<M>& state, Cell<State<M>::dim>& cell) noexcept {
  const Real bulk = cell.soil_pores / cell.soil_porosity;
  cell.closing = cell.gain / (state.water.density * state.dt) - bulk * cell.skeleton_rate;
}

/// What the fluxes bring to every cell, and the counts of held boundaries.
template <class M>
void find_gains(State<M>& state) {
  const std::size_t held = state.held.size();
  auto& nodes = state.nodes;
  nodes.ledger_in.assign(static_cast<std::size_t>(state.grid.slots()) * 2 * held, 0);
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<State<M>::dim>& local, int slot, int) {
              if (nodes.dof[static_cast<std::size_t>(e)] != e) return;
              auto& cell = nodes.cell[static_cast<std::size_t>(e)];
              find_gain(state, CellView<M>(state, local, slot), cell);
              fill_submerged_pores(state, cell);
              if constexpr (is_unsaturated<M>) find_closing(state, cell);
            });
  for (std::size_t h = 0; h < held; ++h)
    for (std::size_t s = 0; s < static_cast<std::size_t>(state.grid.slots()); ++s) {
      state.held[h].inflow += nodes.ledger_in[(s * held + h) * 2];
      state.held[h].outflow += nodes.ledger_in[(s * held + h) * 2 + 1];
    }
}

/// Step 8: what the collected fluxes bring to cells, films and submerged pores.
template <class M>
void book_collected_fluxes(State<M>& state) {
  limit_donors(state);
  find_passed_water(state);
  find_gains(state);
  settle_films(state);
}

/// The same of the faces as they are.
template <class M>
void book_fluxes(State<M>& state) {
  collect_fluxes(state);
  book_collected_fluxes(state);
}

/// Rates of all cells and fluxes of all faces: both read the velocities of the nodes around.
template <class M>
void find_rates_and_fluxes(State<M>& state) {
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<State<M>::dim>& local, int slot, int) {
              const CellView<M> view(state, local, slot);
              if (state.nodes.dof[static_cast<std::size_t>(e)] == e) find_rates(state, view);
              find_fluxes(state, view);
            });
}

/// Step 4 (fluxes) and 8 (gains of cells).
template <class M>
void exchange_water(State<M>& state) {
  if constexpr (has_skeleton<M>) {
    if (!state.frozen) {
      find_rates_and_fluxes(state);
      book_collected_fluxes(state);
      return;
    }
  }
  find_rates(state);
}

}  // namespace vadose::kernel
