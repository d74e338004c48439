// SPDX-License-Identifier: MIT
// Rain on 1 m of sand: below what the sand can take all of it goes in; above, the rest stands on the
// ground, first as a film, then as points of free water. Writes rain_column_balance.csv and
// rain_column_profiles.csv here, prints both ledgers and ends with status 1 if they do not close or the
// water is not where it should be.

#include <cmath>
#include <cstdio>
#include <string>

#include <vadose/vadose.hpp>

namespace vd = vadose;

// Sand that stays where it is: no stresses, no velocities of the skeleton.
struct Sand : vd::UnsaturatedModel<vd::Uniaxial> {
  using Skeleton = vd::law::Rigid;
};

namespace {

using vd::Real;

constexpr Real k_sat = 1e-4;  // [m/s]

vd::Solver<Sand> column(Real rain) {
  vd::Scene<Sand> scene{{.box = {{0.0}, {1.5}}, .cell_size = 0.05}};
  scene.gravity = vd::Vec<1>(-9.81);
  // Soft water, long steps: pressures stay below 1 % of K.
  scene.liquid = {.density = 1000, .bulk_modulus = 1e6};
  scene.add_soil(vd::box({0.0}, {1.0}),
                 {.name = "sand",
                  .porosity = 0.4,
                  .lambda = 0.63,
                  .retention = {.a = 3},
                  .conductivity = {.saturated_conductivity = k_sat}},
                 {.saturation = 0.3});
  scene.add(vd::bc::Rain{.rate = rain});
  return vd::Solver<Sand>{scene};
}

// S of every cell of soil.
void write_profile(vd::io::History& profiles, const vd::Solver<Sand>& solver, Real rain) {
  const auto& nodes = solver.state().nodes;
  for (std::size_t i = 0; i < nodes.cell.size(); ++i)
    if (nodes.dof[i] == static_cast<std::int32_t>(i) && nodes.cell[i].kind == vd::CellKind::soil)
      profiles.add(
          {rain / k_sat, solver.time(), nodes.cell[i].centroid[0], nodes.cell[i].saturation});
}

bool run(Real rain, vd::io::History& balance, vd::io::History& profiles) {
  auto solver = column(rain);
  for (int i = 1; i <= 40; ++i) {
    solver.advance_to(15.0 * i);
    const auto w = solver.water_balance();
    balance.add({rain / k_sat, solver.time(), w.rain, w.pore - w.initial, w.film, w.free});
    if (i % 10 == 0) write_profile(profiles, solver, rain);
  }
  std::printf("\nrain of %g k_sat\n", rain / k_sat);
  vd::io::print_summary(stdout, solver);
  const auto w = solver.water_balance();
  const Real standing = w.film + w.free;
  const bool right_place = rain < k_sat ? standing < 1e-6 * w.rain : w.free > 0.1 * w.rain;
  return right_place && std::fabs(w.relative_closure()) <= 1e-12;
}

}  // namespace

int main() {
  vd::io::History balance{"rain_column_balance.csv",
                          {{"rain", "k_sat"},
                           {"time", "s"},
                           {"fallen", "kg/m2"},
                           {"infiltrated", "kg/m2"},
                           {"film", "kg/m2"},
                           {"free_water", "kg/m2"}}};
  vd::io::History profiles{
      "rain_column_profiles.csv",
      {{"rain", "k_sat"}, {"time", "s"}, {"height", "m"}, {"saturation", "-"}}};
  const bool below = run(0.3 * k_sat, balance, profiles);
  const bool above = run(3 * k_sat, balance, profiles);
  return below && above ? 0 : 1;
}
