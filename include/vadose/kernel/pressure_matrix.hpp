// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The linear system of one iteration for the pressures: pattern, coefficients, solution.

#include <algorithm>
#include <vector>

#include <vadose/kernel/node_assembly.hpp>

namespace vadose::kernel {

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
  for_skeleton_nodes(state, [&](const CellView<M>& view, const SkeletonNode<dim>& node) {
    Real sum[dim] = {};
    for_cells_around(view, [&](int corner, std::int32_t c) {
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

}  // namespace vadose::kernel
