// SPDX-License-Identifier: MIT
// A step beyond the limit is caught by the guard, with a report, before any NaN is in the state.

#include <doctest/doctest.h>

#include "tests/verify/verify_support.hpp"

#include <vadose/policy/shape/linear.hpp>

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

struct Dry : vd::DryModel<vd::Uniaxial> {
  using Shape = vd::shape::Linear;
};
struct Wet : vd::SaturatedModel<vd::Uniaxial> {
  using Shape = vd::shape::Linear;
};
using WetPlane = vd::SaturatedModel<vd::PlaneStrain>;

constexpr long allowed_steps = 1000;

template <class M>
vd::Material<M> soil() {
  if constexpr (vd::has_liquid<M>)
    return verify::saturated_soil<M>(0.01);
  else
    return {.solid_density = 2600,
            .porosity = 0.4,
            .skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.33}};
}

template <class M>
vd::Scene<M> column() {
  constexpr int dim = M::Kinematics::dim, up = dim - 1;
  Vec<dim> low = Vec<dim>::Zero(), high = Vec<dim>::Constant(0.3), top = high;
  high[up] = 2.4;
  top[up] = 2;
  vd::Scene<M> scene({.box = {low, high}, .cell_size = 0.1});
  scene.add_soil(vd::box(low, top), soil<M>());
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  return scene;
}

template <class Points>
bool all_finite(const Points& points) {
  bool finite = true;
  constexpr int dim = Points::fields::template components<vd::field::Position>();
  points.for_each([&](std::size_t b, int l) {
    for (int d = 0; d < dim; ++d)
      finite = finite && std::isfinite(points.at(vd::field::position, b, d)[l]) &&
               std::isfinite(points.at(vd::field::velocity, b, d)[l]);
    finite = finite && std::isfinite(points.at(vd::field::mass, b)[l]) &&
             std::isfinite(points.at(vd::field::volume, b)[l]);
  });
  return finite;
}

/// Kicks a column and runs it at 1.2 times 2/omega.
template <class M>
void check_guard(const char* name, Real courant = 1.2) {
  constexpr int dim = M::Kinematics::dim;
  vd::Solver<M> solver(column<M>(), {.courant = courant});
  auto& solid = solver.mutable_state().solid;
  solid.for_each([&](std::size_t b, int l) {
    for (int d = 0; d < dim; ++d)
      solid.at(vd::field::velocity, b, d)[l] =
          1e-6 * std::sin(1.7 * solid.at(vd::field::id, b)[l] + d);
  });
  vd::StepReport report;
  long steps = 0;
  while (steps < allowed_steps && report.status == vd::Status::ok) {
    report = solver.step();
    ++steps;
  }
  MESSAGE(std::string(name), ": after ", steps, " steps, dt ", report.dt, ": ", report.text());
  CHECK(report.status != vd::Status::ok);
  CHECK(report.trouble.criterion != nullptr);
  CHECK(report.trouble.id >= 0);
  CHECK(all_finite(solver.solid()));
  if constexpr (vd::has_liquid<M>) CHECK(all_finite(solver.liquid()));
}

}  // namespace

TEST_CASE("guard: 1.2 times the limit stops within 1000 steps, dry") {
  check_guard<Dry>("dry");
}
TEST_CASE("guard: 1.2 times the limit stops within 1000 steps, saturated") {
  check_guard<Wet>("saturated");
}
TEST_CASE("guard: 1.2 times the limit stops within 1000 steps, saturated 2D") {
  // The growing motion cuts cells at the surface, whose step is smaller by cut_cell_step: without the
  // factor the run would save itself.
  check_guard<WetPlane>("saturated 2D", 1.2 / vd::kernel::cut_cell_step);
}

TEST_CASE("guard: advance_to throws with the report of the failed step") {
  vd::Solver<Dry> solver(column<Dry>());
  auto& solid = solver.mutable_state().solid;
  solid.for_each([&](std::size_t b, int l) {  // leaves the box
    solid.at(vd::field::velocity, b)[l] = 500;
  });
  try {
    solver.advance_to(1);
    FAIL("nothing thrown");
  } catch (const vd::InstabilityError& e) {
    CHECK(e.report().status != vd::Status::ok);
    CHECK(std::string(e.what()).find("unstable: step ") == 0);
    CHECK(std::string(e.what()).find("solid point") != std::string::npos);
    CHECK(e.report().trouble.criterion != nullptr);
  }
}

TEST_CASE("guard: a NaN in the state stops the next step") {
  for (const int field : {0, 1, 2}) {
    CAPTURE(field);
    vd::Solver<Wet> solver(column<Wet>());
    solver.step();
    auto& state = solver.mutable_state();
    if (field == 0) state.solid.at(vd::field::velocity, 0)[0] = vd::unset;
    if (field == 1) state.solid.at(vd::field::bishop_stress, 0)[0] = vd::unset;
    if (field == 2) state.liquid.at(vd::field::mass, 0)[0] = vd::unset;
    bool stopped = false;
    for (int i = 0; i < 3 && !stopped; ++i) stopped = solver.step().status != vd::Status::ok;
    CHECK(stopped);
    CHECK(solver.last_step().trouble.criterion != nullptr);
  }
}
