// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// What a step and a run report.

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include <vadose/kernel/time_step.hpp>

namespace vadose {

/// Outcome of one step.
struct StepReport {
  Status status = Status::ok;         ///< ok, or failed
  Real time = 0;                      ///< after the step [s]
  Real dt = 0;                        ///< step taken [s]
  StepLimit limit = StepLimit::none;  ///< what limited the step
  std::int64_t step = 0;              ///< number of the step
  Trouble trouble;                    ///< where status is not ok
  SolveReport solve;                  ///< of the pressures, in a semi-implicit step

  /// One line for people.
  std::string text() const {
    char buffer[400];
    if (status == Status::ok) {
      int n = std::snprintf(buffer, sizeof buffer, "step %lld, t = %.6g s, dt = %.3g s (%s)",
                            static_cast<long long>(step), time, dt, name(limit));
      if (solve.newton > 0)
        n += std::snprintf(buffer + n, sizeof buffer - static_cast<std::size_t>(n),
                           ", %d Newton and %d linear iterations, residual %.2g, %d retries",
                           solve.newton, solve.linear, solve.residual, solve.retries);
      if (solve.skeleton)
        std::snprintf(buffer + n, sizeof buffer - static_cast<std::size_t>(n),
                      ", skeleton solved for, %.2g of weights and loads out of balance",
                      solve.inertia_share);
      else if (solve.inertia > 1)
        std::snprintf(buffer + n, sizeof buffer - static_cast<std::size_t>(n),
                      ", inertia times %.3g, %.2g of weights and loads", solve.inertia,
                      solve.inertia_share);
    } else {
      std::snprintf(buffer, sizeof buffer,
                    "unstable: step %lld, t = %.6g s, dt = %.3g s (%s): %s violated by %s point "
                    "%lld at (%.6g, %.6g, %.6g) [m], value %.6g",
                    static_cast<long long>(step), time, dt, name(limit),
                    trouble.criterion ? trouble.criterion : "finite state", trouble.phase,
                    static_cast<long long>(trouble.id), trouble.position[0], trouble.position[1],
                    trouble.position[2], trouble.value);
    }
    return buffer;
  }
};

/// Thrown by advance_to() when a step fails; the state is the one after the failed step and is
/// for inspection only.
class InstabilityError : public std::runtime_error {
 public:
  /// Of the step that failed.
  explicit InstabilityError(const StepReport& report)
      : std::runtime_error(report.text()), report_(report) {}
  /// Report of that step.
  const StepReport& report() const noexcept { return report_; }

 private:
  StepReport report_;
};

/// Water of a run [kg] (per metre in plane strain, per radian, per square metre in 1D).
struct WaterBalance {
  Real initial = 0;  ///< at the start
  Real rain = 0;     ///< fallen on the ground
  Real inflow = 0;   ///< through held pressures
  Real outflow = 0;  ///< through held pressures
  Real pore = 0;     ///< stored as pore water now
  Real free = 0;     ///< stored as free water now
  Real film = 0;     ///< on the ground, not points yet
  Real lost = 0;     ///< left with points that left the box
  Real added = 0;    ///< put in less taken out by the host between steps

  /// Stored now less what must be there [kg].
  Real closure() const noexcept {
    return pore + free + film - (initial + added + rain + inflow - outflow - lost);
  }
  /// Closure over the largest quantity in the balance [-].
  Real relative_closure() const noexcept {
    const Real scale = max(max(max(initial, std::fabs(added)), max(rain, inflow)),
                           max(outflow, pore + free + film));
    return scale > 0 ? closure() / scale : 0;
  }
};

/// Grains of a run [kg].
struct SolidBalance {
  Real initial = 0;  ///< at the start
  Real stored = 0;   ///< now
  Real lost = 0;     ///< left with points that left the box
  Real added = 0;    ///< put in less taken out by the host between steps
  /// Stored now less what must be there [kg].
  Real closure() const noexcept { return stored - (initial + added - lost); }
  /// Closure over the larger of what was and what is there [-].
  Real relative_closure() const noexcept {
    const Real scale = max(initial, stored);
    return scale > 0 ? closure() / scale : 0;
  }
};

}  // namespace vadose
