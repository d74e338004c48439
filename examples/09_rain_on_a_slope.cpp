// SPDX-License-Identifier: MIT
// Heavy rain on a slope of sand: a part goes in, the rest runs down as free water and collects at
// the toe. Writes a VTK series and rain_slope_balance.csv here, prints the ledger and ends with
// status 1 if it does not close or nothing went in or ran off.

#include <cmath>
#include <cstdio>

#include <vadose/vadose.hpp>

namespace vd = vadose;

struct Sand : vd::UnsaturatedModel<vd::PlaneStrain> {
  using Skeleton = vd::law::Rigid;
};

namespace {

using vd::Real;

constexpr Real rain = 5e-3, end_time = 40;  // [m/s], [s]; it rains for half of the time

vd::Solver<Sand> start() {
  vd::Scene<Sand> scene{{.box = {{0.0, 0.0}, {4.0, 1.6}}, .cell_size = 0.1}};
  scene.gravity = {0.0, -9.81};
  scene.liquid = {.density = 1000, .bulk_modulus = 1e6};
  scene.add_soil(vd::polygon({{0, 0}, {4, 0}, {4, 0.4}, {3, 0.4}, {1, 1.2}, {0, 1.2}}),
                 {.name = "sand",
                  .porosity = 0.4,
                  .lambda = 0.63,
                  .retention = {.a = 3},
                  .conductivity = {.saturated_conductivity = 1e-3}},
                 {.saturation = 0.6});
  scene.add(vd::bc::Rain{.function = [](Real t) { return t < 0.5 * end_time ? rain : 0.0; }});
  return vd::Solver<Sand>{scene, {.transfer = {.pic_rate = 2}}};
}

}  // namespace

int main() {
  auto solver = start();
  vd::io::VtkSeries series{"rain_slope"};
  vd::io::WaterBalanceHistory balance{"rain_slope_balance.csv"};
  for (int i = 0; i <= 40; ++i) {
    solver.advance_to(end_time * i / 40);
    balance.record(solver);
    if (i % 4 == 0) series.write(solver);
  }
  vd::io::print_summary(stdout, solver);
  // Free water to the right of the toe.
  Real collected = 0;
  const auto& liquid = solver.liquid();
  liquid.for_each([&](std::size_t b, int l) {
    if (liquid.group(b) == solver.state().free_group() &&
        liquid.at(vd::field::position, b, 0)[l] > 3)
      collected += liquid.at(vd::field::mass, b)[l];
  });
  const auto w = solver.water_balance();
  std::printf("  of %.1f kg of rain %.1f kg went in and %.1f kg ran off to the toe\n", w.rain,
              w.pore - w.initial, collected);
  const bool both = collected > 0 && w.pore > w.initial;
  return both && std::fabs(w.relative_closure()) <= 1e-12 ? 0 : 1;
}
