// SPDX-License-Identifier: MIT
// The semi-implicit scheme at the true compressibility of water, K = 2.2 GPa: the references and
// bounds of the explicit one, in far fewer steps.

#include <doctest/doctest.h>

#include "../seepage.hpp"
#include "../unit/restart_support.hpp"
#include "cases/liakopoulos.hpp"
#include "cases/terzaghi.hpp"
#include "cases/unsaturated_consolidation.hpp"
#include "verify_support.hpp"

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;
using vd::scheme::SemiImplicit;

using Saturated = vd::SaturatedModel<vd::Uniaxial>;
using Strip = vd::SaturatedModel<vd::PlaneStrain>;
using Rigid = vadose_test::Seepage<vd::Uniaxial>;
using Elastic = vd::UnsaturatedModel<vd::Uniaxial>;

using Dry = vd::DryModel<vd::Uniaxial>;

constexpr Real gravity = 9.81;

/// Pressure of a cell at the end of the last step [Pa].
template <class Cell>
Real end_pressure(const Cell& cell) {
  return cell.pressure + (cell.solved ? cell.change : 0);
}

template <class Solver>
void check_ledger(const Solver& solver) {
  CHECK(std::fabs(solver.water_balance().relative_closure()) <= 1e-12);
  CHECK(solver.state().limited_water == 0);
}

/// Terzaghi's column of [Zhan] Table 1, 10 cells.
vd::Solver<Saturated, SemiImplicit> terzaghi(Real conductivity, Real load, Real factor) {
  vd::Scene<Saturated> scene({.box = {Vec<1>(0.0), Vec<1>(1.2)}, .cell_size = 0.1});
  auto material = verify::saturated_soil<Saturated>(conductivity);
  material.conductivity.porosity_dependent = false;
  scene.add_soil(vd::box(Vec<1>(0.0), Vec<1>(1.0)), material,
                 {.liquid_pressure = [=](const Vec<1>&) { return factor * load; }});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  scene.add(
      vd::bc::Traction<1>{.region = vd::box(Vec<1>(0.95), Vec<1>(1.0)), .traction = Vec<1>(-load)});
  scene.add(vd::bc::ZeroSuction{});
  return vd::Solver<Saturated, SemiImplicit>(scene);
}

/// [Zhan] 4.2 at h = 0.5 m: a pond of 0.5 m on 10 m of clay.
template <class M>
vd::Solver<M, SemiImplicit> ponded() {
  constexpr bool rigid = std::is_same_v<M, Rigid>;
  vd::Scene<M> scene({.box = {Vec<1>(0.0), Vec<1>(11.0)}, .cell_size = 0.5});
  scene.gravity[0] = -gravity;
  vd::SoilOptions<1> options{.water_table = 10 - 114e3 / (1000 * gravity)};
  auto clay = [] {
    if constexpr (rigid)
      return vd::Material<M>{
          .name = "clay",
          .porosity = verify::table1::porosity,
          .lambda = verify::table1::lambda,
          .retention = {.a = verify::table1::a, .porosity_dependent = false},
          .conductivity = {.saturated_conductivity = verify::table1::conductivity,
                           .porosity_dependent = false}};
    else
      return verify::clay<M>();
  }();
  if constexpr (!rigid) {
    options.initial_stress = vd::InitialStress::geostatic;
    scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  }
  scene.add_soil(vd::box({0.0}, {10.0}), clay, options);
  scene.add_water(vd::box({10.0}, {10.5}), {.surface_level = 10.5});
  vd::Solver<M, SemiImplicit> solver(scene, {.damping = rigid ? 0.0 : 0.05});
  if constexpr (!rigid)
    REQUIRE(solver.equilibrate({.tolerance = 1e-5, .max_time = 20}).residual < 1e-4);
  return solver;
}

