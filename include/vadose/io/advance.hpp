// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Long runs that say how far they are.

#include <cmath>
#include <cstdint>

#include <vadose/io/progress.hpp>
#include <vadose/solver/report.hpp>

namespace vadose::io {

/// Steps a Solver to time t [s] and lets `progress` print meanwhile. The steps are those of
/// solver.advance_to(t), bit for bit; raises InstabilityError as that does.
template <class S>
void advance(S& solver, Real t, Progress& progress) {
  while (t - solver.time() > 1e-14 * std::fabs(t)) {
    const StepReport report = solver.step(t);
    if (report.status != Status::ok) throw InstabilityError(report);
    progress.update(solver.time(), static_cast<std::uint64_t>(solver.steps()));
  }
  solver.advance_to(t);
}

}  // namespace vadose::io
