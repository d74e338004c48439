// SPDX-License-Identifier: MIT
// Still water over saturated soil stays still: pressures hydrostatic, Bishop stress the buoyant
// weight, for aligned points, random offsets and surfaces that cut cells.

#include <doctest/doctest.h>

#include "verify_support.hpp"

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

template <class K>
using Ponded = vd::SaturatedModel<K>;

struct Case {
  Real soil_top = 1, level = 1.3;  ///< [m], multiples of h / per_axis
  int per_axis = 2;
  Real jitter = 0;           ///< of the points of the soil [cells]
  bool free_jitter = false;  ///< of the free water too
  int columns = 4;           ///< cells across in 2D
  long steps = 20000;
};

struct Outcome {
  Real soil_pressure = 0;  ///< largest |p - hydrostatic| over soil cells and samples [Pa]
  Real free_pressure = 0;  ///< the same over cells of free water
  Real stress = 0;         ///< largest error of Bishop stress at a point, over that at the base [-]
  Real base_stress = 0;    ///< error of the weight carried by the grains [-]
  Real solid_speed = 0;    ///< largest speed of the solid at the end [m/s]
  Real liquid_speed = 0;   ///< largest speed of the liquid at the end [m/s]
  Real equilibrium = 0;    ///< residual of equilibrate() [-]
  Real closure = 0;        ///< of the water ledger, relative [-]

  Real pressure() const { return std::max(soil_pressure, free_pressure); }
  Real speed() const { return std::max(solid_speed, liquid_speed); }
};

constexpr Real cell_size = 0.1, gravity = 9.81, porosity = verify::table1::porosity;

template <class M>
vd::Scene<M> scene_of(const Case& c) {
  constexpr int dim = M::Kinematics::dim;
  Vec<dim> low = Vec<dim>::Zero(), high = Vec<dim>::Constant(c.columns * cell_size);
  high[dim - 1] = 1.5;
  vd::Scene<M> scene({.box = {low, high}, .cell_size = cell_size});
  scene.gravity[dim - 1] = -gravity;
  int points = 1;
  for (int d = 0; d < dim; ++d) points *= c.per_axis;
  Vec<dim> top = high, bottom = low;
  top[dim - 1] = c.soil_top;
  scene.add_soil(vd::box(low, top), verify::saturated_soil<M>(),
                 {.points_per_cell = points,
                  .jitter = c.jitter,
                  .seed = 7,
                  .water_table = c.level,
                  .initial_stress = vd::InitialStress::geostatic});
  bottom[dim - 1] = c.soil_top;
  top[dim - 1] = c.level;
  if (c.level > c.soil_top)
    scene.add_water(vd::box(bottom, top), {.points_per_cell = points,
                                           .jitter = c.free_jitter ? c.jitter : 0,
                                           .seed = 11,
                                           .surface_level = c.level});
  scene.add(vd::bc::Rain{.rate = 0});  // off: springs and films may be, rain not
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  if constexpr (dim > 1) {
    scene.add(vd::bc::Roller{.face = vd::Face::left});
    scene.add(vd::bc::Roller{.face = vd::Face::right});
  }
  return scene;
}

template <class M>
Real pressure_error(const vd::Solver<M>& solver, vd::CellKind kind, const Case& c) {
  constexpr int up = M::Kinematics::dim - 1;
  verify::Norm norm;
  verify::for_cells(solver, kind, [&](const auto& cell) {
    norm.add(cell.pressure - 1000 * gravity * (c.level - cell.centroid[up]));
  });
  REQUIRE(norm.count > 0);
  return norm.max;
}

