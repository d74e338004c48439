// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Nodes to liquid points, [Zhan] 3.4 (f) to (h): velocities, exchanged water, volumes, pressures,
/// positions.

#include <vadose/kernel/cell_shares.hpp>
#include <vadose/kernel/point_motion.hpp>

namespace vadose::kernel {

/// Part of the difference in filling that points of a saturated cell even out per step [-].
inline constexpr Real evening = 0.05;
/// Differences below this part of the filling are round-off and stay: evened out they do not sum to 0,
/// and at rest the same is lost in every step.
inline constexpr Real evenness = 1e-14;

/// Full pores: every point of a saturated cell becomes as full as the others, or a point that crosses to
/// another cell would bring its own pressure along (1 % of filling is 1 % of K). Little by little:
/// shares do not sum to 1 exactly, and done in one step that error would repeat.
VADOSE_INLINE Lanes evened_out(const Lanes& filling, const Lanes& pores,
                               const Lanes& mass) noexcept {
  const Lanes lacks = filling * pores - mass;
  const LaneMask counts = (filling > Lanes(0.0)) & (abs(lacks) > Lanes(evenness) * mass);
  return select(counts, Lanes(evening) * lacks, Lanes(0.0));
}

/// The shares of the cells of eight points, by lane of their records.
template <class M>
VADOSE_INLINE void read_shares(const State<M>& state, const CellFinder<State<M>::dim>& cells,
                               const std::int32_t* entries, Lanes (&share)[lane_count]) noexcept {
  const auto of_cell = [&](int l) -> const Record& {
    return state.nodes.content[static_cast<std::size_t>(entries[cells.index[l]])];
  };
  if (cells.shared) {
    const Record& record = of_cell(0);
    for (int i = 0; i < lane_count; ++i) share[i] = Lanes(record[i]);
  } else {
    for (int l = 0; l < lane_count; ++l) share[l] = Lanes::load(of_cell(l).value);
    transpose(share);
  }
}

/// What eight pore-water points take of the gains of their cells; exchanged water carries its
/// momentum: what leaves a point has the velocity of the point, what comes the mean where it left.
/// (Were the mean of a cell to leave, the rest of each point would double its departure from the mean in
/// soil so dry that half of its water leaves in a step.) Writes mass, velocity and pressure.
template <class M>
VADOSE_INLINE void exchange_batch(State<M>& state, std::size_t b,
                                  const CellFinder<State<M>::dim>& cells,
                                  const std::int32_t* entries,
                                  const Lanes (&x)[State<M>::dim]) noexcept {
  constexpr int dim = State<M>::dim;
  auto& points = state.liquid;
  Lanes share[lane_count];
  read_shares(state, cells, entries, share);
  const Lanes mass = points.load(field::mass, b);
  const Lanes volume = points.load(field::volume, b);
  const Lanes filling = values_at(state.nodes.filling, cells, entries);
  const Lanes pores = volume * points.load(field::porosity, b);
  const Lanes held = select(volume > Lanes(0.0), mass, Lanes(0.0));
  const Lanes by_mass = held * share[lane::by_mass];
  const Lanes given = select(share[lane::by_pores] == Lanes(0.0), by_mass, Lanes(0.0));
  const Lanes taken =
      pores * share[lane::by_pores] + (by_mass - given) + evened_out(filling, pores, held);
  const Lanes rest = mass + given;
  const Lanes after = rest + taken;
  const LaneMask empty = !(after > Lanes(0.0));
  const Lanes over = Lanes(1.0) / select(empty, Lanes(1.0), after);
  for (int d = 0; d < dim; ++d) {
    const Lanes v = points.load(field::velocity, b, d);
    const Lanes mixed =
        (rest * v + taken * share[lane::brought + d]) * over + share[lane::velocity_gain + d];
    points.store(field::velocity, b, d, select(empty, v, mixed));
  }
  points.store(field::mass, b, after);
  if (!state.frozen)
    points.store(field::liquid_pressure, b, pressures_at(state, cells, entries, x));
}

/// Free water: pressure by the rate of its cell; volume from mass and pressure; exchange with the soil
/// in proportion to mass. What a point's pressure differs from its cell's grows as the points of a cell
/// mix and would shake the surface (a falling column of water tore from 32 cells on): it is forgotten
/// over a part of a cell on the point's way, and kept at rest.
template <class M>
VADOSE_INLINE void free_batch(State<M>& state, std::size_t b,
                              const CellFinder<State<M>::dim>& cells, const std::int32_t* entries,
                              const Lanes (&x)[State<M>::dim]) noexcept {
  constexpr int dim = State<M>::dim;
  auto& points = state.liquid;
  double* mass = points.at(field::mass, b);
  double* pressure = points.at(field::liquid_pressure, b);
  double* volume = points.at(field::volume, b);
  const Real bulk_modulus = state.water.bulk_modulus;
  const Real forgets = state.options.free_relaxation * state.dt / state.grid.cell_size();
  for (int l = 0; l < lane_count; ++l) {
    const std::int32_t owner = state.nodes.dof[static_cast<std::size_t>(entries[cells.index[l]])];
    if (owner < 0 || !(volume[l] > 0)) continue;
    const auto& cell = state.nodes.cell[static_cast<std::size_t>(owner)];
    Real at_rest = cell.pressure;
    for (int d = 0; d < dim; ++d)
      at_rest += state.water.density * state.gravity[d] * (x[d][l] - cell.centroid[d]);
    if (cell.kind == CellKind::free) {
      Real speed2 = 0;
      for (int d = 0; d < dim; ++d) {
        const Real v = points.at(field::velocity, b, d)[l];
        speed2 += v * v;
      }
      const Real keep = 1 / (1 + forgets * std::sqrt(speed2));
      if (cell.solved)
        pressure[l] = at_rest + keep * (pressure[l] - at_rest) + cell.change;
      else if (!state.frozen)
        pressure[l] =
            at_rest + keep * (pressure[l] - at_rest) - bulk_modulus * state.dt * cell.rate;
      if (cell.gain != 0 && cell.near_water > 0) {
        const Real near_mass = mass[l] * nearness(cell, x, l, 1 / state.grid.cell_size());
        const Real dm = cell.gain * near_mass / cell.near_water, taken = max(0.0, dm);
        for (int d = 0; d < dim; ++d) {
          double& v = points.at(field::velocity, b, d)[l];
          v = (mass[l] * v + taken * cell.mean_velocity[d]) / (mass[l] + taken) +
              cell.momentum_gain[d];
        }
        mass[l] += dm;
      }
    } else {
      pressure[l] = at_rest;
    }
    volume[l] = mass[l] / (state.water.density * std::exp(pressure[l] / bulk_modulus));
  }
}

/// Stops a free point at the boundary of cells that are soil for the most part: there it sinks in by
/// mass, not by position. Axis by axis; a point that is in such a cell may move.
template <class M>
void stop_at_ground(const State<M>& state, const TileFrame<State<M>::dim>& frame,
                    const std::int32_t* entries, int at, const Real (&x)[State<M>::dim],
                    Real (&velocity)[State<M>::dim]) noexcept {
  constexpr int dim = State<M>::dim;
  const auto is_soil = [&](int cell) {
    Real radius = 1;
    if constexpr (State<M>::Kinematics::axisymmetric) radius = x[0];
    return state.nodes.pore[static_cast<std::size_t>(entries[cell])][lane::bulk_volume] >
           0.5 * state.cell_volume(radius);
  };
  if (is_soil(at)) return;
  for (int d = 0; d < dim; ++d) {
    const Real now = std::floor((x[d] - frame.first[d]) * frame.over_cell_size);
    const Real then =
        std::floor((x[d] + state.dt * velocity[d] - frame.first[d]) * frame.over_cell_size);
    if (then == now) continue;
    const int next = at + (then > now ? 1 : -1) * BlockGrid<dim>::tile_stride(d);
    if (is_soil(next))
      velocity[d] = 0;
    else
      at = next;
  }
}

/// Eight liquid points among the liquid's nodes.
template <class M>
struct LiquidPlace {
  static constexpr int dim = State<M>::dim;
  std::size_t batch;
  int slot;  ///< of their block
  bool is_free;
  Lanes x[dim];       ///< position [m]
  Lanes inside[dim];  ///< the same, moved into the cell whose pressure it shares [m]
  CellFinder<dim> cells;
  Stencil<shape::Linear, dim> stencil;