/// rms error of S over the cells against the profile of a case and time.
template <class M>
Real profile_error(const vd::Solver<M, SemiImplicit>& solver, const std::string& name, Real t) {
  static const verify::Table table("r3_pond_profiles.csv");
  std::vector<std::pair<Real, Real>> rows;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.text(i, "case") == name && table.number(i, "t_s") == t)
      rows.emplace_back(table.number(i, "z_m"), table.number(i, "Sr"));
  REQUIRE(rows.size() > 2);
  verify::Norm norm;
  verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
    std::size_t i = 1;
    while (i + 1 < rows.size() && rows[i].first < cell.centroid[0]) ++i;
    const auto [za, sa] = rows[i - 1];
    const auto [zb, sb] = rows[i];
    norm.add(cell.saturation -
             (sa + std::min(1.0, (cell.centroid[0] - za) / (zb - za)) * (sb - sa)));
  });
  return norm.rms();
}

/// Checks profiles and, at the end, what is left of the pond [m].
template <class M>
void check_pond(const std::string& name, Real end, Real expected_left, std::int64_t most_steps) {
  auto solver = ponded<M>();
  for (const Real t : {50.0, 100.0, 200.0}) {
    solver.advance_to(t);
    const Real error = profile_error(solver, name, t);
    MESSAGE(name, " t ", t, " s: rms S ", error, ", steps ", solver.steps());
    CHECK(error <= 0.01);
  }
  solver.advance_to(end);
  const auto w = solver.water_balance();
  MESSAGE(name, " t ", end, " s: pond ", (w.free + w.film) / 1000, " m, expected ", expected_left,
          ", steps ", solver.steps());
  CHECK(verify::close((w.free + w.film) / 1000, expected_left, 0.02));
  CHECK(solver.steps() <= most_steps);
  check_ledger(solver);
}

/// 2 m of rigid sand, tests/reference/richards.py; it ends a part `cut` of a cell higher.
vd::Scene<Rigid> sand_column(Real h, Real cut = 0) {
  vd::Scene<Rigid> scene({.box = {Vec<1>(0.0), Vec<1>(2.4)}, .cell_size = h});
  scene.gravity[0] = -gravity;
  const vd::Material<Rigid> sand = {
      .name = "sand",
      .porosity = 0.4,
      .lambda = 0.63,
      .retention = {.a = 3, .porosity_dependent = false},
      .conductivity = {.saturated_conductivity = 1e-4, .porosity_dependent = false}};
  scene.add_soil(vd::box({0.0}, {2.0}), sand, {.saturation = 0.3});
  if (cut > 0)
    scene.add_soil(vd::box({2.0}, {2 + cut * h}), sand, {.points_per_cell = 4, .saturation = 0.3});
  return scene;
}

vd::Solver<Rigid, SemiImplicit> rained(Real h, Real rate) {
  auto scene = sand_column(h);
  scene.add(vd::bc::Rain{.rate = rate});
  return vd::Solver<Rigid, SemiImplicit>(scene, {.saturation_step = 0.01});
}

Real richards(const std::string& name, Real t, const std::string& column) {
  static const verify::Table table("richards_history.csv");
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.number(i, "t_s") == t && table.text(i, "case") == name)
      return table.number(i, column);
  FAIL("no row ", name, " at ", t);
  return 0;
}

Real rain_error(const vd::Solver<Rigid, SemiImplicit>& solver, const std::string& name, Real h) {
  static const verify::Table table("richards_profiles.csv");
  verify::Norm norm;
  verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
    verify::Norm mean;
    for (std::size_t i = 0; i < table.size(); ++i)
      if (table.number(i, "t_s") == std::round(solver.time()) && table.text(i, "case") == name &&
          std::fabs(table.number(i, "z_m") - cell.centroid[0]) < 0.5 * h)
        mean.add(table.number(i, "S"));
    REQUIRE(mean.count > 0);
    norm.add(cell.saturation - mean.mean());
  });
  return norm.rms();
}

constexpr Real edge = 0.1, column_level = 1.3;

/// Saturated soil of 1 m under 0.3 m of water, 4 cells wide.
vd::Solver<Strip, SemiImplicit> resting(Real jitter, const vd::SolverOptions<Strip>& options = {}) {
  vd::Scene<Strip> scene({.box = {Vec<2>(0, 0), Vec<2>(0.4, 1.5)}, .cell_size = edge});
  scene.gravity[1] = -gravity;
  scene.add_soil(vd::box(Vec<2>(0, 0), Vec<2>(0.4, 1)), verify::saturated_soil<Strip>(),
                 {.points_per_cell = 4,
                  .jitter = jitter,
                  .seed = 7,
                  .water_table = column_level,
                  .initial_stress = vd::InitialStress::geostatic});
  scene.add_water(vd::box(Vec<2>(0, 1), Vec<2>(0.4, column_level)),
                  {.points_per_cell = 4, .surface_level = column_level});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  scene.add(vd::bc::Roller{.face = vd::Face::left});
  scene.add(vd::bc::Roller{.face = vd::Face::right});
  return vd::Solver<Strip, SemiImplicit>(scene, options);
}

