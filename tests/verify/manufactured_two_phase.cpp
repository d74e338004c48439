// SPDX-License-Identifier: MIT
// Manufactured solutions of skeleton, water and the mass balance between them: orders.

#include "cases/manufactured_two_phase.hpp"
#include "check_case.hpp"

namespace {

namespace vd = vadose;
using verify::Real;

/// Order in h of a quantity at the end, from the coarsest to the finest grid. Earlier the error of the
/// coarsest grid passes through 0.
struct Orders {
  Real displacement = 0, pressure = 0;
};
Orders orders(const verify::ManufacturedTwoPhase<>& problem) {
  std::vector<verify::Outcome> runs;
  for (const auto& r : problem.resolutions) runs.push_back(verify::check(problem, r));
  const Real t = problem.times.back();
  const Orders out{verify::order(runs.front(), runs.back(), "displacement", t),
                   verify::order(runs.front(), runs.back(), "pressure", t)};
  MESSAGE("S ", problem.start_saturation, ", k ", problem.conductivity, " m/s, t ", t,
          " s: order of displacement ", out.displacement, ", of pressure ", out.pressure);
  return out;
}

}  // namespace

TEST_CASE("manufactured two-phase: order in h with dt in proportion to h^2") {
  for (const Real k : {0.01, 0.1}) {
    const Orders o = orders({.conductivity = k});
    CHECK(o.displacement >= 1.8);
    CHECK(o.pressure >= 1.8);
  }
  const Orders partly = orders({.start_saturation = 0.7});
  CHECK(partly.displacement >= 1.5);
  CHECK(partly.pressure >= 1.8);
}

// The implicit drag is of first order in time.
TEST_CASE("manufactured two-phase: order with dt in proportion to h") {
  const std::vector<verify::Resolution> resolutions = {{16, 0.4}, {32, 0.4}};
  const Orders saturated = orders({.resolutions = resolutions});
  CHECK(saturated.displacement >= 0.9);
  CHECK(saturated.pressure >= 0.9);
  const Orders partly = orders({.start_saturation = 0.7, .resolutions = resolutions});
  CHECK(partly.displacement >= 0.9);
  CHECK(partly.pressure >= 0.8);
}
