// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Rain on the current ground: what each column of cells catches, what enters the soil, and the film
/// of water on the ground, which runs down slopes until it is thick enough to be points of free water.

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
/// Serial: columns span blocks. Called only where there may be films.
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

/// Mean height of the ground or of free water in a column [m]: a slope may cut its two highest cells.
template <class M>
Real mean_height(const State<M>& state, const RainColumn<State<M>::dim>& column) noexcept {
  constexpr int up = State<M>::dim - 1;
  Real height = surface_height(state, column);
  if (column.top_cell[up] == 0) return height;
  Index<State<M>::dim> below = column.top_cell;
  --below[up];
  const auto e = static_cast<std::size_t>(state.grid.entry(below));
  return height - (1 - min(1.0, state.nodes.cell[e].raw_fill)) * state.grid.cell_size();
}

/// Area of ground that a column turns towards the rain, over its horizontal area: 1 + drift . grad z,
/// from the heights of the columns beside it; not negative.
template <class M>
Real catching_area(const State<M>& state, const RainColumn<State<M>::dim>& column,
                   const Real (&drift)[State<M>::dim]) {
  constexpr int up = State<M>::dim - 1;
  Real area = 1;
  std::ptrdiff_t stride = 1;
  for (int d = 0; d < up; ++d) {
    const int position = column.top_cell[d], cells = state.grid.cells()[d];
    const auto* low = position > 0 ? &column - stride : &column;
    const auto* high = position + 1 < cells ? &column + stride : &column;
    if (low->top < 0) low = &column;
    if (high->top < 0) high = &column;
    if (drift[d] != 0 && high != low)
      area += drift[d] * (mean_height(state, *high) - mean_height(state, *low)) /
              ((high->top_cell[d] - low->top_cell[d]) * state.grid.cell_size());
    stride *= cells;
  }
  return max(0.0, area);
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
    if (held.supply && held.acts && held.contains(x))
      return held.supply_rate * column.area * catching_area(state, column, held.drift);
  return 0;
}

/// Pressure of the film of a column at its foot [Pa].
template <class M>
Real film_pressure(const State<M>& state, const RainColumn<State<M>::dim>& column) noexcept {
  return column.area > 0
             ? max(0.0, column.film) / column.area * std::fabs(state.gravity[State<M>::dim - 1])
             : 0;
}

/// The column whose rain and film wet an open face, nullptr where none does: the highest ground of
/// the column, and the sides of its soil down to the lower ground beside it, where the water of a
/// slope runs down. (A slope is a staircase of cells; what it takes in goes through both.)
template <class M>
const RainColumn<State<M>::dim>* column_wetting(const State<M>& state, const CellView<M>& view,
                                                int axis, bool soil_below) noexcept {
  constexpr int up = State<M>::dim - 1;
  if (axis == up) {
    if (!soil_below) return nullptr;
    const auto& column = state.columns[column_of(state.grid, view.cell)];
    return column.top == view.neighbour(axis, -1) ? &column : nullptr;
  }
  Index<State<M>::dim> soil = view.cell, air = view.cell;
  --(soil_below ? soil : air)[axis];
  const auto& beside = state.columns[column_of(state.grid, air)];
  if (beside.top >= 0 && beside.top_cell[up] >= view.cell[up]) return nullptr;
  return &state.columns[column_of(state.grid, soil)];
}

/// Column that gives what enters the soil through a fed face, and column that gets what comes out:
/// those of the soil and of the air.
template <class M>
std::size_t column_at_face(const State<M>& state, const CellView<M>& view, int axis,
                           const FaceFlux& face, bool enters) noexcept {
  Index<State<M>::dim> cell = view.cell;
  if (axis < State<M>::dim - 1 && face.soil_below == enters) --cell[axis];
  return column_of(state.grid, cell);
}

/// Entry of the soil cell at a boundary face.
template <class M>
std::int32_t soil_at(const CellView<M>& view, int axis, const FaceFlux& face) noexcept {
  return face.soil_below ? view.neighbour(axis, -1) : view.entry();
}

/// The pressure cell of the soil at a boundary face.
template <class M>
const Cell<State<M>::dim>& soil_cell(const CellView<M>& view, int axis,
                                     const FaceFlux& face) noexcept {
  const auto& nodes = view.state.nodes;
  const std::int32_t owner = nodes.dof[static_cast<std::size_t>(soil_at(view, axis, face))];
  return nodes.cell[static_cast<std::size_t>(owner)];
}