/// Largest |p - hydrostatic| at the end of any step until t [Pa].
Real run_at_rest(vd::Solver<Strip, SemiImplicit>& solver, Real t) {
  verify::Norm norm;
  while (solver.time() < t) {
    const auto step = solver.step(t);
    if (step.status != vd::Status::ok) FAIL(step.text());
    for (const auto kind : {vd::CellKind::soil, vd::CellKind::free})
      verify::for_cells(solver, kind, [&](const auto& cell) {
        norm.add(end_pressure(cell) - 1000 * gravity * (column_level - cell.centroid[1]));
      });
  }
  return norm.max;
}

constexpr Real strip_pressure = 1e4;

/// Soil 2 m wide and 1 m deep under a strip of 10 kPa on its left quarter, which comes within 0.05 s.
vd::Solver<Strip, SemiImplicit> strip(int columns, Real conductivity,
                                      const vd::SolverOptions<Strip>& options = {}) {
  const Real h = 2.0 / columns;
  vd::Scene<Strip> scene({.box = {Vec<2>(0, 0), Vec<2>(2, 1 + 2 * h)}, .cell_size = h});
  scene.add_soil(vd::box(Vec<2>(0, 0), Vec<2>(2, 1)), verify::saturated_soil<Strip>(conductivity),
                 {.points_per_cell = 4, .liquid_pressure = [](const Vec<2>&) { return 0.0; }});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  scene.add(vd::bc::Roller{.face = vd::Face::left});
  scene.add(vd::bc::Roller{.face = vd::Face::right});
  scene.add(vd::bc::Traction<2>{.region = vd::box(Vec<2>(0, 1 - h / 2), Vec<2>(0.5, 1)),
                                .traction = Vec<2>(0, -strip_pressure),
                                .time_factor = [](Real t) { return std::min(1.0, t / 0.05); }});
  scene.add(vd::bc::ZeroSuction{});
  return vd::Solver<Strip, SemiImplicit>(scene, options);
}

/// Pressures over the load in its cells.
std::vector<Real> strip_pressures(const vd::Solver<Strip, SemiImplicit>& solver, int columns) {
  const Real h = 2.0 / columns;
  std::vector<Real> p(static_cast<std::size_t>(columns * columns / 2), 0.0);
  verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
    const int i = static_cast<int>(cell.centroid[0] / h),
              j = static_cast<int>(cell.centroid[1] / h);
    p[static_cast<std::size_t>(i + columns * j)] = end_pressure(cell) / strip_pressure;
  });
  return p;
}

/// The same right after loading, undrained.
std::vector<Real> strip_load(int columns) {
  auto solver = strip(columns, 1e-8);
  solver.advance_to(0.2);
  MESSAGE(columns, " columns: ", solver.last_step().text());
  check_ledger(solver);
  return strip_pressures(solver, columns);
}

}  // namespace

TEST_CASE("semi-implicit: Terzaghi within 1 % of the load in a nineteenth of the steps") {
  const Real stiffness = verify::oedometric_modulus(10e6, 0.33), load = 1e4;
  const Real pores = verify::table1::porosity / verify::table1::bulk_modulus;
  const Real factor = 1 / (1 + stiffness * pores);
  for (const Real k : {1e-3, 1e-4}) {
    auto solver = terzaghi(k, load, factor);
    for (const Real tv : {0.05, 0.1, 0.3, 0.6}) {
      solver.advance_to(tv * 9810 * (1 / stiffness + pores) / k);
      verify::Norm norm;
      verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
        const Real depth = 1 - cell.centroid[0];
        norm.add(end_pressure(cell) / load -
                 factor * verify::terzaghi_mean(depth - 0.05, depth + 0.05, tv));
      });
      MESSAGE("k ", k, " Tv ", tv, ": rms ", 100 * norm.rms(), " % of the load, steps ",
              solver.steps());
      CHECK(norm.rms() <= 0.01);
      check_ledger(solver);
    }
    if (k == 1e-3) CHECK(solver.steps() <= 14853 / 15);  // the explicit scheme's
  }
}

