// SPDX-License-Identifier: MIT
// Rain on an inclined slab of rigid sand: what enters and what runs off, per slope area, against
// Richards' equation along the normal of an infinite slope (tests/reference/richards.py). The middle
// of the slab counts; at its ends the flow along the slope starts and stops.

#include <doctest/doctest.h>

#include <map>

#include "../seepage.hpp"
#include "verify_support.hpp"

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

using Plane = vadose_test::Seepage<vd::PlaneStrain>;

constexpr Real conductivity = 1e-4, gravity = 9.81;

struct Case {
  Real fall = 0.5;  ///< tan of the slope
  const char* name = "1:2";
  Real rain = 3;  ///< over k_sat
  Real h = 0.1;
  Real bulk_modulus = 1e6;  ///< softened water
  Real length = 1.4;        ///< of the sand, horizontal [m]
  Real depth = 0.7;         ///< of the sand along the normal [m]
  std::vector<Real> times;
};

/// A slab of sand between a wall and a tight post, over which the water runs into a tight basin.
vd::Scene<Plane> slope(const Case& c) {
  const Real low = 0.5, thick = c.depth * std::sqrt(1 + c.fall * c.fall);
  const Real post = c.length + 2 * c.h, right = post + 0.6;
  const Real rise = c.fall * c.length;
  const Real top = std::ceil((low + thick + rise) / c.h + 1) * c.h;
  vd::Scene<Plane> scene({.box = {{0.0, 0.0}, {right, top}}, .cell_size = c.h});
  scene.gravity = {0, -gravity};
  scene.liquid.bulk_modulus = c.bulk_modulus;
  vd::Material<Plane> sand = {
      .name = "sand",
      .porosity = 0.4,
      .lambda = 0.63,
      .retention = {.a = 3, .porosity_dependent = false},
      .conductivity = {.saturated_conductivity = conductivity, .porosity_dependent = false}};
  scene.add_soil(
      vd::polygon(
          {{0, low + rise}, {c.length, low}, {c.length, low + thick}, {0, low + thick + rise}}),
      sand, {.saturation = 0.3});
  sand.name = "tight";
  sand.conductivity.saturated_conductivity = 1e-14;
  scene.add_soil(vd::box({c.length, 0.0}, {post, std::floor((low + thick) / c.h) * c.h}), sand,
                 {.saturation = 0.9});
  scene.add_soil(vd::box({post, 0.0}, {right, 0.2}), sand, {.saturation = 0.9});
  scene.add(
      vd::bc::Rain{.rate = c.rain * conductivity, .region = vd::box({0.0, 0.0}, {c.length, top})});
  return scene;
}

/// Pore water between two verticals [kg].
Real pore_water(const vd::Solver<Plane>& solver, Real left, Real right) {
  Real sum = 0;
  solver.liquid().for_each([&](std::size_t b, int l) {
    const auto& p = solver.liquid();
    const Real x = p.at(vd::field::position, b, 0)[l];
    if (p.group(b) != solver.state().free_group() && x > left && x < right)
      sum += p.at(vd::field::mass, b)[l];
  });
  return sum;
}

Real reference(const std::string& name, Real t, const std::string& column) {
  static const verify::Table table("richards_slope.csv");
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.number(i, "t_s") == t && table.text(i, "case") == name)
      return table.number(i, column);
  FAIL("no row ", name, " at ", t);
  return 0;
}

/// Checks what enters to a bound.
void check_slope(const Case& c, Real bound) {
  vd::Solver<Plane> solver(slope(c));
  const Real left = 0.4, right = c.length - 0.4;
  const Real cosine = 1 / std::sqrt(1 + c.fall * c.fall), area = (right - left) / cosine;
  const Real start = pore_water(solver, left, right), all = pore_water(solver, 0, c.length);
  for (const Real t : c.times) {
    solver.advance_to(t);
    const auto w = solver.water_balance();
    const std::string name = std::string(c.name) + (c.rain < 1 ? " rain0.3" : " rain3");
    const Real fallen = c.rain * conductivity * cosine * t;
    const Real entered = (pore_water(solver, left, right) - start) / 1000 / area;
    const Real expected = reference(name, t, "inflow_m");
    MESSAGE(name, ", h ", c.h, " t ", t, ": entered ", entered, " m, Richards ", expected, " (",
            100 * (entered / expected - 1), " %), ran off ", fallen - entered, " m, Richards ",
            fallen - expected, ", of the whole slab entered ",
            (pore_water(solver, 0, c.length) - all) / 1000 / c.length * cosine, " m, closure ",
            w.relative_closure(), ", steps ", solver.steps());
    CHECK(verify::close(w.rain, 1000 * c.rain * conductivity * c.length * t, 1e-10));
    CHECK(verify::close(entered, expected, bound));
    CHECK(std::fabs(w.relative_closure()) <= 1e-12);
    if (c.rain < 1) CHECK(w.free + w.film <= 1e-3 * w.rain);
  }
}

