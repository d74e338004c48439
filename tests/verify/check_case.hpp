// SPDX-License-Identifier: MIT
#pragma once

#include <doctest/doctest.h>

#include "case.hpp"

namespace verify {

/// Reports an outcome and checks it against the bounds of its case. Where a case is known to miss
/// them, `held` is what it holds [-]; the miss stays visible as a warning.
template <class Case>
void check_outcome(const Case& problem, const Outcome& outcome, Real held = 0) {
  CHECK_MESSAGE(outcome.failure.empty(), outcome.failure);
  CHECK(!outcome.comparisons.empty());
  for (const Comparison& c : outcome.comparisons) {
    const Norm norm = c.norm();
    const Real bound = problem.bound(c, outcome.resolution);
    MESSAGE(std::string(Case::name), ", ", outcome.variant, ", ", outcome.resolution.cells,
            " cells, ", c.quantity, " at ", c.time, ": rms ", norm.rms(), ", max ", norm.max,
            ", bound ", bound);
    if (held > bound) WARN(norm.rms() <= bound);
    CHECK(norm.rms() <= std::max(bound, held));
  }
  CHECK(outcome.closure <= 1e-12);
  MESSAGE(outcome.steps, " steps in ", outcome.seconds, " s");
}

/// Runs a case and checks it.
template <class V = Variant<>, class Case>
Outcome check(const Case& problem, const Resolution& resolution) {
  Outcome outcome = run<V>(problem, resolution);
  check_outcome(problem, outcome);
  return outcome;
}

}  // namespace verify