/// Bishop stress against the buoyant weight. Aligned points: each point against
/// (1-n)(rho_s - rho_l) g (H - z), over its value at the base. Random offsets move weight too, so
/// that the reference is the weight where it is, by virtual work with a velocity z:
/// sum S p V - sum sigma* V = g sum (m_s + m_l) z over all points and pressure cells.
template <class M>
void stress_error(const vd::Solver<M>& solver, const Case& c, Outcome& out) {
  constexpr int up = M::Kinematics::dim - 1;
  const Real weight = (1 - porosity) * (verify::table1::solid_density - 1000) * gravity;
  Real total = 0, grains = 0, buoyant = 0;
  solver.solid().for_each([&](std::size_t b, int l) {
    const auto& points = solver.solid();
    const Real z = points.at(vd::field::position, b, up)[l];
    const Real volume = points.at(vd::field::volume, b)[l];
    const Real sigma = points.at(vd::field::bishop_stress, b, up)[l];
    out.stress = std::max(out.stress, std::fabs(sigma / weight + c.soil_top - z) / c.soil_top);
    grains -= sigma * volume;
    total += gravity * points.at(vd::field::mass, b)[l] * z;
    buoyant += weight * z * volume;
  });
  solver.liquid().for_each([&](std::size_t b, int l) {
    const auto& points = solver.liquid();
    total += gravity * points.at(vd::field::mass, b)[l] * points.at(vd::field::position, b, up)[l];
  });
  for (const auto kind : {vd::CellKind::soil, vd::CellKind::free})
    verify::for_cells(solver, kind, [&](const auto& cell) {
      total -= cell.saturation * cell.quad_pressure * cell.quad_volume;
    });
  out.base_stress = std::fabs(grains - total) / buoyant;
}

template <class M>
Outcome run(const Case& c) {
  vd::Solver<M> solver(scene_of<M>(c));
  Outcome out;
  const auto report = solver.equilibrate({.tolerance = 1e-9, .max_time = 1});
  out.equilibrium = report.residual;
  const long samples = 50;
  for (long s = 0; s < samples; ++s) {
    for (long i = 0; i < c.steps / samples; ++i) {
      const auto step = solver.step();
      if (step.status != vd::Status::ok) FAIL(step.text());
    }
    out.soil_pressure = std::max(out.soil_pressure, pressure_error(solver, vd::CellKind::soil, c));
    out.free_pressure = std::max(out.free_pressure, pressure_error(solver, vd::CellKind::free, c));
  }
  const auto w = solver.water_balance();
  CHECK(w.rain == 0);
  CHECK(w.inflow == 0);
  CHECK(w.outflow == 0);
  out.closure = std::fabs(w.relative_closure());
  CHECK(out.closure <= 1e-12);
  stress_error(solver, c, out);
  out.solid_speed = verify::largest_speed(solver.solid());
  out.liquid_speed = verify::largest_speed(solver.liquid());
  MESSAGE("dim ", M::Kinematics::dim, " soil ", c.soil_top, " level ", c.level, " per axis ",
          c.per_axis, std::string(c.free_jitter ? " jitter of all " : " jitter of soil "), c.jitter,
          " steps ", c.steps, ": max |dp| soil ", out.soil_pressure, " free ", out.free_pressure,
          " Pa, stress ", 100 * out.stress, " % (weight ", 100 * out.base_stress, " %), speed ",
          out.solid_speed, " ", out.liquid_speed, " m/s, equilibrium ", out.equilibrium,
          ", closure ", out.closure);
  return out;
}

using M1 = Ponded<vd::Uniaxial>;
using M2 = Ponded<vd::PlaneStrain>;

}  // namespace

TEST_CASE("1D ponded column at rest, aligned points") {
  const Outcome o = run<M1>({});
  CHECK(o.pressure() <= 1e-3);
  CHECK(o.base_stress <= 1e-3);
  CHECK(o.stress <= 1e-3);
  CHECK(o.speed() <= 1e-7);
}

TEST_CASE("1D ponded column at rest, random offsets in the soil") {
  const Outcome o = run<M1>({.jitter = 0.2});
  CHECK(o.pressure() <= 1);
  CHECK(o.base_stress <= 1e-3);
  CHECK(o.speed() <= 1e-6);
}

// Cases whose full bound is missed come twice: with what is held now, and with the bound itself as a
// known miss (doctest reports it without failing the run, until it is met).
namespace {

const Outcome& both_1d() {
  static const Outcome o = run<M1>({.jitter = 0.2, .free_jitter = true});
  return o;
}
const Outcome& soil_2d() {
  static const Outcome o = run<M2>({.jitter = 0.2, .steps = 5000});
  return o;
}
const Outcome& both_2d() {
  static const Outcome o = run<M2>({.jitter = 0.2, .free_jitter = true, .steps = 5000});
  return o;
}

}  // namespace

