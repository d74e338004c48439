// SPDX-License-Identifier: MIT
// [Zhan] 4.2: a pond of free liquid points sinks into 10 m of clay, rigid or elastic
// (tests/reference/r3_pond_profiles.csv; pond left and heave of its summary).

#include <doctest/doctest.h>

#include "verify_support.hpp"

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

struct Rigid : vd::UnsaturatedModel<vd::Uniaxial> {
  using Skeleton = vd::law::Rigid;
};
struct Elastic : vd::UnsaturatedModel<vd::Uniaxial> {
  using Skeleton = vd::law::LinearElastic;
};

constexpr Real height = 10, gravity = 9.81, top_pressure = -114e3;
/// Ten times softer than water: at rest the pores hold n H mean(p) / K = 1 mm more water.
constexpr Real bulk_modulus = 2.2e8;

template <class M>
vd::Solver<M> ponded(Real h, Real depth) {
  constexpr bool rigid = std::is_same_v<M, Rigid>;
  vd::Scene<M> scene({.box = {Vec<1>(0.0), Vec<1>(height + 1)}, .cell_size = h});
  scene.gravity[0] = -gravity;
  scene.liquid.bulk_modulus = bulk_modulus;
  vd::Material<M> clay = {.name = "clay",
                          .porosity = verify::table1::porosity,
                          .lambda = verify::table1::lambda,
                          .retention = {.a = verify::table1::a, .porosity_dependent = !rigid},
                          .conductivity = {.saturated_conductivity = verify::table1::conductivity,
                                           .porosity_dependent = !rigid}};
  vd::SoilOptions<1> options{.water_table = height + top_pressure / (1000 * gravity)};
  if constexpr (!rigid) {
    clay.solid_density = verify::table1::solid_density;
    clay.skeleton = {.young_modulus = verify::table1::young_modulus,
                     .poisson_ratio = verify::table1::poisson_ratio};
    options.initial_stress = vd::InitialStress::geostatic;
    scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  }
  scene.add_soil(vd::box({0.0}, {height}), clay, options);
  scene.add_water(vd::box({height}, {height + depth}), {.surface_level = height + depth});
  vd::Solver<M> solver(scene, {.damping = rigid ? 0.0 : 0.05});
  if constexpr (!rigid) {
    // The pond rests on the soil before it may sink in.
    REQUIRE(solver.equilibrate({.tolerance = 1e-5, .max_time = 20}).residual < 1e-4);
  }
  return solver;
}

/// Depth of the water on the ground [m]: below half a cell it is a film.
Real pond(const vd::WaterBalance& w) {
  return (w.free + w.film) / 1000;
}

template <class M>
Real heave(const vd::Solver<M>& solver) {
  Real most = -1;
  solver.solid().for_each(
      [&](std::size_t b, int l) { most = std::max(most, solver.displacement(b, l)[0]); });
  return most;
}

/// rms error of S over the cells; the reference linear between its rows.
template <class M>
Real profile_error(const vd::Solver<M>& solver, const std::string& name, Real t) {
  static const verify::Table table("r3_pond_profiles.csv");
  std::vector<std::pair<Real, Real>> rows;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.text(i, "case") == name && table.number(i, "t_s") == t)
      rows.emplace_back(table.number(i, "z_m"), table.number(i, "Sr"));
  REQUIRE(rows.size() > 2);
  verify::Norm norm;
  verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
    std::size_t i = 1;
    while (i + 1 < rows.size() && rows[i].first < cell.centroid[0]) ++i;
    const auto [za, sa] = rows[i - 1];
    const auto [zb, sb] = rows[i];
    const Real x = std::min(Real(1), (cell.centroid[0] - za) / (zb - za));
    norm.add(cell.saturation - (sa + x * (sb - sa)));
  });
  return norm.rms();
}

template <class M>
void check_pond(const std::string& name, Real h, const std::vector<Real>& times, Real end,
                Real expected_left, Real expected_heave) {
  auto solver = ponded<M>(h, 0.5);
  const auto report = [&](Real error) {
    const auto w = solver.water_balance();
    MESSAGE(name, " h ", h, " t ", solver.time(), " s: pond ", pond(w), " m, heave ", heave(solver),
            " m, rms S ", error, ", closure ", w.relative_closure(), ", steps ", solver.steps());
    CHECK(std::fabs(w.relative_closure()) <= 1e-12);
  };
  for (const Real t : times) {
    solver.advance_to(t);
    const Real error = profile_error(solver, name, t);
    report(error);
    CHECK(error <= 0.01);
  }
  solver.advance_to(end);
  report(vd::unset);
  CHECK(verify::close(pond(solver.water_balance()), expected_left, 0.02));
  if (expected_heave > 0) CHECK(verify::close(heave(solver), expected_heave, 0.02));
  Real base = 0, lowest = 1e9;
  verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
    if (cell.centroid[0] >= lowest) return;
    lowest = cell.centroid[0];
    base = cell.pressure + 1000 * gravity * lowest;
  });
  const Real level = height + expected_left + expected_heave;
  MESSAGE("base pressure ", base, " Pa, at rest ", 1000 * gravity * level);
  CHECK(verify::close(base, 1000 * gravity * level, 0.01));
}

/// When a pond of 0.2 m has run dry.
template <class M>
void check_dry(Real h, Real expected) {
  auto solver = ponded<M>(h, 0.2);
  Real dry = vd::unset;
  for (Real t = 0.5 * expected; !vd::is_finite(dry) && t < 1.5 * expected; t += 0.5) {
    solver.advance_to(t);
    if (pond(solver.water_balance()) < 1e-4) dry = t;
  }
  const auto w = solver.water_balance();
  MESSAGE("h ", h, ": dry after ", dry, " s, expected ", expected, ", heave ", heave(solver),
          ", closure ", w.relative_closure(), ", steps ", solver.steps());
  CHECK(verify::close(dry, expected, 0.05));
  CHECK(std::fabs(w.relative_closure()) <= 1e-12);
}

}  // namespace

TEST_CASE("pond of 0.2 m on rigid clay runs dry") {
  check_dry<Rigid>(0.2, 180.0);
}
TEST_SUITE("long") {
  TEST_CASE("pond of 0.2 m on elastic clay runs dry") {
    check_dry<Elastic>(0.2, 170.5);
  }
}
TEST_CASE("pond of 0.5 m on rigid clay") {
  check_pond<Rigid>("rigid_pond0.5", 0.5, {50, 100, 200}, 300, 0.2155, 0);
}
TEST_CASE("pond of 0.5 m on elastic clay") {
  check_pond<Elastic>("full_pond0.5", 0.5, {50, 100, 200}, 500, 0.1402, 0.0753);
}
