// SPDX-License-Identifier: MIT
// Free water in the plane: at rest, sloshing in a tank, a falling column.

#include "cases/free_water.hpp"
#include "check_case.hpp"

TEST_CASE("still water stays still") {
  verify::check(verify::StillWater{}, {.cells = 10});
  verify::check(verify::StillWater{.jitter = 0.2}, {.cells = 10});
}
TEST_CASE("sloshing: period of the first mode") {
  verify::check(verify::Sloshing{}, {.cells = 20});
}
TEST_CASE("dam break: front and height after Martin and Moyce") {
  verify::check(verify::DamBreak{}, {.cells = 8});
}
TEST_CASE("dam break on finer cells: none passes a wall, the column does not tear") {
  for (const int cells : {16, 32}) {
    verify::check(verify::DamBreak{.times = {1.19, 1.98, 2.65}}, {.cells = cells});
    CHECK(verify::run(verify::DamBreak{.times = {3.33}}, {.cells = cells}).failure.empty());
  }
}
