// SPDX-License-Identifier: MIT
// [Zhan] 4.4: a slope of loose silty sand at 30 g, 0.2 m high and 45 degrees steep on a foundation
// of 0.1 m, held by suction, then wetted from its surface ("rain": zero suction held there).
//
//   sand_slope [--cell-size 0.02] [--end-time 1.5] ...        --help lists the flags
//
// The paper prints neither the box nor the lengths of foundation and crest. Here the crest is 0.3 m
// long and the box 1 m, so that the debris comes to rest before the wall on the right.
//
// What the answer depends on:
// - The cone. The paper does not say how its Drucker-Prager cone is matched to phi = 31.8 degrees.
//   Matched in plane strain (--cone plane-strain) suction holds the infinite slope to 0.62 m of the
//   prototype's 6 m only: it creeps at 30 g before any rain. The cone through triaxial compression
//   (--cone outer, the default here) mobilises 47.6 degrees in plane strain: the slope stands, and
//   fails when it is wetted.
// - The conductivity. With the k_sat of Table 3 and 30 g the slope is wet within a second of model
//   time and fails before that; the paper reports failure after 50 s.
// - The water. The default K = 22 MPa is 100 times softer than water: ten times longer steps.
//   Pressures stay below 0.1 MPa, 0.5 % of it. --paper takes 2.2 GPa, 10 mm cells and 100 s.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <examples/support/flags.hpp>
#include <vadose/vadose.hpp>

namespace vd = vadose;

// What the scene models. What is not named here costs neither memory nor time.
struct SandSlope : vd::UnsaturatedModel<vd::PlaneStrain> {
  using Skeleton = vd::law::DruckerPrager;
};

namespace {

using vd::Real;

constexpr Real foundation = 0.1, crest_x = 0.3, crest_y = 0.3, toe_x = 0.5;  // [m]

struct Choices : example::RunChoices {
  Real cell_size = 0.02;         // [m]
  int points_per_cell = 4;       // of each phase
  bool frozen_porosity = false;  // retention and conductivity at the initial porosity

  Choices()
      : RunChoices{
            .end_time = 1.5, .bulk_modulus = 2.2e7, .frames = 30, .cone = vd::law::Cone::outer} {}
};

Choices read(int count, char** words) {
  Choices c;
  example::Flags("sand_slope: rain on a slope of silty sand at 30 g, [Zhan] 4.4")
      .number("--cell-size", "H", c.cell_size, "cells of H m that divide 1 and 0.4 m")
      .whole("--points-per-cell", c.points_per_cell, 64, "of each phase: 1, 4, 9, ...")
      .on("--frozen-porosity", c.frozen_porosity, "S(s) and k(S) at the initial porosity")
      .preset(
          "--paper", [&] { c.cell_size = 0.01, c.bulk_modulus = 2.2e9, c.end_time = 100; },
          "cells of 0.01 m, 2.2e9 Pa, 100 s: days")
      .common(c)
      .read(count, words);
  vd::check::positive("--end-time", c.end_time, "s");
  return c;
}

// [Zhan] Table 3. Suction 9.2 kPa gives S = 0.31 and a water content of 10.9 % (11.5 % printed).
vd::Material<SandSlope> silty_sand(const Choices& c) {
  return {.name = "silty sand",
          .solid_density = 2670,  // [kg/m3]
          .porosity = 0.48,
          .lambda = 0.89,
          .skeleton = {.elastic = {.young_modulus = 10e6, .poisson_ratio = 0.33},  // [Pa], [-]
                       .cohesion = 0,
                       .friction_angle = vd::degrees(31.8),
                       .dilation_angle = vd::degrees(-5.0),  // at the peak; 0 at critical state
                       .cone = c.cone,
                       .mobilisation = {.peak_shear_strain = 0.01, .critical_shear_strain = 0.2}},
          .retention = {.residual_saturation = 0,
                        .a = 1.2,  // [1/m]
                        .porosity_dependent = !c.frozen_porosity},
          .conductivity = {.saturated_conductivity = 2.77e-3,  // [m/s]
                           .porosity_dependent = !c.frozen_porosity}};
}

vd::Solver<SandSlope> start(const Choices& c) {
  vd::Scene<SandSlope> scene{{.box = {{0.0, 0.0}, {1.0, 0.4}}, .cell_size = c.cell_size}};
  scene.gravity = {0.0, -30 * 9.81};
  scene.liquid = {.density = 1000, .bulk_modulus = c.bulk_modulus};
  const auto slope = vd::polygon(
      {{0, 0}, {1.0, 0}, {1.0, foundation}, {toe_x, foundation}, {crest_x, crest_y}, {0, crest_y}});
  scene.add_soil(slope, silty_sand(c),
                 {.points_per_cell = c.points_per_cell,
                  .suction = 9.2e3,  // [Pa]
                  .initial_stress = vd::InitialStress::geostatic});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  scene.add(vd::bc::Roller{.face = vd::Face::left});
  scene.add(vd::bc::Roller{.face = vd::Face::right});
  return vd::Solver<SandSlope>{scene,
                               {.courant = c.courant,
                                .damping = c.damping,
                                .transfer = {.pic_rate = c.pic_rate},
                                .threads = c.threads}};
}

// What is measured, besides whole states and balances. Within a cell the pressure is read as that
// of water at rest: at 30 g it differs by 3 kPa over 10 mm, so the gauges sit in the middle of cells.
vd::io::Gauges gauges(const Choices& c) {
  using vd::io::Measure;
  using vd::io::SceneMeasure;
  vd::io::Gauges g{c.output + "/slope_gauges.csv"};
  g.point("crest", {crest_x - 0.005, crest_y - 0.005}, {Measure::displacement});
  const auto middle = [&](Real x) { return (std::floor(x / c.cell_size) + 0.5) * c.cell_size; };
  for (const int depth : {30, 70, 110, 150})
    g.position("depth_" + std::to_string(depth) + "mm",
               vd::Vec<2>(middle(0.05), middle(crest_y - 1e-3 * depth)),
               {Measure::liquid_pressure, Measure::suction, Measure::saturation});
  g.scene({SceneMeasure::max_displacement, SceneMeasure::kinetic_energy, SceneMeasure::time_step,
           SceneMeasure::water_inflow, SceneMeasure::water_outflow, SceneMeasure::pore_water});
  return g;
}

// How far the soil that was above the foundation has come.
class RunOut {
 public:
  RunOut(const std::string& path, const vd::Solver<SandSlope>& solver)
      : file_(path, {{"time", "s"}, {"front_99_percent", "m"}, {"front_last_point", "m"}}) {
    const auto& solid = solver.solid();
    solid.for_each([&](std::size_t b, int l) {
      if (solid.at(vd::field::position, b, 1)[l] < foundation) return;
      const auto id = static_cast<std::size_t>(solid.at(vd::field::id, b)[l]);
      if (slope_.size() <= id) slope_.resize(id + 1);
      slope_[id] = true;
    });
  }
  void record(const vd::Solver<SandSlope>& solver) {
    std::vector<Real> x;
    const auto& solid = solver.solid();
    solid.for_each([&](std::size_t b, int l) {
      const auto id = static_cast<std::size_t>(solid.at(vd::field::id, b)[l]);
      if (id < slope_.size() && slope_[id]) x.push_back(solid.at(vd::field::position, b, 0)[l]);
    });
    std::sort(x.begin(), x.end());
    file_.add({solver.time(), x[x.size() * 99 / 100], x.back()});
  }

