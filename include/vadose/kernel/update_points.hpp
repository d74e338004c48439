// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Steps 7 and 8 on the points, [Zhan] 3.4 (f) to (h): velocities, positions, strains, stresses,
/// volumes, exchanged water, pressures.

#include <vadose/kernel/exchange.hpp>

namespace vadose::kernel {

/// Spin and rate of deformation from a velocity gradient l[a][b] = dv_a/dx_b.
template <int N, int Dim>
VADOSE_INLINE SymTensor<Lanes, N> rate_of_deformation(const Lanes (&l)[Dim][Dim],
                                                      const Lanes& hoop) noexcept {
  SymTensor<Lanes, N> rate;
  for (int i = 0; i < N; ++i) rate[i] = Lanes(0.0);
  for (int d = 0; d < Dim; ++d) rate[d] = l[d][d];
  if constexpr (Dim == 2) {
    rate[2] = hoop;
    rate[3] = Lanes(0.5) * (l[0][1] + l[1][0]);
  }
  if constexpr (Dim == 3) {
    rate[3] = Lanes(0.5) * (l[0][1] + l[1][0]);
    rate[4] = Lanes(0.5) * (l[1][2] + l[2][1]);
    rate[5] = Lanes(0.5) * (l[0][2] + l[2][0]);
  }
  return rate;
}

/// Jaumann rotation of a stress over a step: sigma += dt (W sigma - sigma W), W the spin. The
/// rotation is done exactly about the axis of W (to second order in 3D by two half steps), so that
/// invariants do not drift.
template <int N, int Dim>
VADOSE_INLINE void rotate_stress(const Lanes (&l)[Dim][Dim], Real dt,
                                 SymTensor<Lanes, N>& s) noexcept {
  if constexpr (Dim == 2) {
    // Cayley transform: cos and sin of the step's angle to third order, exactly orthogonal.
    const Lanes half = Lanes(0.25 * dt) * (l[1][0] - l[0][1]);
    const Lanes over = Lanes(1.0) / (Lanes(1.0) + half * half);
    const Lanes c = (Lanes(1.0) - half * half) * over;
    const Lanes q = Lanes(2.0) * half * over;
    const Lanes xx = s[0], yy = s[1], xy = s[3];
    s[0] = c * c * xx - Lanes(2.0) * c * q * xy + q * q * yy;
    s[1] = q * q * xx + Lanes(2.0) * c * q * xy + c * c * yy;
    s[3] = c * q * (xx - yy) + (c * c - q * q) * xy;
  }
  if constexpr (Dim == 3) {
    // R = (I - W dt/2)^-1 (I + W dt/2) = I + 2 (A + A^2) / (1 + a.a), A = W dt/2 = [a]x.
    const Lanes ax = Lanes(0.25 * dt) * (l[2][1] - l[1][2]);
    const Lanes ay = Lanes(0.25 * dt) * (l[0][2] - l[2][0]);
    const Lanes az = Lanes(0.25 * dt) * (l[1][0] - l[0][1]);
    const Lanes f = Lanes(2.0) / (Lanes(1.0) + ax * ax + ay * ay + az * az);
    const Lanes one(1.0);
    const Lanes r[3][3] = {{one - f * (ay * ay + az * az), f * (ax * ay - az), f * (ax * az + ay)},
                           {f * (ax * ay + az), one - f * (ax * ax + az * az), f * (ay * az - ax)},
                           {f * (ax * az - ay), f * (ay * az + ax), one - f * (ax * ax + ay * ay)}};
    const Lanes m[3][3] = {{s[0], s[3], s[5]}, {s[3], s[1], s[4]}, {s[5], s[4], s[2]}};
    Lanes rm[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        rm[i][j] = r[i][0] * m[0][j] + r[i][1] * m[1][j] + r[i][2] * m[2][j];
    const auto entry = [&](int i, int j) {
      return rm[i][0] * r[j][0] + rm[i][1] * r[j][1] + rm[i][2] * r[j][2];
    };
    s[0] = entry(0, 0);
    s[1] = entry(1, 1);
    s[2] = entry(2, 2);
    s[3] = entry(0, 1);
    s[4] = entry(1, 2);
    s[5] = entry(0, 2);
  }
}

/// What nodes hand back to eight points.
template <int Dim>
struct PointMotion {
  Lanes velocity[Dim];       ///< interpolated new velocity
  Lanes increment[Dim];      ///< interpolated change of velocity
  Lanes gradient[Dim][Dim];  ///< dv_a/dx_b
};

/// Interpolates velocity, its change and gradient.
template <bool Slopes, class Shape, int Dim>
VADOSE_INLINE void interpolate(const Stencil<Shape, Dim>& stencil, const Record* tile,
                               PointMotion<Dim>& motion) noexcept {
  Gather<Slopes, Shape, Dim> gather;
  gather.sum_vectors(stencil, tile);
  for (int a = 0; a < Dim; ++a) {
    motion.velocity[a] = gather.value[lane::velocity + a];
    motion.increment[a] = gather.value[lane::increment + a];
    if constexpr (Slopes)
      for (int b = 0; b < Dim; ++b) motion.gradient[a][b] = gather.slope[b][lane::velocity + a];
  }
}

/// First moments of the nodal velocity, B = sum w v (x_I - x_p)^T (APIC). For tensor-product
/// weights it needs one more pass over the nodes; done per point.
template <class Shape, int Dim>
VADOSE_INLINE void velocity_moment(const Stencil<Shape, Dim>& s, const TileFrame<Dim>& frame,
                                   Real h, const Lanes (&x)[Dim], const Record* tile,
                                   Lanes (&moment)[Dim][Dim]) noexcept {
  for (int l = 0; l < lane_count; ++l) {
    Real sum[Dim][Dim] = {};
    for_cube<Dim>(0, Shape::support, [&](const Index<Dim>& i) {
      const double w = s.product(i, l);
      int at = s.offset[l];
      for (int d = 0; d < Dim; ++d) at += i[d] * BlockGrid<Dim>::tile_stride(d);
      for (int b = 0; b < Dim; ++b) {
        const Real r = frame.first[b] + (s.first[b][l] + i[b]) * h - x[b][l];
        for (int a = 0; a < Dim; ++a) sum[a][b] += w * tile[at][lane::velocity + a] * r;
      }
    });
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) moment[a][b].set(l, sum[a][b]);
  }
}

/// New velocity of a batch by the model's transfer.
template <class M, class Shape, class Points>
VADOSE_INLINE void update_velocity(const State<M>& state, Points& points, std::size_t b,
                                   const Stencil<Shape, State<M>::dim>& stencil,
                                   const TileFrame<State<M>::dim>& frame,
                                   const Lanes (&x)[State<M>::dim], const Record* tile,
                                   const PointMotion<State<M>::dim>& motion) noexcept {
  constexpr int dim = State<M>::dim;
  if constexpr (M::Transfer::blends) {
    const Lanes keep(state.flip_share);
    for (int d = 0; d < dim; ++d) {
      const Lanes flip = points.load(field::velocity, b, d) + motion.increment[d];
      points.store(field::velocity, b, d, keep * flip + (Lanes(1.0) - keep) * motion.velocity[d]);
    }
  } else {
    for (int d = 0; d < dim; ++d) points.store(field::velocity, b, d, motion.velocity[d]);
    if constexpr (M::Transfer::stores_gradient) {
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          points.store(field::affine, b, i * dim + j, motion.gradient[i][j]);
    } else {
      Lanes moment[dim][dim];
      velocity_moment(stencil, frame, state.grid.cell_size(), x, tile, moment);
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) points.store(field::affine, b, i * dim + j, moment[i][j]);
    }
  }
}

