// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// What points take of what their cells gain: water, momentum, pressure.

#include <vadose/kernel/exchange.hpp>

namespace vadose::kernel {

/// Share of the gain of a soil cell that each of its points takes: outflow in proportion to its mass,
/// inflow to its pores in saturated cells, else to the room it has.
template <class M>
void share_gain(const State<M>& state, const Cell<State<M>::dim>& cell, Record& share) noexcept {
  const Real density = state.water.density;
  if (cell.gain < 0) {
    share[lane::by_mass] = cell.gain / cell.water;
  } else if (cell.pressure >= 0) {
    share[lane::by_pores] = cell.gain / cell.pore_volume;
  } else {
    // Room of the whole cell can be too small: then by pores.
    const Real room = density * cell.pore_volume - cell.water;
    const bool fits = is_unsaturated<M> && room > cell.gain;
    share[lane::by_pores] = fits ? density * (cell.gain / room) : cell.gain / cell.pore_volume;
    share[lane::by_mass] = fits ? -(cell.gain / room) : 0;
  }
}

/// Water that eight soil cells of one material would have to give off, over the pore volume squeezed out of
/// them, to keep their pressure: S, and what their change of porosity does to the retention curve,
/// n (1 - n) dS/dn [-].
template <class M>
Lanes squeeze_factors(const State<M>& state, const CellBatch<M>& batch) {
  using C = Cell<State<M>::dim>;
  const Lanes zero(0.0), one(1.0);
  Lanes squeeze = batch.numbers([](const C& c) { return c.saturation; });
  if constexpr (is_unsaturated<M> && is_deformable<M>) {
    const Lanes p = batch.numbers([](const C& c) { return c.pressure; });
    if (!any(p < zero)) return squeeze;
    const Lanes n = max(batch.numbers([](const C& c) { return c.porosity; }), Lanes(1e-6));
    const Lanes slope = swrc::porosity_slope<Lanes>(state.soils[batch.material].material.retention,
                                                    max(-p, zero), n);
    squeeze += select(p < zero, n * (one - n) * slope, zero);
  }
  return squeeze;
}

/// Change of the pressure of a soil cell in the step as its start foretells it [Pa]: by gained water, by
/// squeezed pores and by what their change of porosity does to the retention curve. It starts the search
/// for the pressure, which then needs one pass over the points instead of two.
template <class M>
Real predicted_change(const State<M>& state, const Cell<State<M>::dim>& cell,
                      Real squeeze) noexcept {
  const Real squeezed =
      cell.skeleton_rate * state.dt * squeeze * cell.pore_volume / max(cell.porosity, 1e-6);
  return (cell.gain / state.water.density - squeezed) / max(cell.storage, 1e-30);
}

/// Predicts the changes of the pressures of the soil cells of a block that no implicit solution gave.
template <class M>
void predict_changes(State<M>& state, std::size_t slot) {
  constexpr std::size_t cells = Block<State<M>::dim>::cells;
  auto& nodes = state.nodes;
  CellBatch<M> batch;
  const auto finish = [&] {
    if (batch.count == 0) return;
    const Lanes squeeze = squeeze_factors(state, batch);
    for (int l = 0; l < batch.count; ++l)
      batch.cell[l]->change = predicted_change(state, *batch.cell[l], squeeze[l]);
    batch.count = 0;
  };
  for (std::size_t i = slot * cells; i < (slot + 1) * cells; ++i) {
    auto& cell = nodes.cell[i];
    if (nodes.dof[i] != static_cast<std::int32_t>(i)) continue;
    if (cell.kind != CellKind::soil || cell.solved) continue;
    if (batch.count == lane_count || cell.material != batch.material) finish();
    batch.material = cell.material;
    batch.cell[batch.count++] = &cell;
  }
  finish();
}

/// What the pore water of a cell takes, and its pressure after the step as heads are kept.
template <class M>
Real find_share(const State<M>& state, const Cell<State<M>::dim>& cell, Record& share) noexcept {
  constexpr int dim = State<M>::dim;
  Real p = cell.pressure;
  if (cell.kind == CellKind::soil) {
    share_gain(state, cell, share);
    for (int d = 0; d < dim; ++d) share[lane::velocity_gain + d] = cell.momentum_gain[d];
    p += cell.change;
  } else if (cell.pore_gain > 0) {
    share[lane::by_pores] = cell.pore_gain / cell.soil_pores;
  } else if (cell.pore_gain < 0) {
    share[lane::by_mass] = cell.pore_gain / cell.soil_water;
  }
  for (int d = 0; d < dim; ++d) {
    share[lane::brought + d] = cell.mean_velocity[d];
    p -= state.water.density * state.gravity[d] * cell.centroid[d];
  }
  return p;
}

/// How near a point of free water is to the face to soil of its cell: 1 at the face, next to nothing from
/// half a cell on. (What soil takes leaves the points at its face, what it gives goes to them: spread over
/// the cell it would lift the water that rises out of the ground. With 0.02 for what is far, a point that is
/// still small gets next to nothing beside the full ones above it, and the swing of a U-tube is lost.)
template <int Dim>
Real nearness(const Cell<Dim>& cell, const Lanes (&x)[Dim], int l, Real over_cell_size) noexcept {
  constexpr Real far = 0.002;
  if (cell.ground_axis < 0) return 1;
  return max(far, 1 - 2 * std::fabs(x[cell.ground_axis][l] - cell.ground) * over_cell_size);
}

/// Weighs the free water of a cell by nearness. By all of it where it gives much: no point more than half.
template <int Dim>
void find_near_water(Cell<Dim>& cell, Real near_water) noexcept {
  cell.near_water = near_water;
  cell.is_fed = cell.gain > 0;
  if (cell.ground_axis >= 0 && -cell.gain < 0.5 * near_water) return;
  cell.ground_axis = -1;
  cell.near_water = cell.water;
}

/// Mean velocities of the water of every cell: of what it holds, and what the water of its submerged
/// pores that passes to free water brings.
template <class M>
void find_mean_velocities(State<M>& state) {
  constexpr int dim = State<M>::dim;
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<dim>& local, int slot, int) {
              if (state.nodes.dof[static_cast<std::size_t>(e)] != e) return;
              auto& cell = state.nodes.cell[static_cast<std::size_t>(e)];
              const Record sums = member_sums(CellView<M>(state, local, slot), state.nodes.content);
              const bool soil = cell.kind == CellKind::soil;
              const int own = soil ? lane::pore_momentum : lane::free_momentum;
              if (!soil) find_near_water(cell, sums[lane::near_mass]);
              for (int d = 0; d < dim; ++d) {
                cell.mean_velocity[d] = cell.water > 0 ? sums[own + d] / cell.water : 0;
                cell.momentum_gain[d] =
                    !soil && cell.pore_gain < 0
                        ? cell.pore_gain * (cell.mean_velocity[d] -
                                            sums[lane::pore_momentum + d] / cell.soil_water)
                        : 0;
              }
            });
}

