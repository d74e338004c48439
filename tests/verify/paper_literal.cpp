// SPDX-License-Identifier: MIT
// The printed equations of [Zhan], scheme::PaperLiteral, on the cases that the default scheme is held
// to: what each printed choice costs, in error and in steps. Bounds say what the scheme does, good or
// bad: it is the yardstick.

#include <doctest/doctest.h>

#include "../unit/restart_support.hpp"
#include "cases/terzaghi.hpp"
#include "cases/unsaturated_consolidation.hpp"
#include "check_case.hpp"

namespace {

namespace vd = vadose;
using vd::PaperMends;
using vd::Real;
using vd::Vec;
using verify::Terzaghi;
using verify::UnsaturatedConsolidation;

template <PaperMends Mends = PaperMends{}>
using Printed =
    verify::Variant<vd::shape::Gimp, vd::transfer::Flip, vd::scheme::PaperLiteral<Mends>>;
constexpr PaperMends implicit_drag{.implicit_drag = true};
constexpr PaperMends implicit_with_slope{.porosity_slope = true, .implicit_drag = true};

constexpr Real gravity = 9.81, porosity = verify::table1::porosity;
constexpr int cells = 10;

/// Errors of p over the load, in the order of the times of the case.
template <class V, class Case>
std::vector<Real> errors(const Case& problem) {
  const verify::Outcome outcome = verify::run<V>(problem, {.cells = cells});
  CHECK_MESSAGE(outcome.failure.empty(), outcome.failure);
  CHECK(outcome.closure <= 1e-14);
  std::vector<Real> result;
  for (const auto& c : outcome.comparisons) {
    result.push_back(c.norm().rms());
    MESSAGE(std::string(Case::name), ", Tv ", c.time, ": rms ", 100 * result.back(),
            " % of the load");
  }
  MESSAGE(outcome.steps, " steps in ", outcome.seconds, " s");
  return result;
}

/// dp/dq right after loading, mean over the column and over four periods of the wave by a Hann
/// window, as in unsaturated_consolidation.cpp.
template <class V>
Real undrained_ratio(UnsaturatedConsolidation column) {
  column.speed_up = 1;
  auto pair = column.pair<V>({.cells = cells});
  const Real end = 4 * 4 * UnsaturatedConsolidation::height / column.closed_form().wave_speed();
  Real sum = 0, weights = 0;
  while (pair.loaded.time() < end) {
    const auto step = pair.loaded.step();
    REQUIRE(step.status == vd::Status::ok);
    pair.idle.advance_to(step.time);
    const Real weight = step.dt * (1 - std::cos(2 * std::numbers::pi * step.time / end));
    pair.for_cells([&](Real z, Real p) {
      if (z > 0.9) return;  // the cell at the drained surface
      sum += weight * p / column.load;
      weights += weight;
    });
  }
  MESSAGE("dp/dq ", sum / weights, " in ", pair.loaded.steps(), " steps");
  return sum / weights;
}

using Saturated = verify::With<Terzaghi::Physics, Printed<>>;  // compiled for the column anyway
using PrintedSolver = vd::Solver<Saturated, vd::scheme::PaperLiteral<>>;

/// Saturated soil of 1 m under a pond, both at rest up to a level; 1: no pond.
vd::Scene<Saturated> pond(Real level = 1.3) {
  vd::Scene<Saturated> scene({.box = {Vec<1>(0.0), Vec<1>(1.5)}, .cell_size = 0.1});
  scene.gravity[0] = -gravity;
  scene.add_soil(vd::box(Vec<1>(0.0), Vec<1>(1.0)), verify::saturated_soil<Saturated>(),
                 {.water_table = level, .initial_stress = vd::InitialStress::geostatic});
  if (level > 1) scene.add_water(vd::box(Vec<1>(1.0), Vec<1>(level)), {.surface_level = level});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  return scene;
}

}  // namespace

TEST_CASE("printed equations: saturated homogeneous soil needs no mending") {
  // Bounds of the default scheme at 10 cells.
  const Terzaghi column{.conductivity = 1e-3};
  for (const Real e : errors<Printed<>>(column)) CHECK(e <= 0.005);
}