  VADOSE_INLINE LiquidPlace(const State<M>& state, std::size_t b, int block,
                            const TileFrame<dim>& frame) noexcept
      : batch(b), slot(block), is_free(state.liquid.group(b) == state.free_group()) {
    Lanes none[dim];
    load_positions(state.liquid, b, x);
    for (int d = 0; d < dim; ++d) {
      inside[d] = x[d];
      none[d] = Lanes(0.0);
    }
    cells.find(frame, x);
    into_pressure_cell(state, cells, state.grid.tile(slot), slot, inside);
    stencil.evaluate(frame, inside, none);
  }
};

/// New velocities of eight liquid points from the liquid's nodes, and viscous stress of free water.
/// Returns the velocity of the water there.
template <class M>
VADOSE_INLINE PointMotion<State<M>::dim> accelerate_liquid(State<M>& state,
                                                           const LiquidPlace<M>& at,
                                                           const TileFrame<State<M>::dim>& frame,
                                                           const Record* liquid) noexcept {
  constexpr int dim = State<M>::dim;
  auto& points = state.liquid;
  PointMotion<dim> motion;
  interpolate<is_viscous<M> || M::Transfer::stores_gradient>(at.stencil, liquid, motion);
  update_velocity(state, points, at.batch, at.stencil, frame, at.inside, liquid, motion);
  if constexpr (is_viscous<M>) {
    if (at.is_free) {
      const Lanes hoop =
          motion.velocity[0] * over_radius<typename State<M>::Kinematics, dim>(at.x, Real(0));
      const auto tau = state.fluid.viscous_stress(
          rate_of_deformation<State<M>::stress_size>(motion.gradient, hoop));
      for (int i = 0; i < State<M>::stress_size; ++i)
        points.store(field::viscous_stress, at.batch, i, tau[i]);
    }
  }
  return motion;
}

/// A free point of a sliver moves with the edge of its pressure cell. A wall on the far side of its own
/// cell is beyond what that edge knows of: towards it the point moves less, as if the cell had the
/// velocity of the edge on one side and none on the other, and so never passes.
template <class M>
VADOSE_INLINE void keep_within_walls(const State<M>& state, const LiquidPlace<M>& at,
                                     const std::int32_t* entries,
                                     Lanes (&flux)[State<M>::dim]) noexcept {
  constexpr int dim = State<M>::dim;
  if (!state.nodes.near_sliver[static_cast<std::size_t>(at.slot)]) return;
  for (int l = 0; l < lane_count; ++l)
    for (int d = 0; d < dim; ++d) {
      const Real beyond = at.x[d][l] - at.inside[d][l];
      if (beyond == 0) continue;
      const int node = at.cells.index[l] + (beyond > 0 ? BlockGrid<dim>::tile_stride(d) : 0);
      if (state.nodes.node_flags[static_cast<std::size_t>(entries[node])] &
          (node_flag::liquid_fixed << d))
        flux[d].set(l, flux[d][l] * max(0.0, 1 - std::fabs(beyond) / state.grid.cell_size()));
    }
}

/// Moves eight points of free water with a velocity of their own volume.
template <class M>
VADOSE_INLINE void move_free_water(State<M>& state, const LiquidPlace<M>& at,
                                   const std::int32_t* entries, Lanes (&velocity)[State<M>::dim],
                                   StepSums& sums) noexcept {
  free_batch(state, at.batch, at.cells, entries, at.x);
  keep_within_walls(state, at, entries, velocity);
  move(state, state.liquid, at.batch, "liquid", velocity, sums);
}

/// Total volume flux q at eight points, with which free water moves; it stops at the ground.
template <class M>
VADOSE_INLINE void find_total_flux(const State<M>& state, const LiquidPlace<M>& at,
                                   const TileFrame<State<M>::dim>& frame,
                                   const std::int32_t* entries,
                                   Lanes (&flux)[State<M>::dim]) noexcept {
  constexpr int dim = State<M>::dim;
  for (int l = 0; l < lane_count; ++l) {
    Real q[dim] = {};
    for_cube<dim>(0, 2, [&](const Index<dim>& i) {
      int node = at.stencil.offset[l];
      for (int d = 0; d < dim; ++d) node += i[d] * BlockGrid<dim>::tile_stride(d);
      const Record& r = state.nodes.mixture[static_cast<std::size_t>(entries[node])];
      for (int d = 0; d < dim; ++d) q[d] += at.stencil.product(i, l) * r[d];
    });
    if (state.liquid.at(field::id, at.batch)[l] >= 0) {
      Real position[dim];
      for (int d = 0; d < dim; ++d) position[d] = at.x[d][l];
      stop_at_ground(state, frame, entries, at.cells.index[l], position, q);
    }
    for (int d = 0; d < dim; ++d) flux[d].set(l, q[d]);
  }
}

/// Water, volume and position of eight pore-water points, which move with the skeleton through its own
/// shape functions.
template <class M>
VADOSE_INLINE void carry_pore_water(State<M>& state, std::size_t b,
                                    const TileFrame<State<M>::dim>& frame,
                                    const std::int32_t* entries,
                                    [[maybe_unused]] const Record* solid,
                                    [[maybe_unused]] StepSums& sums) noexcept {
  constexpr int dim = State<M>::dim;
  auto& points = state.liquid;
  Lanes x[dim];
  load_positions(points, b, x);
  CellFinder<dim> cells;
  cells.find(frame, x);
  exchange_batch(state, b, cells, entries, x);
  if constexpr (is_deformable<M>) {
    Lanes half[dim];
    load_half_sizes(points, b, half);
    Stencil<typename M::Shape, dim> skeleton;
    skeleton.evaluate(frame, x, half);
    FlowGather<typename M::Shape, dim> carried;
    carried.sum(skeleton, solid);
    Lanes trace = carried.velocity[0] * over_radius<typename State<M>::Kinematics, dim>(x, Real(0));
    for (int d = 0; d < dim; ++d) trace += carried.stretching[d];
    const Lanes rate = cell_rates(state, cells, entries, trace);
    const Lanes n = points.load(field::porosity, b);
    const Lanes stretch = volume_stretch(state, cells, entries, n, Lanes(state.dt) * rate);
    points.store(field::volume, b, points.load(field::volume, b) * stretch);
    points.store(field::porosity, b, Lanes(1.0) - (Lanes(1.0) - n) / stretch);
    update_half_sizes(points, b, carried.stretching, state.dt, state.grid.cell_size());
    move(state, points, b, "liquid", carried.velocity, sums);
  }
}

/// Momentum of eight liquid points, and what free ones hold near the soil, to the cells.
template <class M>
VADOSE_INLINE void add_momentum(const State<M>& state, const LiquidPlace<M>& at,
                                const std::int32_t* entries, Tile<State<M>::dim>& tile) noexcept {
  const auto& points = state.liquid;
  const int first = at.is_free ? lane::free_momentum : lane::pore_momentum;
  const Lanes mass = points.load(field::mass, at.batch);
  Lanes record[lane_count];
  for (auto& r : record) r = Lanes(0.0);
  for (int d = 0; d < State<M>::dim; ++d)
    record[first + d] = mass * points.load(field::velocity, at.batch, d);
  if (at.is_free)
    for (int l = 0; l < lane_count; ++l) {
      const std::int32_t e = state.nodes.dof[static_cast<std::size_t>(entries[at.cells.index[l]])];
      if (e < 0) continue;
      const auto& cell = state.nodes.cell[static_cast<std::size_t>(e)];
      record[lane::near_mass].set(l, mass[l] * nearness(cell, at.x, l, 1 / state.grid.cell_size()));
    }
  add_to_cells(at.cells, record, tile);
}

/// Nodes to liquid points: velocities, and their momentum by cell.
template <class M>
void update_liquid_velocities(State<M>& state) {
  constexpr int dim = State<M>::dim;
  clear(state.nodes.content, state.options.threads);
  for_blocks_adding(state.liquid, state.options.threads, [&](const BatchRange& range, int thread) {
    Tile<dim>& liquid = state.tile(thread, 2);
    Tile<dim>& cell_sums = state.tile(thread, 0);
    liquid.read(state.grid, range.slot, state.nodes.liquid_out);
    const TileFrame<dim> frame = tile_frame(state.grid, range.slot);
    ComingRecords<dim> sums(state.grid, range.slot, state.nodes.content);
    ComingRecords<dim> nodes(state.grid, next_slot(state.liquid, range), state.nodes.liquid_out);
    for (std::size_t b = range.begin; b < range.end; ++b) {
      state.liquid.prefetch(b + 2);
      sums.ask_for_some();
      nodes.ask_for_some();
      const LiquidPlace<M> at(state, b, range.slot, frame);
      if (at.is_free && state.frozen) continue;
      accelerate_liquid(state, at, frame, liquid.record);
      add_momentum(state, at, state.grid.tile(range.slot), cell_sums);
    }
    cell_sums.add_to(state.grid, range.slot, state.nodes.content);
  });
}

/// Nodes to liquid points: water, volumes, pressures, positions.
template <class M>
void carry_liquid(State<M>& state) {
  constexpr int dim = State<M>::dim;
  for_blocks(state.liquid, state.options.threads, [&](const BatchRange& range, int thread) {
    Tile<dim>& solid = state.tile(thread, 3);
    if constexpr (is_deformable<M>) solid.read_twice(state.grid, range.slot, state.nodes.solid_out);
    const TileFrame<dim> frame = tile_frame(state.grid, range.slot);
    const std::int32_t* entries = state.grid.tile(range.slot);
    StepSums& sums = state.sums[static_cast<std::size_t>(thread)];
    for (std::size_t b = range.begin; b < range.end; ++b) {
      state.liquid.prefetch(b + 2);
      if (state.liquid.group(b) != state.free_group()) {
        carry_pore_water(state, b, frame, entries, solid.record, sums);
      } else if (!state.frozen) {
        const LiquidPlace<M> at(state, b, range.slot, frame);
        Lanes flux[dim];
        find_total_flux(state, at, frame, entries, flux);
        move_free_water(state, at, entries, flux, sums);
      }
    }
  });
}

/// Nodes to liquid points where there is no soil: all at once.
template <class M>
void update_free_water(State<M>& state) {
  constexpr int dim = State<M>::dim;
  for_blocks(state.liquid, state.options.threads, [&](const BatchRange& range, int thread) {
    Tile<dim>& liquid = state.tile(thread, 2);
    liquid.read(state.grid, range.slot, state.nodes.liquid_out);
    const TileFrame<dim> frame = tile_frame(state.grid, range.slot);
    const std::int32_t* entries = state.grid.tile(range.slot);
    StepSums& sums = state.sums[static_cast<std::size_t>(thread)];
    for (std::size_t b = range.begin; b < range.end && !state.frozen; ++b) {
      state.liquid.prefetch(b + 2);
      const LiquidPlace<M> at(state, b, range.slot, frame);
      auto motion = accelerate_liquid(state, at, frame, liquid.record);
      move_free_water(state, at, entries, motion.velocity, sums);
    }
  });
}

/// Nodes to liquid points. What cells exchange takes velocities along that must all be there before.
template <class M>
void update_liquid(State<M>& state) {
  if constexpr (has_skeleton<M>) {
    update_liquid_velocities(state);
    find_mean_velocities(state);
    find_shares(state);
    carry_liquid(state);
  } else {
    update_free_water(state);
  }
}

}  // namespace vadose::kernel
