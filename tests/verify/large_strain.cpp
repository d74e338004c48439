// SPDX-License-Identifier: MIT
// Consolidation by 39 % with a conductivity that falls with porosity: Xie and Leo's exact solution and
// finite volumes.

#include "cases/large_strain.hpp"
#include "check_case.hpp"

TEST_CASE("large strain: consolidation of slurry by the square law and by Kozeny and Carman's") {
  for (const bool square_law : {true, false}) {
    CAPTURE(square_law);
    verify::check(verify::LargeStrain{.square_law = square_law}, {.cells = 10});
  }
}

TEST_SUITE("long") {
  TEST_CASE("large strain: to T = 1") {
    for (const bool square_law : {true, false})
      for (const int cells : {20, 40})
        verify::check(
            verify::LargeStrain{.square_law = square_law, .times = {0.1, 0.2, 0.4, 0.6, 1}},
            {.cells = cells});
  }
}
