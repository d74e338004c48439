// SPDX-License-Identifier: MIT
// The printed equations as a scheme, the yardstick of the others: Terzaghi's column, and what the
// printed point force does to a pond.

#include <doctest/doctest.h>

#include "verify_support.hpp"

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

struct Saturated : vd::SaturatedModel<vd::Uniaxial> {};
using Printed = vd::scheme::PaperLiteral<>;

}  // namespace

// In saturated soil the printed drag is right; the error is that of points instead of cells.
TEST_CASE("the printed equations consolidate a saturated column") {
  constexpr Real height = 1, h = 0.1, load = 1e4, conductivity = 1e-3, bulk_modulus = 2.2e8;
  const Real stiffness =
      verify::oedometric_modulus(verify::table1::young_modulus, verify::table1::poisson_ratio);
  const Real share = 1 / (1 + verify::table1::porosity * stiffness / bulk_modulus);
  const Real consolidation =
      conductivity / 9810 / (1 / stiffness + verify::table1::porosity / bulk_modulus);
  vd::Scene<Saturated> scene({.box = {Vec<1>(0.0), Vec<1>(height + 2 * h)}, .cell_size = h});
  scene.liquid.bulk_modulus = bulk_modulus;
  auto material = verify::saturated_soil<Saturated>(conductivity);
  material.conductivity.porosity_dependent = false;
  scene.add_soil(vd::box(Vec<1>(0.0), Vec<1>(height)), material,
                 {.liquid_pressure = [=](const Vec<1>&) { return share * load; }});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  scene.add(vd::bc::Traction<1>{.region = vd::box(Vec<1>(height - h / 2), Vec<1>(height)),
                                .traction = Vec<1>(-load)});
  scene.add(vd::bc::ZeroSuction{});
  vd::Solver<Saturated, Printed> solver(scene);
  for (const Real time_factor : {0.1, 0.3}) {
    solver.advance_to(time_factor * height * height / consolidation);
    // Means of the points of a cell against the series averaged over the cell.
    Real sum[10] = {}, count[10] = {};
    solver.liquid().for_each([&](std::size_t b, int l) {
      const auto cell = static_cast<std::size_t>(
          std::min(9.0, solver.liquid().at(vd::field::position, b)[l] / h));
      sum[cell] += solver.liquid().at(vd::field::liquid_pressure, b)[l];
      count[cell] += 1;
    });
    verify::Norm norm;
    for (int i = 0; i < 10; ++i) {
      const Real depth = height - (i + 0.5) * h;
      const Real exact =
          share * load * verify::terzaghi_mean(depth - 0.5 * h, depth + 0.5 * h, time_factor);
      norm.add((sum[i] / count[i] - exact) / load);
    }
    MESSAGE("printed equations, Tv ", time_factor, ": rms ", 100 * norm.rms(),
            " % of the load after ", solver.steps(), " steps");
    CHECK(norm.rms() <= 0.02);
    CHECK(std::fabs(solver.water_balance().relative_closure()) <= 1e-12);
  }
}