/// The section of [Zhan] 4.5, rigid: ground held at p = 0 over clay under 500 kPa of suction.
vd::Solver<Plane> clay_slope(Real h) {
  const Real top = 12, crest = 10, toe = 21, foot = 5, length = 36;
  vd::Scene<Plane> scene({.box = {{0.0, 0.0}, {length, 14.0}}, .cell_size = h});
  scene.gravity = {0, -gravity};
  scene.liquid.bulk_modulus = 2.2e7;  // softened water
  const vd::Material<Plane> clay = {
      .name = "sandy clay",
      .porosity = 0.4,
      .lambda = 0.19,
      .retention = {.residual_saturation = 0.26, .a = 15.2, .porosity_dependent = false},
      .conductivity = {.saturated_conductivity = 0.082, .porosity_dependent = false}};
  const auto ground = [=](Real x) {
    return top - (top - foot) * std::min(1.0, std::max(0.0, (x - crest) / (toe - crest)));
  };
  scene.add_soil(
      vd::polygon({{0, 0}, {length, 0}, {length, foot}, {toe, foot}, {crest, top}, {0, top}}), clay,
      {.points_per_cell = 4, .liquid_pressure = [=](const Vec<2>& x) {
         return -5e5 + 1000 * gravity * (ground(x[0]) - x[1]);
       }});
  scene.add(vd::bc::ZeroSuction{});
  return vd::Solver<Plane>(scene);
}

/// rms error of S over squares of 0.5 m in the soil against Richards' equation in 2D.
Real clay_error(const vd::Solver<Plane>& solver, Real t) {
  static const verify::Table table("richards_clay_slope.csv");
  std::map<std::pair<int, int>, verify::Norm> computed;
  verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
    computed[{static_cast<int>(cell.centroid[0] / 0.5), static_cast<int>(cell.centroid[1] / 0.5)}]
        .add(cell.saturation);
  });
  verify::Norm norm;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table.number(i, "t_s") != t) continue;
    const auto found = computed.find({static_cast<int>(table.number(i, "x_m") / 0.5),
                                      static_cast<int>(table.number(i, "y_m") / 0.5)});
    if (found != computed.end()) norm.add(found->second.mean() - table.number(i, "S"));
  }
  REQUIRE(norm.count > 1000);
  return norm.rms();
}

/// Largest of the errors of a slope of clay at 1, 2 and 5 s.
Real clay_errors() {
  static const Real largest = [] {
    Real worst = 0;
    auto solver = clay_slope(0.5);
    for (const Real t : {1.0, 2.0, 5.0}) {
      solver.advance_to(t);
      const Real error = clay_error(solver, t);
      MESSAGE("clay t ", t, ": rms S ", error, ", inflow ", solver.water_balance().inflow / 1000,
              " m2, steps ", solver.steps());
      CHECK(std::fabs(solver.water_balance().relative_closure()) <= 1e-12);
      worst = std::max(worst, error);
    }
    return worst;
  }();
  return largest;
}

}  // namespace

TEST_CASE("rain below capacity on slopes of 1:2 and 1:1 enters whole") {
  check_slope({.rain = 0.3, .bulk_modulus = 1e5, .times = {100}}, 1e-3);
  check_slope({.fall = 1, .name = "1:1", .rain = 0.3, .bulk_modulus = 1e5, .times = {100}}, 1e-3);
}
TEST_CASE("rain above capacity on a slope of 1:2 to 200 s") {
  check_slope({.bulk_modulus = 1e5, .times = {200}}, 0.05);
}

TEST_SUITE("long") {
  TEST_CASE("wetting of a slope of clay against Richards' equation in 2D") {
    CHECK(clay_errors() <= 0.045);
  }
  // Measured 0.032, 0.034 and 0.039 at 1, 2 and 5 s, inflow to 5 s 15.10 of 15.46 m2: the front is 0.5 m
  // wide, one of the paper's cells.
  TEST_CASE("known miss: wetting of a slope of clay within 0.02" * doctest::may_fail()) {
    CHECK(clay_errors() <= 0.02);
  }
  TEST_CASE("rain above capacity on a slope of 1:2 to 600 s") {
    check_slope({.times = {200, 300, 600}}, 0.05);
  }
  TEST_CASE("rain above capacity on a slope of 1:1 to 600 s") {
    check_slope({.fall = 1, .name = "1:1", .times = {200, 300, 600}}, 0.05);
  }
}
