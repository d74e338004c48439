// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Velocities of the skeleton at the end of a long step, by backward Euler with the elastic stiffness
/// of the points: (m + dt^2 K) v_{k+1} = m v_k + dt f(x_k, p_{k+1}), one linear system. What plastic flow
/// leaves of the forces is found again in the next step, as the force out of balance.

#include <algorithm>

#include <vadose/kernel/momentum.hpp>

namespace vadose::kernel {

/// Row of a node's velocity along an axis.
template <int Dim>
std::size_t row_of_axis(const SkeletonNode<Dim>& node, int axis) noexcept {
  return static_cast<std::size_t>(node.row * Dim + axis);
}

/// Slopes of a point's strain to the velocity of one node of the system.
template <int Dim>
struct StrainSlope {
  std::int32_t row;
  Real gradient[Dim];  ///< [1/m]
  Real hoop;           ///< weight over the radius [1/m]
};

/// Elastic energy of a unit of strain at a place.
struct ElasticWeights {
  Real shear = 0;       ///< 2 G V of the deviator [J]
  Real volumetric = 0;  ///< K V of the volume strain [J]
};

/// Adds the stiffness of one place to the lower triangle of the system.
template <int Dim>
void add_stiffness(SkeletonSystem<Dim>& skeleton, const std::vector<StrainSlope<Dim>>& slopes,
                   const ElasticWeights& weights) {
  const auto trace = [](const StrainSlope<Dim>& s, int d) {
    return s.gradient[d] + (d == 0 ? s.hoop : 0);
  };
  const Real isotropic = weights.volumetric - weights.shear / 3;
  for (const auto& a : slopes) {
    auto& row = skeleton.rows[static_cast<std::size_t>(a.row)];
    for (const auto& b : slopes) {
      if (b.row > a.row) continue;
      auto at = std::lower_bound(row.begin(), row.end(), b.row,
                                 [](const auto& e, std::int32_t c) { return e.column < c; });
      if (at == row.end() || at->column != b.row) at = row.insert(at, {b.row, {}});
      Real dot = 0;
      for (int d = 0; d < Dim; ++d) dot += a.gradient[d] * b.gradient[d];
      for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j) {
          Real deviator = 0.5 * (a.gradient[j] * b.gradient[i] + (i == j ? dot : 0));
          if (i == 0 && j == 0) deviator += a.hoop * b.hoop;
          at->block[i][j] += weights.shear * deviator + isotropic * trace(a, i) * trace(b, j);
        }
    }
  }
}

/// Adds a node to the slopes of a place; a carried one by those that carry it.
template <class M>
void add_slope(const State<M>& state, std::size_t e, const Real (&gradient)[State<M>::dim],
               Real hoop, std::vector<StrainSlope<State<M>::dim>>& slopes) {
  constexpr int dim = State<M>::dim;
  const auto& node = state.system.skeleton.node[e];
  const auto add = [&](std::int32_t row, Real part) {
    if (row < 0) return;
    StrainSlope<dim> s{row, {}, part * hoop};
    for (int d = 0; d < dim; ++d) s.gradient[d] = part * gradient[d];
    slopes.push_back(s);
  };
  if (node.carried < 0) return add(node.row, 1);
  for (std::int32_t i = 0; i < node.carriers; ++i) {
    const auto& carried = state.nodes.carried[static_cast<std::size_t>(node.carried + i)];
    for (int c = 0; c < CarriedNode<dim>::corners; ++c)
      add(state.system.skeleton.node[static_cast<std::size_t>(carried.corner[c])].row,
          carried.weight[c] / node.carriers);
  }
}

/// Part of a point's extent along an axis in one cell.
struct Overlap {
  int cell;    ///< along the axis
  Real share;  ///< of the extent [-]
  Real xi;     ///< its middle in the cell, 0 to 1
};

/// Splits the extent x +- half along an axis, in cells from the origin, where cells meet; what lies beyond a
/// wall counts at the wall. half <= 1/2.
inline void split_extent(Real x, Real half, int cells, Overlap (&parts)[2]) noexcept {
  const int first = std::min(std::max(static_cast<int>(std::floor(x - half)), 0), cells - 1);
  const Real low = x - half, high = x + half;
  const Real cut = first + 1 < cells ? min(max(first + 1.0, low), high) : high;
  const Real share = half > 0 ? (cut - low) / (high - low) : x < first + 1 ? 1 : 0;
  const auto within = [](Real xi) { return min(max(xi, 0.0), 1.0); };
  parts[0] = {first, share, within(0.5 * (low + cut) - first)};
  parts[1] = {std::min(first + 1, cells - 1), 1 - share, within(0.5 * (cut + high) - first - 1)};
}

