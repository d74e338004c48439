// SPDX-License-Identifier: MIT
// Water rides with the soil: sharp fronts that slide over many cells or turn with a block, water at
// rest in a column that moves, rain on one, and undrained compression through saturation.

#include <doctest/doctest.h>

#include "verify_support.hpp"

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

template <class K>
using Soil = vd::UnsaturatedModel<K>;
using Moving = Soil<vd::Uniaxial>;
using Turning = Soil<vd::PlaneStrain>;

/// Soil whose nodes all move with a velocity: its stiffness bears on the step alone.
template <class M = Moving>
vd::Material<M> soil(Real a, Real lambda, Real conductivity, bool porosity_dependent = false,
                     Real young_modulus = 1e6) {
  return {.name = "soil",
          .solid_density = 2650,
          .porosity = 0.4,
          .lambda = lambda,
          .skeleton = {.young_modulus = young_modulus, .poisson_ratio = 0.2},
          .retention = {.a = a, .porosity_dependent = porosity_dependent},
          .conductivity = {.saturated_conductivity = conductivity,
                           .porosity_dependent = porosity_dependent}};
}

/// Gives every node of the box the velocity v(x), which does not change with time.
template <class M, class V>
void prescribe(vd::Scene<M>& scene, const V& v) {
  constexpr int dim = M::Kinematics::dim;
  const Real h = scene.cell_size();
  vd::Index<dim> size;
  for (int d = 0; d < dim; ++d) size[d] = scene.cells()[static_cast<std::size_t>(d)] + 1;
  const int rows = dim == 1 ? 1 : size[dim - 1];
  for (int i = 0; i < size[0]; ++i)
    for (int j = 0; j < rows; ++j) {
      Vec<dim> x = scene.box().low;
      x[0] += i * h;
      if constexpr (dim == 2) x[1] += j * h;
      const Vec<dim> reach = Vec<dim>::Constant(0.25 * h);
      const Vec<dim> low = (x - reach).cwiseMax(scene.box().low);
      const Vec<dim> high = (x + reach).cwiseMin(scene.box().high);
      scene.add(vd::bc::PrescribedVelocity<dim>{.region = vd::box(low, high), .velocity = v(x)});
    }
}

template <class M>
std::vector<Real> saturations(const vd::Solver<M>& solver) {
  std::vector<Real> s(solver.liquid().size());
  solver.liquid().for_each([&](std::size_t b, int l) {
    const auto& p = solver.liquid();
    const auto id = static_cast<std::size_t>(p.at(vd::field::id, b)[l]);
    s[id] = p.at(vd::field::mass, b)[l] /
            (1000 * p.at(vd::field::porosity, b)[l] * p.at(vd::field::volume, b)[l]);
  });
  return s;
}

/// A front between S = 0.3 and 0.8 that slides over 50 cells without conductivity.
void check_front(Real a, Real lambda, Real velocity) {
  const Real h = 0.1;
  vd::Scene<Moving> scene({.box = {Vec<1>(0.0), Vec<1>(7.0)}, .cell_size = h});
  scene.liquid.bulk_modulus = 1e8;
  const auto material = soil(a, lambda, 1e-30);
  scene.add_soil(vd::box({0.5}, {1.0}), material, {.saturation = 0.3});
  scene.add_soil(vd::box({1.0}, {1.5}), material, {.saturation = 0.8});
  scene.add(
      vd::bc::PrescribedVelocity<1>{.region = vd::box({0.0}, {7.0}), .velocity = Vec<1>(velocity)});
  vd::Solver<Moving> solver(scene);
  const auto before = saturations(solver);
  solver.advance_to(50 * h / velocity);
  const auto after = saturations(solver);
  verify::Norm norm;
  for (std::size_t i = 0; i < before.size(); ++i) norm.add(after[i] - before[i]);
  Real sum = 0, travelled = 0;
  for (std::size_t i = 0; i < before.size(); ++i) sum += std::fabs(after[i] - before[i]);
  solver.solid().for_each(
      [&](std::size_t b, int l) { travelled = std::max(travelled, solver.displacement(b, l)[0]); });
  const auto w = solver.water_balance();
  MESSAGE("a ", a, " lambda ", lambda, ": L1 of the change of S ",
          sum / static_cast<Real>(before.size()), ", largest ", norm.max, ", moved ", travelled / h,
          " cells, closure ", w.relative_closure(), ", steps ", solver.steps());
  CHECK(sum / static_cast<Real>(before.size()) <= 0.002);
  CHECK(travelled > 49 * h);
  CHECK(std::fabs(w.relative_closure()) <= 1e-12);
}