/// What leaves a cell takes the velocity of its water along, the mean where it arrives.
template <class M>
void find_momentum_gain(const State<M>& state, const CellView<M>& view,
                        Cell<State<M>::dim>& cell) noexcept {
  constexpr int dim = State<M>::dim;
  for_collected_inflows(state, view, [&](const Inflow<dim>& f) {
    if (f.from && f.flux > 0)
      for (int d = 0; d < dim; ++d)
        cell.momentum_gain[d] += f.flux * (f.from->mean_velocity[d] - cell.mean_velocity[d]);
  });
  const Real after = cell.water + cell.gain;
  for (Real& v : cell.momentum_gain) v = after > 0 ? v / after : 0;
}

/// What the points in a cell read of the cell whose pressure it uses.
template <class M>
void write_share(State<M>& state, std::size_t entry, const Cell<State<M>::dim>& owner) noexcept {
  auto& nodes = state.nodes;
  nodes.content[entry] = Record{};
  nodes.head[entry] = find_share(state, owner, nodes.content[entry]);
  const bool is_full = owner.kind == CellKind::soil && owner.pressure >= 0;
  nodes.filling[entry] = is_full ? owner.water / owner.pore_volume : 0;
}

/// Shares of the cells of slivers.
template <class M>
void find_sliver_shares(State<M>& state) {
  const auto& nodes = state.nodes;
  for_cells(state.grid, state.options.threads, nodes.near_sliver,
            [&](std::int32_t e, const Index<State<M>::dim>&, int, int) {
              const auto i = static_cast<std::size_t>(e);
              const std::int32_t owner = nodes.dof[i];
              if (owner >= 0 && owner != e)
                write_share(state, i, nodes.cell[static_cast<std::size_t>(owner)]);
            });
}

/// What points take of what their cells gain: momentum, change of pressure, water.
template <class M>
void find_shares(State<M>& state) {
  constexpr int dim = State<M>::dim;
  constexpr std::size_t cells = Block<dim>::cells;
  auto& nodes = state.nodes;
  const auto owns = [&](std::size_t i) { return nodes.dof[i] == static_cast<std::int32_t>(i); };
  parallel_for(static_cast<std::size_t>(state.grid.slots()), state.options.threads,
               [&](std::size_t s, int) {
                 std::size_t i = s * cells;
                 for_cube<dim>(0, Block<dim>::edge, [&](const Index<dim>& local) {
                   if (owns(i))
                     find_momentum_gain(state, CellView<M>(state, local, static_cast<int>(s)),
                                        nodes.cell[i]);
                   ++i;
                 });
                 predict_changes(state, s);
                 for (i = s * cells; i < (s + 1) * cells; ++i) {
                   if (owns(i)) {
                     write_share(state, i, nodes.cell[i]);
                   } else {
                     nodes.content[i] = Record{};
                     nodes.head[i] = nodes.filling[i] = 0;
                   }
                 }
               });
  find_sliver_shares(state);
}

}  // namespace vadose::kernel
