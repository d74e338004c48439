// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The order of a step with implicit pressures.

#include <vadose/kernel/implicit_pressure.hpp>
#include <vadose/solver/scheme/explicit.hpp>

namespace vadose::scheme {

/// Step with implicit cell pressures: neither the compressibility of water nor the conductivity of
/// the soil limits it, only waves in the skeleton (in quasi-static periods not even these), motion, and the
/// change of saturation.
struct SemiImplicit {
  static constexpr const char* name = "semi-implicit";

  /// A step is at most this much longer than the last.
  static constexpr Real growth = 1.5;
  /// The same beyond the step of the waves: inertia that is added faster than damping takes the energy of waves
  /// away feeds them.
  static constexpr Real quasi_static_growth = 1.01;
  /// Knows SolverOptions::quasi_static.
  static constexpr bool knows_quasi_static = true;
  /// So many times a step may be halved.
  static constexpr int max_retries = 20;

  /// One step of at most dt_limit [s]; returns the stable step that was used.
  template <class M>
  static kernel::StableStep step(State<M>& state, Real dt_limit) {
    if constexpr (!has_liquid<M>) {
      return Explicit::step(state, dt_limit);
    } else {
      state.system.report = {};
      kernel::find_pressures(state);  // (g) of the last step: water in the cells, p, S
      if constexpr (has_skeleton<M>) kernel::find_conductivities(state);
      kernel::StableStep stable = kernel::implicit_step(state);
      stable.take(dt_limit, StepLimit::end);
      begin(state, stable.dt);
      kernel::map_liquid(state);  // (a) liquid to nodes
      if constexpr (is_deformable<M>) {
        kernel::map_solid(state);  // (a) solid to nodes
        kernel::map_loads(state);  //     traction
        kernel::unload_carried_nodes(state);
      }
      while (!predict_and_solve(state, stable)) begin(state, stable.dt);
      if (state.sums[0].failed) return stable;
      book(state);
      if constexpr (is_deformable<M>) {
        kernel::move_carried_nodes(state);
        kernel::move_loads(state);
        kernel::update_solid(state);  // (f), (h): positions, stress, volume
      }
      kernel::update_liquid(state);  // (f), (g): positions, water, p
      return stable;
    }
  }

 private:
  template <class M>
  static void begin(State<M>& state, Real dt) {
    kernel::begin_step(state, dt);
    kernel::choose_skeleton(state);
  }

  /// Velocities with the old pressures, then pressures at the end of the step and what follows from
  /// them. False: to be repeated with the smaller step that `stable` then holds. No point is touched.
  template <class M>
  static bool predict_and_solve(State<M>& state, kernel::StableStep& stable) {
    const Vec<State<M>::dim> open_impulse = state.open_impulse;
    if constexpr (has_skeleton<M>) kernel::connect_cells(state);  // (c) k and S between cells
    if (state.frozen) {
      kernel::advance_nodes(state);
      kernel::find_rates(state);
      return true;
    }
    state.system.response.resize(state.grid.size());
    kernel::advance_nodes<true>(state);  // (b), (d), (e): forces, drag, walls, velocities
    if (is_out_of_balance(state)) {
      stable = {kernel::worthwhile_step(state, 0.3 * stable.dt), StepLimit::inertia};
      ++state.system.report.retries;
      state.open_impulse = open_impulse;
      return false;
    }
    const bool solved = kernel::solve_pressures(state);
    if (solved && control_step(state, stable)) {
      kernel::count_open_impulse(state);
      kernel::accept_pressures(state);
      return true;
    }
    kernel::restore_pressures(state);
    state.open_impulse = open_impulse;
    SolveReport& report = state.system.report;
    if (++report.retries > max_retries) {
      state.sums[0].failed = true;
      state.trouble.criterion = "pressures of the cells found";
      state.trouble.phase = "liquid";
      state.trouble.value = report.residual;
      return true;
    }
    if (!solved) stable = {0.5 * stable.dt, StepLimit::retry};
    return false;
  }

  /// Whether forces out of balance want a much shorter step where the skeleton is solved for.
  template <class M>
  static bool is_out_of_balance(State<M>& state) {
    auto& report = state.system.report;
    if (!report.skeleton) return false;
    kernel::find_unbalanced_share(state);
    return kernel::inertia_factor(state, report.inertia_share) < 0.3;
  }

  /// Control of the error by the change of saturation, and by inertia in quasi-static steps: the step that
  /// may come next, and whether this one stands.
  template <class M>
  static bool control_step(State<M>& state, kernel::StableStep& stable) {
    auto& system = state.system;
    const Real change = kernel::saturation_change(state);
    system.report.saturation_change = change;
    const Real target = state.options.saturation_step;
    Real factor = change > 0 ? min(growth, 0.9 * target / change) : growth;
    StepLimit reason = StepLimit::accuracy;
    if (!system.report.skeleton) kernel::find_inertia_share(state);
    kernel::remember_inertia(state);
    const bool jolts = system.report.inertia > 1 &&
                       kernel::inertia_factor(state, system.report.inertia_share) < 0.3;
    if (change > 2 * target || jolts) {
      stable = {(jolts ? 0.3 : max(0.1, factor)) * stable.dt,
                jolts ? StepLimit::inertia : StepLimit::accuracy};
      return false;
    }
    if (state.options.quasi_static.on) {
      const Real still = kernel::inertia_factor(state, system.inertia_share);
      // Inertia lets no step stay below that of the waves; in columns, whose water holds the soil beyond it,
      // it lets none become shorter.
      const Real back = State<M>::dim > 1 ? growth : 1;
      const Real most = system.report.skeleton ? growth : quasi_static_growth;
      const Real calm = max(max(0.5, min(still, most)), min(back, system.wave_dt / stable.dt));
      if (calm < factor) {
        factor = calm;
        reason = StepLimit::inertia;
      }
    }
    // A step of waves goes towards a longer one that is worth its price.
    const bool waits = stable.limit == StepLimit::skeleton &&
                       kernel::worthwhile_step(state, system.next_dt) < system.next_dt;
    const Real next = factor * (waits ? system.next_dt : stable.dt);
    const bool cut = stable.limit == StepLimit::user || stable.limit == StepLimit::end;
    if (cut && next < system.next_dt) return true;
    system.next_dt = next;
    system.next_limit = reason;
    return true;
  }

  /// Water that passes between cells, films and boundaries.
  template <class M>
  static void book(State<M>& state) {
    if constexpr (has_skeleton<M>)
      if (!state.frozen) kernel::book_fluxes(state);
  }
};

}  // namespace vadose::scheme
