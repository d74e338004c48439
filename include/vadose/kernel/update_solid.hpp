// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Nodes to solid points, [Zhan] 3.4 (f) to (h): velocities, positions, stresses, volumes.

#include <vadose/kernel/point_motion.hpp>

namespace vadose::kernel {

/// One batch of solid points. With RateByCell the volume follows the cell, in the strain as in the
/// volume itself; shape follows the point.
/// DEVIATION: [Zhan] Eq. (26) prints J inverted; J = (1 - n0) / (1 - n) here, as in Eq. (27).
template <bool RateByCell, class M>
VADOSE_INLINE void update_solid_batch(State<M>& state, std::size_t b,
                                      const TileFrame<State<M>::dim>& frame,
                                      [[maybe_unused]] const std::int32_t* entries,
                                      const Record* tile, StepSums& sums) noexcept {
  constexpr int dim = State<M>::dim;
  constexpr int n = State<M>::stress_size;
  using K = typename State<M>::Kinematics;
  auto& points = state.solid;
  const Real dt = state.dt;
  Lanes x[dim], half[dim];
  load_positions(points, b, x);
  load_half_sizes(points, b, half);
  Stencil<typename M::Shape, dim> stencil;
  stencil.evaluate(frame, x, half);
  PointMotion<dim> motion;
  interpolate<true>(stencil, tile, motion);

  const Lanes hoop = motion.velocity[0] * over_radius<K, dim>(x, Real(0));
  auto rate = rate_of_deformation<n>(motion.gradient, hoop);
  Lanes volume_rate = rate.trace();
  const auto& soil = state.soils[static_cast<std::size_t>(points.group(b))];
  const Lanes grains = points.load(field::mass, b) * Lanes(1 / soil.material.solid_density);
  [[maybe_unused]] CellFinder<dim> cells;
  if constexpr (has_liquid<M>) cells.find(frame, x);
  if constexpr (RateByCell) {
    const Lanes own = volume_rate;
    volume_rate = cell_rates(state, cells, entries, own);
    rate.add_isotropic((volume_rate - own) * Lanes(1.0 / 3.0));
  }
  [[maybe_unused]] Lanes stretch;
  if constexpr (has_liquid<M>) {
    const Lanes porosity = Lanes(1.0) - grains / max(points.load(field::volume, b), Lanes(1e-300));
    const Lanes strain = Lanes(dt) * volume_rate;
    stretch = volume_stretch(state, cells, entries, porosity, strain);
    // Only where grains become dispersed the volume may fall behind.
    if constexpr (law::RemembersOpening<typename M::Skeleton>)
      if (any(Lanes(dispersed_porosity) < porosity + strain) && any(stretch < exp_of_small(strain)))
        rate.add_isotropic((log(stretch) - strain) * Lanes(1 / (3 * dt)));
  }
  StrainStep<Lanes, n> step;
  step.dt = dt;
  for (int i = 0; i < n; ++i) step.increment[i] = Lanes(dt) * rate[i];
  auto stress = load_stress(state, b);
  rotate_stress(motion.gradient, dt, stress);
  constexpr int state_size = law::state_size<typename M::Skeleton>;
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

  Lanes volume = points.load(field::volume, b);
  if constexpr (has_liquid<M>)
    volume *= stretch;
  else
    volume *= exp_of_small(Lanes(dt) * volume_rate);
  points.store(field::volume, b, volume);
  const Lanes mass = points.load(field::mass, b);
  const Lanes alive_mass = max(mass, Lanes(1e-300));
  sums.max_wave2 =
      max(sums.max_wave2, max_lane(Lanes(soil.p_wave_modulus) *
                                   select(mass > Lanes(0.0), volume, Lanes(0.0)) / alive_mass));
  if constexpr (dim == 1 && RateByCell) {
    const Lanes outside = Lanes(1.0) - in_soil_cells(state, cells, entries);
    sums.max_dry_wave2 = max(sums.max_dry_wave2,
                             max_lane(Lanes(soil.p_wave_modulus) * outside *
                                      select(mass > Lanes(0.0), volume, Lanes(0.0)) / alive_mass));
  }
  const LaneMask solid_only =
      (mass > Lanes(0.0)) & !(mass < Lanes(soil.material.solid_density) * volume);
  if (any(solid_only)) {
    sums.failed = true;
    report_trouble(state, points, b, solid_only, "porosity in (0, 1)", "solid",
                   Lanes(1.0) - mass / (Lanes(soil.material.solid_density) * volume));
  }
  Lanes stretching[dim];
  for (int d = 0; d < dim; ++d) stretching[d] = motion.gradient[d][d];
  update_half_sizes(points, b, stretching, dt, state.grid.cell_size());
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