/// Stretches GIMP half sizes along the axes by rates dv_d/dx_d, at most to half a cell (the three-node
/// stencil).
template <class Points, int Dim>
VADOSE_INLINE void update_half_sizes(Points& points, std::size_t b, const Lanes (&stretching)[Dim],
                                     Real dt, Real h) noexcept {
  if constexpr (Points::fields::template has<field::HalfSize>) {
    for (int d = 0; d < Dim; ++d) {
      const Lanes half = points.load(field::half_size, b, d) * exp(Lanes(dt) * stretching[d]);
      points.store(field::half_size, b, d, min(max(half, Lanes(1e-3 * h)), Lanes(0.5 * h)));
    }
  }
}

/// Records the first thing found wrong with a lane of a batch.
template <class M, class Points>
void report_trouble(State<M>& state, const Points& points, std::size_t b, const LaneMask& bad,
                    const char* criterion, const char* phase, const Lanes& value) noexcept {
  for (int l = 0; l < lane_count; ++l) {
    const double id = points.at(field::id, b)[l];
    if (!bad[l] || id < 0) continue;
#ifdef _OPENMP
#pragma omp critical(vadose_trouble)
#endif
    {
      const auto number = static_cast<std::int64_t>(id);
      if (!state.trouble.criterion || number < state.trouble.id) {
        state.trouble = Trouble{criterion, phase, value[l], number, {}};
        for (int d = 0; d < State<M>::dim; ++d)
          state.trouble.position[static_cast<std::size_t>(d)] = points.at(field::position, b, d)[l];
      }
    }
  }
}

