// SPDX-License-Identifier: MIT
// Terzaghi's consolidation of a saturated column, [Zhan] 4.1, Table 1, against the series.

#include "cases/terzaghi.hpp"
#include "check_case.hpp"

namespace {

using verify::Real;
using verify::Terzaghi;

verify::Outcome check_column(const Terzaghi& column, int cells = 10) {
  MESSAGE("k ", column.conductivity, " m/s, load ", column.load, " Pa");
  const verify::Outcome outcome = verify::check(column, {.cells = cells});
  for (const auto& c : outcome.comparisons)
    CHECK(c.values.size() == static_cast<std::size_t>(cells));
  return outcome;
}

}  // namespace

TEST_CASE("Terzaghi: the series of the test against the reference table") {
  const verify::Table table("r1_terzaghi_isochrones.csv");
  REQUIRE(table.size() > 0);
  int compared = 0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Real z = table.number(i, "z_m"), tv = table.number(i, "Tv");
    if (!(z > 0.01 && z < 0.99 && tv >= 0.01)) continue;
    const Real p = verify::terzaghi_mean(1 - z - 1e-3, 1 - z + 1e-3, tv);
    CHECK(std::fabs(p - table.number(i, "p_over_q")) <= 2e-5);
    ++compared;
  }
  CHECK(compared > 200);
}

TEST_CASE("Terzaghi: 10 cells within 1 % of the load, 0.5 % from Tv = 0.1") {
  for (const Real k : {1e-3, verify::table1::conductivity, 1e-4}) check_column({.conductivity = k});
  check_column({.conductivity = 1e-5, .times = {0.05}});
}

TEST_CASE("Terzaghi: random offsets of the points") {
  check_column({.jitter = 0.2});
}

TEST_CASE("Terzaghi: second order in the cell size") {
  // The step falls with the cell. k and load are small: at k = 1e-3 m/s inertia alone makes 0.2 % at
  // T_v = 0.05 and 0.1, and at 10 kPa finite strain 0.02 % at T_v = 0.6.
  const Terzaghi column{.conductivity = 1e-4, .load = 100, .times = {0.05, 0.1}};
  std::vector<verify::Outcome> runs;
  for (const auto& r : column.resolutions) runs.push_back(check_column(column, r.cells));
  for (std::size_t i = 1; i < runs.size(); ++i)
    for (const Real t : column.times) {
      const Real order = verify::order(runs[i - 1], runs[i], "pressure", t);
      MESSAGE("Tv ", t, ": order ", order, " to ", runs[i].resolution.cells, " cells");
      CHECK(order >= 1.8);
    }
}

// Where the water keeps its speed for more than a step, the flux through the surface does too. Cut off
// whenever the pressure had changed sign, it kept a surface cell swinging by half the load.
TEST_CASE("Terzaghi: fine cells, inertia at the drained surface") {
  check_column({.conductivity = 1e-3, .times = {0.05}}, 40);
}

// Less than half a cell of soil at the surface shares the pressure of the cell below.
TEST_CASE("Terzaghi: surface between the cells") {
  for (const Real fill : {0.75, 0.5, 0.25})
    verify::check(Terzaghi{.top_fill = fill, .times = {0.05, 0.1}}, {.cells = 10});
}

TEST_SUITE("long") {
  TEST_CASE("Terzaghi: 10 cells at k = 1e-5 m/s to Tv = 0.6") {
    check_column({.conductivity = 1e-5});
  }
}
