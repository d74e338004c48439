// SPDX-License-Identifier: MIT
// A reservoir beside a slope of sand falls within 20 s: the slope drains through its face, above the
// falling water as a seepage face. Writes a VTK series and reservoir_drawdown_balance.csv here, prints
// the ledger and ends with status 1 if it does not close.

#include <cmath>
#include <cstdio>

#include <vadose/vadose.hpp>

namespace vd = vadose;

struct Sand : vd::UnsaturatedModel<vd::PlaneStrain> {
  using Skeleton = vd::law::Rigid;
};

namespace {

using vd::Real;

constexpr Real high = 1.0, low = 0.5;  // levels [m]

Real level(Real t) {
  return t < 20 ? high + (low - high) * t / 20 : low;
}

vd::Solver<Sand> start() {
  vd::Scene<Sand> scene{{.box = {{0.0, 0.0}, {4.0, 1.4}}, .cell_size = 0.1}};
  scene.gravity = {0.0, -9.81};
  scene.liquid = {.density = 1000, .bulk_modulus = 1e6};
  scene.add_soil(vd::polygon({{0, 0}, {4, 0}, {4, 0.4}, {3, 0.4}, {1.4, 1.2}, {0, 1.2}}),
                 {.name = "sand",
                  .porosity = 0.4,
                  .lambda = 0.63,
                  .retention = {.a = 3},
                  .conductivity = {.saturated_conductivity = 1e-3}},
                 {.water_table = high});
  scene.add(vd::bc::Reservoir{.function = level});
  return vd::Solver<Sand>{scene};
}

}  // namespace

int main() {
  auto solver = start();
  vd::io::VtkSeries series{"reservoir_drawdown"};
  vd::io::WaterBalanceHistory balance{"reservoir_drawdown_balance.csv"};
  for (int i = 0; i <= 30; ++i) {
    solver.advance_to(2.0 * i);
    balance.record(solver);
    if (i % 5 == 0) series.write(solver);
  }
  vd::io::print_summary(stdout, solver);
  const auto w = solver.water_balance();
  std::printf("  the slope gave %.1f kg back to the reservoir, that is %.1f %% of its water\n",
              w.outflow - w.inflow, 100 * (w.outflow - w.inflow) / w.initial);
  return std::fabs(w.relative_closure()) <= 1e-12 && w.outflow > w.inflow ? 0 : 1;
}