TEST_CASE("1D ponded column at rest, random offsets in soil and free water") {
  CHECK(both_1d().soil_pressure <= 1);
  CHECK(both_1d().free_pressure <= 1);
  CHECK(both_1d().base_stress <= 6e-3);
  CHECK(both_1d().speed() <= 1e-6);
}
// Measured 0.42 %: the packing of the free points at the interface counts as weight there.
TEST_CASE("known miss: 1D ponded column, offsets in the water too, buoyant weight to 0.1 %" *
          doctest::may_fail()) {
  CHECK(both_1d().base_stress <= 1e-3);
}

TEST_CASE("2D ponded strip at rest, aligned points") {
  const Outcome o = run<M2>({.steps = 5000});
  CHECK(o.pressure() <= 1e-3);
  CHECK(o.base_stress <= 1e-3);
  CHECK(o.stress <= 1e-3);
  CHECK(o.speed() <= 1e-7);
}

TEST_CASE("2D ponded strip at rest, random offsets") {
  CHECK(soil_2d().pressure() <= 1);
  CHECK(soil_2d().base_stress <= 1e-3);
  CHECK(soil_2d().speed() <= 1e-3);
  CHECK(both_2d().pressure() <= 1);
  CHECK(both_2d().base_stress <= 2e-2);
  CHECK(both_2d().speed() <= 1e-3);
}
// Measured 0.9e-4 and 1.9e-4 m/s: a few grams of grains, at nodes that hold mostly free water, creep
// when the run starts, and die away. With offsets in the water, 1.2 %.
TEST_CASE("known miss: 2D ponded strip, random offsets, 1e-6 m/s at once" * doctest::may_fail()) {
  CHECK(soil_2d().speed() <= 1e-6);
  CHECK(both_2d().base_stress <= 1e-3);
  CHECK(both_2d().speed() <= 1e-6);
}

// The lattice allows surfaces at multiples of h / per_axis: 0.27 m becomes 0.275 (per axis 4) and
// 0.28 m (per axis 5), 1.03 m becomes 1.025 and 1.04 m.
TEST_CASE("ponded column at rest, surfaces that cut cells") {
  const Case cases[] = {{.level = 1.25, .per_axis = 2},     {.level = 1.275, .per_axis = 4},
                        {.level = 1.28, .per_axis = 5},     {.soil_top = 1.05, .per_axis = 2},
                        {.soil_top = 1.025, .per_axis = 4}, {.soil_top = 1.04, .per_axis = 5},
                        {.soil_top = 1.08, .per_axis = 5}};
  for (Case c : cases) {
    CAPTURE(c.soil_top);
    CAPTURE(c.level);
    CHECK(run<M1>(c).pressure() <= 150);
    c.jitter = 0.4 / c.per_axis;
    c.free_jitter = true;
    c.steps = 10000;
    CHECK(run<M1>(c).pressure() <= 150);
    c.steps = 1500;
    CHECK(run<M2>(c).pressure() <= 150);
  }
}

namespace {

const Outcome& long_1d() {
  static const Outcome o = run<M1>({.steps = 100000});
  return o;
}
const Outcome& long_2d() {
  static const Outcome o = run<M2>({.steps = 100000});
  return o;
}
const Outcome& long_both_2d() {
  static const Outcome o = run<M2>({.jitter = 0.2, .free_jitter = true, .steps = 100000});
  return o;
}

}  // namespace

TEST_SUITE("long") {
  TEST_CASE("ponded column at rest over 1e5 steps") {
    CHECK(long_1d().pressure() <= 1e-3);
    CHECK(run<M1>({.jitter = 0.2, .free_jitter = true, .steps = 100000}).pressure() <= 1);
    CHECK(long_2d().pressure() <= 1e-3);
    CHECK(long_both_2d().pressure() <= 1);
    for (const Outcome* o : {&long_1d(), &long_2d(), &long_both_2d()}) CHECK(o->closure <= 1e-12);
  }
}
