// SPDX-License-Identifier: MIT
// Everything in a model can be one's own: see the headers in plugins/. The library's checks try the
// law and the retention curve first. Then water percolates through a full column, at the conductivity
// of matrix and holes over the viscosity of the cold water; and tides swing beside a strip of soil.

#include <cmath>
#include <cstdio>
#include <exception>

#include <vadose/testing/check_law.hpp>
#include <vadose/testing/check_swrc.hpp>
#include <vadose/vadose.hpp>

#include "plugins/cold_water.hpp"
#include "plugins/fredlund_xing.hpp"
#include "plugins/macro_pores.hpp"
#include "plugins/mixed_spline.hpp"
#include "plugins/no_tension.hpp"
#include "plugins/tide.hpp"

namespace vd = vadose;

struct OwnSoil : vd::UnsaturatedModel<vd::Uniaxial> {
  using Skeleton = NoTension;
  using Retention = FredlundXing;
  using Conductivity = MacroPores;
  using Drag = ColdWater;
  using Shape = MixedSpline;
};

namespace {

const vd::Material<OwnSoil> loam{
    .name = "loam",
    .solid_density = 2650,
    .porosity = 0.45,
    .skeleton = {.elastic = {.young_modulus = 5e6, .poisson_ratio = 0.3}, .tensile_strength = 1e3},
    .retention = {.a = 5e3, .n = 2, .m = 1},
    .conductivity = {.matrix_conductivity = 2e-4, .hole_conductivity = 3e-4},
    .drag = {.temperature = 5},
};

/// Runs the library's checks; true if nothing is wrong.
bool check_plug_ins() {
  const auto law = vd::testing::check_law(loam.skeleton);
  const auto curve = vd::testing::check_swrc(loam.retention);
  std::printf("law: %sretention: %s", law.text().c_str(), curve.text().c_str());
  return law.ok() && curve.ok();
}

vd::Scene<OwnSoil> column() {
  vd::Scene<OwnSoil> scene{{.box = {{0.0}, {1.2}}, .cell_size = 0.1}};
  scene.gravity[0] = -9.81;
  scene.liquid = {.density = 1000, .bulk_modulus = 2e6};
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  return scene;
}

}  // namespace

int main() try {
  if (!check_plug_ins()) return 1;

  auto scene = column();
  scene.add_soil(vd::box({0.0}, {1.0}), loam,
                 {.suction = 0, .initial_stress = vd::InitialStress::geostatic});
  scene.add(vd::bc::Drained{.face = vd::Face::bottom});
  scene.add(vd::bc::ZeroSuction{});
  vd::Solver<OwnSoil> solver{scene, {.damping = 0.1}};
  solver.advance_to(20);
  const vd::Real before = solver.water_balance().outflow;
  solver.advance_to(40);
  const vd::Real flux = (solver.water_balance().outflow - before) / 1000 / 20;
  const vd::Real expected = 5e-4 / loam.drag.viscosity_ratio();
  std::printf("percolation %.4g m/s, expected %.4g m/s\n", flux, expected);

  auto shore = column();
  shore.add_soil(vd::box({0.0}, {1.0}), loam, {.water_table = 0.5});
  shore.add(tide(vd::Face::bottom, 0.5, 0.6, 20));
  vd::Solver<OwnSoil> swinging{shore, {.damping = 0.1}};
  swinging.advance_to(20);
  const auto w = swinging.water_balance();
  std::printf("one tide: %.2f kg/m2 in, %.2f kg/m2 out, ledger closes to %.1e\n", w.inflow,
              w.outflow, w.relative_closure());
  const bool good = std::fabs(flux / expected - 1) < 0.02 && w.inflow > 0.5 && w.outflow > 0.5 &&
                    std::fabs(w.relative_closure()) < 1e-12;
  return good ? 0 : 1;
} catch (const std::exception& e) {
  std::fprintf(stderr, "plug_ins: %s\n", e.what());
  return 1;
}
