// SPDX-License-Identifier: MIT
// Rain of a rate: what enters, what stands on the ground, what the ledger says.

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <string>

#include <vadose/solver/solver.hpp>

#include "../seepage.hpp"

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

using vadose_test::Seepage;
using Column = Seepage<vd::Uniaxial>;
using Strip = Seepage<vd::PlaneStrain>;

constexpr Real conductivity = 1e-4, porosity = 0.4;

/// Sand at S = 0.3 up to `height` [m], softened water, rain as given.
template <class M>
vd::Solver<M> rained(Real height, const vd::bc::Rain& rain, Real saturation = 0.3) {
  constexpr int dim = M::Kinematics::dim, up = dim - 1;
  Vec<dim> low = Vec<dim>::Zero(), high = Vec<dim>::Constant(0.3), top;
  high[up] = 1.2;
  top = high;
  top[up] = height;
  vd::Scene<M> scene({.box = {low, high}, .cell_size = 0.1});
  scene.gravity[up] = -9.81;
  scene.liquid.bulk_modulus = 1e6;
  scene.add_soil(
      vd::box(low, top),
      {.name = "sand",
       .porosity = porosity,
       .lambda = 0.63,
       .retention = {.a = 3, .porosity_dependent = false},
       .conductivity = {.saturated_conductivity = conductivity, .porosity_dependent = false}},
      {.saturation = saturation});
  scene.add(rain);
  return vd::Solver<M>(scene);
}

/// Water that a column took in [m].
template <class M>
Real taken(const vd::WaterBalance& w) {
  return (w.pore - w.initial) / 1000 / (M::Kinematics::dim == 1 ? 1 : 0.3);
}

void check_closed(const vd::WaterBalance& w) {
  CHECK(std::fabs(w.relative_closure()) <= 1e-12);
}

}  // namespace

TEST_CASE("rain below capacity enters at once and whole") {
  auto column = rained<Column>(1, {.rate = 0.3 * conductivity});
  auto strip = rained<Strip>(1, {.rate = 0.3 * conductivity});
  column.advance_to(100);
  strip.advance_to(20);
  const auto w = column.water_balance(), w2 = strip.water_balance();
  CHECK(w.rain == doctest::Approx(1000 * 0.3 * conductivity * 100).epsilon(1e-12));
  CHECK(taken<Column>(w) == doctest::Approx(0.3 * conductivity * 100).epsilon(1e-9));
  CHECK(taken<Strip>(w2) == doctest::Approx(0.3 * conductivity * 20).epsilon(1e-9));
  CHECK(w.free == 0);
  CHECK(std::fabs(w.film) <= 1e-12);
  CHECK(w.inflow == 0);
  check_closed(w);
  check_closed(w2);
}

TEST_CASE("rain above capacity stands on the ground: film, then free water; all of it counted") {
  auto solver = rained<Column>(0.5, {.rate = 20 * conductivity});
  solver.advance_to(15);
  auto w = solver.water_balance();
  CHECK(w.film > 0);
  CHECK(w.pore > w.initial);
  CHECK(taken<Column>(w) < 0.9 * 20 * conductivity * 15);
  check_closed(w);
  solver.advance_to(60);  // 0.12 m of rain on 0.5 m of soil that has room for 0.14 m
  w = solver.water_balance();
  CHECK(w.free > 0);
  CHECK(w.film < 50);  // never half a cell
  MESSAGE("rain ", w.rain, " kg/m2, pore ", w.pore - w.initial, ", free ", w.free, ", film ",
          w.film, ", closure ", w.relative_closure());
  check_closed(w);
}

TEST_CASE("rain can stop, and its film soaks in") {
  auto solver =
      rained<Column>(0.5, {.function = [](Real t) { return t < 10 ? 20 * conductivity : 0.0; }});
  solver.advance_to(10);
  const Real film = solver.water_balance().film;
  CHECK(film > 0);
  solver.advance_to(200);
  const auto w = solver.water_balance();
  CHECK(w.rain == doctest::Approx(20).epsilon(1e-3));
  CHECK(w.film < 0.01 * film);
  CHECK(w.free == 0);
  check_closed(w);
}

TEST_CASE("without rain a surface under suction takes no water") {
  auto solver = rained<Strip>(0.5, {.rate = 0});
  solver.advance_to(1);
  const auto w = solver.water_balance();
  CHECK(w.rain == 0);
  CHECK(w.film == 0);
  CHECK(w.pore == doctest::Approx(w.initial).epsilon(1e-13));
}

