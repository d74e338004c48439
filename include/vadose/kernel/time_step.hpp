// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Step 10: the largest stable step from the state, and what limits it.

#include <vadose/kernel/pressure.hpp>

namespace vadose {

namespace kernel {

/// Highest frequency squared of soil with pore water, drag taken implicitly [1/s2]:
/// omega^2 = (2/h^2) [tr + sqrt(tr^2 - 4 det)], K* = S/(S/K + S_p),
/// tr = K*/rho_l + [E_c + S (1-n)^2 K*/n] / ((1-n) rho_s), det = K* E_c / ((1-n) rho_s rho_l).
/// E_c [Pa], K* [Pa] effective_modulus, n, S [-], densities [kg/m3], h [m].
inline Real two_phase_frequency2(Real p_wave_modulus, Real effective_modulus, Real porosity,
                                 Real saturation, Real solid_density, Real liquid_density,
                                 Real cell_size) noexcept {
  const Real solid = (1 - porosity) * solid_density;
  const Real tr = effective_modulus / liquid_density +
                  (p_wave_modulus +
                   saturation * (1 - porosity) * (1 - porosity) * effective_modulus / porosity) /
                      solid;
  const Real det = effective_modulus * p_wave_modulus / (solid * liquid_density);
  return 2 / (cell_size * cell_size) * (tr + std::sqrt(max(0.0, tr * tr - 4 * det)));
}

/// The same of a rigid skeleton: only the water moves.
inline Real seepage_frequency2(Real effective_modulus, Real liquid_density,
                               Real cell_size) noexcept {
  return 4 * effective_modulus / (liquid_density * cell_size * cell_size);
}

/// A stable step and its reason.
struct StableStep {
  Real dt = 1e30;                     ///< [s]
  StepLimit limit = StepLimit::none;  ///< why not more

