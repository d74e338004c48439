// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Free water that lies on the ground thinner than half a cell becomes a film, and so does what has
/// got into the highest cell of soil: as points it would neither flow nor soak in.

#include <vadose/kernel/rain.hpp>

namespace vadose::detail {

/// Whether the free water in the highest cell of a column is to be a film: a sliver that stands alone
/// on soil, or water within a cell that is soil for the most part.
template <class M>
bool is_film(const State<M>& state, const RainColumn<State<M>::dim>& column) {
  constexpr int up = State<M>::dim - 1;
  const auto e = static_cast<std::size_t>(column.top);
  const auto& cell = state.nodes.cell[e];
  if (!(state.nodes.free[e][lane::free_volume] > 0)) return false;
  if (cell.kind == CellKind::soil) return true;
  const bool thin = cell.members == 1 && cell.raw_fill < kernel::film_fill;
  if (state.nodes.dof[e] != column.top || !thin || column.top_cell[up] == 0) return false;
  Index<State<M>::dim> below = column.top_cell;
  --below[up];
  const auto b = static_cast<std::size_t>(state.grid.entry(below));
  return state.nodes.dof[b] >= 0 && state.nodes.cell[b].kind == CellKind::soil;
}

/// Moves such points into the films of their columns: mass is kept, momentum is not.
template <class M>
void gather_films(State<M>& state) {
  constexpr int dim = State<M>::dim;
  if (!state.films || state.frozen) return;
  bool any = false;
  for (auto& column : state.columns) {
    column.gathers = column.top >= 0 && is_film(state, column);
    any = any || column.gathers;
  }
  if (!any) return;
  auto& points = state.liquid;
  points.for_each([&](std::size_t b, int l) {
    if (points.group(b) != state.free_group()) return;
    Index<dim> cell;
    for (int d = 0; d < dim; ++d)
      cell[d] = std::clamp(static_cast<int>(std::floor(
                               (points.at(field::position, b, d)[l] - state.grid.origin()[d]) /
                               state.grid.cell_size())),
                           0, state.grid.cells()[d] - 1);
    auto& column = state.columns[kernel::column_of(state.grid, cell)];
    if (!column.gathers || cell[dim - 1] != column.top_cell[dim - 1]) return;
    column.film += points.at(field::mass, b)[l];
    points.remove(b, l);
  });
}

}  // namespace vadose::detail
