// SPDX-License-Identifier: MIT
// Water rides with the soil: sharp fronts that move over many cells, rain on a column that moves.

#include <doctest/doctest.h>

#include "verify_support.hpp"

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

struct Moving : vd::UnsaturatedModel<vd::Uniaxial> {
  using Skeleton = vd::law::LinearElastic;
};

/// Soil of a column; all nodes move with a velocity.
vd::Material<Moving> soil(Real a, Real lambda, Real conductivity) {
  return {.name = "soil",
          .solid_density = 2650,
          .porosity = 0.4,
          .lambda = lambda,
          .skeleton = {.young_modulus = 1e6, .poisson_ratio = 0.2},
          .retention = {.a = a, .porosity_dependent = false},
          .conductivity = {.saturated_conductivity = conductivity, .porosity_dependent = false}};
}

std::vector<Real> saturations(const vd::Solver<Moving>& solver) {
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

}  // namespace

TEST_CASE("a sharp front slides over 50 cells without smearing: sand and clay") {
  check_front(3, 0.63, 1);
  check_front(12, 0.09, 1);
}

TEST_CASE("rain below capacity on a column that moves over 10 cells") {
  const Real h = 0.1, height = 2, start = 0.5, end = 600;
  vd::Scene<Moving> scene({.box = {Vec<1>(0.0), Vec<1>(4.0)}, .cell_size = h});
  scene.gravity[0] = -9.81;
  scene.liquid.bulk_modulus = 1e6;
  scene.add_soil(vd::box({start}, {start + height}), soil(3, 0.63, 1e-4), {.saturation = 0.3});
  scene.add(vd::bc::PrescribedVelocity<1>{.region = vd::box({0.0}, {4.0}),
                                          .velocity = Vec<1>(10 * h / end)});
  scene.add(vd::bc::Rain{.rate = 0.3e-4});
  vd::Solver<Moving> solver(scene);
  solver.advance_to(end);
  const verify::Table table("richards_profiles.csv");
  verify::Norm norm;
  const Real base = start + 10 * h;
  verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
    const Real z = cell.centroid[0] - base;
    Real sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < table.size(); ++i)
      if (table.text(i, "case") == "rain0.3" && table.number(i, "t_s") == end &&
          std::fabs(table.number(i, "z_m") - z) < 0.5 * h) {
        sum += table.number(i, "S");
        ++count;
      }
    if (count > 0) norm.add(cell.saturation - sum / count);
  });
  const auto w = solver.water_balance();
  MESSAGE("rms S ", norm.rms(), " over ", norm.count, " cells, taken ", (w.pore - w.initial) / 1000,
          " m, closure ", w.relative_closure(), ", steps ", solver.steps());
  CHECK(norm.count >= 19);
  CHECK(norm.rms() <= 1.5 * 0.015);
  CHECK(verify::close((w.pore - w.initial) / 1000, 0.018, 0.01));
  CHECK(std::fabs(w.relative_closure()) <= 1e-12);
}