/// Half the extent of a point along an axis over the size of a cell, as its shape function has it.
template <class M>
Real half_extent(const State<M>& state, std::size_t b, int l, int axis) noexcept {
  if constexpr (State<M>::Solid::fields::template has<field::HalfSize>)
    return min(state.solid.at(field::half_size, b, axis)[l] / state.grid.cell_size(), 0.5);
  else
    return M::Shape::support == 3 ? 0.5 : 0;
}

/// Slopes of the hat functions of a cell at a place in it.
template <class M>
void find_slopes(const State<M>& state, const Index<State<M>::dim>& cell,
                 const Real (&xi)[State<M>::dim], Real radius,
                 std::vector<StrainSlope<State<M>::dim>>& slopes) {
  constexpr int dim = State<M>::dim;
  slopes.clear();
  for_cube<dim>(0, 2, [&](const Index<dim>& corner) {
    Index<dim> node = cell;
    for (int d = 0; d < dim; ++d) node[d] += corner[d];
    const std::int32_t e = state.grid.entry(node);
    if (e == state.grid.outside()) return;
    const CornerFunction<dim> shape(xi, corner, 1 / state.grid.cell_size());
    const Real hoop = State<M>::Kinematics::axisymmetric ? shape.value / radius : 0;
    add_slope(state, static_cast<std::size_t>(e), shape.gradient, hoop, slopes);
  });
}

/// Stiffness of a point: of its deviator, and outside soil cells of its volume. The hat functions of the
/// cells that its extent lies in stand for its own function, their mean over it: the matrix couples next
/// neighbours only. The square of a mean is at most the mean of squares, so that it is stiffer than the
/// points but for what one place per cell misses of that mean; long steps were stable in all runs.
template <class M>
void add_point_stiffness(State<M>& state, std::size_t b, int l, const ElasticWeights& weights,
                         std::vector<StrainSlope<State<M>::dim>>& slopes) {
  constexpr int dim = State<M>::dim;
  const Real over_h = 1 / state.grid.cell_size();
  Overlap parts[dim][2];
  for (int d = 0; d < dim; ++d) {
    const Real x = (state.solid.at(field::position, b, d)[l] - state.grid.origin()[d]) * over_h;
    split_extent(x, half_extent(state, b, l, d), state.grid.cells()[d], parts[d]);
  }
  const Real radius = state.solid.at(field::position, b, 0)[l];
  for_cube<dim>(0, 2, [&](const Index<dim>& which) {
    Index<dim> cell;
    Real xi[dim], share = 1;
    for (int d = 0; d < dim; ++d) {
      const Overlap& part = parts[d][which[d]];
      cell[d] = part.cell;
      xi[d] = part.xi;
      share *= part.share;
    }
    if (!(share > 0)) return;
    find_slopes(state, cell, xi, radius, slopes);
    add_stiffness<dim>(state.system.skeleton, slopes,
                       {share * weights.shear, share * weights.volumetric});
  });
}

/// Stiffness of all points.
template <class M>
void add_points_stiffness(State<M>& state, std::vector<StrainSlope<State<M>::dim>>& slopes) {
  for_blocks(state.solid, 1, [&](const BatchRange& range, int) {
    const auto frame = tile_frame(state.grid, range.slot);
    for (std::size_t b = range.begin; b < range.end; ++b) {
      Lanes x[State<M>::dim];
      load_positions(state.solid, b, x);
      CellFinder<State<M>::dim> cells;
      cells.find(frame, x);
      const Lanes by_cell = in_soil_cells(state, cells, state.grid.tile(range.slot));
      const auto& soil = state.soils[static_cast<std::size_t>(state.solid.group(b))];
      for (int l = 0; l < lane_count; ++l) {
        const Real volume = state.solid.at(field::volume, b)[l];
        if (volume > 0)
          add_point_stiffness(
              state, b, l,
              {2 * soil.shear_modulus * volume, (1 - by_cell[l]) * soil.bulk_modulus() * volume},
              slopes);
      }
    }
  });
}