/// DEVIATION: [Zhan] Eq. (25) prints v_k; the new velocity is taken, since forward Euler is unstable
/// for undamped waves.
/// Moves a batch by dt v and checks it: finite, |v| dt below a cell, inside the box.
template <class M, class Points>
VADOSE_INLINE void move(State<M>& state, Points& points, std::size_t b, const char* phase,
                        const Lanes (&velocity)[State<M>::dim], StepSums& sums) noexcept {
  constexpr int dim = State<M>::dim;
  const Real h = state.grid.cell_size();
  Lanes speed2(0.0);
  LaneMask outside = Lanes(1.0) < Lanes(0.0);
  for (int d = 0; d < dim; ++d) {
    const Lanes x = points.load(field::position, b, d) + Lanes(state.dt) * velocity[d];
    points.store(field::position, b, d, x);
    speed2 += velocity[d] * velocity[d];
    const Real low = state.grid.origin()[d];
    const Real high = low + state.grid.cells()[d] * h;
    outside = outside | !(x >= Lanes(low)) | !(x <= Lanes(high));
  }
  const Real limit = h / state.dt;
  const LaneMask fast = !(speed2 < Lanes(limit * limit));  // also true for NaN
  const LaneMask alive = points.load(field::id, b) >= Lanes(0.0);
  const bool may_escape = state.options.escaped != Escape::error;
  if (any(outside & alive)) sums.escaped = true;
  if (any((may_escape ? fast : fast | outside) & alive)) {
    sums.failed = true;
    report_trouble(state, points, b, fast & alive, "|v| dt < cell size", phase, sqrt(speed2));
    report_trouble(state, points, b, outside & alive, "points inside the box", phase,
                   points.load(field::position, b, 0));
  }
  sums.max_speed2 = max(sums.max_speed2, max_lane(select(alive & !fast, speed2, Lanes(0.0))));
}

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
  [[maybe_unused]] CellFinder<dim> cells;
  if constexpr (has_liquid<M>) cells.find(frame, x);
  if constexpr (RateByCell) {
    const Lanes own = volume_rate;
    volume_rate = cell_rates(state, cells, entries, own);
    rate.add_isotropic((volume_rate - own) * Lanes(1.0 / 3.0));
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
  const auto& soil = state.soils[static_cast<std::size_t>(points.group(b))];
  if (law::apply(soil.law, step, stress, numbers) != Status::ok) {
    sums.failed = true;
    report_trouble(state, points, b, Lanes(0.0) < Lanes(1.0), "admissible stress", "solid",
                   stress.mean());
  }
  for (int i = 0; i < n; ++i) points.store(field::bishop_stress, b, i, stress[i]);
  if constexpr (state_size > 0)
    for (int i = 0; i < state_size; ++i) points.store(field::law_state, b, i, numbers[i]);

  const Lanes grains = points.load(field::mass, b) * Lanes(1 / soil.material.solid_density);
  Lanes volume = points.load(field::volume, b);
  if constexpr (has_liquid<M>)
    volume *=
        volume_stretch(state, cells, entries, Lanes(1.0) - grains / max(volume, Lanes(1e-300)),
                       Lanes(dt) * volume_rate);
  else
    volume *= exp(Lanes(dt) * volume_rate);
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

/// Part of the difference in filling that points of a saturated cell even out per step [-].
inline constexpr Real evening = 0.05;
/// Differences below this part of the filling are round-off and stay: evened out they do not sum to 0,
/// and at rest the same is lost in every step.
inline constexpr Real evenness = 1e-14;

/// Share of the gain of a soil cell that each of its points takes: outflow in proportion to its mass,
/// inflow to its pores in saturated cells, else to the room it has.
template <class M>
void share_gain(const State<M>& state, const Cell<State<M>::dim>& cell, Record& share) noexcept {
  const Real density = state.water.density;
  if (cell.gain < 0) {
    share[lane::by_mass] = cell.gain / cell.water;
  } else if (cell.pressure >= 0) {
    share[lane::by_pores] = cell.gain / cell.pore_volume;
  } else {
    // Room of the whole cell can be too small: then by pores.
    const Real room = density * cell.pore_volume - cell.water;
    const bool fits = is_unsaturated<M> && room > cell.gain;
    share[lane::by_pores] = fits ? density * (cell.gain / room) : cell.gain / cell.pore_volume;
    share[lane::by_mass] = fits ? -(cell.gain / room) : 0;
  }
}

/// Water that eight soil cells of one material would have to give off, over the pore volume squeezed out of
/// them, to keep their pressure: S, and what their change of porosity does to the retention curve,
/// n (1 - n) dS/dn [-].
template <class M>
Lanes squeeze_factors(const State<M>& state, const CellBatch<M>& batch) {
  using C = Cell<State<M>::dim>;
  const Lanes zero(0.0), one(1.0);
  Lanes squeeze = batch.numbers([](const C& c) { return c.saturation; });
  if constexpr (is_unsaturated<M> && is_deformable<M>) {
    const Lanes p = batch.numbers([](const C& c) { return c.pressure; });
    if (!any(p < zero)) return squeeze;
    const Lanes n = max(batch.numbers([](const C& c) { return c.porosity; }), Lanes(1e-6));
    const Lanes slope = swrc::porosity_slope<Lanes>(state.soils[batch.material].material.retention,
                                                    max(-p, zero), n);
    squeeze += select(p < zero, n * (one - n) * slope, zero);
  }
  return squeeze;
}

/// Change of the pressure of a soil cell in the step as its start foretells it [Pa]: by gained water, by
/// squeezed pores and by what their change of porosity does to the retention curve. It starts the search
/// for the pressure, which then needs one pass over the points instead of two.
template <class M>
Real predicted_change(const State<M>& state, const Cell<State<M>::dim>& cell,
                      Real squeeze) noexcept {
  const Real squeezed =
      cell.skeleton_rate * state.dt * squeeze * cell.pore_volume / max(cell.porosity, 1e-6);
  return (cell.gain / state.water.density - squeezed) / max(cell.storage, 1e-30);
}

/// Predicts the changes of the pressures of the soil cells of a block that no implicit solution gave.
template <class M>
void predict_changes(State<M>& state, std::size_t slot) {
  constexpr std::size_t cells = Block<State<M>::dim>::cells;
  auto& nodes = state.nodes;
  CellBatch<M> batch;
  const auto finish = [&] {
    if (batch.count == 0) return;
    const Lanes squeeze = squeeze_factors(state, batch);
    for (int l = 0; l < batch.count; ++l)
      batch.cell[l]->change = predicted_change(state, *batch.cell[l], squeeze[l]);
    batch.count = 0;
  };
  for (std::size_t i = slot * cells; i < (slot + 1) * cells; ++i) {
    auto& cell = nodes.cell[i];
    if (nodes.dof[i] != static_cast<std::int32_t>(i)) continue;
    if (cell.kind != CellKind::soil || cell.solved) continue;
    if (batch.count == lane_count || cell.material != batch.material) finish();
    batch.material = cell.material;
    batch.cell[batch.count++] = &cell;
  }
  finish();
}

/// What the pore water of a cell takes, and its pressure after the step as heads are kept.
template <class M>
Real find_share(const State<M>& state, const Cell<State<M>::dim>& cell, Record& share) noexcept {
  constexpr int dim = State<M>::dim;
  Real p = cell.pressure;
  if (cell.kind == CellKind::soil) {
    share_gain(state, cell, share);
    for (int d = 0; d < dim; ++d) share[lane::velocity_gain + d] = cell.momentum_gain[d];
    p += cell.change;
  } else if (cell.pore_gain > 0) {
    share[lane::by_pores] = cell.pore_gain / cell.soil_pores;
  } else if (cell.pore_gain < 0) {
    share[lane::by_mass] = cell.pore_gain / cell.soil_water;
  }
  for (int d = 0; d < dim; ++d) {
    share[lane::brought + d] = cell.mean_velocity[d];
    p -= state.water.density * state.gravity[d] * cell.centroid[d];
  }
  return p;
}

/// How near a point of free water is to the face to soil of its cell: 1 at the face, next to nothing from
/// half a cell on. (What soil takes leaves the points at its face, what it gives goes to them: spread over
/// the cell it would lift the water that rises out of the ground. With 0.02 for what is far, a point that is
/// still small gets next to nothing beside the full ones above it, and the swing of a U-tube is lost.)
template <int Dim>
Real nearness(const Cell<Dim>& cell, const Lanes (&x)[Dim], int l, Real over_cell_size) noexcept {
  constexpr Real far = 0.002;
  if (cell.ground_axis < 0) return 1;
  return max(far, 1 - 2 * std::fabs(x[cell.ground_axis][l] - cell.ground) * over_cell_size);
}

/// Weighs the free water of a cell by nearness. By all of it where it gives much: no point more than half.
template <int Dim>
void find_near_water(Cell<Dim>& cell, Real near_water) noexcept {
  cell.near_water = near_water;
  cell.is_fed = cell.gain > 0;
  if (cell.ground_axis >= 0 && -cell.gain < 0.5 * near_water) return;
  cell.ground_axis = -1;
  cell.near_water = cell.water;
}

/// Mean velocities of the water of every cell: of what it holds, and what the water of its submerged
/// pores that passes to free water brings.
template <class M>
void find_mean_velocities(State<M>& state) {
  constexpr int dim = State<M>::dim;
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<dim>& local, int slot, int) {
              if (state.nodes.dof[static_cast<std::size_t>(e)] != e) return;
              auto& cell = state.nodes.cell[static_cast<std::size_t>(e)];
              const Record sums = member_sums(CellView<M>(state, local, slot), state.nodes.content);
              const bool soil = cell.kind == CellKind::soil;
              const int own = soil ? lane::pore_momentum : lane::free_momentum;
              if (!soil) find_near_water(cell, sums[lane::near_mass]);
              for (int d = 0; d < dim; ++d) {
                cell.mean_velocity[d] = cell.water > 0 ? sums[own + d] / cell.water : 0;
                cell.momentum_gain[d] =
                    !soil && cell.pore_gain < 0
                        ? cell.pore_gain * (cell.mean_velocity[d] -
                                            sums[lane::pore_momentum + d] / cell.soil_water)
                        : 0;
              }
            });
}

