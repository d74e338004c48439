// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Step 2: cell pressures from the water in the cells. One ledger: the mass on the points is the
/// state, the pressure follows from it through S = 1 and through dry soil without a switch.
/// DEVIATION: [Zhan] integrates p on the liquid points by Eq. (9), which as printed is an Eulerian
/// rate with a misprint in its last term and without n S_n Dn; here the dependence of S on n enters
/// exactly, by the mass of each point.

#include <vadose/kernel/cells.hpp>

namespace vadose::kernel {

/// rho_l g . (to - from): pressure difference of water at rest [Pa].
template <class M>
Real hydrostatic(const State<M>& state, const Real (&from)[State<M>::dim],
                 const Real (&to)[State<M>::dim]) noexcept {
  Real dp = 0;
  for (int d = 0; d < State<M>::dim; ++d)
    dp += state.water.density * state.gravity[d] * (to[d] - from[d]);
  return dp;
}

/// K* = S / (S/K + S_p) of soil from theta' = n (S/K + S_p) exp(p/K) summed over the cell [Pa].
template <int Dim>
Real effective_modulus(const Cell<Dim>& cell, Real compression) noexcept {
  return cell.saturation * compression * cell.pore_volume / max(cell.storage, 1e-30);
}

/// What follows from the pressure of a cell once it is found.
template <class M>
void finish_cell(const State<M>& state, Cell<State<M>::dim>& cell) noexcept {
  cell.quad_pressure = cell.pressure + hydrostatic(state, cell.centroid, cell.quad_point);
  if (cell.kind == CellKind::free) {
    cell.saturation = 1;
    cell.quad_pressure = max(0.0, cell.quad_pressure);  // water does not pull on air
  } else if constexpr (is_unsaturated<M>) {
    const Real compression = exp_of_small(cell.pressure / state.water.bulk_modulus);
    cell.saturation = min(1.0, cell.content / (cell.pore_volume * compression));
    cell.modulus = effective_modulus(cell, compression);
  } else {
    cell.modulus = state.water.bulk_modulus;
  }
}

/// Calls f(cell, entry, slot) for every cell that owns a pressure.
template <class M, class F>
void for_pressure_cells(State<M>& state, F&& f) {
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<State<M>::dim>&, int slot, int) {
              if (state.nodes.dof[static_cast<std::size_t>(e)] == e)
                f(state.nodes.cell[static_cast<std::size_t>(e)], e, slot);
            });
}

/// Pressure of saturated cells, closed form: M = rho_l0 exp(p/K) sum n V.
/// The centroid is pore weighted, so that the head inside the cell drops out to O((rho g h/K)^2).
template <class M>
void solve_saturated(State<M>& state) {
  for_pressure_cells(state, [&](Cell<State<M>::dim>& cell, std::int32_t, int) {
    if (cell.kind != CellKind::soil) return;
    const Real bulk_modulus = state.water.bulk_modulus;
    cell.saturation = 1;
    if (!state.frozen)
      cell.pressure =
          bulk_modulus * std::log(cell.water / (state.water.density * cell.pore_volume));
    cell.storage = cell.pore_volume / bulk_modulus * std::exp(cell.pressure / bulk_modulus);
    finish_cell(state, cell);
  });
}

/// Numbers of the cells of eight points.
template <int Dim, class Values>
VADOSE_INLINE Lanes values_at(const Values& values, const CellFinder<Dim>& cells,
                              const std::int32_t* entries) noexcept {
  if (cells.shared) return Lanes(values[static_cast<std::size_t>(entries[cells.index[0]])]);
  return lanes_of([&](int l) { return values[static_cast<std::size_t>(entries[cells.index[l]])]; });
}

/// Volume rates of the skeleton in the cells of eight points; `otherwise` where there is none.
template <class M>
VADOSE_INLINE Lanes cell_rates(const State<M>& state, const CellFinder<State<M>::dim>& cells,
                               const std::int32_t* entries, const Lanes& otherwise) noexcept {
  const Lanes found = values_at(state.nodes.rate, cells, entries);
  return select(found == found, found, otherwise);
}

