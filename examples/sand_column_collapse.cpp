// SPDX-License-Identifier: MIT
// [Zhan] 4.3: a column of moist sand collapses when the plate at its side is taken away, for water
// contents w of 0 to 4 %. What is measured is the run-out R(w) = (L1 - L0) / H0.
//
//   sand_column_collapse [--water-content 1] [--cell-size 0.0025] ...      --help lists the flags
//   sand_column_collapse --sweep          all water contents of the paper; R(w) in column_sweep.csv
//   sand_column_collapse --sweep --cell-size 0.005      the same in a seventh of the time
//
// What the paper does not say, and what is done here:
// - The size is printed as 0.007 x 0.008 m, 3.5 x 4 grains; it is 0.07 x 0.08 m (suction holds a
//   vertical face of 30 to 100 mm). Which of the two is the height is not said: H0 = 0.08 m and
//   L0 = 0.07 m here, `--height 0.07 --length 0.08` is the other reading.
// - The cells: 2.5 mm, about one grain, with four points of each phase.
// - The stiffness: Table 2 has E = 50 MPa; the default here is a tenth of it, for steps three times as
//   long. The weight of the column strains it by 3e-4. --young-modulus 5e7 takes the printed one.
// - The box: the base is rough (--base-friction makes it slide), the wall behind the column smooth.
//   The plate is gone at t = 0; before, it held the earth pressure at rest.
// - The cone: matched in plane strain, so that phi = 35 degrees is what is mobilised.
// - L1: the deposit ends where it is thinner than one grain of 2 mm, its scattered grains pushed
//   together. The files also have the place behind which 99 % of the sand lies, and the last point.
// - w: S = w (1 - n) rho_s / (n rho_l) = 4.2 w; the paper's 0.042 and 0.126 for 1 and 3 %.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include <examples/support/flags.hpp>
#include <vadose/vadose.hpp>

namespace vd = vadose;

// What the scene models: dry sand is the same model without water.
struct SandColumn : vd::UnsaturatedModel<vd::PlaneStrain> {
  using Skeleton = vd::law::WithOpening<vd::law::DruckerPrager>;
};

namespace {

using vd::Real;

constexpr Real grain = 0.002;                                           // [m]
constexpr Real solid_density = 2800, liquid_density = 1000;             // [kg/m3]
constexpr Real porosity = 0.4;                                          // [-]
constexpr Real contents[] = {0, 0.25, 0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4};  // of the sweep [%]

struct Choices : example::RunChoices {
  Real height = 0.08, length = 0.07;  // H0, L0 [m]
  Real water_content = 1;             // w [%]
  Real cell_size = 0.0025;            // [m]
  Real friction_angle = 35;           // [degrees]
  Real young_modulus = 5e6;           // of the skeleton [Pa]
  Real poisson_ratio = 0.33;          // [-]
  Real base_friction = vd::unset;     // [-]; unset: rough
  int points_per_cell = 4;
  bool sweep = false;

