// SPDX-License-Identifier: MIT
// A soil-water retention curve of one's own: laws/brooks_corey.hpp. A column of full sand drains
// through its bottom until its water hangs in equilibrium over the water table there: p = -rho g z,
// so the water left is the integral of n S(rho g z).

#include <cmath>
#include <cstdio>
#include <exception>

#include <vadose/vadose.hpp>

#include "laws/brooks_corey.hpp"

namespace vd = vadose;

// Seepage only: the skeleton does not move.
struct Drainage : vd::UnsaturatedModel<vd::Uniaxial> {
  using Skeleton = vd::law::Rigid;
  using Retention = BrooksCorey;
  using Conductivity = vd::conductivity::Constant;
};

int main() try {
  constexpr vd::Real height = 1, porosity = 0.4, gravity = 9.81, density = 1000;
  const vd::Material<Drainage> sand{
      .name = "sand",
      .porosity = porosity,
      .retention = {.residual_saturation = 0.05, .air_entry = 3e3, .pore_index = 2},
      .conductivity = {.saturated_conductivity = 0.05},
  };
  vd::Scene<Drainage> scene{{.box = {{0.0}, {height}}, .cell_size = 0.05}};
  scene.gravity[0] = -gravity;
  scene.liquid = {.density = density, .bulk_modulus = 1e7};  // softer water, larger steps
  scene.add_soil(vd::box({0.0}, {height}), sand, {.points_per_cell = 2, .suction = 0});
  scene.add(vd::bc::Drained{.face = vd::Face::bottom});

  vd::Solver<Drainage> solver{scene};
  for (int i = 1; i <= 5; ++i) {
    solver.advance_to(6.0 * i);
    std::printf("t = %2.0f s: %.2f kg/m2 of %.2f kg/m2 drained\n", solver.time(),
                solver.water_balance().outflow, solver.water_balance().initial);
  }
  vd::Real left = 0;
  constexpr int parts = 1000;
  for (int i = 0; i < parts; ++i) {
    const vd::Real z = height * (i + 0.5) / parts;
    left += density * porosity * height / parts *
            sand.retention.saturation(density * gravity * z, porosity);
  }
  const vd::Real error = solver.water_balance().pore / left - 1;
  std::printf("left %.2f kg/m2, expected %.2f kg/m2, error %.2f %%, water balance closes to %.1e\n",
              solver.water_balance().pore, left, 100 * error,
              solver.water_balance().relative_closure());
  return std::fabs(error) < 0.01 ? 0 : 1;
} catch (const std::exception& e) {
  std::fprintf(stderr, "custom_retention: %s\n", e.what());
  return 1;
}