/// The rates as cell_rates() reads them: of the soil cell whose pressure a cell uses, NaN without one.
template <class M>
void spread_rates(State<M>& state) {
  constexpr std::size_t cells = Block<State<M>::dim>::cells;
  auto& nodes = state.nodes;
  parallel_for(
      static_cast<std::size_t>(state.grid.slots()), state.options.threads, [&](std::size_t s, int) {
        for (std::size_t i = s * cells; i < (s + 1) * cells; ++i) {
          const std::int32_t owner = nodes.dof[i];
          const bool soil = owner >= 0 && nodes.cell[i].kind == CellKind::soil;
          nodes.rate[i] = soil ? nodes.cell[static_cast<std::size_t>(owner)].skeleton_rate : unset;
        }
      });
}

/// Grains this far apart no longer follow the volume between them [-]: a skeleton that has come
/// apart keeps this porosity.
inline constexpr Real dispersed_porosity = 0.7;

/// Factor of the bulk volume of points of porosity n over a step of volume strain dt div v^s. Dispersed
/// grains keep theirs, unless water that fills their pores presses them apart: held back, its pressure
/// would do work without falling (a pulp of n = 0.7 blew itself up from 14 to 280 J within 1 ms).
template <class M>
VADOSE_INLINE Lanes volume_stretch(const State<M>& state, const CellFinder<State<M>::dim>& cells,
                                   const std::int32_t* entries, const Lanes& porosity,
                                   const Lanes& strain) noexcept {
  const Lanes follows = exp_of_small(strain);
  const Lanes limit =
      max(Lanes(1.0), (Lanes(1.0) - porosity) * Lanes(1 / (1 - dispersed_porosity)));
  if (!any(limit < follows)) return follows;
  const Lanes pressure = lanes_of([&](int l) -> Real {
    const std::int32_t owner = state.nodes.dof[static_cast<std::size_t>(entries[cells.index[l]])];
    return owner < 0 ? 0 : state.nodes.cell[static_cast<std::size_t>(owner)].pressure;
  });
  return select(Lanes(0.0) < pressure, follows, min(follows, limit));
}

/// Whether the search for the pressure of a cell is over.
template <int Dim>
bool is_found(const Cell<Dim>& cell) noexcept {
  return cell.low > cell.high;
}

/// Pressure of the water of a cell at the origin, p_c - rho_l g . x_c [Pa].
template <class M>
Real head_of(const State<M>& state, const Cell<State<M>::dim>& cell) noexcept {
  Real head = cell.pressure;
  for (int d = 0; d < State<M>::dim; ++d)
    head -= state.water.density * state.gravity[d] * cell.centroid[d];
  return head;
}

/// Pressures of the cells as the points read them, in marked blocks; with `Open`, NaN for those that are
/// found.
template <bool Open = false, class M>
void find_heads(State<M>& state, const std::vector<char>& marks) {
  auto& nodes = state.nodes;
  for_cells(state.grid, state.options.threads, marks,
            [&](std::int32_t e, const Index<State<M>::dim>&, int, int) {
              const auto i = static_cast<std::size_t>(e);
              const std::int32_t owner = nodes.dof[i];
              nodes.head[i] = 0;
              if (owner < 0) return;
              const auto& cell = nodes.cell[static_cast<std::size_t>(owner)];
              nodes.head[i] = Open && is_found(cell) ? unset : head_of(state, cell);
            });
}

/// Trial pressures at eight points: those of their cells and the weight of the water between.
template <class M>
VADOSE_INLINE Lanes pressures_at(const State<M>& state, const CellFinder<State<M>::dim>& cells,
                                 const std::int32_t* entries,
                                 const Lanes (&x)[State<M>::dim]) noexcept {
  Lanes p = values_at(state.nodes.head, cells, entries);
  for (int d = 0; d < State<M>::dim; ++d) p += Lanes(state.water.density * state.gravity[d]) * x[d];
  return p;
}

