// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Step 3, [Zhan] 3.4 (a): mass, momentum, stress and volume of the points to the nodes.

#include <vadose/kernel/pressure.hpp>
#include <vadose/policy/shape/linear.hpp>

namespace vadose::kernel {

/// Index of stress component (a, b) in a SymTensor of a kinematics of dimension Dim; shears
/// follow the normals as xy, yz, zx.
template <int Dim>
constexpr int stress_index(int a, int b) noexcept {
  if (a == b) return a;
  return a + b == 1 ? 3 : a + b == 3 ? 4 : 5;
}

/// Value and moments of the velocity that a batch hands to the nodes: v + C (x_I - x_p), C being
/// the gradient (TPIC) or B D^-1 (APIC, D = second moment of the weights at the present place).
/// `value` is for the first node of each point; `moment[e]` is what Scatter takes along axis e:
/// mass times the change per cell.
template <class M, class Shape, class Points>
VADOSE_INLINE void affine_velocity(const State<M>& state, const Points& points, std::size_t b,
                                   const Stencil<Shape, State<M>::dim>& stencil,
                                   const TileFrame<State<M>::dim>& frame,
                                   const Lanes (&x)[State<M>::dim], const Lanes& mass,
                                   Lanes (&value)[State<M>::dim],
                                   Lanes (&moment)[State<M>::dim][lane_count]) noexcept {
  constexpr int dim = State<M>::dim;
  const Real h = state.grid.cell_size();
  for (int e = 0; e < dim; ++e) {
    const Lanes first = Lanes(frame.first[e]) + Lanes(h) * Lanes::load(stencil.first[e]);
    Lanes over_moment(1.0);
    if constexpr (!M::Transfer::stores_gradient) {
      Lanes second(0.0);
      for (int i = 0; i < Shape::support; ++i) {
        const Lanes r = first + Lanes(i * h) - x[e];
        second += Lanes::load(stencil.weight[e][i]) * r * r;
      }
      // Hat functions have no second moment at a node; B is small there too.
      over_moment = Lanes(1.0) / max(second, Lanes(1e-3 * h * h));
    }
    for (auto& r : moment[e]) r = Lanes(0.0);
    for (int d = 0; d < dim; ++d) {
      const Lanes c = points.load(field::affine, b, d * dim + e) * over_moment;
      value[d] += c * (first - x[e]);
      moment[e][lane::momentum + d] = mass * (c * Lanes(h));
    }
    transpose(moment[e]);
  }
}

/// Loads a batch's Bishop stress.
template <class M>
VADOSE_INLINE SymTensor<Lanes, State<M>::stress_size> load_stress(const State<M>& state,
                                                                  std::size_t b) noexcept {
  SymTensor<Lanes, State<M>::stress_size> stress;
  for (int i = 0; i < State<M>::stress_size; ++i)
    stress[i] = state.solid.load(field::bishop_stress, b, i);
  return stress;
}

/// 1 for points in cells of soil, 0 in others.
template <class M>
VADOSE_INLINE Lanes in_soil_cells(const State<M>& state, const CellFinder<State<M>::dim>& cells,
                                  const std::int32_t* entries) noexcept {
  return values_at(state.nodes.soil, cells, entries);
}

/// Whether all cells that points of a block can be in are soil.
template <class M>
bool is_all_soil(const State<M>& state, const std::int32_t* entries) noexcept {
  constexpr int dim = State<M>::dim;
  bool all = true;
  for_cube<dim>(-1, Block<dim>::edge + 1, [&](const Index<dim>& cell) {
    const std::int32_t e = entries[BlockGrid<dim>::tile_index(cell)];
    all = all && state.nodes.soil[static_cast<std::size_t>(e)] > 0;
  });
  return all;
}

/// Adds one batch of solid points to a tile of nodes. With MeanByCell the mean stress goes to the
/// cells instead, where it meets the liquid pressure: see prepare_cell(). Not so in cells of free water:
/// grains that only come into one have next to no mass at its far nodes, which its mean stress would
/// throw away.
template <bool MeanByCell, class M>
VADOSE_INLINE void map_solid_batch(const State<M>& state, std::size_t b,
                                   const TileFrame<State<M>::dim>& frame,
                                   [[maybe_unused]] const std::int32_t* entries,
                                   [[maybe_unused]] bool all_soil, Record* tile,
                                   [[maybe_unused]] Tile<State<M>::dim>& cell_sums) noexcept {
  constexpr int dim = State<M>::dim;
  using Shape = typename M::Shape;
  constexpr bool affine = M::Transfer::affine;
  Lanes x[dim], half[dim];
  load_positions(state.solid, b, x);
  load_half_sizes(state.solid, b, half);
  Stencil<Shape, dim> stencil;
  stencil.evaluate(frame, x, half);

  const Lanes mass = state.solid.load(field::mass, b);
  const Lanes volume = state.solid.load(field::volume, b);
  auto stress = load_stress(state, b);
  if constexpr (MeanByCell) {
    CellFinder<dim> cells;
    cells.find(frame, x);
    const Lanes by_cell = all_soil ? Lanes(1.0) : in_soil_cells(state, cells, entries);
    const Lanes mean = by_cell * stress.mean();
    stress.add_isotropic(-mean);
    Lanes record[lane_count];
    for (auto& r : record) r = Lanes(0.0);
    record[lane::skeleton_volume] = by_cell * volume;
    record[lane::mean_stress] = volume * mean;
    add_to_cells(cells, record, cell_sums);
  }
  Lanes velocity[dim];
  for (int d = 0; d < dim; ++d) velocity[d] = state.solid.load(field::velocity, b, d);
  if constexpr (!affine && !State<M>::Kinematics::axisymmetric) {
    Lanes value[5], force[dim][dim];
    value[lane::mass] = mass;
    for (int d = 0; d < 3; ++d)
      value[lane::momentum + d] = d < dim ? mass * velocity[d] : Lanes(0.0);
    value[4] = volume;
    for (int e = 0; e < dim; ++e)
      for (int d = 0; d < dim; ++d) force[e][d] = -volume * stress[stress_index<dim>(d, e)];
    ForceScatter<Shape, dim> scatter;
    scatter.set(value, force);
    scatter.add(stencil, tile);
  } else {
    Scatter<true, affine, Shape, dim> scatter;
    if constexpr (affine)
      affine_velocity(state, state.solid, b, stencil, frame, x, mass, velocity, scatter.moment);
    for (auto& r : scatter.value) r = Lanes(0.0);
    scatter.value[lane::mass] = mass;
    for (int d = 0; d < dim; ++d) scatter.value[lane::momentum + d] = mass * velocity[d];
    scatter.value[lane::volume] = volume;
    if constexpr (State<M>::Kinematics::axisymmetric)
      scatter.value[lane::force] =
          -volume * stress[2] * over_radius<typename State<M>::Kinematics, dim>(x, Real(0));
    transpose(scatter.value);
    for (int e = 0; e < dim; ++e) {
      for (auto& r : scatter.slope[e]) r = Lanes(0.0);
      for (int d = 0; d < dim; ++d)
        scatter.slope[e][lane::force + d] = -volume * stress[stress_index<dim>(d, e)];
      transpose(scatter.slope[e]);
    }
    scatter.add(stencil, tile);
  }
}

/// Solid points to nodes: m, m v, -sum sigma V grad S, V. Without MeanByCell that is the whole
/// stress of each point, as [Zhan] Eq. (22) has it.
template <class M, bool MeanByCell = has_liquid<M>>
void map_solid(State<M>& state) {
  constexpr int dim = State<M>::dim;
  clear(state.nodes.solid_in, state.options.threads);
  for_blocks_adding(state.solid, state.options.threads, [&](const BatchRange& range, int thread) {
    Tile<dim>& tile = state.tile(thread, 0);
    Tile<dim>& cell_sums = state.tile(thread, 1);
    const TileFrame<dim> frame = tile_frame(state.grid, range.slot);
    ComingRecords<dim> nodes(state.grid, range.slot, state.nodes.solid_in);
    ComingRecords<dim> sums(state.grid, range.slot,
                            MeanByCell ? state.nodes.content : state.nodes.solid_in);
    const std::int32_t* entries = state.grid.tile(range.slot);
    const bool all_soil = MeanByCell && is_all_soil(state, entries);
    for (std::size_t b = range.begin; b < range.end; ++b) {
      state.solid.prefetch(b + 2);
      nodes.ask_for_some();
      if constexpr (MeanByCell) sums.ask_for_some();
      map_solid_batch<MeanByCell>(state, b, frame, entries, all_soil, tile.record, cell_sums);
    }
    tile.add_to(state.grid, range.slot, state.nodes.solid_in);
    if constexpr (MeanByCell) cell_sums.add_to(state.grid, range.slot, state.nodes.content);
  });
}

/// Moves points of slivers to the edge of the cell whose pressure they share, for their mapping:
/// nodes beyond it have no share in the pressure force.
template <class M>
VADOSE_INLINE void into_pressure_cell(const State<M>& state, const CellFinder<State<M>::dim>& cells,
                                      const std::int32_t* entries, int slot,
                                      Lanes (&x)[State<M>::dim]) noexcept {
  constexpr int dim = State<M>::dim;
  if (!state.nodes.near_sliver[static_cast<std::size_t>(slot)]) return;
  const Real h = state.grid.cell_size();
  for (int l = 0; l < lane_count; ++l) {
    const std::int32_t e = entries[cells.index[l]];
    const std::int32_t owner = state.nodes.dof[static_cast<std::size_t>(e)];
    if (owner < 0 || owner == e) continue;
    const Index<dim> first = state.grid.first_cell(slot);
    Index<dim> cell;  // of the point, in the grid
    for (int d = 0; d < dim; ++d)
      cell[d] =
          first[d] - 1 + (cells.index[l] / BlockGrid<dim>::tile_stride(d)) % Block<dim>::tile_edge;
    for_cube<dim>(-1, 2, [&](const Index<dim>& step) {
      Index<dim> target = cell;
      for (int d = 0; d < dim; ++d) target[d] += step[d];
      if (state.grid.entry(target) != owner) return;
      for (int d = 0; d < dim; ++d) {
        const Real low = state.grid.origin()[d] + target[d] * h;
        x[d].set(l, min(max(x[d][l], low), low + h));
      }
    });
  }
}

/// Adds one batch of liquid points to a tile (hat functions).
template <class M>
VADOSE_INLINE void map_liquid_batch(const State<M>& state, std::size_t b,
                                    const TileFrame<State<M>::dim>& frame, int slot,
                                    Record* tile) noexcept {
  constexpr int dim = State<M>::dim;
  constexpr bool affine = M::Transfer::affine;
  constexpr bool viscous = is_viscous<M>;
  Lanes x[dim], none[dim];
  load_positions(state.liquid, b, x);
  CellFinder<dim> cells;
  cells.find(frame, x);
  into_pressure_cell(state, cells, state.grid.tile(slot), slot, x);
  for (auto& n : none) n = Lanes(0.0);
  Stencil<shape::Linear, dim> stencil;
  stencil.evaluate(frame, x, none);
  const Lanes mass = state.liquid.load(field::mass, b);
  Scatter<viscous, affine, shape::Linear, dim> scatter;
  Lanes velocity[dim];
  for (int d = 0; d < dim; ++d) velocity[d] = state.liquid.load(field::velocity, b, d);
  if constexpr (affine)
    affine_velocity(state, state.liquid, b, stencil, frame, x, mass, velocity, scatter.moment);
  for (auto& r : scatter.value) r = Lanes(0.0);
  scatter.value[lane::mass] = mass;
  for (int d = 0; d < dim; ++d) scatter.value[lane::momentum + d] = mass * velocity[d];
  if constexpr (viscous) {
    const bool is_free = state.liquid.group(b) == state.free_group();
    const Lanes volume = is_free ? state.liquid.load(field::volume, b) : Lanes(0.0);
    if constexpr (State<M>::Kinematics::axisymmetric)
      scatter.value[lane::force] = -volume * state.liquid.load(field::viscous_stress, b, 2) *
                                   over_radius<typename State<M>::Kinematics, dim>(x, Real(0));
    for (int e = 0; e < dim; ++e) {
      for (auto& r : scatter.slope[e]) r = Lanes(0.0);
      for (int d = 0; d < dim; ++d)
        scatter.slope[e][lane::force + d] =
            -volume * state.liquid.load(field::viscous_stress, b, stress_index<dim>(d, e));
      transpose(scatter.slope[e]);
    }
  }
  transpose(scatter.value);
  scatter.add(stencil, tile);
}

/// Liquid points to nodes: m, m v, viscous force.
template <class M>
void map_liquid(State<M>& state) {
  constexpr int dim = State<M>::dim;
  clear(state.nodes.liquid_in, state.options.threads);
  for_blocks_adding(state.liquid, state.options.threads, [&](const BatchRange& range, int thread) {
    Tile<dim>& tile = state.tile(thread);
    const TileFrame<dim> frame = tile_frame(state.grid, range.slot);
    ComingRecords<dim> coming(state.grid, range.slot, state.nodes.liquid_in);
    for (std::size_t b = range.begin; b < range.end; ++b) {
      state.liquid.prefetch(b + 2);
      coming.ask_for_some();
      map_liquid_batch(state, b, frame, range.slot, tile.record);
    }
    tile.add_to(state.grid, range.slot, state.nodes.liquid_in);
  });
}

/// Calls f(entry, weight) for the nodes around a place that exist (hat functions).
template <int Dim, class F>
void for_hat_nodes(const BlockGrid<Dim>& grid, const Vec<Dim>& x, F&& f) {
  Index<Dim> cell;
  Real xi[Dim];
  for (int d = 0; d < Dim; ++d) {
    cell[d] = grid.cell_of(x[d], d);
    xi[d] = (x[d] - grid.origin()[d]) / grid.cell_size() - cell[d];
  }
  for_cube<Dim>(0, 2, [&](const Index<Dim>& corner) {
    Index<Dim> node = cell;
    Real w = 1;
    for (int d = 0; d < Dim; ++d) {
      node[d] += corner[d];
      w *= corner[d] ? xi[d] : 1 - xi[d];
    }
    const std::int32_t e = grid.entry(node);
    if (e != grid.outside()) f(static_cast<std::size_t>(e), w);
  });
}

/// Loads on the ground to nodes, at the surface itself. Few: one thread.
template <class M>
void map_loads(State<M>& state) {
  for (const auto& load : state.loads) {
    const Real factor = state.factor_values[load.factor];
    for_hat_nodes(state.grid, load.position, [&](std::size_t node, Real w) {
      for (int d = 0; d < State<M>::dim; ++d)
        state.nodes.solid_in[node][lane::force + d] += factor * w * load.force[d];
    });
  }
}

}  // namespace vadose::kernel
