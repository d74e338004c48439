// SPDX-License-Identifier: MIT
// The library inside a host: several solvers at once and in several threads, observers, and the cost
// of a run that is told beforehand.

#include <doctest/doctest.h>

#include <thread>

#include "../seepage.hpp"
#include "../slope.hpp"
#include "restart_support.hpp"

namespace {

namespace vd = vadose;
using vd::Real;

using Column = vadose_test::Seepage<vd::Uniaxial>;
using S = vd::Solver<Column>;

/// Soil without any condition.
vd::Scene<Column> dry_sky(Real saturation) {
  vd::Scene<Column> scene({.box = {{0.0}, {1.0}}, .cell_size = 0.05});
  scene.gravity[0] = -9.81;
  scene.liquid.bulk_modulus = 1e6;
  scene.add_soil(vd::box({0.0}, {0.8}),
                 {.name = "sand",
                  .porosity = 0.4,
                  .lambda = 0.63,
                  .retention = {.a = 3},
                  .conductivity = {.saturated_conductivity = 1e-4}},
                 {.saturation = saturation});
  return scene;
}
S column(Real saturation) {
  auto scene = dry_sky(saturation);
  scene.add(vd::bc::Rain{.rate = 1e-5});
  return S(scene);
}

}  // namespace

TEST_CASE("embedding: solvers in turns and in threads of the host have the bits of one alone") {
  const restart_test::TemporaryDirectory directory("embedding", true);
  const auto bytes = [&](const S& s) { return restart_test::bytes_of(s, directory); };
  const Real wet[3] = {0.4, 0.6, 0.8};
  std::string alone[3];
  for (int i = 0; i < 3; ++i) {
    S solver = column(wet[i]);
    REQUIRE(restart_test::steps(solver, 300));
    alone[i] = bytes(solver);
  }
  std::vector<S> turns, threads;
  for (const Real w : wet) turns.push_back(column(w)), threads.push_back(column(w));
  for (int step = 0; step < 300; ++step)
    for (S& solver : turns) solver.step();
  std::vector<std::thread> running;
  for (S& solver : threads)
    running.emplace_back([&solver] {
      for (int step = 0; step < 300; ++step) solver.step();
    });
  for (std::thread& t : running) t.join();
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(bytes(turns[i]) == alone[i]);
    CHECK(bytes(threads[i]) == alone[i]);
  }
}

TEST_CASE("embedding: an observer sees every step, may stop the run, and changes no bit") {
  const restart_test::TemporaryDirectory directory("embedding", true);
  S plain = column(0.5), watched = column(0.5);
  plain.advance_to(0.5);
  std::int64_t calls = 0;
  Real time = 0;
  watched.advance_to(0.5, [&](const vd::StepReport& report) {
    ++calls;
    CHECK(report.time > time);
    time = report.time;
  });
  CHECK(calls == watched.steps());
  CHECK(time == 0.5);
  CHECK(restart_test::bytes_of(plain, directory) == restart_test::bytes_of(watched, directory));
  struct Enough {};
  CHECK_THROWS_AS(watched.advance_to(1, [](const vd::StepReport&) { throw Enough{}; }), Enough);
  CHECK(watched.steps() == plain.steps() + 1);
}

TEST_CASE("embedding: the estimate goes on with the trend of the step, down to its floor") {
  using vd::detail::StepTrend;
  using vd::detail::TrialMark;
  // Steps of c / t from t = 1 s on, as a wetting front brings them about.
  const Real floor = 2e-3;
  const auto step_at = [](Real t) { return 0.02 / t; };
  std::vector<TrialMark> marks{{0, 1, 0}};
  Real t = 1;
  while (t < 3) {
    t += step_at(t);
    marks.push_back({0, t, marks.back().step + 1});
  }
  const StepTrend trend = StepTrend::of(marks);
  CHECK(trend.power == doctest::Approx(-1).epsilon(0.01));
  for (const Real end : {5.0, 50.0}) {
    std::int64_t steps = 0;
    for (Real now = t; now < end; now += std::max(floor, step_at(now))) ++steps;
    CHECK(trend.steps(t, end, floor) == doctest::Approx(static_cast<Real>(steps)).epsilon(0.01));
  }
  CHECK(trend.steps(t, t, floor) == 0);
  // Steps that only scatter have no trend.
  std::vector<TrialMark> even{{0, 1, 0}};
  for (int i = 0; i < 400; ++i)
    even.push_back({0, even.back().time + (i * 7919 % 13 < 6 ? 0.9e-2 : 1.1e-2), i + 1});
  const StepTrend none = StepTrend::of(even);
  CHECK(none.power == 0);
  CHECK(none.steps(5, 105, floor) == doctest::Approx(1e4).epsilon(0.02));
}