/// Sums content and storage of the pore water at the pressures that find_heads() wrote; `Stretched`: in
/// the volume after the step; `Open`: only of cells whose pressure is not found yet.
template <bool Stretched = false, bool Open = false, class M>
void sum_content(State<M>& state) {
  constexpr int dim = State<M>::dim;
  const Lanes over_modulus(1 / state.water.bulk_modulus);
  if constexpr (Stretched) spread_rates(state);
  for_blocks_adding(state.liquid, state.options.threads, [&](const BatchRange& range, int thread) {
    if (!state.nodes.retry[static_cast<std::size_t>(range.slot)]) return;
    Tile<dim>& tile = state.tile(thread);
    const TileFrame<dim> frame = tile_frame(state.grid, range.slot);
    const std::int32_t* entries = state.grid.tile(range.slot);
    ComingRecords<dim> coming(state.grid, range.slot, state.nodes.content);
    for (std::size_t b = range.begin; b < range.end; ++b) {
      coming.ask_for_some();
      const int group = state.liquid.group(b);
      if (group == state.free_group()) continue;
      Lanes x[dim], record[lane_count];
      load_positions(state.liquid, b, x);
      CellFinder<dim> cells;
      cells.find(frame, x);
      for (auto& r : record) r = Lanes(0.0);
      Lanes p = pressures_at(state, cells, entries, x);
      if constexpr (Open) {
        const LaneMask wanted = p == p;
        if (!any(wanted)) continue;
        p = select(wanted, p, Lanes(0.0));
      }
      Lanes porosity = state.liquid.load(field::porosity, b);
      Lanes volume = state.liquid.load(field::volume, b);
      if constexpr (Stretched) {
        const Lanes rate = cell_rates(state, cells, entries, Lanes(0.0));
        const Lanes stretch =
            volume_stretch(state, cells, entries, porosity, Lanes(state.dt) * rate);
        volume = volume * stretch;
        porosity = Lanes(1.0) - (Lanes(1.0) - porosity) / stretch;
      }
      const auto theta = swrc::water_content<Lanes>(
          state.soils[static_cast<std::size_t>(group)].material.retention, p, porosity,
          over_modulus);
      record[lane::content] = volume * theta.value;
      record[lane::storage] = volume * theta.slope;
      add_to_cells(cells, record, tile);
    }
    tile.add_to(state.grid, range.slot, state.nodes.content);
  });
}

/// Water in excess, over the pores, from which a Newton step leaves nothing that counts [-].
inline constexpr Real straight_excess = 1e-7;
/// The same of a step that follows the curvature of the retention curve [-].
inline constexpr Real curved_excess = 1e-5;

/// How far the search for the pressure of a cell has come.
enum class Search : unsigned char {
  goes_on,
  curved,  ///< found but for the curvature of the retention curve over the last step
  over,
};

/// One safeguarded Newton step on the pressure of a cell.
/// content, storage: sums at the present trial pressure; target: M / rho_l0.
template <int Dim>
Search improve_pressure(Cell<Dim>& cell, Real content, Real storage, Real target, Real floor) {
  const Real excess = content - target;
  cell.storage = storage;
  if (excess > 0)
    cell.high = min(cell.high, cell.pressure);
  else
    cell.low = max(cell.low, cell.pressure);
  if (std::fabs(excess) <= 1e-14 * cell.pore_volume) return Search::over;
  if (cell.pressure <= floor && excess >= 0) return Search::over;  // drier than any pressure sought
  Real next = cell.pressure - excess / max(storage, 1e-30 * cell.pore_volume);
  // The storage of water says nothing about the dry side, nor does that at one suction about that
  // at ten times as much: go there in growing steps.
  if (cell.pressure > 0)
    next = max(next, -100.0);
  else
    next = max(next, 10 * cell.pressure - 100);
  next = max(next, floor);
  const bool leaves_bracket = !(next > cell.low && next < cell.high) && next != floor;
  if (leaves_bracket) {
    const Real middle = 0.5 * (cell.low + cell.high);
    if (middle == cell.pressure) return Search::over;
    next = middle;
  }
  const Real change = std::fabs(next - cell.pressure), size = std::fabs(cell.pressure);
  const bool same_side = (next < 0) == (cell.pressure < 0);
  const bool near = same_side && change <= 1e-3 * size + 1 &&
                    std::fabs(excess) <= curved_excess * cell.pore_volume;
  const bool close = near && std::fabs(excess) <= straight_excess * cell.pore_volume;
  const bool settled = change <= 1e-15 * size;
  cell.pressure = next;
  if (close || settled) return Search::over;
  const bool follows_storage = !leaves_bracket && next < 0 && next > floor;
  return near && follows_storage ? Search::curved : Search::goes_on;
}