/// What leaves a cell takes the velocity of its water along, the mean where it arrives.
template <class M>
void find_momentum_gain(const State<M>& state, const CellView<M>& view,
                        Cell<State<M>::dim>& cell) noexcept {
  constexpr int dim = State<M>::dim;
  for_collected_inflows(state, view, [&](const Inflow<dim>& f) {
    const Real dm = f.from && f.flux > 0 ? passed_water(state, cell, f) : 0;
    if (dm > 0)
      for (int d = 0; d < dim; ++d)
        cell.momentum_gain[d] += dm * (f.from->mean_velocity[d] - cell.mean_velocity[d]);
  });
  const Real after = cell.water + cell.gain;
  for (Real& v : cell.momentum_gain) v = after > 0 ? v / after : 0;
}

/// What points need to know of every cell before its shares: momentum gained, change of pressure.
template <class M>
void find_changes(State<M>& state) {
  constexpr int dim = State<M>::dim;
  parallel_for(
      static_cast<std::size_t>(state.grid.slots()), state.options.threads, [&](std::size_t s, int) {
        const int slot = static_cast<int>(s);
        std::int32_t e = slot * Block<dim>::cells;
        for_cube<dim>(0, Block<dim>::edge, [&](const Index<dim>& local) {
          const auto i = static_cast<std::size_t>(e);
          if (state.nodes.dof[i] == e)
            find_momentum_gain(state, CellView<M>(state, local, slot), state.nodes.cell[i]);
          ++e;
        });
        predict_changes(state, s);
      });
}

