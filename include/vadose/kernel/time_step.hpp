// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Step 10: the largest stable step from the state, and what limits it.

#include <vadose/kernel/closing_pores.hpp>
#include <vadose/kernel/held_column.hpp>

namespace vadose {

namespace kernel {

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
  constexpr char free_water = 1,
                 closes = 2;  // of a block: it has some; what its stiffest cell does
  nodes.sought.assign(slots, 0);
  const Real speed = highest_speed(state);
  parallel_for(slots, state.options.threads, [&](std::size_t s, int) {
    Real most = 0;
    bool has_free = false, is_closing = false;
    for (std::size_t i = s * cells; i < (s + 1) * cells; ++i) {
      if (nodes.dof[i] != static_cast<std::int32_t>(i)) continue;
      const auto& c = nodes.cell[i];
      if (c.kind == CellKind::free) {
        has_free = true;
      } else if constexpr (has_skeleton<M>) {
        const Real coming = c.saturation > 0 ? coming_frequency2(state, c, speed) : 0;
        if (!(coming > most)) continue;
        most = coming;
        is_closing = coming > cell_frequency2(state, c, c.modulus, c.saturation);
      }
    }
    nodes.frequency2[s] = most;
    nodes.sought[s] = static_cast<char>((has_free ? free_water : 0) | (is_closing ? closes : 0));
  });
  Real most = 0;
  bool has_free = false, is_closing = false;
  for (std::size_t s = 0; s < slots; ++s) {
    has_free = has_free || (nodes.sought[s] & free_water);
    if (!(nodes.frequency2[s] > most)) continue;
    most = nodes.frequency2[s];
    is_closing = nodes.sought[s] & closes;
  }
  StableStep step;
  if (most > 0)
    step.take(2 / std::sqrt(most), is_closing ? StepLimit::closing : StepLimit::two_phase);
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

/// A solution for the motion of the skeleton costs some steps of its waves and has to save as many: in the
/// plane 2 to 5, in space 4 with 252 nodes and 20 with 1452 were measured.
template <int Dim>
inline constexpr Real worthwhile = Dim < 3 ? 3 : 20;

/// A step, or that of waves in the skeleton where a solution for its motion would not be worth its price.
template <class M>
Real worthwhile_step(const State<M>& state, Real dt) noexcept {
  const auto& choice = state.options.quasi_static;
  const Real wave = state.system.wave_dt;
  const bool solves = choice.on && choice.skeleton == SlowSkeleton::implicit;
  return solves && dt > wave && dt < worthwhile<State<M>::dim> * wave ? wave : dt;
}

/// Largest step with implicit pressures: neither the compression of water nor the drag counts. Where
/// nothing limits the first step, in soil that does not move, it is the explicit one; the control of the
/// error lets those that follow grow. A quasi-static step is not bound by waves in the skeleton: see
/// choose_skeleton.
template <class M>
StableStep implicit_step(State<M>& state) {
  StableStep step = skeleton_step(state);
  // In columns the water of a cell may hold its skeleton (see held_step), so that points count only
  // outside such cells. In more dimensions waves of shear, which water does not hold, bound the step of
  // every point.
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
  if (goes_on) {
    const Real next = worthwhile_step(state, state.system.next_dt);
    const bool shortened = next < state.system.next_dt;
    step.take(next, shortened ? StepLimit::skeleton : state.system.next_limit);
  }
  if (step.limit == StepLimit::none)
    step.take(state.options.courant * wet_step(state).dt, StepLimit::accuracy);
  return step;
}

}  // namespace kernel
}  // namespace vadose
