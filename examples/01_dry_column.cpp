// SPDX-License-Identifier: MIT
// A dry column of 1 m settles under its own weight by w H^2 / (2 E_c) = 0.51644 mm at rest. Where
// gravity comes on suddenly and nothing damps, it swings between 0 and twice that.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <utility>

#include <vadose/vadose.hpp>

namespace vd = vadose;

struct DrySoil : vd::DryModel<vd::Uniaxial> {};  // linear elasticity, GIMP, FLIP

namespace {

constexpr vd::Real settlement = 0.51644e-3;  // closed form [m]

// Largest settlement of a point until time t, and the settlement then [m].
std::pair<vd::Real, vd::Real> settle(vd::Real damping, vd::Real t) {
  const vd::Material<DrySoil> soil{.solid_density = 2600,  // [kg/m3]
                                   .porosity = 0.4,
                                   .skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.33}};
  vd::Scene<DrySoil> scene{{.box = {{0.0}, {1.2}}, .cell_size = 0.05}};  // [m]
  scene.gravity[0] = -9.81;
  scene.add_soil(vd::box({0.0}, {1.0}), soil);
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});

  vd::Solver<DrySoil> solver{scene, {.damping = damping}};
  vd::Real largest = 0, now = 0;
  while (solver.time() < t) {
    solver.advance_to(std::min(t, solver.time() + 1e-3));
    now = 0;
    solver.solid().for_each([&](std::size_t batch, int lane) {
      now = std::max(now, -solver.displacement(batch, lane)[0]);
    });
    largest = std::max(largest, now);
  }
  return {largest, now};
}

}  // namespace

int main() try {
  const vd::Real swing = settle(0, 0.03).first / (2 * settlement);  // 3/4 of the first period
  const vd::Real rest = settle(0.7, 1).second / settlement;
  std::printf("undamped: %.2f %% of twice the settlement; damped: %.2f %% of it\n", 100 * swing,
              100 * rest);
  return std::fabs(swing - 1) < 0.02 && std::fabs(rest - 1) < 0.005 ? 0 : 1;
} catch (const std::exception& e) {
  std::fprintf(stderr, "dry_column: %s\n", e.what());
  return 1;
}
