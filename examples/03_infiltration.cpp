// SPDX-License-Identifier: MIT
// [Zhan] 4.2: a pond of 0.5 m, made of free liquid points, sinks into 10 m of elastic clay that swells.
// Writes pond.csv here, prints the ledger, and ends with status 1 if it does not close or if pond or
// heave are not those of coupled Richards, within 3 %.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <vadose/vadose.hpp>

namespace vd = vadose;

struct Clay : vd::UnsaturatedModel<vd::Uniaxial> {
  using Skeleton = vd::law::LinearElastic;
};

namespace {

using vd::Real;

constexpr Real height = 10, pond = 0.5;  // [m]

vd::Solver<Clay> start() {
  vd::Scene<Clay> scene{{.box = {{0.0}, {height + 1}}, .cell_size = 0.5}};
  scene.gravity = vd::Vec<1>(-9.81);
  scene.liquid = {.density = 1000, .bulk_modulus = 2.2e8};
  // Hydrostatic, -114 kPa at the top.
  scene.add_soil(
      vd::box({0.0}, {height}),
      {.name = "clay",
       .solid_density = 2600,
       .porosity = 0.4,
       .lambda = 0.09,
       .skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.33},
       .retention = {.a = 12},
       .conductivity = {.saturated_conductivity = 9.8e-4}},
      {.water_table = height - 114e3 / 9810, .initial_stress = vd::InitialStress::geostatic});
  scene.add_water(vd::box({height}, {height + pond}), {.surface_level = height + pond});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  vd::Solver<Clay> solver{scene, {.damping = 0.05}};
  solver.equilibrate({.tolerance = 1e-5, .max_time = 20});  // the pond rests on the clay
  return solver;
}

Real heave(const vd::Solver<Clay>& solver) {
  Real most = -1;
  solver.solid().for_each(
      [&](std::size_t b, int l) { most = std::max(most, solver.displacement(b, l)[0]); });
  return most;
}

}  // namespace

int main() {
  auto solver = start();
  vd::io::History history{"pond.csv", {{"time", "s"}, {"pond", "m"}, {"heave", "m"}}};
  for (int i = 0; i <= 100; ++i) {
    solver.advance_to(5.0 * i);
    const auto w = solver.water_balance();
    history.add({solver.time(), (w.free + w.film) / 1000, heave(solver)});
  }
  vd::io::print_summary(stdout, solver);
  const auto w = solver.water_balance();
  const Real left = (w.free + w.film) / 1000, up = heave(solver);
  std::printf("  pond left %.4f m (coupled Richards 0.1402 m), heave %.4f m (0.0753 m)\n", left,
              up);
  const bool good = std::fabs(left / 0.1402 - 1) < 0.03 && std::fabs(up / 0.0753 - 1) < 0.03 &&
                    std::fabs(w.relative_closure()) <= 1e-12;
  return good ? 0 : 1;
}