  Choices() : RunChoices{.end_time = 0.5} {}
};

// 0.2 x 0.1 m of rods of 1 and 1.5 mm; the front came to rest about 0.43 m from the wall.
void rods(Choices& c) {
  c.height = 0.1;
  c.length = 0.2;
  c.water_content = 0;
  c.friction_angle = 19.8;
  c.young_modulus = 0.84e6;
  c.poisson_ratio = 0.3;
  c.end_time = 1;
  c.damping = 0;
}

Choices read(int count, char** words) {
  Choices c;
  example::Flags("sand_column_collapse: collapse of a column of moist sand, [Zhan] 4.3")
      .number("--water-content", "W", c.water_content, "by weight in %")
      .on("--sweep", c.sweep, "water contents of 0 to 4 %, each in a folder of its own")
      .number("--height", "H", c.height, "of the column in m")
      .number("--length", "L", c.length, "of the column in m")
      .number("--cell-size", "H", c.cell_size, "cells of H m")
      .whole("--points-per-cell", c.points_per_cell, 64, "of each phase: 1, 4, 9, ...")
      .number("--base-friction", "MU", c.base_friction, "Coulomb friction of the base (rough)")
      .number("--young-modulus", "E", c.young_modulus, "of the sand in Pa; Table 2: 5e7")
      .number("--friction-angle", "PHI", c.friction_angle, "in degrees")
      .preset(
          "--rods", [&] { rods(c); }, "the dry column of aluminium rods of Bui et al. (2008)")
      .check(c)
      .common(c)
      .read(count, words);
  vd::check::positive("--height", c.height, "m");
  vd::check::positive("--length", c.length, "m");
  vd::check::positive("--end-time", c.end_time, "s");
  vd::check::within("--water-content", c.water_content, 0, 20, "%");
  return c;
}

// [Zhan] Table 2.
vd::Material<SandColumn> sand(const Choices& c) {
  return {
      .name = "sand",
      .solid_density = solid_density,
      .porosity = porosity,
      .lambda = 0.63,
      .skeleton = {{.elastic = {.young_modulus = c.young_modulus, .poisson_ratio = c.poisson_ratio},
                    .cohesion = 0,
                    .friction_angle = vd::degrees(c.friction_angle),
                    .dilation_angle = 0,
                    .tensile_strength = 0,
                    .cone = c.cone}},
      .retention = {.residual_saturation = 0, .a = 18.4},
      .conductivity = {.saturated_conductivity = 4.41e-6}};
}

// S at the start.
Real saturation(const Choices& c) {
  return 0.01 * c.water_content * (1 - porosity) * solid_density / (porosity * liquid_density);
}

vd::Solver<SandColumn> start(const Choices& c) {
  const auto cells = [&](Real edge) { return c.cell_size * std::ceil(edge / c.cell_size - 1e-9); };
  vd::Scene<SandColumn> scene{
      {.box = {{0.0, 0.0}, {cells(c.length + 3.5 * c.height), cells(1.25 * c.height)}},
       .cell_size = c.cell_size}};
  scene.gravity = {0.0, -9.81};
  scene.liquid = {.density = liquid_density, .bulk_modulus = c.bulk_modulus};
  vd::SoilOptions<2> options{.points_per_cell = c.points_per_cell,
                             .initial_stress = vd::InitialStress::geostatic};
  if (c.water_content > 0)
    options.saturation = saturation(c);
  else
    options.dry = true;
  scene.add_soil(vd::box({0.0, 0.0}, {c.length, c.height}), sand(c), options);
  if (c.base_friction == c.base_friction)
    scene.add(
        vd::bc::Frictional{.face = vd::Face::bottom, .friction_coefficient = c.base_friction});
  else
    scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  scene.add(vd::bc::Roller{.face = vd::Face::left});
  scene.add(vd::bc::Roller{.face = vd::Face::right});
  return vd::Solver<SandColumn>{scene,
                                {.courant = c.courant,
                                 .damping = c.damping,
                                 .transfer = {.pic_rate = c.pic_rate},
                                 .threads = c.threads}};
}

// Shape of the deposit.
struct Deposit {
  Real front = 0;                   // where it is thinner than a grain [m]
  Real front_99 = 0, farthest = 0;  // behind which 99 % of the sand lies, and all [m]
  Real height = 0;                  // at the wall [m]
  Real energy = 0;                  // kinetic [J/m]
};

Deposit measure(const vd::Solver<SandColumn>& solver, Real cell_size) {
  const auto& solid = solver.solid();
  std::vector<Real> x, thickness;
  Deposit d;
  solid.for_each([&](std::size_t b, int l) {
    const Real px = solid.at(vd::field::position, b, 0)[l];
    const Real py = solid.at(vd::field::position, b, 1)[l];
    x.push_back(px);
    const auto column = static_cast<std::size_t>(px / cell_size);
    if (thickness.size() <= column) thickness.resize(column + 1);
    // Sand pushed together to its porosity at the start: what flies counts little.
    const Real mass = solid.at(vd::field::mass, b)[l];
    thickness[column] += mass / (solid_density * (1 - porosity) * cell_size);
    if (px < 2 * cell_size) d.height = std::max(d.height, py);
    const Real u = solid.at(vd::field::velocity, b, 0)[l];
    const Real v = solid.at(vd::field::velocity, b, 1)[l];
    d.energy += 0.5 * mass * (u * u + v * v);
  });
  std::sort(x.begin(), x.end());
  d.front_99 = x[x.size() * 99 / 100];
  d.farthest = x.back();
  // From the wall on to the first column of cells thinner than a grain; in it, as far as it is filled.
  std::size_t column = 0;
  while (column < thickness.size() && thickness[column] >= grain) ++column;
  const Real rest = column < thickness.size() ? thickness[column] / grain : 0;
  d.front = cell_size * (static_cast<Real>(column) + rest);
  return d;
}

// Height up to which a vertical face stands by suction: H_c = (4 c / gamma) tan(45 + phi/2) with
// c = S s tan(phi) [m].
Real critical_height(const Choices& c, Real suction) {
  const Real phi = vd::degrees(c.friction_angle), s = saturation(c);
  const Real weight = 9.81 * ((1 - porosity) * solid_density + porosity * s * liquid_density);
  return 4 * s * suction * std::tan(phi) / weight * std::tan(vd::degrees(45) + phi / 2);
}

struct Result {
  Deposit deposit;
  Real run_out = 0;          // R [-]
  Real critical_height = 0;  // [m]
};

// One column to its end.
Result run(const Choices& c) {
  std::filesystem::create_directories(c.output);
  vd::Solver<SandColumn> solver = start(c);
  Result result;
  if (c.water_content > 0) {
    const auto material = sand(c).resolved(9.81 * liquid_density);
    const Real suction = vd::swrc::suction(material.retention, saturation(c), porosity);
    result.critical_height = critical_height(c, suction);
    std::printf("w = %g %%: S = %.4f, s = %.0f Pa, S s = %.0f Pa; a face of %.3f m stands\n",
                c.water_content, saturation(c), suction, saturation(c) * suction,
                result.critical_height);
  } else {
    std::printf("dry\n");
  }
  if (!c.check) vd::io::print_preflight(stdout, solver, c.end_time);
  std::fflush(stdout);

  vd::io::VtkSeries vtk{c.output + "/column",
                        {"id", "displacement", "velocity", "porosity", "suction", "saturation",
                         "plastic_shear_strain", "mean_stress"}};
  vd::io::History history{c.output + "/column_history.csv",
                          {{"time", "s"},
                           {"run_out", "-"},
                           {"front", "m"},
                           {"front_99_percent", "m"},
                           {"farthest", "m"},
                           {"height", "m"},
                           {"kinetic_energy", "J"},
                           {"mean_time_step", "s"}}};
  vd::io::WaterBalanceHistory balance{c.output + "/column_balance.csv"};
  vd::io::Progress progress{c.end_time};
  const vd::io::RunClock clock{solver};
  constexpr int records = 10;  // rows of the histories per frame
  const int frames = c.check ? 1 : c.frames;
  for (int i = 0; i <= frames * records; ++i) {
    const Real before = solver.time();
    const auto first = solver.steps();
    vd::io::advance(solver, c.end_time * i / (frames * records), progress);
    const auto taken = static_cast<Real>(std::max<std::int64_t>(solver.steps() - first, 1));
    result.deposit = measure(solver, c.cell_size);
    result.run_out = (result.deposit.front - c.length) / c.height;
    const Deposit& d = result.deposit;
    history.add({solver.time(), result.run_out, d.front, d.front_99, d.farthest, d.height, d.energy,
                 (solver.time() - before) / taken});
    balance.record(solver);
    if (!c.check && i % records == 0) vtk.write(solver);
  }
  if (!c.check) vd::io::print_summary(stdout, solver, clock);
  std::printf("  deposit  R = %.3f, %.1f mm high at the wall, %.1e J/m left\n", result.run_out,
              1e3 * result.deposit.height, result.deposit.energy);
  std::fflush(stdout);
  return result;
}

// Dry and with 3 % of water in cells of 5 mm: the dry run-out is 1.2 H0 in experiments with columns of
// this shape (Lube et al. 2005), and water holds the column back.
int check(Choices c) {
  c.cell_size = 0.005;
  c.water_content = 0;
  const Real dry = run(c).run_out;
  c.water_content = 3;
  c.end_time = 0.2;
  const Real moist = run(c).run_out;
  return example::expect("dry run-out R", dry, 0.9, 1.5) +
         example::expect("R with 3 % of water in 0.2 s over the dry one", moist / dry, -0.1, 0.5);
}

// R(w).
void sweep(Choices c) {
  const std::string folder = c.output;
  std::filesystem::create_directories(folder);
  vd::io::History table{folder + "/column_sweep.csv",
                        {{"water_content", "%"},
                         {"run_out", "-"},
                         {"front", "m"},
                         {"front_99_percent", "m"},
                         {"height", "m"},
                         {"critical_height", "m"},
                         {"kinetic_energy", "J"}}};
  for (const Real w : contents) {
    c.water_content = w;
    char name[16];
    std::snprintf(name, sizeof name, "/w%.2f", w);
    c.output = folder + name;
    const Result r = run(c);
    table.add({w, r.run_out, r.deposit.front, r.deposit.front_99, r.deposit.height,
               r.critical_height, r.deposit.energy});
  }
}

}  // namespace

int main(int count, char** words) {
  return example::guarded("sand_column_collapse", [&] {
    const Choices c = read(count, words);
    if (c.check) return check(c);
    if (c.sweep)
      sweep(c);
    else
      run(c);
    return 0;
  });
}
