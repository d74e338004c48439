// SPDX-License-Identifier: MIT

// What a closed system keeps: mass, momentum, angular momentum. Two bodies fly and collide, far
// from walls and without gravity.

#include <doctest/doctest.h>

#include "kernel_support.hpp"

namespace {

using namespace kernel_test;
namespace law = vadose::law;
namespace shape = vadose::shape;
namespace transfer = vadose::transfer;
using vadose::PlaneStrain;
using vadose::ThreeDimensional;

/// Two blocks that meet off centre; their momenta do not cancel.
template <class M>
vadose::Scene<M> two_bodies(Real suction = 1e4) {
  constexpr int dim = M::Kinematics::dim;
  const Real h = 0.1;
  Vec<dim> top, low_a, high_a, low_b, high_b;
  vadose::SoilOptions<dim> a, b;
  const Real extent = dim == 2 ? 0.5 : 0.3;
  for (int d = 0; d < dim; ++d) {
    top[d] = d == 0 ? 2.4 : 1.6;
    low_a[d] = 0.53 + 0.04 * d;
    high_a[d] = low_a[d] + extent;
    low_b[d] = low_a[d] + (d == 0 ? extent + 0.08 : 0.11);
    high_b[d] = low_b[d] + extent;
    a.velocity[d] = 1.3 - 0.9 * d;
    b.velocity[d] = -0.9 + 0.8 * d;
  }
  if constexpr (vadose::is_unsaturated<M>) {
    a.suction = suction;
    b.suction = 0.7 * suction;
  }
  vadose::Scene<M> scene({.box = {Vec<dim>::Zero(), top}, .cell_size = h});
  scene.liquid.bulk_modulus = 2e7;
  scene.add_soil(vadose::box<dim>(low_a, high_a), soil<M>(), a);
  scene.add_soil(vadose::box<dim>(low_b, high_b), soil<M>(), b);
  return scene;
}

template <class M>
Total momentum(const vadose::Solver<M>& solver) {
  Total total;
  add_momentum<M::Kinematics::dim>(solver.solid(), total);
  if constexpr (vadose::has_liquid<M>) add_momentum<M::Kinematics::dim>(solver.liquid(), total);
  return total;
}

/// Largest stress of a point [Pa]: shows that the bodies did touch.
template <class M>
Real largest_stress(const vadose::Solver<M>& solver) {
  Real most = 0;
  solver.solid().for_each([&](std::size_t b, int l) {
    for (int i = 0; i < vadose::State<M>::stress_size; ++i)
      most = std::max(most, std::fabs(solver.solid().at(vadose::field::bishop_stress, b, i)[l]));
  });
  return most;
}

/// Runs through the collision and checks mass and momentum on the way.
template <class M>
void check_linear(int steps, Real courant = 0.5) {
  const vadose::Scene<M> scene = two_bodies<M>();
  vadose::Solver<M> solver(scene, {.courant = courant});
  const Total start = momentum(solver);
  const Wide solid = total_mass(solver.solid());
  Wide liquid = 0;
  if constexpr (vadose::has_liquid<M>) liquid = total_mass(solver.liquid());
  for (int part = 0; part < 5; ++part) {
    REQUIRE(run(solver, steps / 5));
    CHECK(momentum(solver).relative_to(start) < 1e-12);
    CHECK(total_mass(solver.solid()) == solid);  // no mass of a solid point ever changes
    if constexpr (vadose::has_liquid<M>)
      CHECK(std::fabs(total_mass(solver.liquid()) - liquid) < 1e-13L * liquid);
  }
  CHECK(std::fabs(solver.solid_balance().relative_closure()) < 1e-13);
  if constexpr (vadose::has_liquid<M>)
    CHECK(std::fabs(solver.water_balance().relative_closure()) < 1e-12);
  CHECK(largest_stress(solver) > 1e3);
}

/// The same for the angular momentum, with blocks that also spin.
template <class M>
void check_angular(int steps) {
  constexpr int dim = M::Kinematics::dim;
  const vadose::Scene<M> scene = two_bodies<M>();
  vadose::Solver<M> solver(scene);
  auto& points = solver.mutable_state().solid;
  points.for_each([&](std::size_t b, int l) {
    const Real x = points.at(vadose::field::position, b, 0)[l] - 1.1;
    const Real y = points.at(vadose::field::position, b, 1)[l] - 0.8;
    points.at(vadose::field::velocity, b, 0)[l] -= 0.7 * y;
    points.at(vadose::field::velocity, b, 1)[l] += 0.7 * x;
  });
  const Total start = angular_momentum<dim>(solver.solid());
  for (int part = 0; part < 5; ++part) {
    REQUIRE(run(solver, steps / 5));
    CHECK(angular_momentum<dim>(solver.solid()).relative_to(start) < 1e-12);
  }
  CHECK(largest_stress(solver) > 1e3);
}

template <class K, class Law, class Tr>
using Body = Dry<K, Law, Tr>;
template <class K>
using Spline = Dry<K, law::LinearElastic, transfer::Apic, shape::QuadraticBSpline>;

}  // namespace