TEST_CASE("a film runs down a slope at Manning's depth, and collects at the toe") {
  // Nearly tight ground: what falls runs off.
  vd::Scene<Strip> scene({.box = {{0.0, 0.0}, {2.0, 1.2}}, .cell_size = 0.1});
  scene.gravity = {0, -9.81};
  scene.liquid.bulk_modulus = 1e6;
  scene.add_soil(vd::polygon({{0, 0}, {2, 0}, {2, 0.2}, {1.6, 0.2}, {0, 1}}),
                 {.name = "clay",
                  .porosity = porosity,
                  .lambda = 0.63,
                  .retention = {.a = 3, .porosity_dependent = false},
                  .conductivity = {.saturated_conductivity = 1e-9, .porosity_dependent = false}},
                 {.saturation = 0.9});
  const Real rate = 1e-3, roughness = 0.1;
  scene.add(vd::bc::Rain{.rate = rate, .roughness = roughness});
  vd::Solver<Strip> solver(scene);
  solver.advance_to(8);
  const auto w = solver.water_balance();
  check_closed(w);
  CHECK(w.rain == doctest::Approx(1000 * rate * 2 * 8).epsilon(1e-12));
  // Steady sheet flow at x = 1.25: q = r x = d^(5/3) sqrt(0.5) / n.
  const Real depth = std::pow(rate * 1.25 * roughness / std::sqrt(0.5), 0.6);
  Real film = 0;  // the mean over the staircase of cells
  for (std::size_t c = 11; c < 14; ++c) film += solver.state().columns[c].film / 3;
  MESSAGE("film ", film / 100, " m, Manning ", depth, "; at the toe ", w.free, " kg free");
  CHECK(film / 100 == doctest::Approx(depth).epsilon(0.1));
  CHECK(w.free + w.film > 0.95 * w.rain);
}

TEST_CASE("springs on a slope feed films, and the water is counted where it goes") {
  // A hill whose lower half is under a water table that rises into the slope.
  vd::Scene<Strip> scene({.box = {{0.0, 0.0}, {2.0, 1.2}}, .cell_size = 0.1});
  scene.gravity = {0, -9.81};
  scene.liquid.bulk_modulus = 1e6;
  scene.add_soil(vd::polygon({{0, 0}, {2, 0}, {2, 0.2}, {1.6, 0.2}, {0, 1}}),
                 {.name = "sand",
                  .porosity = porosity,
                  .lambda = 0.63,
                  .retention = {.a = 3, .porosity_dependent = false},
                  .conductivity = {.saturated_conductivity = 1e-3, .porosity_dependent = false}},
                 {.water_table = 0.7});
  auto open = scene;
  scene.add(vd::bc::Rain{.rate = 0});
  vd::Solver<Strip> solver(scene);
  solver.advance_to(10);
  auto w = solver.water_balance();
  MESSAGE("springs: pore ", w.pore - w.initial, " kg, free ", w.free, ", film ", w.film,
          ", closure ", w.relative_closure());
  CHECK(w.rain == 0);
  CHECK(w.free + w.film > 1);  // [kg]
  check_closed(w);
  open.add(vd::bc::SeepageFace{});
  vd::Solver<Strip> drained(open);
  drained.advance_to(10);
  w = drained.water_balance();
  MESSAGE("seepage face: out ", w.outflow, " kg, in ", w.inflow, ", closure ",
          w.relative_closure());
  CHECK(w.outflow > 1);  // [kg]
  CHECK(w.inflow == 0);
  check_closed(w);
}

TEST_CASE("rain and a pond enter soil that holds no water at all") {
  for (const bool pond : {false, true}) {
    vd::Scene<Column> scene({.box = {Vec<1>(0.0), Vec<1>(1.2)}, .cell_size = 0.1});
    scene.gravity[0] = -9.81;
    scene.liquid.bulk_modulus = 1e6;
    scene.add_soil(
        vd::box({0.0}, {0.8}),
        {.name = "sand",
         .porosity = porosity,
         .lambda = 0.63,
         .retention = {.a = 3, .porosity_dependent = false},
         .conductivity = {.saturated_conductivity = conductivity, .porosity_dependent = false}},
        {.dry = true});
    if (pond)
      scene.add_water(vd::box({0.8}, {1.0}), {.surface_level = 1.0});
    else
      scene.add(vd::bc::Rain{.rate = 0.3 * conductivity});
    vd::Solver<Column> solver(scene);
    solver.advance_to(60);
    const auto w = solver.water_balance();
    CAPTURE(pond);
    MESSAGE(std::string(pond ? "pond" : "rain"), " on dry soil: entered ", w.pore / 1000,
            " m, closure ", w.relative_closure());
    CHECK(w.pore > 0);
    if (!pond) CHECK(w.pore == doctest::Approx(1000 * 0.3 * conductivity * 60).epsilon(1e-9));
    if (pond) CHECK(w.pore + w.free + w.film == doctest::Approx(w.initial).epsilon(1e-12));
    check_closed(w);
  }
}

