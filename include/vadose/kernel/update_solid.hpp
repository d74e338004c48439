// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Nodes to solid points, [Zhan] 3.4 (f) to (h): velocities, positions, stresses, volumes.

#include <vadose/kernel/point_motion.hpp>

namespace vadose::kernel {

/// Factor of the volume of eight solid points over the step. With RateByCell it follows the cell, in the
/// strain as in the volume itself; shape follows the point. A law that remembers openings is given the
/// strain that the volume takes.
/// DEVIATION: [Zhan] Eq. (26) prints J inverted; J = (1 - n0) / (1 - n) here, as in Eq. (27).
template <bool RateByCell, class M>
VADOSE_INLINE Lanes stretch_solid(const State<M>& state,
                                  [[maybe_unused]] const CellFinder<State<M>::dim>& cells,
                                  [[maybe_unused]] const std::int32_t* entries,
                                  [[maybe_unused]] const Lanes& porosity,
                                  SymTensor<Lanes, State<M>::stress_size>& rate) noexcept {
  const Lanes own = rate.trace(), dt(state.dt);
  if constexpr (has_liquid<M>) {
    Lanes volume_rate = own;
    if constexpr (RateByCell) {
      volume_rate = cell_rates(state, cells, entries, own);
      rate.add_isotropic((volume_rate - own) * Lanes(1.0 / 3.0));
    }
    const Lanes strain = dt * volume_rate;
    const Lanes stretch = volume_stretch(state, cells, entries, porosity, strain);
    if constexpr (law::RemembersOpening<typename M::Skeleton>)
      if (any(stretch < exp(strain)))
        rate.add_isotropic((log(stretch) - strain) * Lanes(1 / (3 * state.dt)));
    return stretch;
  } else {
    return exp(dt * own);
  }
}

/// Stress and state of the law of eight solid points: the law on a stress that has turned with them.
template <class M>
VADOSE_INLINE void update_stress(State<M>& state, std::size_t b, const Soil<M>& soil,
                                 const Lanes (&gradient)[State<M>::dim][State<M>::dim],
                                 const SymTensor<Lanes, State<M>::stress_size>& rate,
                                 StepSums& sums) noexcept {
  constexpr int n = State<M>::stress_size;
  constexpr int state_size = law::state_size<typename M::Skeleton>;
  auto& points = state.solid;
  StrainStep<Lanes, n> step;
  step.dt = state.dt;
  for (int i = 0; i < n; ++i) step.increment[i] = Lanes(state.dt) * rate[i];
  auto stress = load_stress(state, b);
  rotate_stress(gradient, state.dt, stress);
  Lanes numbers[state_size + 1];
  if constexpr (state_size > 0)
    for (int i = 0; i < state_size; ++i) numbers[i] = points.load(field::law_state, b, i);
  if (law::apply(soil.law, step, stress, numbers) != Status::ok) {
    sums.failed = true;
    report_trouble(state, points, b, Lanes(0.0) < Lanes(1.0), "admissible stress", "solid",
                   stress.mean());
  }
  for (int i = 0; i < n; ++i) points.store(field::bishop_stress, b, i, stress[i]);
  if constexpr (state_size > 0)
    for (int i = 0; i < state_size; ++i) points.store(field::law_state, b, i, numbers[i]);
}

/// Largest speed of waves in eight solid points.
template <bool RateByCell, class M>
VADOSE_INLINE void find_wave(const State<M>& state, const Soil<M>& soil, const Lanes& mass,
                             const Lanes& volume,
                             [[maybe_unused]] const CellFinder<State<M>::dim>& cells,
                             [[maybe_unused]] const std::int32_t* entries,
                             StepSums& sums) noexcept {
  const Lanes wave2 = Lanes(soil.p_wave_modulus) * select(mass > Lanes(0.0), volume, Lanes(0.0)) /
                      max(mass, Lanes(1e-300));
  sums.max_wave2 = max(sums.max_wave2, max_lane(wave2));
  if constexpr (State<M>::dim == 1 && RateByCell) {
    const Lanes outside = Lanes(1.0) - in_soil_cells(state, cells, entries);
    sums.max_dry_wave2 = max(sums.max_dry_wave2, max_lane(outside * wave2));
  }
}

/// Eight solid points must have pores.
template <class M>
VADOSE_INLINE void check_pores(State<M>& state, std::size_t b, const Lanes& grains,
                               const Lanes& volume, StepSums& sums) noexcept {
  const LaneMask solid_only = (grains > Lanes(0.0)) & !(grains < volume);
  if (!any(solid_only)) return;
  sums.failed = true;
  report_trouble(state, state.solid, b, solid_only, "porosity in (0, 1)", "solid",
                 Lanes(1.0) - grains / volume);
}

/// One batch of solid points.
template <bool RateByCell, class M>
VADOSE_INLINE void update_solid_batch(State<M>& state, std::size_t b,
                                      const TileFrame<State<M>::dim>& frame,
                                      const std::int32_t* entries, const Record* tile,
                                      StepSums& sums) noexcept {
  constexpr int dim = State<M>::dim;
  auto& points = state.solid;
  Lanes x[dim], half[dim];
  load_positions(points, b, x);
  load_half_sizes(points, b, half);
  Stencil<typename M::Shape, dim> stencil;
  stencil.evaluate(frame, x, half);
  PointMotion<dim> motion;
  interpolate<true>(stencil, tile, motion);
  CellFinder<dim> cells;
  if constexpr (has_liquid<M>) cells.find(frame, x);

  const auto& soil = state.soils[static_cast<std::size_t>(points.group(b))];
  const Lanes hoop =
      motion.velocity[0] * over_radius<typename State<M>::Kinematics, dim>(x, Real(0));
  auto rate = rate_of_deformation<State<M>::stress_size>(motion.gradient, hoop);
  const Lanes mass = points.load(field::mass, b);
  const Lanes grains = mass * Lanes(1 / soil.material.solid_density);
  Lanes volume = points.load(field::volume, b);
  const Lanes porosity = Lanes(1.0) - grains / max(volume, Lanes(1e-300));
  volume *= stretch_solid<RateByCell>(state, cells, entries, porosity, rate);
  update_stress(state, b, soil, motion.gradient, rate, sums);
  points.store(field::volume, b, volume);
  find_wave<RateByCell>(state, soil, mass, volume, cells, entries, sums);
  check_pores(state, b, grains, volume, sums);

  Lanes stretching[dim];
  for (int d = 0; d < dim; ++d) stretching[d] = motion.gradient[d][d];
  update_half_sizes(points, b, stretching, state.dt, state.grid.cell_size());
  update_velocity(state, points, b, stencil, frame, x, tile, motion);
  move(state, points, b, "solid", motion.velocity, sums);
}

/// Nodes to solid points: velocity, position, stress, volume.
template <class M, bool RateByCell = has_liquid<M>>
void update_solid(State<M>& state) {
  constexpr int dim = State<M>::dim;
  if constexpr (RateByCell) spread_rates(state);
  for_blocks(state.solid, state.options.threads, [&](const BatchRange& range, int thread) {
    Tile<dim>& tile = state.tile(thread, 2);
    tile.read(state.grid, range.slot, state.nodes.solid_out);
    const TileFrame<dim> frame = tile_frame(state.grid, range.slot);
    const std::int32_t* entries = state.grid.tile(range.slot);
    StepSums& sums = state.sums[static_cast<std::size_t>(thread)];
    ComingRecords<dim> coming(state.grid, next_slot(state.solid, range), state.nodes.solid_out);
    for (std::size_t b = range.begin; b < range.end; ++b) {
      state.solid.prefetch(b + 2);
      coming.ask_for_some();
      update_solid_batch<RateByCell>(state, b, frame, entries, tile.record, sums);
    }
  });
}

}  // namespace vadose::kernel