  /// Takes another step if it is shorter.
  void take(Real other, StepLimit reason) noexcept {
    if (other < dt) {
      dt = other;
      limit = reason;
    }
  }
};

/// Part of 2/omega that a cell cut by the ground surface allows: its nodes carry less mass than the
/// formula assumes. Measured: 200 steps from noise on a saturated block at K = 2.2 GPa in 80
/// positions on the grid do not grow at half of this.
inline constexpr Real cut_cell_step = 0.55;

/// Part of 2/omega that a cell allows [-].
template <int Dim>
Real step_share(const Cell<Dim>& c) noexcept {
  return c.at_air && (c.members > 1 || c.raw_fill < 0.95) ? cut_cell_step : 1;
}

/// Highest frequency squared of a soil cell of effective modulus K* [Pa] and saturation S [-], over the
/// square of the part of 2/omega that it allows.
template <class M>
Real cell_frequency2(const State<M>& state, const Cell<State<M>::dim>& c, Real modulus,
                     Real saturation) noexcept {
  const Real h = state.grid.cell_size();
  const Real rho = state.water.density;
  const auto& soil = state.soils[c.material];
  const Real w2 = is_rigid<M>
                      ? seepage_frequency2(modulus, rho, h)
                      : two_phase_frequency2(soil.p_wave_modulus, modulus, c.porosity, saturation,
                                             soil.material.solid_density, rho, h);
  const Real share = step_share(c);
  return w2 / (share * share);
}

/// Part of the time until the air-filled pores of a cell have closed that one step may take [-].
inline constexpr Real closing_share = 0.5;

/// Highest frequency squared that a cell will have in a step: where little air is left, K* leaps to that of
/// water within it. `speed` bounds that of all points [m/s].
template <class M>
Real coming_frequency2(const State<M>& state, const Cell<State<M>::dim>& c, Real speed) noexcept {
  const Real now = cell_frequency2(state, c, c.modulus, c.saturation);
  if constexpr (is_unsaturated<M>) {
    const Real air = max(0.0, c.pore_volume - c.content);
    const Real bulk = c.pore_volume / c.porosity;
    const Real known = is_finite(c.closing)
                           ? c.closing
                           : 2 * State<M>::dim * speed / state.grid.cell_size() * bulk;
    // A step of closing_share air / closing has this 2/omega.
    const Real coming = 2 * max(0.0, known) / closing_share;
    if (coming * coming <= now * air * air) return now;
    const Real full = cell_frequency2(state, c, state.water.bulk_modulus, 1);
    return coming * coming < full * air * air ? coming * coming / (air * air) : max(now, full);
  } else {
    return now;
  }
}

/// Highest speed of points in the last step [m/s].
template <class M>
Real highest_speed(const State<M>& state) noexcept {
  Real speed2 = 0;
  for (const StepSums& s : state.sums) speed2 = max(speed2, s.max_speed2);
  return std::sqrt(speed2);
}

/// Largest step of the water and the soil it fills, 2/omega, over all cells.
template <class M>
StableStep wet_step(State<M>& state) {
  constexpr std::size_t cells = Block<State<M>::dim>::cells;
  auto& nodes = state.nodes;
  const auto slots = static_cast<std::size_t>(state.grid.slots());
  nodes.frequency2.assign(slots, 0);
  nodes.sought.assign(slots, 0);  // whether there is free water
  const Real speed = highest_speed(state);
  parallel_for(slots, state.options.threads, [&](std::size_t s, int) {
    Real most = 0;
    for (std::size_t i = s * cells; i < (s + 1) * cells; ++i) {
      if (nodes.dof[i] != static_cast<std::int32_t>(i)) continue;
      const auto& c = nodes.cell[i];
      if (c.kind == CellKind::free) {
        nodes.sought[s] = 1;
      } else if constexpr (has_skeleton<M>) {
        if (c.saturation > 0) most = max(most, coming_frequency2(state, c, speed));
      }
    }
    nodes.frequency2[s] = most;
  });
  Real most = 0;
  bool has_free = false;
  for (std::size_t s = 0; s < slots; ++s) {
    most = max(most, nodes.frequency2[s]);
    has_free = has_free || nodes.sought[s];
  }
  StableStep step;
  if (most > 0) step.take(2 / std::sqrt(most), StepLimit::two_phase);
  if (has_free) {
    const Real h = state.grid.cell_size();
    step.take(2 / std::sqrt(4 * state.water.bulk_modulus / (state.water.density * h * h)),
              StepLimit::water);
  }
  return step;
}

/// Time factors of loads and prescribed motion at the present time: each is called once per step.
template <class M>
void find_factors(State<M>& state) {
  state.factor_values.resize(state.factors.size());
  for (std::size_t i = 0; i < state.factors.size(); ++i)
    state.factor_values[i] = state.factors[i] ? state.factors[i](state.time) : 1;
}

/// Takes a step into work: its length and what follows from it for all points.
template <class M>
void begin_step(State<M>& state, Real dt) {
  state.dt = dt;
  if constexpr (M::Transfer::blends) state.flip_share = std::exp(-state.transfer.pic_rate * dt);
  for (StepSums& s : state.sums) s = StepSums{};
  find_factors(state);
}

/// Motion of the points, and what the user allows.
template <class M>
void take_motion_limits(const State<M>& state, StableStep& step) {
  const Real speed = highest_speed(state);
  if (speed > 0)
    step.take(state.options.displacement_cap * state.grid.cell_size() / speed, StepLimit::motion);
  step.take(state.options.dt_max, StepLimit::user);
}

/// Waves in the dry skeleton, the factor C, and motion: the end of every search for a step.
template <class M>
void take_common_limits(const State<M>& state, StableStep& step,
                        Real StepSums::*wave = &StepSums::max_wave2) {
  const Real h = state.grid.cell_size();
  Real wave2 = 0;
  for (const StepSums& s : state.sums) wave2 = max(wave2, s.*wave);
  if (wave2 > 0) step.take(h / std::sqrt(wave2), StepLimit::skeleton);
  step.dt *= state.options.courant;
  take_motion_limits(state, step);
}

/// Largest stable step of the present state, before the factor C, and motion limits after it.
template <class M>
StableStep stable_step(State<M>& state) {
  StableStep step;
  if constexpr (has_liquid<M>) step = wet_step(state);
  take_common_limits(state, step);
  return step;
}

/// Part of the time in which a cell consolidates, gamma h^2 / (k E_c), that a step may take [-].
inline constexpr Real drainage_share = 0.05;

/// Step of a cell of a column that its pore water holds; 0 if it does not. In one dimension all motion
/// changes volume: water that cannot flow away within the step resists it by S K* / n, implicitly, in
/// series with its drainage. Where that is more than E_c, waves in the skeleton do not grow; with a margin
/// 1 / (n / (S (K* + p)) + 4 k dt / (gamma h^2)) >= 2 E_c: S p, the stress it takes, grows by
/// S + p dS/dp.
template <class M>
Real held_step(const State<M>& state, const Cell<State<M>::dim>& c) noexcept {
  const auto& soil = state.soils[c.material];
  const Real h = state.grid.cell_size(), stiffness = soil.p_wave_modulus;
  if (!(c.saturation > 0)) return 0;
  const Real held = c.saturation * (c.modulus + min(0.0, c.pressure)) / c.porosity;
  if (!(held > 2 * stiffness)) return 0;
  const Real room = 0.5 / stiffness - 1 / held;
  if (!(c.conductivity > 0)) return 1e30;
  const Real drainage = soil.material.unit_weight * h * h / c.conductivity;
  const Real near = c.at_air ? 0.25 : 1;  // an open surface is nearer than the next cell
  return near * min(0.25 * room * drainage, drainage_share * drainage / stiffness);
}

/// Largest step of the skeleton alone, 2/omega = h / sqrt(E_c / ((1-n) rho_s)), over all cells; in a
/// column longer where the pore water holds it.
template <class M>
StableStep skeleton_step(const State<M>& state) {
  const Real h = state.grid.cell_size();
  StableStep step;
  if constexpr (is_deformable<M>) {
    for (std::size_t i = 0; i + Block<State<M>::dim>::cells < state.nodes.cell.size(); ++i) {
      const auto& c = state.nodes.cell[i];
      if (state.nodes.dof[i] != static_cast<std::int32_t>(i) || c.kind != CellKind::soil) continue;
      const auto& soil = state.soils[c.material];
      const Real wave2 = soil.p_wave_modulus / ((1 - c.porosity) * soil.material.solid_density);
      const Real wave = step_share(c) * h / std::sqrt(wave2);
      const Real held = State<M>::dim == 1 && has_liquid<M> ? held_step(state, c) : 0;
      step.take(max(wave, held), held > wave ? StepLimit::drainage : StepLimit::skeleton);
    }
  }
  return step;
}

/// Step in which waves on free water cross a cell, h / sqrt(g depth), the depth from its pressure.
template <class M>
StableStep gravity_wave_step(const State<M>& state) {
  StableStep step;
  if constexpr (State<M>::dim > 1) {
    Real deepest = 0;
    for (std::size_t i = 0; i + Block<State<M>::dim>::cells < state.nodes.cell.size(); ++i) {
      const auto& c = state.nodes.cell[i];
      if (state.nodes.dof[i] == static_cast<std::int32_t>(i) && c.kind == CellKind::free)
        deepest = max(deepest, c.quad_pressure);
    }
    if (deepest > 0)
      step.take(state.grid.cell_size() / std::sqrt(deepest / state.water.density),
                StepLimit::gravity);
  }
  return step;
}

/// Largest step with implicit pressures: neither the compression of water nor the drag counts. Where
/// nothing limits the first step, in soil that does not move, it is the explicit one; the control of the
/// error lets those that follow grow. A quasi-static step is not bound by waves in the skeleton: see
/// raise_inertia.
template <class M>
StableStep implicit_step(State<M>& state) {
  StableStep step = skeleton_step(state);
  // In columns the water of a cell may hold its skeleton: see held_step.
  constexpr bool column = State<M>::dim == 1;
  take_common_limits(state, step, column ? &StepSums::max_dry_wave2 : &StepSums::max_wave2);
  state.system.wave_dt = step.dt;
  const bool goes_on = state.system.next_dt > 0 && !state.frozen;
  if (goes_on && state.options.quasi_static.on) {
    step = {};
    take_motion_limits(state, step);
  }
  const StableStep waves = gravity_wave_step(state);
  step.take(state.options.courant * waves.dt, waves.limit);
  if (goes_on) step.take(state.system.next_dt, state.system.next_limit);
  if (step.limit == StepLimit::none)
    step.take(state.options.courant * wet_step(state).dt, StepLimit::accuracy);
  return step;
}

}  // namespace kernel
}  // namespace vadose
