// SPDX-License-Identifier: MIT
// The semi-implicit scheme in axisymmetry and 3D, in free water alone and at reservoirs and drains, against
// the explicit one.

#include <doctest/doctest.h>

#include "../seepage.hpp"
#include "verify_support.hpp"

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;
using vd::scheme::Explicit;
using vd::scheme::SemiImplicit;

constexpr Real gravity = 9.81, load = 1e4;

template <class Solver>
std::vector<Real> end_pressures(const Solver& solver) {
  std::vector<Real> p;
  verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
    p.push_back(cell.pressure + (cell.solved ? cell.change : 0));
  });
  return p;
}

/// Rms of the difference over `scale`.
Real difference(const std::vector<Real>& a, const std::vector<Real>& b, Real scale) {
  REQUIRE(a.size() == b.size());
  verify::Norm norm;
  for (std::size_t i = 0; i < a.size(); ++i) norm.add((a[i] - b[i]) / scale);
  return norm.rms();
}

/// Saturated soil of 1 m under 10 kPa on the third of its top next to the axis or the left wall, 0.5 s after
/// the load came; in 3D one cell thick.
template <class M, class Scheme>
std::vector<Real> loaded(std::int64_t& steps) {
  constexpr int dim = M::Kinematics::dim, up = dim - 1;
  const Real h = 0.1;
  Vec<dim> low = Vec<dim>::Zero(), high = Vec<dim>::Constant(h), top = high;
  high[0] = top[0] = 1;
  high[up] = 1.2;
  top[up] = 1;
  vd::Scene<M> scene({.box = {low, high}, .cell_size = h});
  scene.liquid.bulk_modulus = 2.2e8;
  const vd::Material<M> soil = {.solid_density = 2650,
                                .porosity = 0.4,
                                .skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.3},
                                .conductivity = {.saturated_conductivity = 1e-4}};
  scene.add_soil(vd::box(low, top), soil,
                 {.points_per_cell = vd::power<dim>(2),
                  .liquid_pressure = [](const Vec<dim>&) { return Real(0); }});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  scene.add(vd::bc::Roller{.face = vd::Face::left});
  scene.add(vd::bc::Roller{.face = vd::Face::right});
  if constexpr (dim == 3) {
    scene.add(vd::bc::Roller{.face = vd::Face::front});
    scene.add(vd::bc::Roller{.face = vd::Face::back});
  }
  Vec<dim> first = low, last = top, traction = Vec<dim>::Zero();
  first[up] = 1 - 0.5 * h;
  last[0] = 0.3;
  traction[up] = -load;
  scene.add(vd::bc::Traction<dim>{
      .region = vd::box(first, last), .traction = traction, .time_factor = [](Real t) {
        return std::min(Real(1), t / 0.05);
      }});
  scene.add(vd::bc::ZeroSuction{});
  vd::Solver<M, Scheme> solver(scene, {.damping = 0.3});
  solver.advance_to(0.5);
  steps = solver.steps();
  CHECK(std::fabs(solver.water_balance().relative_closure()) <= 1e-12);
  return end_pressures(solver);
}

template <class M>
void check_loaded(const char* name) {
  std::int64_t many = 0, few = 0;
  const auto p = loaded<M, Explicit>(many), q = loaded<M, SemiImplicit>(few);
  const Real rms = difference(q, p, load);
  MESSAGE(std::string(name), ": p differs by ", 100 * rms, " % of the load; ", few, " steps of ",
          many);
  CHECK(rms <= 0.002);
  CHECK(4 * few <= many);
}

/// A rigid strip of sand beside a reservoir that falls, drained at its base.
template <class Scheme>
vd::WaterBalance drawn_down(std::vector<Real>& pressures) {
  using M = vadose_test::Seepage<vd::PlaneStrain>;
  vd::Scene<M> scene({.box = {{0, 0}, {1, 1.2}}, .cell_size = 0.1});
  scene.gravity[1] = -gravity;
  scene.liquid.bulk_modulus = 1e6;
  scene.add_soil(vd::box({0, 0}, {1, 1}),
                 {.name = "sand",
                  .porosity = 0.4,
                  .lambda = 0.63,
                  .retention = {.a = 3, .porosity_dependent = false},
                  .conductivity = {.saturated_conductivity = 1e-3, .porosity_dependent = false}},
                 {.water_table = 0.8});
  scene.add(vd::bc::Reservoir{.face = vd::Face::left, .function = [](Real t) {
                                return std::max(Real(0.3), Real(0.8) - Real(0.01) * t);
                              }});
  scene.add(vd::bc::Drain{.face = vd::Face::bottom, .region = vd::box({0.8, 0}, {1, 0.1})});
  vd::Solver<M, Scheme> solver(scene);
  solver.advance_to(60);
  pressures = end_pressures(solver);
  return solver.water_balance();
}

}  // namespace

TEST_CASE("semi-implicit: a footing in axisymmetry as by the explicit scheme") {
  check_loaded<vd::SaturatedModel<vd::Axisymmetric>>("axisymmetric");
}
TEST_CASE("semi-implicit: a footing in 3D as by the explicit scheme") {
  check_loaded<vd::SaturatedModel<vd::ThreeDimensional>>("3D");
}

TEST_CASE("semi-implicit: a reservoir that falls beside drained sand as by the explicit scheme") {
  std::vector<Real> p, q;
  const auto a = drawn_down<Explicit>(p), b = drawn_down<SemiImplicit>(q);
  const Real rms = difference(q, p, 1000 * gravity);
  MESSAGE("out ", b.outflow, " of ", a.outflow, " kg, in ", b.inflow, " of ", a.inflow,
          " kg, p differs by ", 100 * rms, " % of 1 m of water");
  CHECK(rms <= 0.01);
  CHECK(verify::close(b.outflow, a.outflow, 0.02));
  CHECK(std::fabs(b.relative_closure()) <= 1e-12);
}

TEST_CASE("semi-implicit: two bodies of free water fall together") {
  using M = vd::FreeWaterModel<vd::PlaneStrain>;
  vd::Scene<M> scene({.box = {{0, 0}, {1, 0.8}}, .cell_size = 0.05});
  scene.gravity[1] = -gravity;
  scene.add_water(vd::box({0, 0}, {0.25, 0.4}), {.surface_level = 0.4});
  scene.add_water(vd::box({0.75, 0}, {1, 0.3}), {.surface_level = 0.3});
  vd::Solver<M, SemiImplicit> solver(scene);
  for (int i = 1; i <= 20; ++i) solver.advance_to(0.1 * i);
  const auto w = solver.water_balance();
  MESSAGE(solver.last_step().text());
  CHECK(w.lost == 0);
  CHECK(std::fabs(w.relative_closure()) <= 1e-12);
  CHECK(verify::largest_speed(solver.liquid()) < 2);  // they started 0.4 m high
}