/// A front between S = 0.3 and 0.8 in a block that turns by 90 degrees without conductivity.
void check_turn(Real a, Real lambda) {
  const Real h = 0.1, turn = std::numbers::pi / 2, rate = 1;  // [rad/s]
  const Vec<2> centre(0.93, 0.88);
  vd::Scene<Turning> scene({.box = {{0.0, 0.0}, {1.8, 1.8}}, .cell_size = h});
  scene.liquid.bulk_modulus = 1e8;
  const auto material = soil<Turning>(a, lambda, 1e-30);
  scene.add_soil(vd::box({0.4, 0.4}, {0.9, 1.4}), material, {.saturation = 0.3});
  scene.add_soil(vd::box({0.9, 0.4}, {1.4, 1.4}), material, {.saturation = 0.8});
  prescribe(scene, [&](const Vec<2>& x) {
    return Vec<2>(rate * (centre[1] - x[1]), rate * (x[0] - centre[0]));
  });
  vd::Solver<Turning> solver(scene);
  const auto before = saturations(solver);
  solver.advance_to(turn / rate);
  const auto after = saturations(solver);
  verify::Norm change, place;
  Real sum = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    change.add(after[i] - before[i]);
    sum += std::fabs(after[i] - before[i]);
  }
  solver.solid().for_each([&](std::size_t b, int l) {
    const auto& p = solver.solid();
    const Vec<2> x(p.at(vd::field::position, b, 0)[l], p.at(vd::field::position, b, 1)[l]);
    const Vec<2> from = x - solver.displacement(b, l) - centre, to = x - centre;
    place.add((to - Vec<2>(-from[1], from[0])).norm());
  });
  const auto w = solver.water_balance();
  MESSAGE("turn, a ", a, " lambda ", lambda, ": L1 of the change of S ",
          sum / static_cast<Real>(before.size()), ", largest ", change.max,
          ", distance from the turned place ", place.max, " m, closure ", w.relative_closure(),
          ", steps ", solver.steps());
  CHECK(sum / static_cast<Real>(before.size()) <= 0.01);
  CHECK(place.max <= 0.02 * h);
  CHECK(std::fabs(w.relative_closure()) <= 1e-12);
}

/// Clay at rest under suction in a column that moves up or down: pressures stay hydrostatic in it.
void check_moving_rest(Real start, Real velocity) {
  const Real h = 0.1, height = 2, depth = 11.6;  // of the water table below the base
  vd::Scene<Moving> scene({.box = {Vec<1>(0.0), Vec<1>(4.5)}, .cell_size = h});
  scene.gravity[0] = -9.81;
  scene.liquid.bulk_modulus = 1e7;
  scene.add_soil(vd::box({start}, {start + height}),
                 soil(verify::table1::a, verify::table1::lambda, verify::table1::conductivity),
                 {.water_table = start - depth, .velocity = Vec<1>(velocity)});
  scene.add(
      vd::bc::PrescribedVelocity<1>{.region = vd::box({0.0}, {4.5}), .velocity = Vec<1>(velocity)});
  vd::Solver<Moving> solver(scene);
  const Real end = 12 * h / std::fabs(velocity);
  verify::Norm norm;
  for (int i = 1; i <= 60; ++i) {
    solver.advance_to(i * end / 60);
    // The cells are those at the start of the last step.
    const Real base = start + velocity * (solver.time() - solver.last_step().dt);
    verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
      norm.add(cell.pressure + 9810 * (cell.centroid[0] - base + depth));
    });
  }
  const auto w = solver.water_balance();
  MESSAGE("moving clay, start ", start, " velocity ", velocity, ": largest |dp| ", norm.max,
          " Pa, closure ", w.relative_closure(), ", steps ", solver.steps());
  CHECK(norm.max <= 100);
  CHECK(std::fabs(w.relative_closure()) <= 1e-12);
}

/// Rain of 0.3 k_sat on a column that moves by 10 cells of 0.1 m in 600 s.
void check_rain(Real h, Real bound, const std::vector<Real>& times) {
  const Real height = 2, start = 0.5, velocity = 1.0 / 600;
  const Real room = std::ceil(start + height + velocity * times.back() + 0.5);
  vd::Scene<Moving> scene({.box = {Vec<1>(0.0), Vec<1>(room)}, .cell_size = h});
  scene.gravity[0] = -9.81;
  scene.liquid.bulk_modulus = 1e6;
  scene.add_soil(vd::box({start}, {start + height}), soil(3, 0.63, 1e-4, false, 1e4),
                 {.saturation = 0.3});
  scene.add(vd::bc::PrescribedVelocity<1>{.region = vd::box({0.0}, {room}),
                                          .velocity = Vec<1>(velocity)});
  scene.add(vd::bc::Rain{.rate = 0.3e-4});
  vd::Solver<Moving> solver(scene);
  const verify::Table table("richards_profiles.csv");
  for (const Real t : times) {
    solver.advance_to(t);
    verify::Norm norm;
    const Real base = start + velocity * (t - solver.last_step().dt);
    verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
      const Real z = cell.centroid[0] - base;
      Real sum = 0;
      int count = 0;
      for (std::size_t i = 0; i < table.size(); ++i)
        if (table.text(i, "case") == "rain0.3" && table.number(i, "t_s") == t &&
            std::fabs(table.number(i, "z_m") - z) < 0.5 * h) {
          sum += table.number(i, "S");
          ++count;
        }
      if (count > 0) norm.add(cell.saturation - sum / count);
    });
    const auto w = solver.water_balance();
    MESSAGE("rain on a moving column, h ", h, " t ", t, ": rms S ", norm.rms(), " over ",
            norm.count, " cells, taken ", (w.pore - w.initial) / 1000, " m, closure ",
            w.relative_closure(), ", steps ", solver.steps());
    CHECK(norm.count >= std::lround(height / h) - 1);
    CHECK(norm.rms() <= 1.5 * bound);
    CHECK(verify::close((w.pore - w.initial) / 1000, 0.3e-4 * t, 0.01));
    CHECK(std::fabs(w.relative_closure()) <= 1e-12);
  }
}

