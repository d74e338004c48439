// SPDX-License-Identifier: MIT
// Walls with friction, prescribed motion, several soils in one scene.

#include <doctest/doctest.h>

#include <cmath>
#include <vadose/vadose.hpp>

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

using DryPlane = vd::DryModel<vd::PlaneStrain>;
using DryBar = vd::DryModel<vd::Uniaxial>;
using WetBar = vd::UnsaturatedModel<vd::Uniaxial>;

template <class Solver>
Real mean_velocity(const Solver& solver, int axis) {
  Real momentum = 0, mass = 0;
  solver.solid().for_each([&](std::size_t b, int l) {
    const Real m = solver.solid().at(vd::field::mass, b)[l];
    mass += m;
    momentum += m * solver.solid().at(vd::field::velocity, b, axis)[l];
  });
  return momentum / mass;
}

/// Acceleration of a stiff block on a floor with friction, gravity inclined by `slope` [rad].
Real sliding_acceleration(Real slope, Real friction) {
  vd::Scene<DryPlane> scene({.box = {{0, 0}, {4, 1}}, .cell_size = 0.1});
  scene.gravity = 9.81 * Vec<2>(std::sin(slope), -std::cos(slope));
  scene.add_soil(vd::box({0.5, 0.0}, {1.1, 0.2}),
                 {.solid_density = 2600,
                  .porosity = 0.4,
                  .skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.3}},
                 {.initial_stress = vd::InitialStress::none});
  scene.add(vd::bc::Frictional{.face = vd::Face::bottom, .friction_coefficient = friction});
  vd::Solver<DryPlane> solver(scene, {.damping = 0.0, .transfer = {.pic_rate = 200}});
  solver.advance_to(0.1);
  const Real early = mean_velocity(solver, 0);
  solver.advance_to(0.3);
  return (mean_velocity(solver, 0) - early) / 0.2;
}

/// Settlement of the top of a column of two layers under gravity at rest.
Real layered_settlement(Real lower_modulus, Real upper_modulus) {
  const auto soil = [](Real young) {
    return vd::Material<DryBar>{.solid_density = 2600,
                                .porosity = 0.4,
                                .skeleton = {.young_modulus = young, .poisson_ratio = 0.33}};
  };
  vd::Scene<DryBar> scene({.box = {{0.0}, {1.2}}, .cell_size = 0.05});
  scene.gravity[0] = -9.81;
  scene.add_soil(vd::box({0.0}, {0.499}), soil(lower_modulus));
  scene.add_soil(vd::box({0.501}, {1.0}), soil(upper_modulus));
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  vd::Solver<DryBar> solver(scene, {.damping = 0.2});
  solver.advance_to(0.5);
  Real lowest = 0;
  solver.solid().for_each(
      [&](std::size_t b, int l) { lowest = std::min(lowest, solver.displacement(b, l)[0]); });
  return -lowest;
}

}  // namespace

TEST_CASE("a block slides down a wall with friction at g (sin - mu cos), or stays") {
  const Real slope = vd::degrees(30);
  for (const Real mu : {0.0, 0.2, 0.4})
    CHECK(sliding_acceleration(slope, mu) ==
          doctest::Approx(9.81 * (std::sin(slope) - mu * std::cos(slope))).epsilon(0.02));
  CHECK(std::fabs(sliding_acceleration(slope, 0.8)) < 0.02);
}

TEST_CASE("two soils in one scene settle each by its own stiffness") {
  const Real weight = 0.6 * 2600 * 9.81;
  const auto modulus = [](Real young) { return young * 0.67 / (1.33 * 0.34); };
  const auto expected = [&](Real lower, Real upper) {
    // weight per height w: lower half carries w (1 - z), upper half w (1 - z).
    return weight * (0.375 / modulus(lower) + 0.125 / modulus(upper));
  };
  CHECK(layered_settlement(10e6, 2e6) == doctest::Approx(expected(10e6, 2e6)).epsilon(0.01));
  CHECK(layered_settlement(2e6, 10e6) == doctest::Approx(expected(2e6, 10e6)).epsilon(0.01));
}

TEST_CASE("two unsaturated soils in one scene stay at the same hydrostatic pressure") {
  const auto soil = [](Real a, Real lambda, Real k) {
    vd::Material<WetBar> m{.solid_density = 2600,
                           .porosity = 0.4,
                           .lambda = lambda,
                           .skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.33}};
    m.retention.a = a;
    m.conductivity.saturated_conductivity = k;
    return m;
  };
  vd::Scene<WetBar> scene({.box = {{0.0}, {1.2}}, .cell_size = 0.1});
  scene.gravity[0] = -9.81;
  const vd::SoilOptions<1> start{.water_table = -1.0,
                                 .initial_stress = vd::InitialStress::geostatic};
  scene.add_soil(vd::box({0.0}, {0.499}), soil(12, 0.09, 9.8e-4), start);
  scene.add_soil(vd::box({0.501}, {1.0}), soil(3, 0.63, 1e-4), start);
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  vd::Solver<WetBar> solver(scene, {.damping = 0.05});
  REQUIRE(solver.equilibrate({.tolerance = 1e-8, .max_time = 5}).residual < 1e-6);
  for (int i = 0; i < 2000; ++i) REQUIRE(solver.step().status == vd::Status::ok);
  Real worst = 0;
  solver.liquid().for_each([&](std::size_t b, int l) {
    const Real z = solver.liquid().at(vd::field::position, b)[l];
    const Real p = solver.liquid().at(vd::field::liquid_pressure, b)[l];
    worst = std::max(worst, std::fabs(p + 9810 * (1 + z)));
  });
  CHECK(worst < 1);
  CHECK(std::fabs(solver.water_balance().relative_closure()) < 1e-12);
}

TEST_CASE("prescribed velocity drives the nodes of its region and only those components") {
  vd::Scene<DryPlane> scene({.box = {{0, 0}, {1, 1}}, .cell_size = 0.1});
  scene.add_soil(vd::box({0.2, 0.2}, {0.8, 0.8}),
                 {.solid_density = 2600,
                  .porosity = 0.4,
                  .skeleton = {.young_modulus = 1e6, .poisson_ratio = 0.3}});
  scene.add(vd::bc::PrescribedVelocity<2>{.region = vd::box({0.0, 0.0}, {1.0, 1.0}),
                                          .velocity = Vec<2>(0.1, vd::unset)});
  vd::Solver<DryPlane> solver(scene, {.transfer = {.pic_rate = 1e4}});
  solver.advance_to(0.2);
  CHECK(mean_velocity(solver, 0) == doctest::Approx(0.1).epsilon(1e-6));
  CHECK(std::fabs(mean_velocity(solver, 1)) < 1e-12);
}
