// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Steps longer than those of waves in the skeleton: how the skeleton stands them, and how far from
/// equilibrium it is.

#include <algorithm>
#include <cmath>

#include <vadose/kernel/pressure_system.hpp>
#include <vadose/kernel/state.hpp>

namespace vadose::kernel {

/// DEVIATION: [Zhan] steps through slow periods by dynamics too.
/// Chooses how the skeleton stands a step longer than that of its waves: its motion is solved for, or the
/// grains have more inertia, (dt / dt_wave)^2 of their own.
template <class M>
void choose_skeleton(State<M>& state) {
  auto& system = state.system;
  const Real ratio = state.dt / system.wave_dt;
  const bool slow = state.options.quasi_static.on && !state.frozen && ratio > 1;
  const bool solves = slow && state.options.quasi_static.skeleton == SlowSkeleton::implicit;
  system.report.inertia = slow && !solves ? ratio * ratio : 1;
  if constexpr (is_deformable<M>) {
    system.report.skeleton = system.skeleton.on = solves;
    if (solves) system.skeleton.node.assign(state.grid.size(), {});
  }
}

/// All weights and loads, as lengths [N].
template <class M>
Real weights_and_loads(const State<M>& state, Real mass) noexcept {
  Real sum = mass * state.gravity.norm();
  for (const auto& load : state.loads)
    sum += load.force.norm() * std::fabs(state.factor_values[load.factor]);
  return sum;
}

/// Measures the share of forces out of balance in the weights and loads, where the skeleton is solved for.
template <class M>
void find_unbalanced_share(State<M>& state) {
  const auto& system = state.system;
  Real mass = 0, unbalanced = 0;
  for (std::size_t i = 0; i < system.skeleton.node.size(); ++i) {
    const auto& node = system.skeleton.node[i];
    if (!(node.inertia[0][0] > 0)) continue;
    mass += state.nodes.solid_in[i][lane::mass] + state.nodes.liquid_in[i][lane::mass];
    unbalanced += node.unbalanced;
  }
  const Real forces = weights_and_loads(state, mass);
  state.system.report.inertia_share = forces > 0 ? unbalanced / forces : 1;
}

/// Measures the share of inertia in the weights and loads in a step that may be quasi-static.
template <class M>
void find_inertia_share(State<M>& state) {
  constexpr int dim = State<M>::dim;
  if (!state.options.quasi_static.on) return;
  if constexpr (is_deformable<M>) {
    const auto slots = static_cast<std::size_t>(state.grid.slots());
    auto& sums = state.system.worst;
    sums.assign(2 * slots, 0);
    for_cells(state.grid, state.options.threads,
              [&](std::int32_t e, const Index<dim>&, int slot, int) {
                const auto i = static_cast<std::size_t>(e), s = static_cast<std::size_t>(slot);
                const Real mass = state.nodes.solid_in[i][lane::mass];
                Real change2 = 0;
                for (int d = 0; d < dim; ++d)
                  change2 += power<2>(state.nodes.solid_out[i][lane::increment + d]);
                sums[2 * s] += mass * std::sqrt(change2);
                sums[2 * s + 1] += mass + state.nodes.liquid_in[i][lane::mass];
              });
    Real change = 0, mass = 0;
    for (std::size_t s = 0; s < slots; ++s) {
      change += sums[2 * s];
      mass += sums[2 * s + 1];
    }
    auto& report = state.system.report;
    const Real forces = weights_and_loads(state, mass);
    report.inertia_share = forces > 0 ? report.inertia * change / (state.dt * forces) : 1;
  }
}

/// The share of inertia as the next steps are to see it: highest values count on for a while. (A step that
/// followed each swing of a wave would add inertia where the grains are fastest, and so drive the wave.)
template <class M>
void remember_inertia(State<M>& state) noexcept {
  constexpr Real keeps = 0.97;  // of the last value, per step
  auto& share = state.system.inertia_share;
  if (state.system.report.skeleton)  // damps waves by itself
    share = state.system.report.inertia_share;
  else
    share = max(state.system.report.inertia_share, keeps * share);
}

/// What the length of a quasi-static step is to be multiplied by to bring a share of inertia to what the
/// options ask for, as it grows with the square of the step; infinite in other steps.
template <class M>
Real inertia_factor(const State<M>& state, Real share) noexcept {
  if (!state.options.quasi_static.on || !(share > 0)) return 1e300;
  return 0.9 * std::sqrt(state.options.quasi_static.inertia / share);
}

}  // namespace vadose::kernel
