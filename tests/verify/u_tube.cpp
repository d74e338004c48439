// SPDX-License-Identifier: MIT
// A U-tube of water with soil at its lowest point: levelling out by Darcy's law, swinging by inertia.

#include "cases/u_tube.hpp"
#include "check_case.hpp"

TEST_CASE("U-tube: a leg falls through saturated soil") {
  verify::check(verify::FallingLeg{}, {.cells = 20});
}
// Free water that soil feeds from below gets its pressure from rates alone: once it has risen by about a
// cell, pressure and level part. What falls is right; what rises runs on past its level.
TEST_CASE("known miss: U-tube, two ponds level out through saturated soil") {
  const verify::UTubePonds ponds;
  verify::check_outcome(ponds, verify::run(ponds, {.cells = 10}), 0.07);
}
TEST_CASE("known miss: U-tube, period and decay of its swing") {
  const verify::UTubeLeg leg;
  verify::check_outcome(leg, verify::run(leg, {.cells = 10}), 0.1);
}
