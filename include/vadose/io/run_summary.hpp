// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// What a run will cost and what it did, in a few lines; printed only where asked for.

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>

#include <vadose/core/error.hpp>
#include <vadose/solver/report.hpp>

namespace vadose::io {

/// Wall time and steps since its construction.
class RunClock {
 public:
  /// Starts now, at the step that the solver has reached.
  template <class S>
  explicit RunClock(const S& solver) : first_step_(solver.steps()) {}

  /// Wall time since then [s].
  Real seconds() const {
    return std::chrono::duration<Real>(std::chrono::steady_clock::now() - start_).count();
  }
  /// Steps taken since then.
  template <class S>
  std::int64_t steps(const S& solver) const {
    return solver.steps() - first_step_;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::int64_t first_step_;
};

/// Prints points, cells, memory, step and its limit, number of steps and wall time of a run to
/// t_end [s], and the most that these can come to. It runs a copy for a second of wall time; the solver
/// stays as it is.
template <class S>
void print_preflight(std::FILE* out, const S& solver, Real t_end) {
  const auto e = solver.estimate(t_end);
  std::string shrinking;
  if (e.trend < -0.05)
    shrinking = ", becoming shorter; " + check::text(e.shortest_dt) + " s when all is wet";
  std::fprintf(out,
               "before the run from t = %.6g s to %.6g s\n"
               "  points   %zu solid, %zu liquid\n"
               "  grid     %zu blocks of 64 cells, %.1f MB with the points\n"
               "  step     %.3g s, limited by %s%s\n"
               "  steps    %lld\n"
               "  wall     about %.3g s\n",
               solver.time(), t_end, e.solid_points, e.liquid_points, e.blocks, e.megabytes, e.dt,
               name(e.limit), shrinking.c_str(), static_cast<long long>(e.steps), e.seconds);
  if (static_cast<Real>(e.most_steps) > 1.05 * static_cast<Real>(e.steps))
    std::fprintf(out,
                 "  at most  %lld steps, %.3g s, if all that water reaches is wet and all that can "
                 "slide does\n",
                 static_cast<long long>(e.most_steps), e.most_seconds);
}

/// Prints time, steps, points and both ledgers with their closure errors.
template <class S>
void print_summary(std::FILE* out, const S& solver) {
  std::fprintf(out, "run at t = %.6g s after %lld steps: %zu solid points, %zu liquid points\n",
               solver.time(), static_cast<long long>(solver.steps()), solver.solid().size(),
               solver.liquid().size());
  const WaterBalance w = solver.water_balance();
  std::fprintf(out,
               "  water    %.6g kg at the start, %.6g rain, %.6g in, %.6g out, %.6g left the box, "
               "%.6g by the host; now %.6g in pores, %.6g free, %.6g on the ground; closure %.2g "
               "kg (%.2g)\n",
               w.initial, w.rain, w.inflow, w.outflow, w.lost, w.added, w.pore, w.free, w.film,
               w.closure(), w.relative_closure());
  const SolidBalance s = solver.solid_balance();
  std::fprintf(out,
               "  grains   %.6g kg at the start, %.6g left the box, %.6g by the host; now %.6g; "
               "closure %.2g kg "
               "(%.2g)\n",
               s.initial, s.lost, s.added, s.stored, s.closure(), s.relative_closure());
}

/// The same with wall time, and its share per point and step, since `clock` was started.
template <class S>
void print_summary(std::FILE* out, const S& solver, const RunClock& clock) {
  print_summary(out, solver);
  const Real seconds = clock.seconds();
  const std::int64_t steps = clock.steps(solver);
  const Real points = static_cast<Real>(solver.solid().size() + solver.liquid().size());
  std::fprintf(out, "  wall     %.3g s", seconds);
  if (steps > 0 && points > 0)
    std::fprintf(out, ", %.1f ns per point and step",
                 1e9 * seconds / (points * static_cast<Real>(steps)));
  std::fprintf(out, "\n");
}

}  // namespace vadose::io
