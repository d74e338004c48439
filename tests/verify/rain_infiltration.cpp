// SPDX-License-Identifier: MIT
// Rain, ponding, zero suction and redistribution in a rigid column of sand against Richards'
// equation (tests/reference/richards.py).

#include <doctest/doctest.h>

#include "verify_support.hpp"

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

template <class K>
struct Seepage : vd::UnsaturatedModel<K> {
  using Skeleton = vd::law::Rigid;
};
using M1 = Seepage<vd::Uniaxial>;
using M2 = Seepage<vd::PlaneStrain>;
using M3 = Seepage<vd::ThreeDimensional>;

constexpr Real conductivity = 1e-4, porosity = 0.4, height = 2, gravity = 9.81;
/// Softened water. Its density at the initial suction is lower by 0.3 %, all else is the same.
constexpr Real bulk_modulus = 1e6;

/// Sand of 2 m; saturation by height; room for a pond above. A strip two cells wide in 2D and 3D.
template <class M>
vd::Scene<M> sand_column(Real h, const std::function<Real(Real)>& saturation) {
  constexpr int dim = M::Kinematics::dim, up = dim - 1;
  Vec<dim> low = Vec<dim>::Zero(), high = Vec<dim>::Constant(2 * h);
  high[up] = height + 0.4;
  vd::Scene<M> scene({.box = {low, high}, .cell_size = h});
  scene.gravity[up] = -gravity;
  scene.liquid.bulk_modulus = bulk_modulus;
  const vd::Material<M> sand = {
      .name = "sand",
      .porosity = porosity,
      .lambda = 0.63,
      .retention = {.a = 3, .porosity_dependent = false},
      .conductivity = {.saturated_conductivity = conductivity, .porosity_dependent = false}};
  for (int half = 0; half < 2; ++half) {
    Vec<dim> bottom = low, top = high;
    bottom[up] = half;
    top[up] = half + 1;
    scene.add_soil(vd::box(bottom, top), sand, {.saturation = saturation(half + 0.5)});
  }
  return scene;
}

/// Water per horizontal area [m] of a mass [kg].
template <class M>
Real depth(Real mass, Real h) {
  return mass / 1000 / std::pow(2 * h, M::Kinematics::dim - 1);
}

/// Mean of the reference S over [z - h/2, z + h/2].
Real reference_saturation(const verify::Table& table, const std::string& name, Real t, Real z,
                          Real h) {
  Real sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.number(i, "t_s") == t && table.text(i, "case") == name &&
        std::fabs(table.number(i, "z_m") - z) < 0.5 * h) {
      sum += table.number(i, "S");
      ++count;
    }
  REQUIRE(count > 0);
  return sum / count;
}

Real reference(const std::string& name, Real t, const std::string& column) {
  static const verify::Table table("richards_history.csv");
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.number(i, "t_s") == t && table.text(i, "case") == name)
      return table.number(i, column);
  FAIL("no row ", name, " at ", t);
  return 0;
}

/// rms error of S over the cells.
template <class M>
Real profile_error(const vd::Solver<M>& solver, const std::string& name, Real h) {
  static const verify::Table table("richards_profiles.csv");
  verify::Norm norm;
  verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
    const Real z = cell.centroid[M::Kinematics::dim - 1];
    norm.add(cell.saturation - reference_saturation(table, name, std::round(solver.time()), z, h));
  });
  REQUIRE(norm.count > 0);
  return norm.rms();
}

/// Rain below capacity.
template <class M>
void check_rain(Real h, Real bound, const std::vector<Real>& times) {
  auto scene = sand_column<M>(h, [](Real) { return 0.3; });
  scene.add(vd::bc::Rain{.rate = 0.3 * conductivity});
  vd::Solver<M> solver(scene);
  for (const Real t : times) {
    solver.advance_to(t);
    const auto w = solver.water_balance();
    const Real error = profile_error(solver, "rain0.3", h);
    const Real taken = depth<M>(w.pore - w.initial, h);
    MESSAGE("dim ", M::Kinematics::dim, " h ", h, " t ", t, ": rms S ", error, ", taken ", taken,
            " m, closure ", w.relative_closure(), ", steps ", solver.steps());
    CHECK(error <= bound);
    CHECK(verify::close(taken, reference("rain0.3", t, "inflow_m"), 0.01));
    CHECK(std::fabs(w.relative_closure()) <= 1e-12);
    CHECK(w.free == 0);
  }
}

