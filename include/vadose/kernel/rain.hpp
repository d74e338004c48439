// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Rain on the current ground: what each column of cells catches, what enters the soil, and the film
/// of water that stays on the ground until it is thick enough to be points of free water.

#include <vadose/kernel/pressure.hpp>

namespace vadose::kernel {

/// Whether any rain is set.
template <class M>
bool has_rain(const State<M>& state) noexcept {
  for (const auto& held : state.held)
    if (held.supply) return true;
  return false;
}

/// Number of the vertical column of a cell.
template <int Dim>
std::size_t column_of(const BlockGrid<Dim>& grid, const Index<Dim>& cell) noexcept {
  std::size_t column = 0;
  for (int d = Dim - 2; d >= 0; --d)
    column = column * static_cast<std::size_t>(grid.cells()[d]) + static_cast<std::size_t>(cell[d]);
  return column;
}

/// Horizontal area of the column of a cell [m2] (per metre, per radian).
template <class M>
Real column_area(const CellView<M>& view) noexcept {
  const Real area = power<State<M>::dim - 1>(view.state.grid.cell_size());
  return State<M>::Kinematics::axisymmetric ? area * view.centre(0) : area;
}

/// Highest water-bearing cell of every column: it catches the column's rain. Rates are read once.
/// Serial: columns span blocks. Called only in scenes with rain.
template <class M>
void find_columns(State<M>& state) {
  constexpr int dim = State<M>::dim, up = dim - 1;
  std::size_t columns = 1;
  for (int d = 0; d < up; ++d) columns *= static_cast<std::size_t>(state.grid.cells()[d]);
  state.columns.resize(columns);
  for (auto& column : state.columns) column.top = -1;
  for (auto& held : state.held)
    if (held.supply) held.supply_rate = max(0.0, held.supply(state.time));
  for_cells(state.grid, 1, [&](std::int32_t e, const Index<dim>& local, int slot, int) {
    if (state.nodes.dof[static_cast<std::size_t>(e)] < 0) return;
    const CellView<M> view(state, local, slot);
    auto& column = state.columns[column_of(state.grid, view.cell)];
    if (column.top >= 0 && column.top_cell[up] >= view.cell[up]) return;
    column.top = e;
    column.top_cell = view.cell;
    column.area = column_area(view);
  });
}

/// Height of the surface of a column [m]: soil or water, as high as its highest cell is full.
template <class M>
Real surface_height(const State<M>& state, const RainColumn<State<M>::dim>& column) noexcept {
  constexpr int up = State<M>::dim - 1;
  const auto& cell = state.nodes.cell[static_cast<std::size_t>(column.top)];
  return state.grid.origin()[up] +
         (column.top_cell[up] + min(1.0, cell.raw_fill)) * state.grid.cell_size();
}

/// Rate at which rain of a condition reaches a column [m3/s]; 0 where it is not raining.
template <class M>
Real rain_on(const State<M>& state, const RainColumn<State<M>::dim>& column) {
  constexpr int dim = State<M>::dim;
  if (column.top < 0) return 0;
  Vec<dim> x;
  for (int d = 0; d < dim; ++d)
    x[d] = state.grid.origin()[d] + (column.top_cell[d] + 0.5) * state.grid.cell_size();
  x[dim - 1] = surface_height(state, column);
  for (const auto& held : state.held)
    if (held.supply && held.contains(x)) return held.supply_rate * column.area;
  return 0;
}

/// Column that lies on the air side of an open face, where water that comes out of the soil goes.
template <class M>
std::size_t column_outside(const State<M>& state, const CellView<M>& view, int axis,
                           const FaceFlux& face) noexcept {
  Index<State<M>::dim> cell = view.cell;
  if (axis < State<M>::dim - 1 && !face.soil_below) --cell[axis];
  return column_of(state.grid, cell);
}

/// After the fluxes: rain falls on the films, soil drinks from them and springs feed them. The same
/// products as in the gains of the cells, so that the ledger closes to round-off.
template <class M>
void settle_films(State<M>& state) {
  constexpr int dim = State<M>::dim;
  if (!has_rain(state)) return;
  const Real mass_per_flux = state.dt * state.water.density;
  for (auto& column : state.columns) {
    const Real fallen = mass_per_flux * rain_on(state, column);
    column.film += fallen;
    state.rain += fallen;
  }
  for_cells(state.grid, 1, [&](std::int32_t e, const Index<dim>& local, int slot, int) {
    const CellView<M> view(state, local, slot);
    for (int d = 0; d < dim; ++d) {
      const FaceFlux& face =
          state.nodes.face[static_cast<std::size_t>(e) * dim + static_cast<std::size_t>(d)];
      if (!face.fed || face.flux == 0) continue;
      const std::int32_t soil = face.soil_below ? view.neighbour(d, -1) : e;
      const auto owner = static_cast<std::size_t>(state.nodes.dof[static_cast<std::size_t>(soil)]);
      const Real into = face.soil_below ? -face.flux : face.flux;
      const Real limit = into < 0 ? state.nodes.cell[owner].limit : 1;
      state.columns[column_outside(state, view, d, face)].film -= mass_per_flux * limit * into;
    }
  });
}

}  // namespace vadose::kernel