 private:
  vd::io::History file_;
  std::vector<bool> slope_;
};

// Points pressed to rest at 30 g, the water held where it is.
void spin_up(vd::Solver<SandSlope>& solver) {
  const auto report = solver.equilibrate({.tolerance = 2e-3, .max_time = 0.3});
  Real shear = 0;
  solver.solid().for_each([&](std::size_t b, int l) {
    shear = std::max<Real>(shear, solver.solid().at(vd::field::law_state, b)[l]);
  });
  std::printf(
      "at 30 g before the rain: out of balance %.1e of the weight, largest plastic shear "
      "strain %.2g%s\n",
      report.residual, shear, report.converged ? "" : "; NOT at rest");
}

// The numbers that a reader of the results needs.
void write_choices(const Choices& c) {
  vd::io::History file{c.output + "/slope_choices.csv",
                       {{"cell_size", "m"},
                        {"points_per_cell", "-"},
                        {"bulk_modulus", "Pa"},
                        {"end_time", "s"},
                        {"courant", "-"},
                        {"damping", "-"},
                        {"pic_rate", "1/s"},
                        {"cone", "-"},
                        {"frozen_porosity", "-"}}};
  file.add({c.cell_size, static_cast<Real>(c.points_per_cell), c.bulk_modulus, c.end_time,
            c.courant, c.damping, c.pic_rate, static_cast<Real>(c.cone),
            static_cast<Real>(c.frozen_porosity)});
}

void run(const Choices& c) {
  vd::Solver<SandSlope> solver = start(c);
  std::printf("cells %g m, water of K = %g Pa, %g s of rain, %d thread(s)\n", c.cell_size,
              c.bulk_modulus, c.end_time, c.threads);
  if (c.bulk_modulus < 2.2e9)
    std::printf("the water is %g times softer than water; --bulk-modulus 2.2e9 is the real one\n",
                2.2e9 / c.bulk_modulus);
  std::filesystem::create_directories(c.output);
  write_choices(c);
  spin_up(solver);
  solver.add(vd::bc::ZeroSuction{});
  vd::io::print_preflight(stdout, solver, c.end_time);
  std::fflush(stdout);

  vd::io::VtkSeries vtk{c.output + "/slope",
                        {"id", "displacement", "velocity", "porosity", "suction", "liquid_pressure",
                         "saturation", "plastic_shear_strain", "mean_stress"}};
  vd::io::Gauges gauge = gauges(c);
  vd::io::WaterBalanceHistory balance{c.output + "/slope_balance.csv"};
  RunOut run_out{c.output + "/slope_run_out.csv", solver};
  vd::io::Progress progress{c.end_time};
  const vd::io::RunClock clock{solver};
  constexpr int records = 8;  // rows of the histories per frame
  for (int i = 0; i <= c.frames * records; ++i) {
    vd::io::advance(solver, c.end_time * i / (c.frames * records), progress);
    gauge.record(solver);
    balance.record(solver);
    run_out.record(solver);
    if (i % records == 0) vtk.write(solver);
  }
  vd::io::print_summary(stdout, solver, clock);
}

}  // namespace

int main(int count, char** words) {
  return example::guarded("sand_slope", [&] {
    run(read(count, words));
    return 0;
  });
}
