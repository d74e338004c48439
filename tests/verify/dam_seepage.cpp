// SPDX-License-Identifier: MIT
// Steady seepage through a rectangular dam: discharge after Dupuit and Charny, and the free surface.

#include "cases/dam_seepage.hpp"
#include "check_case.hpp"

TEST_CASE("dam seepage: discharge and free surface") {
  verify::check(verify::DamSeepage{}, {.cells = 20});
}
