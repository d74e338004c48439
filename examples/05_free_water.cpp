// SPDX-License-Identifier: MIT
// A dam of water breaks onto dry sand: the water spreads, stands and sinks in. Writes a VTK series and
// dam_break_balance.csv here, prints the ledger and ends with status 1 if it does not close.

#include <cmath>
#include <cstdio>

#include <vadose/vadose.hpp>

namespace vd = vadose;

struct Sand : vd::UnsaturatedModel<vd::PlaneStrain> {
  using Skeleton = vd::law::Rigid;
};

namespace {

using vd::Real;

vd::Solver<Sand> start() {
  vd::Scene<Sand> scene{{.box = {{0.0, 0.0}, {3.0, 1.2}}, .cell_size = 0.05}};
  scene.gravity = {0.0, -9.81};
  scene.liquid = {.density = 1000, .bulk_modulus = 1e6};
  scene.add_soil(vd::box({0.0, 0.0}, {3.0, 0.4}),
                 {.name = "sand",
                  .porosity = 0.4,
                  .lambda = 0.63,
                  .retention = {.a = 3},
                  .conductivity = {.saturated_conductivity = 5e-3}},
                 {.dry = true});
  scene.add_water(vd::box({0.0, 0.4}, {0.6, 1.0}), {.surface_level = 1.0});
  return vd::Solver<Sand>{scene, {.transfer = {.pic_rate = 5}, .escaped = vd::Escape::clamp}};
}

}  // namespace

int main() {
  auto solver = start();
  vd::io::VtkSeries series{"dam_break"};
  vd::io::WaterBalanceHistory balance{"dam_break_balance.csv"};
  for (int i = 0; i <= 40; ++i) {
    solver.advance_to(0.2 * i);
    balance.record(solver);
    if (i < 10 || i % 10 == 0) series.write(solver);
  }
  vd::io::print_summary(stdout, solver);
  const auto w = solver.water_balance();
  std::printf("  %.1f of %.1f kg have sunk in\n", w.pore, w.initial);
  return std::fabs(w.relative_closure()) <= 1e-12 && w.pore > 0 ? 0 : 1;
}
