// SPDX-License-Identifier: MIT
// Terzaghi's consolidation: a load on a full column is carried by the water first, then by the
// skeleton as the water leaves through the top. Checks the pressure at the base at T_v = 0.5.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <numbers>

#include <vadose/vadose.hpp>

namespace vd = vadose;

struct Clay : vd::SaturatedModel<vd::Uniaxial> {};  // the model: which physics

int main() try {
  const vd::Real load = 1e4, height = 1, h = 0.1;  // [Pa], [m]
  // The material: which soil.
  const vd::Material<Clay> clay{
      .name = "clay",
      .solid_density = 2600,
      .porosity = 0.4,
      .skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.33},
      .conductivity = {.saturated_conductivity = 1e-4},
  };

  vd::Scene<Clay> scene{{.box = {{0.0}, {height + 2 * h}}, .cell_size = h}};  // the scene: where
  scene.liquid = {.density = 1000, .bulk_modulus = 2.2e9};
  scene.add_soil(vd::box({0.0}, {height}), clay,
                 {.liquid_pressure = [=](const vd::Vec<1>&) { return load; }});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  scene.add(vd::bc::Traction<1>{.region = vd::box({height - h / 2}, {height}),
                                .traction = vd::Vec<1>(-load)});
  scene.add(vd::bc::ZeroSuction{});  // drained where the soil meets the air

  vd::Solver<Clay> solver{scene};  // the solver: state and step
  vd::io::Gauges gauges{"consolidation.csv"};
  gauges.position("base", {0.5 * h}, {vd::io::Measure::liquid_pressure});

  const vd::Real consolidation = 1e-4 * 14.816e6 / 9810;  // c_v = k E_c / gamma_l [m2/s]
  const vd::Real end = 0.5 * height * height / consolidation;
  for (int i = 0; i <= 20; ++i) {  // the loop is yours
    solver.advance_to(end * i / 20);
    gauges.record(solver);
  }

  vd::Real base = 0;
  solver.liquid().for_each([&](std::size_t batch, int lane) {
    base = std::max(base, solver.liquid().at(vd::field::liquid_pressure, batch)[lane]);
  });
  const vd::Real expected = 4 / std::numbers::pi * std::exp(-std::pow(std::numbers::pi / 2, 2) / 2);
  std::printf("base pressure over load: %.4f, series: %.4f\n", base / load, expected);
  return std::fabs(base / load - expected) < 0.005 ? 0 : 1;
} catch (const std::exception& e) {
  std::fprintf(stderr, "consolidation: %s\n", e.what());
  return 1;
}
