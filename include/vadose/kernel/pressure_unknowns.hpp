// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Cells whose pressures an implicit solution seeks, and their places among nodes and cells.

#include <algorithm>
#include <vector>

#include <vadose/kernel/exchange.hpp>
#include <vadose/kernel/pressure_system.hpp>

namespace vadose::kernel {

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

/// Calls f(corner number, entry) for the cells around a node; f(., -1) outside the box.
template <class M, class F>
void for_cells_around(const CellView<M>& node, F&& f) {
  for_cells_at(node, [&](int at, const Index<State<M>::dim>& corner) {
    f(corner_number(corner), is_in_box(node, corner) ? node.tile[at] : -1);
  });
}

/// Unknown of a cell around a node if it is its own, else nullptr.
template <class M>
const PressureUnknown<State<M>::dim>* own_unknown(const State<M>& state, std::int32_t e) noexcept {
  if (e < 0) return nullptr;
  const std::int32_t row = state.system.row_of[static_cast<std::size_t>(e)];
  return row < 0 ? nullptr : &state.system.unknowns[static_cast<std::size_t>(row)];
}

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

}  // namespace vadose::kernel