/// The shares of all cells, as points read them.
template <class M>
void find_shares(State<M>& state) {
  constexpr std::size_t cells = Block<State<M>::dim>::cells;
  auto& nodes = state.nodes;
  parallel_for(static_cast<std::size_t>(state.grid.slots()), state.options.threads,
               [&](std::size_t s, int) {
                 for (std::size_t i = s * cells; i < (s + 1) * cells; ++i) {
                   const std::int32_t owner = nodes.dof[i];
                   nodes.content[i] = Record{};
                   nodes.head[i] = nodes.filling[i] = 0;
                   if (owner < 0) continue;
                   const auto& cell = nodes.cell[static_cast<std::size_t>(owner)];
                   nodes.head[i] = find_share(state, cell, nodes.content[i]);
                   if (cell.kind == CellKind::soil && cell.pressure >= 0)
                     nodes.filling[i] = cell.water / cell.pore_volume;
                 }
               });
}

/// Full pores: every point of a saturated cell becomes as full as the others, or a point that crosses to
/// another cell would bring its own pressure along (1 % of filling is 1 % of K). Little by little:
/// shares do not sum to 1 exactly, and done in one step that error would repeat.
VADOSE_INLINE Lanes evened_out(const Lanes& filling, const Lanes& pores,
                               const Lanes& mass) noexcept {
  const Lanes lacks = filling * pores - mass;
  const LaneMask counts = (filling > Lanes(0.0)) & (abs(lacks) > Lanes(evenness) * mass);
  return select(counts, Lanes(evening) * lacks, Lanes(0.0));
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
  for (int l = 0; l < lane_count; ++l)
    share[l] =
        Lanes::load(state.nodes.content[static_cast<std::size_t>(entries[cells.index[l]])].value);
  transpose(share);
  const Lanes mass = points.load(field::mass, b);
  const Lanes volume = points.load(field::volume, b);
  const Lanes filling = lanes_of([&](int l) {
    return state.nodes.filling[static_cast<std::size_t>(entries[cells.index[l]])];
  });
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

  LiquidPlace(const State<M>& state, std::size_t b, int block, const TileFrame<dim>& frame)
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
    find_changes(state);
    find_shares(state);
    carry_liquid(state);
  } else {
    update_free_water(state);
  }
}

/// Carries the loads with the ground (hat functions).
template <class M>
void move_loads(State<M>& state) {
  constexpr int dim = State<M>::dim;
  for (auto& load : state.loads) {
    Vec<dim> v = Vec<dim>::Zero();
    for_hat_nodes(state.grid, load.position, [&](std::size_t node, Real w) {
      for (int d = 0; d < dim; ++d) v[d] += w * state.nodes.solid_out[node][d];
    });
    load.position += state.dt * v;
  }
}

}  // namespace vadose::kernel
