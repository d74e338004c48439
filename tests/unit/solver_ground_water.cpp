// SPDX-License-Identifier: MIT
// Water at walls and at the ground: heads, reservoirs, drains, seepage faces, switches.

#include <doctest/doctest.h>

#include <cmath>

#include <vadose/solver/solver.hpp>

#include "../seepage.hpp"

namespace {

namespace vd = vadose;
using vd::Face;
using vd::Real;
using vd::Vec;

using vadose_test::Seepage;
using Column = Seepage<vd::Uniaxial>;
using Strip = Seepage<vd::PlaneStrain>;
using Elastic = vd::UnsaturatedModel<vd::Uniaxial>;

/// Sand of 1 m height with a water table; softened water.
template <class M>
vd::Scene<M> ground(Real water_table, Real width = 0.3) {
  constexpr int dim = M::Kinematics::dim, up = dim - 1;
  Vec<dim> low = Vec<dim>::Zero(), high = Vec<dim>::Constant(width), top;
  high[up] = 1.2;
  top = high;
  top[up] = 1;
  vd::Scene<M> scene({.box = {low, high}, .cell_size = 0.1});
  scene.gravity[up] = -9.81;
  scene.liquid.bulk_modulus = 1e6;
  vd::Material<M> sand = {
      .name = "sand",
      .porosity = 0.4,
      .lambda = 0.63,
      .retention = {.a = 3, .porosity_dependent = false},
      .conductivity = {.saturated_conductivity = 1e-3, .porosity_dependent = false}};
  vd::SoilOptions<dim> options{.water_table = water_table};
  if constexpr (!std::is_same_v<typename M::Skeleton, vd::law::Rigid>) {
    sand.solid_density = 2650;
    sand.skeleton = {.young_modulus = 1e6, .poisson_ratio = 0.3};
    options.initial_stress = vd::InitialStress::geostatic;
    scene.liquid.bulk_modulus = 1e8;  // the weight of compressed water is not in that stress
  }
  scene.add_soil(vd::box(low, top), sand, options);
  return scene;
}

void check_closed(const vd::WaterBalance& w) {
  CHECK(std::fabs(w.relative_closure()) <= 1e-12);
}

/// Water that passed relative to the water there.
Real passed(const vd::WaterBalance& w) {
  return (w.inflow + w.outflow) / w.initial;
}

}  // namespace

TEST_CASE("soil under a reservoir at rest stays at rest") {
  for (const Real level : {1.0, 2.5}) {
    auto rigid = ground<Strip>(level);
    rigid.add(vd::bc::Reservoir{.level = level});
    vd::Solver<Strip> a(rigid);
    auto elastic = ground<Elastic>(level);
    elastic.add(vd::bc::Fixed{.face = Face::bottom});
    elastic.add(vd::bc::Reservoir{.level = level});
    vd::Solver<Elastic> b(elastic);
    a.advance_to(0.5);
    b.advance_to(0.5);
    CAPTURE(level);
    CHECK(passed(a.water_balance()) < 1e-9);
    CHECK(passed(b.water_balance()) < 1e-6);
    b.solid().for_each(
        [&](std::size_t i, int l) { CHECK(std::fabs(b.displacement(i, l)[0]) < 2e-6); });
    check_closed(a.water_balance());
    check_closed(b.water_balance());
  }
}

TEST_CASE("a reservoir that falls beside soil drains it through a seepage face") {
  auto scene = ground<Strip>(0.9);
  scene.add(
      vd::bc::Reservoir{.face = Face::right, .function = [](Real t) { return t < 1 ? 0.9 : 0.3; }});
  vd::Solver<Strip> solver(scene);
  solver.advance_to(1);
  CHECK(passed(solver.water_balance()) < 1e-6);
  solver.advance_to(30);
  const auto low = solver.water_balance();
  CHECK(low.outflow > 0.03 * low.initial);
  CHECK(low.inflow < 1e-6 * low.initial);
  check_closed(low);
}

