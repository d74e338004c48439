// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// What a run will cost, from a trial on a copy of it.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <vadose/kernel/pressure.hpp>
#include <vadose/kernel/time_step.hpp>

namespace vadose {

/// What a run will cost.
struct Estimate {
  std::size_t solid_points = 0;       ///< at the start
  std::size_t liquid_points = 0;      ///< at the start
  std::size_t blocks = 0;             ///< blocks of 64 cells that exist
  Real dt = 0;                        ///< mean step at the end of the trial [s]
  StepLimit limit = StepLimit::none;  ///< what limits it
  Real trend = 0;                     ///< the step goes with time to this power [-], <= 0
  Real shortest_dt = 0;               ///< step when everything is wet [s]; 0: no such bound
  std::int64_t steps = 0;             ///< to the end time
  Real seconds = 0;                   ///< wall time of these, without output
  /// Steps if after the trial each is as short as any can become: soil that water reaches is wet, ground that
  /// can slide is cut by the cells as it is worst. 0: not known.
  std::int64_t most_steps = 0;
  Real most_seconds = 0;  ///< wall time of these
  Real megabytes = 0;     ///< of points and grid

  /// A few lines for people.
  std::string text() const {
    char buffer[400];
    std::snprintf(buffer, sizeof buffer,
                  "points: %zu solid, %zu liquid; blocks of 64 cells: %zu; memory %.1f MB\n"
                  "step: %.3g s, limited by %s; %lld steps, about %.3g s of wall time\n",
                  solid_points, liquid_points, blocks, megabytes, dt, name(limit),
                  static_cast<long long>(steps), seconds);
    return buffer;
  }
};

namespace detail {

/// Moment of a trial.
struct TrialMark {
  Real wall = 0;  ///< since the start of the trial [s]
  Real time = 0;  ///< of the run [s]
  std::int64_t step = 0;
};

/// How the step goes on: dt(t) = level (t / origin)^power, power <= 0, never below a floor. Soil that
/// takes up water wets cell by cell, and each full cell costs step; when all are wet it ends.
struct StepTrend {
  Real level = 0, origin = 1, power = 0;

  /// Least squares in the logarithms over the last three quarters of the steps of a trial, in eight
  /// pieces. A power that is not twice its standard error is none.
  static StepTrend of(const std::vector<TrialMark>& marks) {
    constexpr int pieces = 8;
    const std::size_t steps = marks.size() - 1, first = steps / 4;
    const auto mean_step = [&](std::size_t from, std::size_t to) {
      return (marks[to].time - marks[from].time) / static_cast<Real>(to - from);
    };
    StepTrend trend{.level = mean_step(steps / 2, steps)};
    if (steps - first < 4 * pieces || !(marks[first].time > 0)) return trend;
    Real x[pieces], y[pieces], mean_x = 0, mean_y = 0;
    for (int i = 0; i < pieces; ++i) {
      const std::size_t from = first + (steps - first) * static_cast<std::size_t>(i) / pieces;
      const std::size_t to = first + (steps - first) * static_cast<std::size_t>(i + 1) / pieces;
      x[i] = std::log(0.5 * (marks[from].time + marks[to].time));
      y[i] = std::log(mean_step(from, to));
      mean_x += x[i] / pieces;
      mean_y += y[i] / pieces;
    }
    Real xx = 0, xy = 0, yy = 0;
    for (int i = 0; i < pieces; ++i) {
      xx += (x[i] - mean_x) * (x[i] - mean_x);
      xy += (x[i] - mean_x) * (y[i] - mean_y);
      yy += (y[i] - mean_y) * (y[i] - mean_y);
    }
    const Real power = xy / xx;
    const Real error = std::sqrt(std::max(0.0, yy - power * xy) / ((pieces - 2) * xx));
    if (!(power < -2 * error)) return trend;
    return {std::exp(mean_y), std::exp(mean_x), std::max(power, -2.0)};
  }