namespace {

vd::Material<Elastic> moist_sand() {
  return {.solid_density = 2650,
          .porosity = 0.4,
          .lambda = 0.63,
          .skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.3},
          .retention = {.residual_saturation = 0.05, .a = 3},
          .conductivity = {.saturated_conductivity = 1e-6}};
}

/// Of the solid points, all as heavy [m].
template <class Solver>
Real mean_height(const Solver& solver) {
  Real sum = 0, count = 0;
  solver.solid().for_each([&](std::size_t b, int l) {
    sum += solver.solid().at(vd::field::position, b)[l];
    ++count;
  });
  return sum / count;
}

using Column = verify::Variant<vd::shape::Gimp, vd::transfer::Flip, SemiImplicit>;

}  // namespace

TEST_CASE("semi-implicit: tight clay in more than fifty times the step of waves in the skeleton") {
  const verify::Terzaghi clay{.conductivity = 1e-6};
  const auto run = verify::run<Column>(clay, {.cells = 10});
  const Real waves = 0.5 * 0.1 *
                     std::sqrt((1 - verify::table1::porosity) * verify::table1::solid_density /
                               verify::Terzaghi::stiffness());
  const Real step = clay.seconds(clay.times.back()) / static_cast<Real>(run.steps);
  for (const auto& c : run.comparisons) {
    MESSAGE("Tv ", c.time, ": rms ", 100 * c.norm().rms(), " % of the load, steps ", run.steps,
            ", ", step / waves, " times that of waves");
    CHECK(c.norm().rms() <= 0.01);
  }
  CHECK(step >= 50 * waves);
}

namespace {

/// Unsaturated consolidation at its true conductivity in quasi-static steps; returns their number.
std::int64_t consolidate(Real young_modulus, vd::SlowSkeleton skeleton) {
  const verify::UnsaturatedConsolidation clay{.young_modulus = young_modulus,
                                              .speed_up = 1,
                                              .quasi_static = {.on = true, .skeleton = skeleton}};
  const auto exact = clay.closed_form();
  auto solver = clay.column<Column>({.cells = 10}, clay.load, [t_full = clay.ramp()](Real t) {
    return std::min(Real(1), t / t_full);
  });
  for (const Real tv : clay.times) {
    solver.advance_to(clay.seconds(tv));
    verify::Norm norm;
    verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
      const Real depth = 1 - cell.centroid[0];
      norm.add((end_pressure(cell) + exact.suction) / clay.load -
               exact.undrained() * verify::terzaghi_mean(depth - 0.05, depth + 0.05, tv));
    });
    MESSAGE("E ", young_modulus, " Pa, Tv ", tv, ": rms ", 100 * norm.rms(),
            " % of the load, steps ", solver.steps(), ", ", solver.last_step().text());
    CHECK(norm.rms() <= 0.01);
    check_ledger(solver);
  }
  CHECK(solver.steps() < 10000);  // waves in the skeleton bound the step to 1 ms: 7e6 steps
  return solver.steps();
}

}  // namespace

TEST_CASE("quasi-static: unsaturated consolidation at its true conductivity") {
  for (const Real young_modulus : {3e6, 10e6}) {
    const std::int64_t solved = consolidate(young_modulus, vd::SlowSkeleton::implicit);
    // Added inertia is what a solution for the skeleton has to beat.
    CHECK(2 * solved <= consolidate(young_modulus, vd::SlowSkeleton::heavy));
  }
}

TEST_CASE("quasi-static: drainage of Liakopoulos' column at its true conductivity") {
  const verify::Liakopoulos sand{
      .speed_up = 1, .bulk_modulus = 2.2e9, .quasi_static = {.on = true}};
  const auto run = verify::run<Column>(sand, {.cells = 20});
  for (const auto& c : run.comparisons) {
    MESSAGE(c.quantity, " at ", c.time, " s: rms ", c.norm().rms(), ", steps ", run.steps);
    CHECK(c.norm().rms() <= 0.02);
  }
}