/// Calls f(face, view, axis) for every fed face, in the order of the cells.
template <class M, class F>
void for_fed_faces(State<M>& state, F&& f) {
  constexpr int dim = State<M>::dim;
  for_cells(state.grid, 1, [&](std::int32_t e, const Index<dim>& local, int slot, int) {
    for (int d = 0; d < dim; ++d) {
      FaceFlux& face =
          state.nodes.face[static_cast<std::size_t>(e) * dim + static_cast<std::size_t>(d)];
      if (face.fed) f(face, CellView<M>(state, local, slot), d);
    }
  });
}

/// Shares what a column has to give, its rain and its film, among the faces it wets, by what the
/// soil could take through each: the flux that its head gradient drives at the pressure of the film.
/// Given less than that in all the soil drinks all of it and its surface stays under suction, closed to
/// the nodes; given more it is held at that pressure.
template <class M>
void share_supplies(State<M>& state) {
  if (!state.films) return;
  for (auto& column : state.columns) column.potential = 0;
  for_fed_faces(state, [&](FaceFlux& face, const CellView<M>& view, int axis) {
    if (face.wetted)
      state.columns[column_at_face(state, view, axis, face, true)].potential += face.supply;
  });
  for_fed_faces(state, [&](FaceFlux& face, const CellView<M>& view, int axis) {
    const bool inward = (face.soil_below ? face.head_gradient : -face.head_gradient) >= 0;
    if (!face.wetted) {
      face.thirsty = inward;
      return;
    }
    const auto& column = state.columns[column_at_face(state, view, axis, face, true)];
    const Real given =
        rain_on(state, column) + max(0.0, column.film) / (state.water.density * state.dt);
    face.thirsty = inward && given <= column.potential;
    face.supply = column.potential > 0 ? given * (face.supply / column.potential) : 0;
  });
}

/// Mass [kg] that a film passes to the next column in a step: sheet flow by Manning,
/// q = d^(5/3) sqrt(drop / h) / roughness down the fall of the water surface; at most a quarter of
/// what there is, and no more than levels the two.
template <class M>
Real sheet_flow(const State<M>& state, const RainColumn<State<M>::dim>& from,
                const RainColumn<State<M>::dim>& to) noexcept {
  const Real h = state.grid.cell_size(), density = state.water.density;
  const Real depth = from.film / (density * from.area);
  const Real drop = mean_height(state, from) + depth - mean_height(state, to) -
                    max(0.0, to.film) / (density * to.area);
  if (!(drop > 0)) return 0;
  const Real width = 0.5 * (from.area + to.area) / h;
  const Real rate =
      depth * std::cbrt(depth * depth) * std::sqrt(drop / h) / state.roughness * width;
  const Real level = 0.25 * drop * min(from.area, to.area);
  return min(0.25 * from.film, density * min(rate * state.dt, level));
}

/// Films run down the slope, column by column. What one loses the other gets.
template <class M>
void route_films(State<M>& state) {
  constexpr int up = State<M>::dim - 1;
  std::size_t stride = 1;
  for (int d = 0; d < up; ++d) {
    const auto cells = static_cast<std::size_t>(state.grid.cells()[d]);
    for (std::size_t c = 0; c < state.columns.size(); ++c) {
      if ((c / stride) % cells + 1 == cells) continue;
      auto& a = state.columns[c];
      auto& b = state.columns[c + stride];
      if (a.top < 0 || b.top < 0 || !(a.film > 0 || b.film > 0)) continue;
      Real dm = a.film > 0 ? sheet_flow(state, a, b) : 0;
      if (dm == 0 && b.film > 0) dm = -sheet_flow(state, b, a);
      a.film -= dm;
      b.film += dm;
    }
    stride *= cells;
  }
}

/// After the fluxes: rain falls on the films, soil drinks from them and springs feed them. The same
/// products as in the gains of the cells, so that the ledger closes to round-off.
template <class M>
void settle_films(State<M>& state) {
  if (!state.films) return;
  const Real mass_per_flux = state.dt * state.water.density;
  for (auto& column : state.columns) {
    const Real fallen = mass_per_flux * rain_on(state, column);
    const Real before = column.film;
    column.film += fallen;
    state.rain += column.film - before;  // what was added, after rounding
  }
  for_fed_faces(state, [&](const FaceFlux& face, const CellView<M>& view, int axis) {
    if (face.flux == 0) return;
    const Real into = face.soil_below ? -face.flux : face.flux;
    const auto owner = static_cast<std::size_t>(
        state.nodes.dof[static_cast<std::size_t>(soil_at(view, axis, face))]);
    const Real limit = into < 0 ? state.nodes.donor[owner].limit : 1;
    state.columns[column_at_face(state, view, axis, face, into > 0)].film -=
        mass_per_flux * limit * into;
  });
  route_films(state);
}

}  // namespace vadose::kernel