  /// Step at time t where none is shorter than `floor`.
  Real at(Real t, Real floor) const {
    return std::max(power == 0 ? level : level * std::pow(t / origin, power), floor);
  }

  /// Steps from time `from` to `to` where none is shorter than `floor`; real number.
  Real steps(Real from, Real to, Real floor) const {
    if (!(to > from) || !(level > 0)) return 0;
    if (power == 0) return (to - from) / std::max(level, floor);
    Real bend = to;  // where the floor is reached
    if (floor > 0) bend = std::clamp(origin * std::pow(floor / level, 1 / power), from, to);
    const auto integral = [&](Real t) { return origin * std::pow(t / origin, 1 - power); };
    return (integral(bend) - integral(from)) / (level * (1 - power)) +
           (bend < to ? (to - bend) / floor : 0);
  }
};

/// Whether the soil can yield, so that its surface may come to lie anywhere on the grid.
template <class M>
constexpr bool can_slide(const State<M>& /*state*/) {
  if constexpr (is_deformable<M>)
    return State<M>::dim > 1 && law::state_size<typename M::Skeleton> > 0;
  else
    return false;
}

/// Step of the explicit scheme in soil that has slid, as wet as it is now [s]: each cell may be cut by the
/// ground, and grains have come apart.
template <class M>
Real slid_step(const State<M>& state) {
  Real most = 0, wave2 = 0;
  if constexpr (is_deformable<M>)
    for (const auto& soil : state.soils)
      wave2 = std::max(wave2, soil.p_wave_modulus /
                                  ((1 - kernel::dispersed_porosity) * soil.material.solid_density));
  if constexpr (has_liquid<M> && has_skeleton<M>)
    for (std::size_t i = 0; i + Block<State<M>::dim>::cells < state.nodes.cell.size(); ++i) {
      const auto& c = state.nodes.cell[i];
      if (state.nodes.dof[i] != static_cast<std::int32_t>(i) || c.kind != CellKind::soil ||
          !(c.saturation > 0))
        continue;
      const Real share = kernel::step_share(c);
      most = std::max(most,
                      share * share * kernel::cell_frequency2(state, c, c.modulus, c.saturation));
    }
  Real dt = 1e30;
  if (wave2 > 0) dt = state.grid.cell_size() / std::sqrt(wave2);
  if (most > 0) dt = std::min(dt, kernel::cut_cell_step * 2 / std::sqrt(most));
  return state.options.courant * dt;
}

/// Step of the explicit scheme when all soil is saturated and water stands on it [s]; 0 in models
/// without water, which do not become wetter. `cut`: as short as the cells cut by the ground make it
/// now; without, those cells have drained.
template <class M>
Real shortest_step(const State<M>& state, bool cut = true) {
  if constexpr (!has_liquid<M>) {
    return 0;
  } else {
    const Real h = state.grid.cell_size(), rho = state.water.density,
               modulus = state.water.bulk_modulus;
    Real dt = 2 / std::sqrt(kernel::seepage_frequency2(modulus, rho, h));  // also of free water
    if constexpr (has_skeleton<M>) {
      Real share = 1;
      for (std::size_t i = 0; cut && i + Block<State<M>::dim>::cells < state.nodes.cell.size(); ++i)
        if (state.nodes.dof[i] == static_cast<std::int32_t>(i) &&
            state.nodes.cell[i].kind == CellKind::soil)
          share = std::min(share, kernel::step_share(state.nodes.cell[i]));
      for (const auto& soil : state.soils) {
        const Real w2 = is_rigid<M> ? kernel::seepage_frequency2(modulus, rho, h)
                                    : kernel::two_phase_frequency2(
                                          soil.p_wave_modulus, modulus, soil.material.porosity, 1,
                                          soil.material.solid_density, rho, h);
        dt = std::min(dt, share * 2 / std::sqrt(w2));
      }
    }
    return state.options.courant * dt;
  }
}

}  // namespace detail

}  // namespace vadose
