// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Films of water on the ground that fill half a cell become points of free water.

#include <vadose/kernel/rain.hpp>
#include <vadose/solver/assemble.hpp>

namespace vadose::detail {

/// Points of free water along each axis of a cell.
inline constexpr int film_points_per_axis = 2;

/// Turns every film of half a cell or more into one row of points on the surface of its column: the
/// mass moves from the film to the points, no remainder is lost. The points join at the next sort.
template <class M>
void release_films(State<M>& state) {
  constexpr int dim = State<M>::dim, up = dim - 1;
  const Real h = state.grid.cell_size();
  const Real spacing = h / film_points_per_axis;
  constexpr int count = power<dim - 1>(film_points_per_axis);
  for (auto& column : state.columns) {
    const Real row = state.water.density * column.area * spacing;
    if (column.top < 0 || !(column.film >= row)) continue;
    // On soil in the cell above it: a cell that is soil for the most part holds no free points.
    const bool on_soil =
        state.nodes.cell[static_cast<std::size_t>(column.top)].kind == CellKind::soil;
    const Real surface = on_soil ? state.grid.origin()[up] + (column.top_cell[up] + 1) * h
                                 : kernel::surface_height(state, column);
    const Real z = surface + 0.5 * spacing;
    if (z >= state.grid.origin()[up] + state.grid.cells()[up] * h) continue;  // waits for room
    for (int i = 0; i < count; ++i) {
      PointValues<LiquidFields<M>> point;
      SeedPoint<dim> seed;
      int rest = i;
      for (int d = 0; d < dim; ++d) {
        seed.position[d] = state.grid.origin()[d] + column.top_cell[d] * h +
                           (rest % film_points_per_axis + 0.5) * spacing;
        if (d < up) rest /= film_points_per_axis;
      }
      seed.position[up] = z;
      seed.volume = power<dim>(spacing);
      set_common<M>(point, seed, Vec<dim>::Zero().eval(), spacing, state.next_liquid_id++);
      point.set(field::mass, row / count);
      point.set(field::volume, row / count / state.water.density);
      point.set(field::porosity, 1);
      state.liquid.append(point.all(), state.free_group());
    }
    column.film -= row;
  }
}

}  // namespace vadose::detail