// A fifth of the consolidation under a strip, against a run whose steps waves in the skeleton bound.
TEST_CASE("quasi-static: consolidation under a strip as by dynamics") {
  constexpr int columns = 10;
  constexpr Real end = 50, conductivity = 3e-6;
  auto dynamic = strip(columns, conductivity, {.damping = 0.5});
  auto slow = strip(columns, conductivity, {.quasi_static = {.on = true}});
  dynamic.advance_to(end);
  slow.advance_to(end);
  const auto p = strip_pressures(slow, columns), wanted = strip_pressures(dynamic, columns);
  verify::Norm pressures, displacements;
  for (std::size_t i = 0; i < p.size(); ++i) pressures.add(p[i] - wanted[i]);
  Real largest = 0;
  std::vector<Real> settlements;
  dynamic.solid().for_each([&](std::size_t b, int l) {
    settlements.push_back(dynamic.displacement(b, l)[1]);
    largest = std::max(largest, std::fabs(settlements.back()));
  });
  std::size_t i = 0;
  slow.solid().for_each([&](std::size_t b, int l) {
    displacements.add((slow.displacement(b, l)[1] - settlements[i++]) / largest);
  });
  MESSAGE("rms of p ", 100 * pressures.rms(), " % of the load, of the settlement ",
          100 * displacements.rms(), " % of its ", 1000 * largest, " mm; steps ", slow.steps(),
          " of ", dynamic.steps(), ", ", slow.last_step().text());
  CHECK(pressures.rms() <= 0.005);
  CHECK(displacements.rms() <= 0.005);
  CHECK(4 * slow.steps() <= dynamic.steps());  // the first 0.5 s are dynamic in both
  check_ledger(slow);
}

// A block at rest on a support that is taken away after 100 s: from then on it falls freely.
TEST_CASE("quasi-static: a block that loses its support falls as it must") {
  constexpr Real h = 0.1, support_ends = 100;
  vd::Scene<Elastic> scene({.box = {Vec<1>(0.0), Vec<1>(3.0)}, .cell_size = h});
  scene.gravity = Vec<1>(-gravity);
  scene.add_soil(vd::box(Vec<1>(2.0), Vec<1>(2.5)), moist_sand(), {.saturation = 0.6});
  const Real weight = gravity * 0.5 * (2650 * 0.6 + 1000 * 0.4 * 0.6);
  scene.add(
      vd::bc::Traction<1>{.region = vd::box(Vec<1>(2.0), Vec<1>(2 + 0.5 * h)),
                          .traction = Vec<1>(weight),
                          .time_factor = [=](Real t) { return t < support_ends ? 1.0 : 0.0; }});
  vd::Solver<Elastic, SemiImplicit> solver(scene, {.quasi_static = {.on = true}});
  solver.advance_to(support_ends);
  const Real start = mean_height(solver);
  MESSAGE("before: ", solver.last_step().text());
  CHECK(solver.steps() < 40000);
  for (const Real t : {0.1, 0.2, 0.3}) {
    solver.advance_to(support_ends + t);
    const Real fall = start - mean_height(solver);
    MESSAGE("after ", t, " s: fallen ", fall, " of ", 0.5 * gravity * t * t, " m, ",
            solver.last_step().text());
    CHECK(verify::close(fall, 0.5 * gravity * t * t, 0.01));
    CHECK(solver.last_step().solve.inertia == 1);
    CHECK_FALSE(solver.last_step().solve.skeleton);
  }
}

