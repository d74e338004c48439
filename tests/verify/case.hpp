// SPDX-License-Identifier: MIT
#pragma once

// A case is a value: the numbers of a problem, its reference and its bounds. Tests, benchmarks and
// plots run the same one:
//
//     struct Problem {
//       static constexpr const char* name = "problem";
//       std::vector<Real> times;  // in its own unit
//       std::vector<Resolution> resolutions;
//       // A Solver, or what has advance_to(t), steps() and points().
//       template <class V> auto start(const Resolution&) const;
//       Real seconds(Real time) const;
//       template <class Run> std::vector<Comparison> compare(const Run&, Real time) const;
//       Real bound(const Comparison&, const Resolution&) const;  // on the rms; infinity: none
//     };
//
//     const Outcome outcome = run<Variant<vd::shape::Linear>>(Problem{}, {.cells = 20});

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "comparison.hpp"
#include "variant.hpp"

namespace verify {

/// Grid and step of a run.
struct Resolution {
  int cells = 10;      ///< along the length of the case
  Real courant = 0.5;  ///< part of the stable step, SolverOptions::courant
};

/// What a run gave and what it cost.
struct Outcome {
  std::string variant;
  Resolution resolution;
  std::vector<Comparison> comparisons = {};
  std::int64_t steps = 0;
  std::size_t points = 0;
  Real seconds = 0;          ///< wall time of the steps
  Real closure = 0;          ///< of the water ledger, largest at the times of the case [-]
  std::string failure = {};  ///< report of an unstable step; empty if there was none

  Real point_steps() const { return static_cast<Real>(points) * static_cast<Real>(steps); }
  /// rms of a quantity at a time.
  Real rms(const std::string& quantity, Real time) const {
    for (const Comparison& c : comparisons)
      if (c.quantity == quantity && c.time == time) return c.norm().rms();
    return vadose::unset;
  }
};

/// Number of points of a run.
template <class Run>
std::size_t point_count(const Run& run) {
  if constexpr (requires { run.points(); }) {
    return run.points();
  } else {
    std::size_t count = run.solid().size();
    if constexpr (requires { run.liquid().size(); }) count += run.liquid().size();
    return count;
  }
}

/// A copy whose cells are those of the present time; a solver's own are those at the start of its
/// last step.
template <class Run>
Run present(const Run& run) {
  if constexpr (requires { run.present(); }) {
    return run.present();
  } else {
    Run copy = run;
    if constexpr (requires { copy.mutable_state().liquid; })
      vadose::kernel::find_pressures(copy.mutable_state());
    return copy;
  }
}

/// Runs a case once. An unstable run ends early and says so in `failure`.
template <class V = Variant<>, class Case>
Outcome run(const Case& problem, const Resolution& resolution) {
  auto solver = problem.template start<V>(resolution);
  Outcome outcome{.variant = V::name(), .resolution = resolution};
  outcome.points = point_count(solver);
  for (const Real time : problem.times) {
    const auto begin = std::chrono::steady_clock::now();
    try {
      solver.advance_to(problem.seconds(time));
    } catch (const vadose::InstabilityError& error) {
      outcome.failure = error.what();
      break;
    }
    outcome.seconds +=
        std::chrono::duration<Real>(std::chrono::steady_clock::now() - begin).count();
    if constexpr (requires { solver.water_balance(); })
      outcome.closure =
          std::max(outcome.closure, std::fabs(solver.water_balance().relative_closure()));
    for (Comparison& c : problem.compare(present(solver), time))
      outcome.comparisons.push_back(std::move(c));
  }
  outcome.steps = solver.steps();
  return outcome;
}

/// Order of convergence from a run to a finer one, by the rms of a quantity at a time.
inline Real order(const Outcome& coarse, const Outcome& fine, const std::string& quantity,
                  Real time) {
  return std::log(coarse.rms(quantity, time) / fine.rms(quantity, time)) /
         std::log(static_cast<Real>(fine.resolution.cells) / coarse.resolution.cells);
}

}  // namespace verify
