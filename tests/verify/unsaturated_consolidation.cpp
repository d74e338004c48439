// SPDX-License-Identifier: MIT
// Loading of unsaturated soil at S = 0.86, [Zhan] 4.1: undrained pressure and its decay against
// closed forms of the equations that are solved.

#include <doctest/doctest.h>

#include "cases/figure_consolidation.hpp"
#include "check_case.hpp"

namespace {

using verify::Real;
using verify::UnsaturatedConsolidation;
using verify::Variant;

constexpr Real stiff = 10e6, soft = 3e6;

/// Calls f(case) for both moduli, with and without porosity dependence.
template <class F>
void for_soils(F&& f) {
  for (const Real young_modulus : {stiff, soft})
    for (const bool porosity_dependent : {true, false}) {
      CAPTURE(young_modulus);
      CAPTURE(porosity_dependent);
      MESSAGE("E ", young_modulus, std::string(porosity_dependent ? ", coupled" : ", frozen"));
      f(UnsaturatedConsolidation{.young_modulus = young_modulus,
                                 .porosity_dependent = porosity_dependent});
    }
}

}  // namespace

TEST_CASE("undrained ratio: the closed form of the test against the reference table") {
  const verify::Table table("r2_undrained_readings.csv");
  int compared = 0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table.text(i, "e^b") != "n" || table.text(i, "modulus") != "E_oed" ||
        table.text(i, "p dS in d(chi p)") != "True")
      continue;
    const verify::UnsaturatedClosedForm exact(1e6 * table.number(i, "E_MPa"),
                                              table.text(i, "dS/dn term") == "True");
    CHECK(verify::close(exact.undrained(), table.number(i, "p0_over_q"), 1e-6));
    CHECK(verify::close(exact.suction, 1e3 * table.number(i, "suction_kPa"), 1e-9));
    ++compared;
  }
  CHECK(compared == 4);
}

TEST_CASE("unsaturated soil at rest under its own suction") {
  const UnsaturatedConsolidation column{.speed_up = 1};
  auto solver = column.column<Variant<>>({.cells = 10}, 0, {});
  for (int i = 0; i < 2000; ++i) solver.step();
  verify::Norm norm;
  verify::for_cells(solver, vadose::CellKind::soil, [&](const auto& cell) {
    norm.add(cell.pressure + column.closed_form().suction);
  });
  MESSAGE("largest |dp| ", norm.max, " Pa, speed ", verify::largest_speed(solver.solid()), " m/s");
  CHECK(norm.max <= 1);
}

TEST_CASE("unsaturated consolidation: undrained pressure ratio, mean over the first P1 periods") {
  for_soils([](UnsaturatedConsolidation column) {
    column.speed_up = 1;
    const auto exact = column.closed_form();
    auto pair = column.pair<Variant<>>({.cells = 10});
    const Real period = 4 * UnsaturatedConsolidation::height / exact.wave_speed();
    // Trapezoidal mean over 4 periods, weights of a Hann window: insensitive to their length.
    verify::Norm cells;
    std::vector<Real> sum(20, 0.0), weight(20, 0.0);
    while (pair.loaded.time() < 4 * period) {
      const auto step = pair.loaded.step();
      REQUIRE(step.status == vadose::Status::ok);
      pair.idle.advance_to(step.time);
      const Real w = step.dt * (1 - std::cos(std::numbers::pi * step.time / (2 * period)));
      pair.for_cells([&](Real z, Real p) {
        const auto i = static_cast<std::size_t>(z * 10);
        sum[i] += w * p / column.load;
        weight[i] += w;
      });
    }
    for (std::size_t i = 0; i < 9; ++i) {  // the cell at the drained surface is left out
      CHECK(weight[i] > 0);
      cells.add(sum[i] / weight[i]);
    }
    MESSAGE("dp/dq ", cells.mean(), ", closed form ", exact.undrained(), ", ratio ",
            cells.mean() / exact.undrained(), "; at the base ", sum[0] / weight[0]);
    CHECK(verify::close(cells.mean(), exact.undrained(), 0.02));
  });
}

TEST_CASE("unsaturated consolidation: decay of a small load") {
  for_soils([](const UnsaturatedConsolidation& column) { verify::check(column, {.cells = 10}); });
}

TEST_CASE("unsaturated consolidation: 10 kPa, figures 6 and 7") {
  for (const Real modulus : {stiff, soft})
    for (const bool coupled : {true, false}) {
      MESSAGE("E ", modulus, std::string(coupled ? ", coupled" : ", frozen"));
      verify::check(verify::FigureConsolidation(modulus, coupled), {.cells = 10});
    }
}