TEST_CASE_TEMPLATE("two dry bodies collide in the plane and keep mass and momentum", M,
                   Body<PlaneStrain, law::LinearElastic, transfer::Flip>,
                   Body<PlaneStrain, law::LinearElastic, transfer::Apic>,
                   Body<PlaneStrain, law::LinearElastic, transfer::Tpic>,
                   Body<PlaneStrain, law::DruckerPrager, transfer::Flip>) {
  check_linear<M>(200);
}

TEST_CASE_TEMPLATE("two dry bodies collide in space and keep mass and momentum", M,
                   Body<ThreeDimensional, law::LinearElastic, transfer::Tpic>,
                   Body<ThreeDimensional, law::DruckerPrager, transfer::Flip>,
                   Body<ThreeDimensional, law::DruckerPrager, transfer::Apic>) {
  check_linear<M>(200);
}

TEST_CASE_TEMPLATE("affine transfer keeps the angular momentum of spinning, colliding bodies", M,
                   Body<PlaneStrain, law::LinearElastic, transfer::Apic>, Spline<PlaneStrain>,
                   Body<ThreeDimensional, law::DruckerPrager, transfer::Apic>) {
  check_angular<M>(200);
}

TEST_CASE("saturated bodies collide and keep mass and momentum of both phases together") {
  check_linear<Saturated<PlaneStrain>>(400);
}

TEST_CASE("unsaturated bodies collide and keep mass and momentum of both phases together") {
  check_linear<Unsaturated<PlaneStrain>>(400);
}

TEST_CASE("mass of soil and free water is kept while they collide") {
  using M = Saturated<PlaneStrain>;
  vadose::Scene<M> scene({.box = {{0, 0}, {2.4, 1.6}}, .cell_size = 0.1});
  scene.liquid.bulk_modulus = 2e7;
  scene.add_soil(vadose::box({0.53, 0.57}, {1.03, 1.07}), soil<M>(), {.velocity = {0.5, 0}});
  scene.add_water(vadose::box({1.16, 0.68}, {1.56, 1.18}), {.velocity = {-0.5, 0.1}});
  vadose::Solver<M> solver(scene, {.courant = 0.3});
  const Wide solid = total_mass(solver.solid()), liquid = total_mass(solver.liquid());
  REQUIRE(run(solver, 150));
  CHECK(total_mass(solver.solid()) == solid);
  CHECK(std::fabs(total_mass(solver.liquid()) - liquid) < 1e-12L * liquid);
  CHECK(std::fabs(solver.water_balance().relative_closure()) < 1e-12);
}