/// Redistribution in a closed column.
void check_closed_column(const std::string& name, Real h, Real bound,
                         const std::vector<Real>& times) {
  const Real low = name == "rise" ? 0.9 : 0.2;
  vd::Solver<M1> solver(sand_column<M1>(h, [low](Real z) { return z < 1 ? low : 1.1 - low; }));
  for (const Real t : times) {
    solver.advance_to(t);
    const Real error = profile_error(solver, name, h);
    MESSAGE(name, " h ", h, " t ", t, ": rms S ", error, ", steps ", solver.steps());
    CHECK(error <= bound);
    CHECK(std::fabs(solver.water_balance().relative_closure()) <= 1e-12);
  }
}

}  // namespace

TEST_CASE("rain below capacity, 1D, h = 0.1 m") {
  check_rain<M1>(0.1, 0.015, {600, 1500});
}
TEST_CASE("rain below capacity, strip of 2D") {
  check_rain<M2>(0.1, 0.015, {600});
}
TEST_CASE("closed column: capillary rise and drainage") {
  check_closed_column("rise", 0.1, 0.02, {600, 1800});
  check_closed_column("drainage", 0.1, 0.02, {600, 1800});
}
namespace {

/// Rain of 3 k_sat: when water stands on the ground, and how deep.
void check_ponding(Real h, const std::vector<Real>& times, Real bound) {
  auto scene = sand_column<M1>(h, [](Real) { return 0.3; });
  scene.add(vd::bc::Rain{.rate = 3 * conductivity});
  vd::Solver<M1> solver(scene);
  const Real expected = reference("rain3", 300, "ponding_s");
  Real ponding = vd::unset;
  for (Real t = 10; !vd::is_finite(ponding) && t < 2 * expected; t += 1) {
    solver.advance_to(t);
    if (solver.water_balance().film > 0.01) ponding = t;
  }
  MESSAGE("ponding after ", ponding, " s, Richards ", expected);
  CHECK(verify::close(ponding, expected, 0.05));
  for (const Real t : times) {
    solver.advance_to(t);
    const auto w = solver.water_balance();
    const Real pond = (w.film + w.free) / 1000;
    MESSAGE("t ", t, " s: pond ", pond, " m (film ", w.film / 1000, "), Richards ",
            reference("rain3", t, "pond_m"), ", taken ", (w.pore - w.initial) / 1000, ", Richards ",
            reference("rain3", t, "inflow_m"), ", rms S ", profile_error(solver, "rain3", h),
            ", closure ", w.relative_closure(), ", steps ", solver.steps());
    if (t > 100)  // at 100 s Richards' pond is 0.02 mm
      CHECK(verify::close(pond, reference("rain3", t, "pond_m"), bound));
    CHECK(verify::close((w.pore - w.initial) / 1000, reference("rain3", t, "inflow_m"), 0.02));
    CHECK(std::fabs(w.relative_closure()) <= 1e-12);
  }
}

/// p = 0 held at the ground.
void check_zero_suction(Real h, const std::vector<Real>& times) {
  auto scene = sand_column<M1>(h, [](Real) { return 0.3; });
  scene.add(vd::bc::ZeroSuction{});
  vd::Solver<M1> solver(scene);
  for (const Real t : times) {
    solver.advance_to(t);
    const auto w = solver.water_balance();
    const Real inflow = (w.inflow - w.outflow) / 1000,
               expected = reference("zero_suction", t, "inflow_m");
    MESSAGE("zero suction, h ", h, " t ", t, ": inflow ", inflow, " m, Richards ", expected, " (",
            100 * (inflow / expected - 1), " %), rms S ", profile_error(solver, "zero_suction", h),
            ", closure ", w.relative_closure(), ", steps ", solver.steps());
    if (t >= 300) CHECK(verify::close(inflow, expected, 0.05));
    CHECK(std::fabs(w.relative_closure()) <= 1e-12);
  }
}

}  // namespace

TEST_CASE("rain above capacity: ponding time and pond depth") {
  check_ponding(0.05, {100, 300, 600}, 0.05);
}
TEST_CASE("zero suction") {
  check_zero_suction(0.05, {100, 300, 600});
}

TEST_SUITE("long") {
  TEST_CASE("rain above capacity to 1200 s") {
    check_ponding(0.05, {100, 300, 600, 1200}, 0.05);
  }
  TEST_CASE("zero suction to 1800 s") {
    check_zero_suction(0.05, {100, 300, 600, 900, 1200, 1800});
  }
  TEST_CASE("rain below capacity to 4500 s, 1D, 2D and 3D") {
    check_rain<M1>(0.1, 0.015, {600, 1500, 3000, 4500});
    check_rain<M1>(0.05, 0.008, {600, 1500, 3000, 4500});
    check_rain<M2>(0.1, 0.015, {600, 1500, 3000, 4500});
    check_rain<M3>(0.1, 0.015, {600});
  }
  TEST_CASE("closed column to 5400 s") {
    for (const char* name : {"rise", "drainage"})
      check_closed_column(name, 0.1, 0.02, {600, 1800, 5400});
  }
}