/// Stiffness of the volume of a soil cell, which its mean stress acts through (see prepare_cell).
template <class M>
void add_cell_stiffness(State<M>& state, const CellView<M>& view,
                        std::vector<StrainSlope<State<M>::dim>>& slopes) {
  const auto& c = state.nodes.cell[static_cast<std::size_t>(view.entry())];
  if (c.kind != CellKind::soil || c.drop) return;
  Real xi[State<M>::dim];
  quad_coordinates(state, view.cell, c, xi);
  find_slopes(state, view.cell, xi, c.quad_point[0], slopes);
  add_stiffness<State<M>::dim>(
      state.system.skeleton, slopes,
      {0, c.quad_volume * c.soil_share * state.soils[c.material].bulk_modulus()});
}

/// Numbers the nodes with grains and finds those that others carry.
template <class M>
void list_skeleton_nodes(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& skeleton = state.system.skeleton;
  skeleton.entry.clear();
  for_cells(state.grid, 1, [&](std::int32_t e, const Index<dim>&, int, int) {
    auto& node = skeleton.node[static_cast<std::size_t>(e)];
    if (!(node.inertia[0][0] > 0)) return;
    node.row = static_cast<std::int32_t>(skeleton.entry.size());
    skeleton.entry.push_back(e);
  });
  for_carried(state.nodes, [&](std::size_t first, std::size_t last) {
    auto& node = skeleton.node[static_cast<std::size_t>(state.nodes.carried[first].entry)];
    node.carried = static_cast<std::int32_t>(first);
    node.carriers = static_cast<std::int32_t>(last - first);
  });
  skeleton.rows.resize(std::max(skeleton.rows.size(), skeleton.entry.size()));
  for (auto& row : skeleton.rows) row.clear();
}

/// Elastic stiffness of the whole skeleton.
template <class M>
void find_stiffness(State<M>& state) {
  constexpr int dim = State<M>::dim;
  list_skeleton_nodes(state);
  std::vector<StrainSlope<dim>> slopes;
  add_points_stiffness(state, slopes);
  for_cells(state.grid, 1, [&](std::int32_t e, const Index<dim>& local, int slot, int) {
    if (state.nodes.dof[static_cast<std::size_t>(e)] == e)
      add_cell_stiffness(state, CellView<M>(state, local, slot), slopes);
  });
}

/// Calls f(row, column, value) for every coefficient of the stiffness in the lower triangle.
template <int Dim, class F>
void for_stiffness(const SkeletonSystem<Dim>& skeleton, F&& f) {
  for (std::size_t r = 0; r < skeleton.entry.size(); ++r)
    for (const auto& e : skeleton.rows[r])
      for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j) {
          const int row = static_cast<int>(r) * Dim + i, column = e.column * Dim + j;
          if (column <= row) f(row, column, e.block[i][j]);
        }
}

/// m + dt^2 K with its held rows, and what these bring to the right-hand side.
template <class M>
void fill_skeleton_matrix(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& skeleton = state.system.skeleton;
  const int size = dim * static_cast<int>(skeleton.entry.size());
  const auto node = [&](int row) -> const SkeletonNode<dim>& {
    return skeleton
        .node[static_cast<std::size_t>(skeleton.entry[static_cast<std::size_t>(row / dim)])];
  };
  const auto impulse = [&](int row) -> Real& {
    return skeleton.impulse[static_cast<std::size_t>(row)];
  };
  const auto held = [&](int row) { return (node(row).held >> (row % dim)) & 1; };
  skeleton.impulse.assign(static_cast<std::size_t>(size), 0);
  auto& values = skeleton.values;
  values.clear();
  for (int row = 0; row < size; ++row) {
    const auto& n = node(row);
    const int i = row % dim, first = row - i;
    if (held(row)) {
      values.emplace_back(row, row, 1);
      impulse(row) += n.given[i];
      continue;
    }
    impulse(row) += n.impulse[i];
    for (int j = 0; j < dim; ++j) {
      if (held(first + j))
        impulse(row) -= n.inertia[i][j] * n.given[j];
      else if (j <= i)
        values.emplace_back(row, first + j, n.inertia[i][j]);
    }
  }
  const Real dt2 = state.dt * state.dt;
  for_stiffness(skeleton, [&](int row, int column, Real value) {
    const bool a = held(row), b = held(column);
    if (a && b) return;
    if (a)
      impulse(column) -= dt2 * value * node(row).given[row % dim];
    else if (b)
      impulse(row) -= dt2 * value * node(column).given[column % dim];
    else
      values.emplace_back(row, column, dt2 * value);
  });
}