TEST_CASE("embedding: the estimate knows when rain and switched conditions come and go") {
  const auto spells_of = [](const vd::bc::Rain& rain) {
    auto scene = dry_sky(0.5);
    scene.add(rain);
    scene.add(vd::bc::Drained{.face = vd::Face::bottom, .active = [](Real t) { return t > 7; }});
    return vd::detail::find_spells(S(scene).state(), 10);
  };
  // Rain that stops, starts, grows by a tenth and threefold; the drain opens.
  const auto spells =
      spells_of({.table = {{0, 1e-4}, {1.2345, 0}, {4, 1e-4}, {5, 1.1e-4}, {6, 3e-4}}});
  const Real starts[] = {0, 1.2345, 4, 6, 7};
  const bool wetter[] = {true, false, true, true, true},
             drains[] = {false, true, false, false, false};
  REQUIRE(spells.size() == 5);
  for (std::size_t i = 0; i < 5; ++i) {
    CHECK(spells[i].start == doctest::Approx(starts[i]).epsilon(1e-6));
    CHECK(spells[i].end == (i < 4 ? spells[i + 1].start : 10));
    CHECK(spells[i].wetter == wetter[i]);
    CHECK(spells[i].drains == drains[i]);
  }
  // Rain like a wave makes no more than eight.
  CHECK(spells_of({.function = [](Real t) { return 1e-4 * (1 + std::sin(50 * t)); }}).size() <= 8);
}

TEST_CASE("embedding: the estimate tries what begins later, and lets the ground drain") {
  auto scene = dry_sky(0.3);
  scene.add(vd::bc::Rain{.function = [](Real t) { return t > 100 && t < 200 ? 1e-2 : 0.0; }});
  const S solver(scene);
  const vd::Estimate dry = solver.estimate(99, 0), rain = solver.estimate(200, 0.2),
                     after = solver.estimate(1000, 0.2);
  CHECK(dry.steps > 0);
  CHECK(rain.steps > 2 * dry.steps);
  CHECK(rain.steps <= static_cast<std::int64_t>(200 / rain.shortest_dt));
  // Wet soil below dry ground is not stiffer than soil under a pond.
  const Real drained = vd::detail::shortest_step(solver.state(), false);
  CHECK(drained >= rain.shortest_dt);
  CHECK(after.steps > rain.steps);
  CHECK(solver.steps() == 0);
}

TEST_CASE("embedding: no step of a wet column is below the floor of the estimate") {
  S solver = column(1);
  for (int i = 0; i < 20; ++i) REQUIRE(solver.step().status == vd::Status::ok);
  const Real floor = vd::detail::shortest_step(solver.state());
  CHECK(floor <= solver.last_step().dt * (1 + 1e-3));
  CHECK(floor == doctest::Approx(solver.last_step().dt).epsilon(0.01));
  CHECK(column(0.5).estimate(0.1, 0).shortest_dt <= floor * (1 + 1e-3));
}

TEST_CASE("embedding: no run takes more steps than the estimate has at most") {
  // Rain fills a column from S = 0.5 on; a block slides out of the cells that it fills.
  S wetting = column(0.5);
  const vd::Estimate wet = wetting.estimate(20, 0);
  CHECK(wet.most_steps > wet.steps);
  CHECK(wet.most_seconds >= wet.seconds);
  wetting.advance_to(20);
  CHECK(wetting.steps() <= wet.most_steps);
  CHECK(wetting.steps() >= wet.steps);

  vd::Scene<vadose_test::Slope> scene({.box = {{0, 0}, {2, 1}}, .cell_size = 0.1});
  scene.gravity = {5, -9.81};
  scene.liquid.bulk_modulus = 1e6;
  scene.add_soil(vd::box({0.2, 0.0}, {0.6, 0.3}),
                 {.name = "sand",
                  .solid_density = 2650,
                  .porosity = 0.4,
                  .lambda = 0.63,
                  .skeleton = {.elastic = {.young_modulus = 2e6, .poisson_ratio = 0.3},
                               .friction_angle = vd::degrees(30)},
                  .retention = {.a = 3},
                  .conductivity = {.saturated_conductivity = 1e-6}},
                 {.saturation = 0.9, .velocity = {0.5, 0}});
  vd::Solver<vadose_test::Slope> sliding(scene, {.escaped = vd::Escape::clamp});
  REQUIRE(vd::detail::can_slide(sliding.state()));
  const vd::Estimate slide = sliding.estimate(0.4, 0);
  sliding.advance_to(0.4);
  MESSAGE("a slide: ", slide.steps, " to ", slide.most_steps, " steps told, ", sliding.steps(),
          " taken");
  CHECK(sliding.steps() <= slide.most_steps);
  CHECK(slide.steps <= 1.3 * static_cast<Real>(sliding.steps()));
  CHECK(slide.steps >= 0.7 * static_cast<Real>(sliding.steps()));
}

TEST_CASE("embedding: the estimate of a short run counts its steps") {
  S solver = column(0.5);
  const vd::Estimate short_run = solver.estimate(0.05, 100);  // the trial reaches the end
  const vd::Estimate guessed = solver.estimate(2, 0);         // from the first steps
  solver.advance_to(0.05);
  CHECK(short_run.steps == solver.steps());
  CHECK(guessed.steps > short_run.steps);
  CHECK(guessed.seconds > 0);
}
