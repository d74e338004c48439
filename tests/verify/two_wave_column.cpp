// SPDX-License-Identifier: MIT
// Fast and slow compression wave of a saturated column, low and high conductivity, against the modal
// series and the drag-free fronts of the linear equations.

#include "cases/two_wave_column.hpp"
#include "check_case.hpp"

TEST_CASE("two waves: pressures at low conductivity, arrivals and heights at high") {
  verify::check(verify::TwoWaveColumn{}, {.cells = 50});
  verify::check(verify::TwoWaveColumn::high(), {.cells = 100});
}