/// Larger systems in space are solved by iteration (with 4356 rows both take 0.4 s per step).
inline constexpr std::size_t most_factored_in_space = 4000;

/// The whole matrix of a system from its lower triangle.
inline void fill_whole(const std::vector<Eigen::Triplet<Real>>& lower, std::size_t size,
                       SparseRows& matrix) {
  std::vector<std::vector<int>> columns(size);
  for (const auto& v : lower) {
    columns[static_cast<std::size_t>(v.row())].push_back(v.col());
    if (v.row() != v.col()) columns[static_cast<std::size_t>(v.col())].push_back(v.row());
  }
  for (auto& row : columns) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
  }
  matrix.set_pattern(columns);
  for (const auto& v : lower) {
    matrix.add(v.row(), v.col(), v.value());
    if (v.row() != v.col()) matrix.add(v.col(), v.row(), v.value());
  }
}

/// Makes the system ready for solutions; false where it cannot be solved.
template <class M>
bool prepare_skeleton(State<M>& state) {
  auto& skeleton = state.system.skeleton;
  find_stiffness(state);
  fill_skeleton_matrix(state);
  const std::size_t size = skeleton.impulse.size();
  skeleton.factored = State<M>::dim < 3 || size <= most_factored_in_space;
  skeleton.solved = true;
  if (!skeleton.factored) {
    fill_whole(skeleton.values, size, skeleton.matrix);
    skeleton.iteration.factor(skeleton.matrix, state.options.threads);
    return true;
  }
  const auto rows = static_cast<int>(size);
  SparseCholesky::Matrix lower(rows, rows);
  lower.setFromTriplets(skeleton.values.begin(), skeleton.values.end());
  return skeleton.solver.factor(lower);
}

/// Velocities by impulses: skeleton.impulse to skeleton.velocity. An iteration that ends far from its
/// tolerance is noted in skeleton.solved.
template <int Dim>
void solve_skeleton(SkeletonSystem<Dim>& skeleton, int threads) {
  constexpr Real tolerance = 1e-11, limit = 1e-8;
  constexpr int most = 1000;
  if (skeleton.factored) {
    skeleton.solver.solve(skeleton.impulse, skeleton.velocity);
    return;
  }
  const auto outcome = skeleton.iteration.solve_factored(
      skeleton.matrix, skeleton.impulse, skeleton.velocity, tolerance, most, threads);
  skeleton.solved = skeleton.solved && outcome.residual <= limit;
}

/// Velocities of both phases at the end of the step with the pressures of its start; false where the
/// system cannot be solved.
template <class M>
bool predict_skeleton(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& skeleton = state.system.skeleton;
  if (!prepare_skeleton(state)) return false;
  solve_skeleton(skeleton, state.options.threads);
  if (!skeleton.solved) return false;
  for (std::size_t r = 0; r < skeleton.entry.size(); ++r) {
    const auto i = static_cast<std::size_t>(skeleton.entry[r]);
    const auto& n = skeleton.node[i];
    auto& response = state.system.response[i];
    for (int d = 0; d < dim; ++d)
      response.solid[d] = skeleton.velocity[r * dim + static_cast<std::size_t>(d)];
    for (int d = 0; d < dim; ++d) {
      Real v = n.liquid_velocity[d];
      for (int j = 0; j < dim; ++j) v += n.coupling[d][j] * response.solid[j];
      if (!(response.liquid_held & (1 << d))) response.liquid[d] = v;
      if (response.follows) response.liquid[d] = response.solid[d];
    }
  }
  return true;
}

/// Changes of the grains' velocities by impulses at the nodes: skeleton.impulse to skeleton.velocity.
template <int Dim>
void respond_skeleton(SkeletonSystem<Dim>& skeleton, int threads) {
  for (std::size_t r = 0; r < skeleton.entry.size(); ++r) {
    const auto held = skeleton.node[static_cast<std::size_t>(skeleton.entry[r])].held;
    for (std::size_t d = 0; d < Dim; ++d)
      if (held >> d & 1) skeleton.impulse[r * Dim + d] = 0;
  }
  solve_skeleton(skeleton, threads);
}

}  // namespace vadose::kernel