TEST_CASE("a reservoir that rises beside soil wets it") {
  auto scene = ground<Strip>(0.2);
  scene.add(vd::bc::Reservoir{.face = Face::left, .level = 0.8});
  vd::Solver<Strip> solver(scene);
  solver.advance_to(20);
  const auto w = solver.water_balance();
  CHECK(w.inflow > 0.1 * w.initial);
  check_closed(w);
}

TEST_CASE("a prescribed head at rest moves no water; a lower one drains") {
  auto rest = ground<Strip>(0.5);
  rest.add(vd::bc::PrescribedHead{.face = Face::right, .head = 0.5});
  vd::Solver<Strip> a(rest);
  a.advance_to(1);
  CHECK(passed(a.water_balance()) < 1e-9);
  auto lower = ground<Strip>(0.5);
  lower.add(vd::bc::PrescribedHead{.face = Face::right, .function = [](Real) { return 0.2; }});
  vd::Solver<Strip> b(lower);
  b.advance_to(5);
  CHECK(b.water_balance().outflow > 10 * b.water_balance().inflow);
  check_closed(b.water_balance());
}

TEST_CASE("drains and seepage faces let water out and none in") {
  // Under suction at the base nothing passes; with a water table it drains.
  auto dry = ground<Column>(-0.5);
  dry.add(vd::bc::SeepageFace{.face = Face::bottom});
  vd::Solver<Column> a(dry);
  a.advance_to(2);
  CHECK(passed(a.water_balance()) == 0);
  auto wet = ground<Column>(0.5);
  wet.liquid.bulk_modulus = 2e5;  // for longer steps; what drains and rests hardly depends on it
  wet.add(vd::bc::Drain{.face = Face::bottom, .pressure = 1000});
  vd::Solver<Column> b(wet);
  b.advance_to(1000);  // 1.1 % from rest
  const auto w = b.water_balance();
  CHECK(w.inflow == 0);
  CHECK(w.outflow > 0.05 * w.initial);
  // At rest again: 1000 Pa at the base.
  CHECK(b.liquid().at(vd::field::liquid_pressure, 0)[0] ==
        doctest::Approx(1000 - 9810 * b.liquid().at(vd::field::position, 0)[0]).epsilon(0.02));
  check_closed(w);
}

TEST_CASE("grains that fly off the ground draw no more water after them than its head drives") {
  constexpr Real conductivity = 0.1, suction = 200, h = 0.1, end = 0.01;
  vd::Scene<Elastic> scene({.box = {Vec<1>(0.0), Vec<1>(1.2)}, .cell_size = h});
  scene.liquid.bulk_modulus = 1e7;
  scene.add_soil(
      vd::box(Vec<1>(0.3), Vec<1>(0.8)),
      {.solid_density = 2650,
       .porosity = 0.4,
       .lambda = 0.63,
       .skeleton = {.young_modulus = 1e4, .poisson_ratio = 0.3},
       .retention = {.a = 3, .porosity_dependent = false},
       .conductivity = {.saturated_conductivity = conductivity, .porosity_dependent = false}},
      {.suction = suction});
  scene.add(vd::bc::ZeroSuction{});
  vd::Solver<Elastic> solver(scene);
  auto& grains = solver.mutable_state().solid;
  grains.for_each([&](std::size_t b, int l) { grains.at(vd::field::velocity, b)[l] = 2; });
  // Both ends of the block take up water, through half a cell or more.
  Real most = 0;
  while (solver.time() < end) {
    solver.step();
    Real low = 0;
    for (const auto& cell : solver.state().nodes.cell)
      if (cell.kind == vd::CellKind::soil) low = std::min(low, cell.pressure);
    most += 2 * conductivity * -low / (9810 * 0.5 * h) * solver.last_step().dt;
  }
  const auto w = solver.water_balance();
  MESSAGE("inflow ", w.inflow / 1000, " m, at most ", most, " m");
  CHECK(w.inflow > 0);
  CHECK(w.inflow / 1000 <= most);
  check_closed(w);
}