/// Clears the sums of content of the blocks that are still sought.
template <class M>
void clear_content(State<M>& state) {
  parallel_for(static_cast<std::size_t>(state.grid.slots()), state.options.threads,
               [&](std::size_t s, int) {
                 if (!state.nodes.retry[s]) return;
                 for (std::size_t i = s * Block<State<M>::dim>::cells;
                      i < (s + 1) * Block<State<M>::dim>::cells; ++i)
                   for (int l = lane::content; l < lane_count; ++l) state.nodes.content[i][l] = 0;
               });
}

/// Sums of a pressure cell and its slivers.
template <class M>
Record member_sums(const CellView<M>& view, const AlignedVector<Record>& records) {
  Record total;
  for_members(view, [&](std::int32_t m, const auto&) {
    (Lanes::load(total.value) + Lanes::load(records[static_cast<std::size_t>(m)].value))
        .store(total.value);
  });
  return total;
}

/// Cells whose last step has yet to be corrected for the curvature of the retention curve.
template <class M>
struct CurvedSteps {
  CellBatch<M> cells;
  Real start[lane_count];  ///< pressures before it [Pa]
};

/// The search for the pressure of a cell is over.
template <class M>
void end_search(const State<M>& state, Cell<State<M>::dim>& cell) noexcept {
  cell.low = 1, cell.high = 0;  // not touched again
  finish_cell(state, cell);
}

/// Corrects the last steps of up to eight cells: the mean storage over a step, not that at its start, says
/// how far it goes. (The curve at the mean porosity of a cell says how storage changes, not how large it
/// is.) Where it bends by more than a little the search goes on.
template <class M>
void follow_curve(State<M>& state, CurvedSteps<M>& steps, std::size_t slot) {
  using C = Cell<State<M>::dim>;
  auto& batch = steps.cells;
  if (batch.count == 0) return;
  const auto& retention = state.soils[batch.material].material.retention;
  const Lanes start = lanes_of([&](int l) { return steps.start[l < batch.count ? l : 0]; });
  const Lanes end = batch.numbers([](const C& c) { return c.pressure; });
  const Lanes porosity = batch.numbers([](const C& c) { return c.porosity; });
  const Lanes over_modulus(1 / state.water.bulk_modulus);
  const auto storage = [&](const Lanes& p) {
    return swrc::water_content<Lanes>(retention, p, porosity, over_modulus).slope;
  };
  const Lanes before = storage(start), after = storage(end);
  const Lanes next = start + (end - start) * (Lanes(2.0) * before / (before + after));
  const Lanes growth = after / before;
  const LaneMask follows = abs(after - before) <= Lanes(0.01) * before;
  for (int l = 0; l < batch.count; ++l) {
    if (follows[l]) {
      batch.cell[l]->pressure = next[l];
      batch.cell[l]->storage *= growth[l];
      end_search(state, *batch.cell[l]);
    } else {
      state.nodes.retry[slot] = 1;
    }
  }
  batch.count = 0;
}

/// One step of the search in every cell of a block; marks the block if one has to go on.
template <class M>
void improve_pressures(State<M>& state, int slot) {
  constexpr int dim = State<M>::dim;
  auto& nodes = state.nodes;
  const auto block = static_cast<std::size_t>(slot);
  CurvedSteps<M> steps;
  std::int32_t e = slot * Block<dim>::cells - 1;
  for_cube<dim>(0, Block<dim>::edge, [&](const Index<dim>& local) {
    const auto i = static_cast<std::size_t>(++e);
    auto& cell = nodes.cell[i];
    if (nodes.dof[i] != e || cell.kind != CellKind::soil || is_found(cell)) return;
    const Record sums = member_sums(CellView<M>(state, local, slot), nodes.content);
    cell.content = cell.water / state.water.density;
    if (state.frozen) {
      cell.storage = sums[lane::storage];
      cell.content = sums[lane::content];
      end_search(state, cell);
      return;
    }
    const Real start = cell.pressure;
    const Search search = improve_pressure(cell, sums[lane::content], sums[lane::storage],
                                           cell.content, state.soils[cell.material].pressure_floor);
    if (search == Search::over) {
      end_search(state, cell);
    } else if (search == Search::goes_on) {
      nodes.retry[block] = 1;
    } else {
      auto& batch = steps.cells;
      if (batch.count == lane_count || cell.material != batch.material)
        follow_curve(state, steps, block);
      steps.start[batch.count] = start;
      batch.material = cell.material;
      batch.cell[batch.count++] = &cell;
    }
  });
  follow_curve(state, steps, block);
}