/// [Zhan] Eq. (14) at void ratio n / (1 - n), written again: p of a water content theta at porosity n,
/// theta = n S(p, n) exp(p / K).
Real pressure_of(Real theta, Real n, Real a, Real lambda, Real reference_porosity, bool dependent,
                 Real bulk_modulus) {
  if (theta >= n) return bulk_modulus * std::log(theta / n);
  const Real e = dependent ? n / (1 - n) : reference_porosity / (1 - reference_porosity);
  Real low = -1e12, high = 0;
  for (int i = 0; i < 200; ++i) {
    const Real p = 0.5 * (low + high);
    const Real x = a * -p * std::pow(e, (1 - lambda) / lambda) / 9810;
    const Real s = std::pow(1 + std::pow(x, 1 / (1 - lambda)), -lambda);
    (n * s * std::exp(p / bulk_modulus) > theta ? high : low) = p;
  }
  return 0.5 * (low + high);
}

/// Undrained compression of S = 0.9 from J = 1 to 0.8 through S = 1 at about J = 0.96, by a velocity
/// -c x of all nodes.
void check_compression(Real a, Real lambda, bool dependent) {
  const Real h = 0.1, rate = 1, bulk_modulus = 2.2e9, n0 = 0.4;
  vd::Scene<Moving> scene({.box = {Vec<1>(0.0), Vec<1>(1.2)}, .cell_size = h});
  scene.liquid.bulk_modulus = bulk_modulus;
  scene.add_soil(vd::box({0.0}, {1.0}), soil(a, lambda, 1e-30, dependent), {.saturation = 0.9});
  prescribe(scene, [&](const Vec<1>& x) { return Vec<1>(-rate * x[0]); });
  vd::Solver<Moving> solver(scene);
  const Real content = solver.water_balance().initial / 1000;
  Real last = -1e12, largest = 0;
  bool below = false, above = false;
  for (const Real j : {0.99, 0.97, 0.965, 0.962, 0.961, 0.9605, 0.9601, 0.96, 0.9599, 0.9595, 0.959,
                       0.958, 0.955, 0.95, 0.93, 0.9, 0.85, 0.8}) {
    solver.advance_to(-std::log(j) / rate);
    vd::kernel::find_pressures(solver.mutable_state());
    const Real expected =
        pressure_of(content / j, 1 - (1 - n0) / j, a, lambda, n0, dependent, bulk_modulus);
    verify::Norm norm;
    Real low = 1e12, high = -1e12;
    verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
      norm.add(cell.pressure - expected);
      low = std::min(low, cell.pressure);
      high = std::max(high, cell.pressure);
    });
    CAPTURE(j);
    CAPTURE(expected);
    CHECK(norm.max <= 0.01 * std::fabs(expected) + 1);
    CHECK(low > last);  // no jump back
    last = high;
    largest = std::max(largest, norm.max / (std::fabs(expected) + 100));
    (expected < 0 ? below : above) = true;
  }
  CHECK(below);
  CHECK(above);
  const auto w = solver.water_balance();
  MESSAGE("compression, a ", a, " lambda ", lambda, std::string(dependent ? " S(s, n)" : " S(s)"),
          ": largest error of p ", 100 * largest, " %, p at the end ", last, " Pa, closure ",
          w.relative_closure(), ", steps ", solver.steps());
  CHECK(w.pore == w.initial);
}

}  // namespace

TEST_CASE("a sharp front slides over 50 cells without smearing: sand and clay") {
  check_front(3, 0.63, 1);
  check_front(12, 0.09, 1);
}
TEST_CASE("a sharp front turns by 90 degrees without smearing: sand and clay") {
  check_turn(3, 0.63);
  check_turn(verify::table1::a, verify::table1::lambda);
}
TEST_CASE("hydrostatic clay that moves over 12 cells keeps its pressures") {
  check_moving_rest(1, 0.1);
  check_moving_rest(2.23, -0.1);
}
TEST_CASE("rain below capacity on a column that moves over 10 cells") {
  check_rain(0.1, 0.015, {600});
}
TEST_CASE("undrained compression through saturation: sand and clay") {
  check_compression(3, 0.63, false);
  check_compression(3, 0.63, true);
  check_compression(verify::table1::a, verify::table1::lambda, true);
}

TEST_SUITE("long") {
  TEST_CASE("rain below capacity on a moving column to 4500 s") {
    check_rain(0.1, 0.015, {600, 1500, 3000, 4500});
    check_rain(0.05, 0.008, {600, 1500, 3000, 4500});
  }
}
