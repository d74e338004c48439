// SPDX-License-Identifier: MIT
// Unsaturated flow through rigid soil: Srivastava and Yeh's rain, Philip's horizontal infiltration.

#include "cases/philip.hpp"
#include "cases/srivastava_yeh.hpp"
#include "check_case.hpp"

TEST_CASE("Srivastava and Yeh: rain on exponential soil over a water table") {
  const verify::SrivastavaYeh rain;
  std::vector<verify::Outcome> runs;
  for (const auto& r : rain.resolutions) runs.push_back(verify::check(rain, r));
  for (const auto time : rain.times) {
    const auto order = verify::order(runs.front(), runs.back(), "effective saturation", time);
    MESSAGE("order at ", time, ": ", order);
    CHECK(order >= 0.9);
  }
}

TEST_CASE("Philip: horizontal infiltration into clay") {
  verify::check(verify::Philip{}, {.cells = 20});
}
TEST_SUITE("long") {
  TEST_CASE("Philip: finer cells") {
    for (const int cells : {40, 80}) verify::check(verify::Philip{}, {.cells = cells});
  }
}