namespace {

/// A block of moist soil falls into water.
void check_fall(Real saturation, Real courant) {
  using M = Unsaturated<PlaneStrain>;
  vadose::Scene<M> scene({.box = {{0, 0}, {1.6, 1.6}}, .cell_size = 0.1});
  scene.gravity = {0, -9.81};
  scene.liquid.bulk_modulus = 2e6;
  scene.add_soil(vadose::box({0.6, 0.62}, {1.0, 1.02}), soil<M>(),
                 {.saturation = saturation, .velocity = {0, -0.5}});
  scene.add_water(vadose::box({0.0, 0.0}, {1.6, 0.5}), {.surface_level = 0.5});
  vadose::Solver<M> solver(scene, {.courant = courant});
  CAPTURE(courant);
  const Wide solid = total_mass(solver.solid());
  while (solver.time() < 0.25) REQUIRE(solver.step(0.25).status == vadose::Status::ok);
  const auto w = solver.water_balance();
  MESSAGE("soil in water: pore ", w.pore, " of ", w.initial, " kg, free ", w.free, ", closure ",
          w.relative_closure(), ", steps ", solver.steps());
  CHECK(total_mass(solver.solid()) == solid);
  CHECK(std::fabs(w.relative_closure()) < 1e-12);
  CHECK(w.pore + w.free + w.film == doctest::Approx(w.initial).epsilon(1e-12));
}

}  // namespace

TEST_CASE("moist soil falls into water: the ledger closes, at any step size") {
  for (const Real courant : {0.2, 0.25, 0.3}) check_fall(0.5, courant);
}

// Water weighs its pressure force by its mass at a node, so that it rests in any arrangement of
// points; what that takes from the balance is counted, and with it the balance closes.
TEST_CASE("free water collides: momentum closes with the counted impulse") {
  using M = vadose::FreeWaterModel<PlaneStrain>;
  vadose::Scene<M> scene({.box = {{0, 0}, {2.4, 1.6}}, .cell_size = 0.1});
  scene.liquid.bulk_modulus = 2e7;
  scene.add_water(vadose::box({0.53, 0.57}, {1.03, 1.07}), {.velocity = {1.3, 0.4}});
  scene.add_water(vadose::box({1.16, 0.68}, {1.66, 1.18}), {.velocity = {-0.9, -0.1}});
  vadose::Solver<M> solver(scene, {.courant = 0.3});
  const Total start = momentum(solver);
  REQUIRE(run(solver, 300));
  Total end = momentum(solver);
  for (int d = 0; d < 2; ++d)
    end.sum[static_cast<std::size_t>(d)] += solver.state().open_impulse[d];
  CHECK(end.relative_to(start) < 1e-12);
}

namespace {

/// A block under uniform pressure and no total stress, anywhere on the grid, at any speed.
template <class M>
void check_uniform_pressure(Real pressure, Real shift, Real speed, Real bound) {
  vadose::Scene<M> scene({.box = {{0, 0}, {1.6, 1.6}}, .cell_size = 0.1});
  scene.liquid.bulk_modulus = 2e7;
  const Real low = 0.4 + shift;
  vadose::SoilOptions<2> start;
  start.velocity = {speed, 0.3 * speed};
  start.liquid_pressure = [=](const Vec<2>&) { return pressure; };
  scene.add_soil(vadose::box({low, low}, {low + 0.6, low + 0.6}), soil<M>(), start);
  vadose::Solver<M> solver(scene);
  auto& state = solver.mutable_state();
  Real saturation = 1;
  if constexpr (vadose::is_unsaturated<M>)
    saturation = vadose::swrc::saturation<Real>(state.soils[0].material.retention, -pressure,
                                                state.soils[0].material.porosity);
  state.solid.for_each([&](std::size_t b, int l) {
    for (int i = 0; i < 3; ++i)
      state.solid.at(vadose::field::bishop_stress, b, i)[l] = saturation * pressure;
  });
  REQUIRE(run(solver, 400));
  Real worst = 0;
  solver.liquid().for_each([&](std::size_t b, int l) {
    worst = std::max(worst, std::fabs(solver.liquid().at(vadose::field::velocity, b)[l] - speed));
  });
  CAPTURE(shift);
  CAPTURE(speed);
  CHECK(worst < bound);
}

}  // namespace

TEST_CASE("uniform pressure behind closed surfaces is at rest for any cut of the cells") {
  for (const Real shift : {0.0, 0.03, 0.05})
    for (const Real speed : {0.0, 1.3}) {
      check_uniform_pressure<Saturated<PlaneStrain>>(-1e4, shift, speed, 1e-11);
      check_uniform_pressure<Unsaturated<PlaneStrain>>(-1e3, shift, speed, 1e-11);
    }
}
