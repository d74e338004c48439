// SPDX-License-Identifier: MIT
// Drainage of an elastic column through its base (Liakopoulos 1965).

#include "cases/liakopoulos.hpp"
#include "check_case.hpp"

TEST_CASE("Liakopoulos: drainage for 20 minutes") {
  verify::check(verify::Liakopoulos{}, {.cells = 10});
}
TEST_SUITE("long") {
  TEST_CASE("Liakopoulos: drainage for two hours") {
    for (const int cells : {10, 20})
      verify::check(verify::Liakopoulos{.times = {300, 600, 1200, 2400, 4800, 7200}},
                    {.cells = cells});
  }
}