TEST_CASE("quasi-static steps are refused where no scheme or model knows them") {
  vd::Scene<Elastic> scene({.box = {Vec<1>(0.0), Vec<1>(3.0)}, .cell_size = 0.1});
  scene.add_soil(vd::box(Vec<1>(2.0), Vec<1>(2.5)), moist_sand(), {.saturation = 0.6});
  CHECK_THROWS_WITH_AS(vd::Solver<Elastic>(scene, {.quasi_static = {.on = true}}),
                       doctest::Contains("quasi_static.on"), vd::SetupError);
  const auto refused = [&](vd::QuasiStatic choice, const char* name) {
    CHECK_THROWS_WITH_AS((vd::Solver<Elastic, SemiImplicit>(scene, {.quasi_static = choice})),
                         doctest::Contains(name), vd::SetupError);
  };
  refused({.on = true, .inertia = 0}, "inertia");
  refused({.on = true, .inertia = 0.1, .dynamic = 0.1}, "dynamic");
  refused({.on = true, .damping = 1}, "damping");
}

TEST_CASE("semi-implicit: 10 m of rigid clay under a pond, 400 s in at most 800 steps") {
  check_pond<Rigid>("rigid_pond0.5", 400, 0.2155, 800);
}

TEST_CASE("semi-implicit: rain below and above what sand can take") {
  auto below = rained(0.1, 0.3e-4);
  for (const Real t : {600.0, 1500.0, 3000.0, 4500.0}) {
    below.advance_to(t);
    const auto w = below.water_balance();
    const Real error = rain_error(below, "rain0.3", 0.1);
    MESSAGE("0.3 k, t ", t, ": rms S ", error, ", steps ", below.steps());
    CHECK(error <= 0.015);
    CHECK(verify::close((w.pore - w.initial) / 1000, richards("rain0.3", t, "inflow_m"), 0.01));
    check_ledger(below);
  }
  auto above = rained(0.05, 3e-4);
  for (const Real t : {300.0, 600.0, 1200.0}) {
    above.advance_to(t);
    const auto w = above.water_balance();
    MESSAGE("3 k, t ", t, ": pond ", (w.film + w.free) / 1000, " m, Richards ",
            richards("rain3", t, "pond_m"), ", taken ", (w.pore - w.initial) / 1000, ", Richards ",
            richards("rain3", t, "inflow_m"), ", steps ", above.steps());
    CHECK(verify::close((w.film + w.free) / 1000, richards("rain3", t, "pond_m"), 0.05));
    CHECK(verify::close((w.pore - w.initial) / 1000, richards("rain3", t, "inflow_m"), 0.02));
    check_ledger(above);
  }
}

TEST_CASE("semi-implicit: zero suction on ground that cuts cells") {
  for (const Real cut : {0.0, 0.25, 0.5, 0.75}) {
    auto scene = sand_column(0.1, cut);
    scene.add(vd::bc::ZeroSuction{});
    vd::Solver<Rigid, SemiImplicit> solver(scene);
    for (const Real t : {300.0, 600.0, 1200.0}) {
      solver.advance_to(t);
      const auto w = solver.water_balance();
      const Real error =
          (w.inflow - w.outflow) / 1000 / richards("zero_suction", t, "inflow_m") - 1;
      MESSAGE("cut ", cut, " t ", t, ": inflow ", 100 * error, " %, steps ", solver.steps());
      CHECK(std::fabs(error) <= 0.05);
      check_ledger(solver);
    }
  }
}

TEST_CASE("semi-implicit: still water over soil stays still") {
  for (const Real jitter : {0.0, 0.2}) {
    auto solver = resting(jitter);
    solver.equilibrate({.tolerance = 1e-9, .max_time = 1});
    const Real error = run_at_rest(solver, 1);
    MESSAGE("jitter ", jitter, ": largest |dp| ", error, " Pa, steps ", solver.steps());
    CHECK(error <= (jitter > 0 ? 3 : 1e-3));
    check_ledger(solver);
  }
}