/// More than the head differs by over a cell and its slivers [Pa].
template <class M>
Real head_span(const State<M>& state) noexcept {
  return 2 * state.water.density * state.gravity.norm() * state.grid.cell_size() + 1;
}

/// Bounds of the search for the pressure of a soil cell.
template <class M>
void begin_search(const State<M>& state, Real span, Cell<State<M>::dim>& cell) noexcept {
  const Real filling = cell.water / (state.water.density * cell.pore_volume);
  const Real compressed = filling > 1 ? state.water.bulk_modulus * std::log(filling) : 0;
  cell.high = compressed + span;
  cell.low = state.soils[cell.material].pressure_floor - span;
  if (!state.frozen) cell.pressure = min(max(cell.pressure, cell.low), cell.high);
}

/// Pressure of unsaturated cells: sum V theta(p_c + rho g (x - x_c), n) = M / rho_l0.
template <class M>
void solve_unsaturated(State<M>& state) {
  constexpr int max_passes = 60;
  auto& nodes = state.nodes;
  find_heads(state, nodes.near_sliver);  // others wrote theirs as they were gathered
  sum_content(state);
  for (int pass = 1;; ++pass) {
    nodes.sought = nodes.retry;
    std::fill(nodes.retry.begin(), nodes.retry.end(), char{0});
    parallel_for(static_cast<std::size_t>(state.grid.slots()), state.options.threads,
                 [&](std::size_t slot, int) {
                   if (nodes.sought[slot]) improve_pressures(state, static_cast<int>(slot));
                 });
    bool any = false;
    for (const char r : nodes.retry) any = any || r;
    if (!any) return;
    if (pass == max_passes) break;
    nodes.sought = nodes.retry;  // points beyond their block count in its neighbours too
    widen_marks(state.grid, nodes.sought, nodes.retry);
    clear_content(state);
    find_heads<true>(state, nodes.retry);
    sum_content<false, true>(state);
  }
  for_pressure_cells(state, [&](Cell<State<M>::dim>& cell, std::int32_t, int) {
    if (cell.kind == CellKind::soil && !is_found(cell)) finish_cell(state, cell);
  });
}

/// Gathers every cell that owns its pressure, and begins the search for it.
template <class M>
void gather_cells(State<M>& state) {
  [[maybe_unused]] const Real span = head_span(state);
  state.nodes.has_edge.assign(static_cast<std::size_t>(state.grid.slots()), 0);
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<State<M>::dim>& local, int slot, int) {
              const auto i = static_cast<std::size_t>(e);
              auto& cell = state.nodes.cell[i];
              if (state.nodes.dof[i] != e) {
                if constexpr (is_unsaturated<M>) {
                  cell.closing = unset;
                  state.nodes.head[i] = 0;
                }
                return;
              }
              gather_cell(state, CellView<M>(state, local, slot));
              if (cell.kind == CellKind::free)
                finish_cell(state, cell);
              else if constexpr (is_unsaturated<M>)
                begin_search(state, span, cell);
              if constexpr (is_unsaturated<M>) state.nodes.head[i] = head_of(state, cell);
            });
}

/// Steps 1 and 2: cells and their pressures from the points.
template <class M>
void find_pressures(State<M>& state) {
  sum_water(state);
  if (state.soils.size() > 1) sum_materials(state);
  classify_cells(state);
  assign_pressure_cells(state);
  gather_cells(state);
  clear(state.nodes.content, state.options.threads);
  std::fill(state.nodes.retry.begin(), state.nodes.retry.end(), char{1});
  if constexpr (is_unsaturated<M>) {
    solve_unsaturated(state);
  } else if constexpr (has_skeleton<M>) {
    solve_saturated(state);
  }
}

}  // namespace vadose::kernel
