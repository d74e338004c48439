// SPDX-License-Identifier: MIT

// What the solver promises its host: exact times, reports, errors that name their cause, checked
// options, equilibrium, estimates, conditions that open during a run.

#include <doctest/doctest.h>

#include "kernel_support.hpp"

namespace {

using namespace kernel_test;
namespace field = vadose::field;
using vadose::Status;

using Plane = Dry<vadose::PlaneStrain>;
using Wet = Saturated<vadose::PlaneStrain>;
using Moist = Unsaturated<vadose::PlaneStrain>;

/// A block that flies through a box, without gravity.
vadose::Scene<Plane> flying_block(const Vec<2>& velocity) {
  vadose::Scene<Plane> scene({.box = {{0, 0}, {1, 1}}, .cell_size = 0.1});
  scene.add_soil(vadose::box({0.3, 0.3}, {0.6, 0.6}), soil<Plane>(), {.velocity = velocity});
  return scene;
}

/// Message of the SetupError that bad options raise; empty if none is raised.
template <class Change>
std::string option_error(Change&& change) {
  vadose::SolverOptions<Plane> options;
  change(options);
  try {
    const vadose::Solver<Plane> solver(flying_block({0, 0}), options);
  } catch (const vadose::SetupError& error) {
    return error.what();
  }
  return {};
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A uniaxial column that stands on its bottom.
template <class M>
vadose::Scene<M> column(Real height, int cells, vadose::SoilOptions<1> options = {}) {
  vadose::Scene<M> scene({.box = {Vec<1>(0.0), Vec<1>(1.2 * height)}, .cell_size = height / cells});
  scene.gravity = Vec<1>(-9.81);
  scene.liquid.bulk_modulus = 2e7;
  scene.add_soil(vadose::box<1>(Vec<1>(0.0), Vec<1>(height)), soil<M>(), options);
  scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
  return scene;
}

}  // namespace

TEST_CASE("advance_to ends at the time asked for, to the last bit") {
  vadose::Solver<Plane> solver(flying_block({0.3, 0.1}));
  for (const Real t : {1e-5, 0.01, 1.0 / 30, 0.1}) {
    solver.advance_to(t);
    CHECK(solver.time() == t);
  }
  const std::int64_t steps = solver.steps();
  solver.advance_to(0.1);  // no time left: no step
  solver.advance_to(0.05);
  CHECK(solver.steps() == steps);
  CHECK(solver.time() == 0.1);
}

TEST_CASE("a step reports time, size, number and what limited it") {
  vadose::Solver<Plane> solver(flying_block({0.3, 0.1}));
  Real time = 0;
  for (int i = 1; i <= 5; ++i) {
    const vadose::StepReport r = solver.step();
    CHECK(r.status == Status::ok);
    CHECK(r.step == i);
    CHECK(solver.steps() == i);
    CHECK(r.dt > 0);
    CHECK(r.time == time + r.dt);
    CHECK(r.time == solver.time());
    CHECK(r.limit == vadose::StepLimit::skeleton);
    CHECK(r.trouble.criterion == nullptr);
    time = r.time;
  }
  // h / sqrt(E_c / rho), halved.
  const auto sand = soil<Plane>();
  const Real wave = std::sqrt(sand.skeleton.p_wave_modulus() / (2600 * 0.6));
  CHECK(solver.last_step().dt == doctest::Approx(0.5 * 0.1 / wave).epsilon(1e-3));
  const vadose::StepReport last = solver.step(time + 1e-6);
  CHECK(last.dt == doctest::Approx(1e-6).epsilon(1e-6));
  CHECK(last.limit == vadose::StepLimit::end);
  CHECK(contains(last.text(), "end time"));
  CHECK(solver.last_step().step == last.step);
}

TEST_CASE("fast points limit the step by their motion") {
  vadose::Solver<Plane> solver(flying_block({50, 0}), {.displacement_cap = 0.05});
  const vadose::StepReport r = solver.step();
  CHECK(r.limit == vadose::StepLimit::motion);
  CHECK(r.dt == doctest::Approx(0.05 * 0.1 / 50).epsilon(1e-12));
}

TEST_CASE("a point driven out of the box stops the run and is named") {
  // No wall of the grid holds a point that is already beyond it.
  vadose::Solver<Plane> solver(flying_block({0, 0}));
  auto& points = solver.mutable_state().solid;
  std::int64_t id = -1;
  points.for_each([&](std::size_t b, int l) {
    if (id >= 0) return;
    id = static_cast<std::int64_t>(points.at(field::id, b)[l]);
    points.at(field::position, b, 0)[l] = -0.02;
  });
  try {
    solver.advance_to(1);
    FAIL("no error was raised");
  } catch (const vadose::InstabilityError& error) {
    const vadose::StepReport& r = error.report();
    CHECK(r.status == Status::failed);
    CHECK(std::string(r.trouble.criterion) == "points inside the box");
    CHECK(std::string(r.trouble.phase) == "solid");
    CHECK(r.trouble.id == id);
    CHECK(r.trouble.position[0] == doctest::Approx(-0.02).epsilon(1e-3));
    CHECK(r.step == 1);
    const std::string text = error.what();
    CHECK(contains(text, "points inside the box"));
    CHECK(contains(text, "solid point " + std::to_string(id)));
    CHECK(contains(text, "unstable"));
    CHECK(contains(text, "-0.02"));
  }
}

TEST_CASE("a velocity that is not a number is caught in that very step") {
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  for (const Real wild : {nan, 1e6, std::numeric_limits<Real>::infinity()}) {
    vadose::Solver<Plane> solver(flying_block({0.1, 0}));
    REQUIRE(run(solver, 3));
    solver.mutable_state().solid.at(field::velocity, 0, 1)[0] = wild;
    const vadose::StepReport r = solver.step();
    CHECK(r.status == Status::failed);
    CHECK(r.step == 4);
    REQUIRE(r.trouble.criterion != nullptr);
    CHECK(std::string(r.trouble.phase) == "solid");
    CHECK(r.trouble.id >= 0);
  }
  vadose::Scene<Wet> scene({.box = {{0, 0}, {1, 1}}, .cell_size = 0.1});
  scene.add_soil(vadose::box({0, 0}, {0.5, 0.5}), soil<Wet>());
  vadose::Solver<Wet> solver(scene);
  REQUIRE(run(solver, 2));
  solver.mutable_state().liquid.at(field::velocity, 0, 0)[0] = nan;
  CHECK(solver.step().status == Status::failed);
}

TEST_CASE("bad options are refused by name and range") {
  using Options = vadose::SolverOptions<Plane>;
  CHECK(option_error([](Options&) {}).empty());
  const std::string place = "solver options";
  const auto check = [&](const std::string& error, const std::string& name) {
    CHECK(contains(error, name + " = "));
    CHECK(contains(error, place));
  };
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  check(option_error([](Options& o) { o.courant = 0; }), "courant");
  check(option_error([](Options& o) { o.courant = 4.5; }), "courant");
  check(option_error([&](Options& o) { o.courant = nan; }), "courant");
  check(option_error([](Options& o) { o.damping = -0.1; }), "damping");
  check(option_error([](Options& o) { o.damping = 1; }), "damping");
  check(option_error([&](Options& o) { o.damping = nan; }), "damping");
  check(option_error([](Options& o) { o.displacement_cap = 0; }), "displacement_cap");
  check(option_error([](Options& o) { o.displacement_cap = 0.3; }), "displacement_cap");
  check(option_error([](Options& o) { o.dt_max = 0; }), "dt_max");
  check(option_error([](Options& o) { o.free_relaxation = -1; }), "free_relaxation");
  check(option_error([](Options& o) { o.transfer.pic_rate = -1; }), "pic_rate");
  check(option_error([](Options& o) { o.threads = 0; }), "threads");
}

TEST_CASE("equilibrate brings a dry column to its weight") {
  using M = Dry<vadose::Uniaxial>;
  const Real height = 2;
  vadose::Solver<M> solver(column<M>(height, 20));
  const vadose::EquilibriumReport r = solver.equilibrate({.tolerance = 1e-6, .max_time = 20});
  CHECK(r.converged);
  CHECK(r.residual < 1e-6);
  CHECK(r.steps > 0);
  CHECK(solver.time() == 0);
  CHECK(solver.steps() == 0);
  CHECK(solver.state().options.damping == 0);
  CHECK_FALSE(solver.state().frozen);
  const Real unit_weight = 2600 * 0.6 * 9.81;
  solver.solid().for_each([&](std::size_t b, int l) {
    // Weight above the point's place in the undeformed column; K_0 = nu / (1 - nu) aside.
    const auto id = static_cast<int>(solver.solid().at(field::id, b)[l]);
    const Real depth = height - (id + 0.5) * height / 40;
    CHECK(solver.solid().at(field::bishop_stress, b, 0)[l] ==
          doctest::Approx(-unit_weight * depth).epsilon(0.02).scale(unit_weight * height));
    CHECK(solver.solid().at(field::velocity, b, 0)[l] == 0);
    CHECK(solver.displacement(b, l)[0] == 0);
  });
  // At rest it stays at rest.
  REQUIRE(run(solver, 100));
  solver.solid().for_each([&](std::size_t b, int l) {
    CHECK(std::fabs(solver.displacement(b, l)[0]) < 1e-7 * height);
  });
}

TEST_CASE("equilibrate that runs out of time says so") {
  using M = Dry<vadose::Uniaxial>;
  vadose::Solver<M> solver(column<M>(2, 20));
  const vadose::EquilibriumReport r = solver.equilibrate({.tolerance = 1e-12, .max_time = 0.01});
  CHECK_FALSE(r.converged);
  CHECK(r.time >= 0.01);
}

TEST_CASE("an estimate is positive and leaves the run alone") {
  vadose::Scene<Wet> scene({.box = {{0, 0}, {1, 1}}, .cell_size = 0.1});
  scene.add_soil(vadose::box({0, 0}, {0.5, 0.5}), soil<Wet>());
  const vadose::Solver<Wet> solver(scene);
  const auto before = by_id(solver.solid());
  const vadose::Estimate e = solver.estimate(0.5);
  CHECK(e.solid_points == 100);
  CHECK(e.liquid_points == 100);
  CHECK(e.blocks == static_cast<std::size_t>(solver.state().grid.slots()));
  CHECK(e.dt > 0);
  CHECK(e.limit == vadose::StepLimit::two_phase);
  CHECK(e.steps >= static_cast<std::int64_t>(0.5 / e.dt));
  CHECK(e.seconds > 0);
  CHECK(e.megabytes > 0);
  CHECK(contains(e.text(), "100 solid, 100 liquid"));
  CHECK(solver.steps() == 0);
  const auto after = by_id(solver.solid());
  for (const auto& [id, values] : before) CHECK(same_bits(values, after.at(id)));
}

TEST_CASE("zero suction opens during a run and its water is counted") {
  using M = Unsaturated<vadose::Uniaxial>;
  vadose::SoilOptions<1> options;
  options.saturation = 0.5;
  vadose::Solver<M> solver(column<M>(1, 10, options));
  solver.equilibrate({.tolerance = 1e-3, .max_time = 5});
  REQUIRE(run(solver, 50));
  const vadose::WaterBalance dry = solver.water_balance();
  CHECK(dry.inflow == 0);
  CHECK(dry.outflow == 0);
  CHECK(std::fabs(dry.relative_closure()) < 1e-13);
  solver.add(vadose::bc::ZeroSuction{});
  REQUIRE(run(solver, 200));
  const vadose::WaterBalance wet = solver.water_balance();
  CHECK(wet.inflow > 0);
  CHECK(wet.pore > dry.pore);
  CHECK(wet.pore - dry.pore == doctest::Approx(wet.inflow - wet.outflow).epsilon(1e-9));
  CHECK(std::fabs(wet.relative_closure()) < 1e-12);
  CHECK_THROWS_AS(
      solver.add(vadose::bc::ZeroSuction{.region = vadose::box({0.0, 0.0}, {1.0, 1.0})}),
      vadose::SetupError);
}

TEST_CASE("a copy of a solver runs on by itself, to the same bits") {
  vadose::Solver<Plane> solver(flying_block({0.3, 0.1}));
  REQUIRE(run(solver, 10));
  vadose::Solver<Plane> copy = solver;
  REQUIRE(run(solver, 20));
  REQUIRE(run(copy, 20));
  const auto a = by_id(solver.solid()), b = by_id(copy.solid());
  for (const auto& [id, values] : a) CHECK(same_bits(values, b.at(id)));
}
