// SPDX-License-Identifier: MIT
// [Zhan] 4.2: a pond of free liquid points sinks into 10 m of clay, rigid or elastic
// (tests/reference/r3_pond_profiles.csv; pond left and heave of its summary).

#include "cases/pond.hpp"
#include "check_case.hpp"

namespace {

using verify::Pond;
using verify::Real;
using Rigid = vadose::law::Rigid;
using Elastic = vadose::law::LinearElastic;

/// When a pond of 0.2 m has run dry.
template <class Skeleton>
void check_dry(int cells, Real expected) {
  auto solver = Pond<Skeleton>{.depth = 0.2}.template start<verify::Variant<>>({.cells = cells});
  Real dry = vadose::unset;
  for (Real t = 0.5 * expected; !vadose::is_finite(dry) && t < 1.5 * expected; t += 0.5) {
    solver.advance_to(t);
    if (Pond<Skeleton>::water_above(solver.water_balance()) < 1e-4) dry = t;
  }
  const auto w = solver.water_balance();
  MESSAGE(cells, " cells: dry after ", dry, " s, expected ", expected, ", heave ",
          Pond<Skeleton>::largest_heave(solver), ", closure ", w.relative_closure(), ", steps ",
          solver.steps());
  CHECK(verify::close(dry, expected, 0.05));
  CHECK(std::fabs(w.relative_closure()) <= 1e-12);
}

}  // namespace

TEST_CASE("pond of 0.2 m on rigid clay runs dry") {
  check_dry<Rigid>(50, 180.0);
}
TEST_SUITE("long") {
  TEST_CASE("pond of 0.2 m on elastic clay runs dry") {
    check_dry<Elastic>(50, 170.5);
  }
}
TEST_CASE("pond of 0.5 m on rigid clay") {
  verify::check(Pond<Rigid>{}, {.cells = 20});
}

TEST_CASE("pond of 0.5 m on elastic clay") {
  verify::check(Pond<Elastic>{}, {.cells = 20});
}
TEST_SUITE("long") {
  TEST_CASE("pond of 0.5 m on elastic clay, water of 2.2 GPa") {
    verify::check(Pond<Elastic>{.bulk_modulus = 2.2e9}, {.cells = 20});
  }
}