TEST_CASE("rain by a table falls in steps, and is counted exactly") {
  auto solver = rained<Column>(0.5, {.table = {{2, 0.2e-4}, {5, 0}, {8, 0.1e-4}}});
  for (const Real t : {2.0, 5.0, 8.0, 10.0}) solver.advance_to(t);
  const auto w = solver.water_balance();
  CHECK(w.rain == doctest::Approx(1000 * (3 * 0.2e-4 + 2 * 0.1e-4)).epsilon(1e-12));
  check_closed(w);
}

TEST_CASE("driven rain falls on slopes that face it") {
  // A ridge of slopes 1:2 and flat ground before and behind it, tight.
  const auto caught = [](std::array<Real, 3> direction) {
    vd::Scene<Strip> scene({.box = {{0.0, 0.0}, {4.0, 1.2}}, .cell_size = 0.1});
    scene.gravity = {0, -9.81};
    scene.liquid.bulk_modulus = 1e6;
    scene.add_soil(
        vd::polygon({{0, 0}, {4, 0}, {4, 0.2}, {3.2, 0.2}, {2, 0.8}, {0.8, 0.2}, {0, 0.2}}),
        {.name = "clay",
         .porosity = porosity,
         .lambda = 0.63,
         .retention = {.a = 3, .porosity_dependent = false},
         .conductivity = {.saturated_conductivity = 1e-9, .porosity_dependent = false}},
        {.saturation = 0.9});
    scene.add(vd::bc::Rain{.rate = 1e-4, .direction = direction, .roughness = 10});
    vd::Solver<Strip> solver(scene);
    solver.advance_to(0.2);
    check_closed(solver.water_balance());
    Real film[4] = {};
    const auto& columns = solver.state().columns;
    for (std::size_t c = 0; c < columns.size(); ++c)
      film[c < 8 ? 0 : c < 20 ? 1 : c < 32 ? 2 : 3] += columns[c].film / (c < 8 || c > 31 ? 8 : 12);
    return std::array<Real, 4>{film[0] / film[3], film[1] / film[0], film[2] / film[0],
                               solver.water_balance().rain / (1000 * 1e-4 * 4 * 0.2)};
  };
  const auto straight = caught({0, -2});
  CHECK(straight[1] == doctest::Approx(1).epsilon(0.02));
  CHECK(straight[2] == doctest::Approx(1).epsilon(0.02));
  CHECK(straight[3] == doctest::Approx(1).epsilon(1e-12));
  // One to the right for every two down: 1 + 0.5 x 0.5 on the left slope, 1 - 0.25 on the right.
  const auto driven = caught({1, -2});
  CHECK(driven[0] == doctest::Approx(1).epsilon(0.05));
  CHECK(driven[1] == doctest::Approx(1.25).epsilon(0.03));
  CHECK(driven[2] == doctest::Approx(0.75).epsilon(0.03));
  CHECK(driven[3] == doctest::Approx(1).epsilon(1e-12));  // as much as through a horizontal plane
  // Two to the right for each one down: 2 on the left; none on the right, 1 - 1.
  const auto slanting = caught({2, -1});
  CHECK(slanting[1] == doctest::Approx(2).epsilon(0.05));
  CHECK(slanting[2] < 0.1);
}

TEST_CASE("rain is refused where it makes no sense") {
  CHECK_THROWS_AS(rained<Column>(1, {.table = {{0, 1e-6}, {0, 2e-6}}}), vd::SetupError);
  CHECK_THROWS_AS(rained<Column>(1, {.table = {{0, -1e-6}}}), vd::SetupError);
  CHECK_THROWS_AS(rained<Column>(1, {.rate = 1e-6, .table = {{0, 1e-6}}}), vd::SetupError);
  CHECK_THROWS_AS(rained<Column>(1, {.rate = 1e-6, .direction = {0, 1}}), vd::SetupError);
  CHECK_THROWS_AS(rained<Strip>(1, {.rate = 1e-6, .direction = {1, 0}}), vd::SetupError);
  CHECK_THROWS_AS(rained<Strip>(1, {.rate = 1e-6, .direction = {1, 0, -1}}), vd::SetupError);
  CHECK_THROWS_AS(rained<Column>(1, {}), vd::SetupError);
  CHECK_THROWS_AS(rained<Column>(1, {.rate = -1e-6}), vd::SetupError);
  CHECK_THROWS_AS(rained<Column>(1, {.rate = 1e-6, .roughness = 0}), vd::SetupError);
  vd::Scene<Column> scene({.box = {Vec<1>(0.0), Vec<1>(1.0)}, .cell_size = 0.1});
  scene.add(vd::bc::Rain{.rate = 1e-6});
  CHECK_THROWS_WITH_AS(scene.add(vd::bc::ZeroSuction{}),
                       doctest::Contains("bc::ZeroSuction contradicts bc::Rain"), vd::SetupError);
}
