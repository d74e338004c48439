// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Cell pressures at the end of a step from the water ledger, by Newton's method: in every cell
/// M_c / rho_l0 + dt (inflow) = sum V j theta(p', n'), j = exp(dt div v^s), n' = 1 - (1 - n) / j, with
/// fluxes and velocities at the new pressures. The residual is the ledger itself: what a solution
/// leaves is found again in the next step, and exchanged water is conserved whatever its error.

#include <algorithm>
#include <numeric>

#include <vadose/kernel/pressure_matrix.hpp>
#include <vadose/kernel/quasi_static.hpp>

namespace vadose::kernel {

/// Newton's method has found the pressures when no cell has more water unbalanced than this part of
/// its pores.
inline constexpr Real balance_tolerance = 1e-13;
/// More than this part and the step is given up.
inline constexpr Real balance_limit = 1e-7;
inline constexpr int max_newton = 25;

/// A step of Newton's method on one pressure. Storage changes a thousandfold where p crosses 0, and
/// that at one suction says nothing about that at ten times as much.
inline Real safe_change(Real pressure, Real change, Real floor, bool early) noexcept {
  if (pressure < 0) {
    const Real most = max(3e4, 0.5 * std::fabs(pressure));
    change = min(max(change, -most), max(most, -pressure));
    if (early && pressure < -1 && pressure + change > 0) change = -0.9 * pressure;
  } else if (pressure + change < -100) {
    change = -100 - pressure;
  }
  return max(change, floor - pressure);
}

/// The same between the last pressures that left too much water and too little: a change past one of them
/// would go to and fro between a full cell and one whose highest points drain. Their chord then (Illinois: the
/// residual of an end that stays counts half).
template <int Dim>
Real bracketed_change(PressureUnknown<Dim>& u, Real residual, Real change) noexcept {
  auto& own = residual > 0 ? u.low : u.high;
  auto& other = residual > 0 ? u.high : u.low;
  if (u.last_residual * residual > 0) other.residual *= 0.5;
  u.last_residual = residual;
  own = {u.pressure, residual, true};
  const Real back = other.pressure - u.pressure;
  if (!other.known || change * back <= 0 || std::fabs(change) < 0.99 * std::fabs(back))
    return change;
  return back * residual / (residual - other.residual);
}

/// Adds the solution of the linear system to the pressures; returns the largest change in relation to
/// 1e-9 of the pressure and 1e-6 Pa.
template <class M>
Real change_pressures(State<M>& state, int iteration) {
  auto& system = state.system;
  system.worst.assign(system.unknowns.size(), 0);
  for_unknowns(state, [&](std::size_t row, auto& u, auto& cell) {
    Real change = system.change[row];
    if constexpr (has_skeleton<M>)
      if (!u.free) {
        const Real floor = is_unsaturated<M> ? state.soils[cell.material].pressure_floor : -1e30;
        if (is_unsaturated<M>)
          change = bracketed_change(u, system.residual[row],
                                    safe_change(u.pressure, change, floor, iteration < 12));
      }
    u.pressure += change;
    system.worst[row] = std::fabs(change) / (1e-6 + 1e-9 * std::fabs(u.pressure));
  });
  Real worst = 0;
  for (const Real w : system.worst) worst = is_finite(w) ? max(worst, w) : 1e300;
  return worst;
}

/// Largest change of saturation in a cell over the step.
template <class M>
Real saturation_change(State<M>& state) {
  if constexpr (!is_unsaturated<M>) {
    return 0;
  } else {
    auto& system = state.system;
    system.worst.assign(system.unknowns.size(), 0);
    for_unknowns(state, [&](std::size_t row, auto& u, auto& cell) {
      if (u.free) return;
      const Record sums = member_sums(view_of(state, u.entry), state.nodes.content);
      const Real bulk = cell.pore_volume / max(cell.porosity, 1e-6);
      const Real pores = cell.pore_volume + bulk * (std::exp(state.dt * cell.skeleton_rate) - 1);
      const Real compression = std::exp(u.pressure / state.water.bulk_modulus);
      const Real saturation = min(1.0, sums[lane::content] / (pores * compression));
      system.worst[row] = std::fabs(saturation - cell.saturation);
    });
    return std::accumulate(system.worst.begin(), system.worst.end(), 0.0,
                           [](Real a, Real b) { return max(a, b); });
  }
}

/// Gives the cells their pressures of the start of the step back.
template <class M>
void restore_pressures(State<M>& state) {
  for_unknowns(state, [&](std::size_t, auto& u, auto& cell) {
    cell.pressure = u.start;
    cell.quad_pressure = u.start_quad;
  });
}

/// Adds what no phase takes of the changes of pressure, as advance_nodes does of the pressures
/// before the step.
template <class M>
void count_open_impulse(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& open = state.nodes.open_impulse;
  open.assign(static_cast<std::size_t>(state.grid.slots() * dim), 0);
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<dim>& local, int slot, int) {
              const auto& r = state.system.response[static_cast<std::size_t>(e)];
              if (!r.active) return;
              Real force[dim], bishop[dim];
              gradient_changes(state, CellView<M>(state, local, slot), force, bishop);
              for (int d = 0; d < dim; ++d) {
                const Real full = bishop[d] - r.liquid_part * force[d];
                const Real taken =
                    r.grains ? r.bishop_part * bishop[d] - r.pore_part[d] * force[d] : 0;
                open[static_cast<std::size_t>(slot * dim + d)] += state.dt * (full - taken);
              }
            });
  for (std::size_t i = 0; i < open.size(); ++i)
    state.open_impulse[static_cast<int>(i % dim)] += open[i];
}

/// What the points need to know of the solution.
template <class M>
void accept_pressures(State<M>& state) {
  for_unknowns(state, [&](std::size_t, auto& u, auto& cell) {
    cell.change = u.pressure - u.start;
    cell.solved = true;
  });
  restore_pressures(state);
}

/// Newton's method; whether it found the pressures. On the way cells hold trial pressures.
template <class M>
bool solve_pressures(State<M>& state) {
  auto& system = state.system;
  SolveReport& report = system.report;
  list_unknowns(state);
  if constexpr (is_deformable<M>)
    if (system.skeleton.on && !predict_skeleton(state)) return false;
  if (system.unknowns.empty()) {
    if (system.skeleton.on) respond_nodes(state);
    return true;
  }
  update_pattern(state);
  system.blocks.resize(state.grid.size());
  system.start_gradient.resize(state.nodes.face.size());
  system.surface_flux.resize(state.nodes.face.size());
  for (std::size_t i = 0; i < state.nodes.face.size(); ++i)
    system.start_gradient[i] = state.nodes.face[i].head_gradient;
  Real change = 1e300;
  for (int iteration = 0;; ++iteration) {
    report.residual = evaluate_trial(state);
    report.newton += iteration > 0;
    if (report.residual <= balance_tolerance) break;
    if (report.residual <= balance_limit && change <= 1) break;
    if (iteration == max_newton || !(report.residual < 1e100)) break;
    assemble_matrix(state);
    report.linear += solve_linear(state);
    change = change_pressures(state, iteration);
  }
  return report.residual <= balance_limit && (!system.skeleton.on || system.skeleton.solved);
}

}  // namespace vadose::kernel