TEST_CASE("printed equations: a run that is saved and taken up again has the same bits") {
  PrintedSolver run(pond(1)), other(pond(1));
  REQUIRE(restart_test::steps(other, 3));
  for (int i = 0; i < 5; ++i) restart_test::check_taken_up(run, other, 20);
}

TEST_CASE("printed equations: the step of explicit drag") {
  const Real masses = porosity * 1000 / ((1 - porosity) * verify::table1::solid_density);
  for (const Real k : {1e-3, 1e-6}) {
    const Terzaghi column{.conductivity = k, .times = {1e-5}};
    const auto a = column.start<Printed<>>({.cells = cells}).step();
    const auto b = column.start<Printed<implicit_drag>>({.cells = cells}).step();
    MESSAGE("k ", k, " m/s: dt ", a.dt, " s (", std::string(vd::name(a.limit)), "), implicit ",
            b.dt, " s");
    CHECK(b.limit == vd::StepLimit::two_phase);
    // C times 2 k / (n g) / (1 + m_l / m_s).
    const Real stable = 0.5 * 2 * k / (porosity * gravity) / (1 + masses);
    CHECK(verify::close(a.dt, std::min(stable, b.dt), 1e-3));
    if (k > 1e-4) continue;
    CHECK(a.limit == vd::StepLimit::drag);
    CHECK(b.dt > 100 * a.dt);
    // The same answer.
    const Real error = errors<Printed<>>(column).front();
    CHECK(std::fabs(errors<Printed<implicit_drag>>(column).front() - error) <= 0.01);
  }
}

TEST_CASE("printed equations: Eq. (9) without n S_n Dn answers four times too much") {
  const UnsaturatedConsolidation column;
  const Real exact = column.closed_form().undrained();
  const Real without =
      UnsaturatedConsolidation{.porosity_dependent = false}.closed_form().undrained();
  CHECK(verify::close(undrained_ratio<Printed<implicit_drag>>(column), without, 0.02));
  CHECK(verify::close(undrained_ratio<Printed<implicit_with_slope>>(column), exact, 0.02));
  const Real late[] = {0.17, 0.14, 0.10, 0.04};
  const auto printed = errors<Printed<implicit_drag>>(column);
  const auto mended = errors<Printed<implicit_with_slope>>(column);
  REQUIRE(printed.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(printed[i] >= late[i]);
    CHECK(mended[i] <= 1e-3);
  }
}

// Eq. (20) takes n p V grad S point by point. Where n jumps at the ground under a pond the sum is not
// -n grad p: still water is pushed by (1 - n) p. And the porosity of step (a), weighted by mass, takes
// a node for soil as soon as a grain reaches it. The default scheme is at rest (rest_ponded.cpp).
TEST_CASE("printed equations: a pond at rest is pushed into the soil by (1 - n) p") {
  PrintedSolver solver(pond());
  const auto& state = solver.state();
  REQUIRE(solver.step().status == vd::Status::ok);
  Real force = 0;
  for (int i = 1; i <= state.grid.cells()[0]; ++i) {
    const auto e = static_cast<std::size_t>(state.grid.entry({i}));
    force += state.nodes.liquid_in[e][vd::lane::mass] *
             state.nodes.liquid_out[e][vd::lane::increment] / state.dt;
  }
  const Real p = 1000 * gravity * 0.3;
  MESSAGE("force on the water ", force, " Pa, (1 - n) p = ", (1 - porosity) * p, " Pa");
  CHECK(verify::close(force, -(1 - porosity) * p, 0.01));
  CHECK_THROWS_AS(solver.advance_to(0.01), vd::InstabilityError);
  MESSAGE("ends in step ", solver.steps());
}

TEST_CASE("printed equations: conditions without a natural form are refused") {
  auto scene = pond();
  scene.add(vd::bc::ZeroSuction{});
  PrintedSolver solver(scene);
  CHECK_THROWS_AS(solver.add(vd::bc::Rain{.rate = 1e-5}), vd::SetupError);
  CHECK_THROWS_AS(
      solver.add(vd::bc::PrescribedPressure<1>{.face = vd::Face::bottom, .pressure = 1}),
      vd::SetupError);
  solver.add(vd::bc::Drained{.face = vd::Face::bottom});
  scene.add(vd::bc::PrescribedHead{.face = vd::Face::bottom, .head = 1});
  CHECK_THROWS_AS(PrintedSolver{scene}, vd::SetupError);
}