TEST_CASE("semi-implicit: undrained strip load without checkerboard") {
  const auto coarse = strip_load(20), fine = strip_load(40);
  const auto at = [&](int i, int j) { return coarse[static_cast<std::size_t>(i + 20 * j)]; };
  Real coherent = 0;
  int count = 0;
  for (int j = 1; j < 8; ++j)
    for (int i = 1; i < 19; ++i) {
      const Real residual =
          at(i, j) - 0.5 * (at(i - 1, j) + at(i + 1, j) + at(i, j - 1) + at(i, j + 1)) +
          0.25 * (at(i - 1, j - 1) + at(i + 1, j - 1) + at(i - 1, j + 1) + at(i + 1, j + 1));
      coherent += ((i + j) % 2 ? -1 : 1) * residual / 4;
      ++count;
    }
  MESSAGE("coherent checkerboard ", 100 * coherent / count, " % of the load");
  CHECK(std::fabs(coherent / count) <= 1e-3);
  for (int j = 4; j < 9; ++j) {  // cells beside the axis of the load
    Real mean = 0;
    for (int k = 0; k < 4; ++k)
      mean += 0.25 * fine[static_cast<std::size_t>(k % 2 + 40 * (2 * j + k / 2))];
    MESSAGE("depth ", 0.95 - 0.1 * j, " m: p/q ", at(0, j), ", finer ", mean);
    CHECK(verify::close(at(0, j), mean, 0.02));
  }
}

TEST_CASE("semi-implicit: same bits for any number of threads") {
  std::vector<Real> first;
  for (const int threads : {1, 2, 3}) {
    auto solver = resting(0.2, {.threads = threads});
    for (int i = 0; i < 40; ++i) REQUIRE(solver.step().status == vd::Status::ok);
    std::vector<Real> values;
    solver.liquid().for_each([&](std::size_t b, int l) {
      for (int d = 0; d < 2; ++d)
        values.push_back(solver.liquid().at(vd::field::velocity, b, d)[l]);
      values.push_back(solver.liquid().at(vd::field::liquid_pressure, b)[l]);
    });
    if (threads == 1) first = values;
    CHECK(values == first);
  }
}

TEST_CASE("semi-implicit: a run that is saved and taken up again has the same bits") {
  const auto check = [](auto run, Real first) {
    run.advance_to(first);
    auto other = run;
    REQUIRE(restart_test::steps(other, 2));
    for (int i = 0; i < 6; ++i) restart_test::check_taken_up(run, other, 5);
    CHECK(run.last_step().solve.newton > 0);
  };
  check(rained(0.1, 3e-4), 1);  // limited by the change of saturation: the next step is in the file
  check(ponded<Rigid>(), 0.1);
  check(terzaghi(1e-4, 1e4, 1), 1e-3);
  check(resting(0.2), 1e-3);
  const verify::UnsaturatedConsolidation clay{.speed_up = 1, .quasi_static = {.on = true}};
  check(clay.column<Column>({.cells = 10}, clay.load, {}), 20);
}

TEST_CASE("dry soil takes the explicit step, to the last bit") {
  vd::Scene<Dry> scene({.box = {Vec<1>(0.0), Vec<1>(1.2)}, .cell_size = 0.1});
  scene.gravity = Vec<1>(-gravity);
  scene.add_soil(vd::box(Vec<1>(0.0), Vec<1>(1.0)),
                 {.solid_density = 2600,
                  .porosity = 0.4,
                  .skeleton = {.young_modulus = 1e7, .poisson_ratio = 0.3}});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  vd::Solver<Dry, SemiImplicit> solver(scene);
  vd::Solver<Dry> explicit_solver(scene);
  for (int i = 0; i < 50; ++i) CHECK(solver.step().dt == explicit_solver.step().dt);
  CHECK(solver.last_step().solve.newton == 0);
  solver.solid().for_each([&](std::size_t b, int l) {
    CHECK(solver.solid().at(vd::field::position, b)[l] ==
          explicit_solver.solid().at(vd::field::position, b)[l]);
    CHECK(solver.displacement(b, l)[0] < 0);
  });
}

TEST_SUITE("long") {
  TEST_CASE("quasi-static: still water over soil stays still for ten minutes") {
    for (const Real jitter : {0.0, 0.2}) {
      auto solver = resting(jitter, {.quasi_static = {.on = true}});
      solver.equilibrate({.tolerance = 1e-9, .max_time = 1});
      const Real error = run_at_rest(solver, 600);
      MESSAGE("jitter ", jitter, ": largest |dp| ", error, " Pa, ", solver.last_step().text());
      CHECK(error <= (jitter > 0 ? 25 : 1e-3));
      check_ledger(solver);
    }
  }
  TEST_CASE("semi-implicit: 10 m of elastic clay under a pond") {
    check_pond<Elastic>("full_pond0.5", 500, 0.1402, 250000);
  }
}