TEST_CASE("conditions switch in time, and an impermeable part closes what another opens") {
  auto scene = ground<Column>(-1);
  scene.add(vd::bc::ZeroSuction{.active = [](Real t) { return t >= 1; }});
  vd::Solver<Column> solver(scene);
  solver.advance_to(1);
  CHECK(solver.water_balance().inflow == 0);
  solver.advance_to(3);
  CHECK(solver.water_balance().inflow > 0);

  const auto inflow = [](bool covered) {
    auto s = ground<Strip>(-1, 0.4);
    s.add(vd::bc::ZeroSuction{});
    if (covered) s.add(vd::bc::Impermeable{.region = vd::box({0.0, 0.0}, {0.2, 1.2})});
    vd::Solver<Strip> run(s);
    run.advance_to(1);
    return run.water_balance().inflow;
  };
  CHECK(inflow(true) / inflow(false) == doctest::Approx(0.5).epsilon(0.02));
}

TEST_CASE("conditions that contradict each other are refused") {
  const auto refuses = [](const auto& first, const auto& second, const char* what) {
    auto scene = ground<Strip>(0.5);
    scene.add(first);
    CHECK_THROWS_WITH_AS(scene.add(second), doctest::Contains(what), vd::SetupError);
  };
  refuses(vd::bc::Reservoir{.level = 1}, vd::bc::ZeroSuction{},
          "bc::ZeroSuction contradicts bc::Reservoir");
  refuses(vd::bc::Drain{.face = Face::left}, vd::bc::PrescribedHead{.face = Face::left, .head = 0},
          "bc::PrescribedHead contradicts bc::Drain");
  refuses(vd::bc::Impermeable{.face = Face::left}, vd::bc::SeepageFace{.face = Face::left},
          "bc::Drain contradicts bc::Impermeable");
  auto scene = ground<Strip>(0.5);
  CHECK_THROWS_AS(scene.add(vd::bc::Reservoir{.face = Face::left}), vd::SetupError);
  CHECK_THROWS_AS(scene.add(vd::bc::PrescribedHead{.head = 1}), vd::SetupError);
  CHECK_THROWS_AS(scene.add(vd::bc::Drain{.pressure = vd::unset}), vd::SetupError);
  scene.add(vd::bc::Reservoir{.face = Face::left, .level = 1});
  scene.add(vd::bc::Drain{.face = Face::right});
  scene.add(vd::bc::Rain{.rate = 1e-6});
}

namespace {

/// A dam of water on flat tight ground breaks; its right wall is a drain.
vd::Solver<Strip> broken_dam(vd::Escape escaped) {
  vd::Scene<Strip> scene({.box = {{0.0, 0.0}, {1.0, 0.8}}, .cell_size = 0.1});
  scene.gravity = {0, -9.81};
  scene.liquid.bulk_modulus = 1e6;
  scene.add_soil(vd::box({0.0, 0.0}, {1.0, 0.2}),
                 {.name = "sand",
                  .porosity = 0.4,
                  .lambda = 0.63,
                  .retention = {.a = 3, .porosity_dependent = false},
                  .conductivity = {.saturated_conductivity = 1e-3, .porosity_dependent = false}},
                 {.saturation = 0.3});
  scene.add_water(vd::box({0.0, 0.2}, {0.5, 0.6}), {.surface_level = 0.6});
  scene.add(vd::bc::Drain{.face = Face::right});
  return vd::Solver<Strip>(scene, {.transfer = {.pic_rate = 5}, .escaped = escaped});
}

}  // namespace

TEST_CASE("points that leave the box: refused, counted out, or kept in") {
  auto strict = broken_dam(vd::Escape::error);
  CHECK_THROWS_WITH_AS(strict.advance_to(2), doctest::Contains("points inside the box"),
                       vd::InstabilityError);
  auto open = broken_dam(vd::Escape::outflow);
  open.advance_to(2);
  const auto w = open.water_balance();
  MESSAGE("lost ", w.lost, " of ", w.initial, " kg, pore ", w.pore, ", free ", w.free, ", film ",
          w.film, ", closure ", w.relative_closure());
  CHECK(w.lost > 0.2 * w.initial);
  check_closed(w);
  CHECK(open.solid_balance().lost == 0);
  auto kept = broken_dam(vd::Escape::clamp);
  kept.advance_to(2);
  CHECK(kept.water_balance().lost == 0);
  check_closed(kept.water_balance());
}
