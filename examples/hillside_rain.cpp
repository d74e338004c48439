// SPDX-License-Identifier: MIT
// A three-dimensional hillside from a height grid (plain ESRI ASCII) under rain: loose silty sand,
// held by suction, slides where it gets wet.
//
//   hillside_rain [--ground examples/data/hillside.asc] [--cell-size 1] ...   --help lists the flags
//   hillside_rain --cell-size 0.5 --end-time 10     1.1 million points
//
// The soil is that of [Zhan] Table 3 at 1 g, its cone matched in plane strain, with a k_sat of 0.08
// m/s, 30 times the printed one: so the storm is 30 times as fast and as strong as the one it stands
// for. Rain falls at 0.04 m/s, half of k_sat; what does not soak in runs off. The sides of the box are
// smooth walls, its base is rough, the water is 100 times softer than water.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include <examples/support/flags.hpp>
#include <examples/support/long_run.hpp>
#include <vadose/vadose.hpp>

namespace vd = vadose;

// What the scene models.
struct Hillside : vd::UnsaturatedModel<vd::ThreeDimensional> {
  using Skeleton = vd::law::DruckerPrager;
};

namespace {

using vd::Real;

constexpr Real solid_density = 2670, porosity = 0.48;  // [kg/m3], [-]

struct Choices : example::RunChoices {
  std::string ground = "examples/data/hillside.asc";
  Real cell_size = 1;        // [m]
  Real rate = 0.04;          // of the rain [m/s]
  Real conductivity = 0.08;  // k_sat [m/s]
  Real suction = 9.2e3;      // at the start [Pa]
  bool resume = false;

  Choices() : RunChoices{.end_time = 10, .bulk_modulus = 2.2e7, .courant = 0.45, .frames = 5} {}
};

Choices read(int count, char** words) {
  Choices c;
  example::Flags("hillside_rain: rain on a three-dimensional slope from a height grid")
      .word("--ground", "FILE", c.ground, "ESRI ASCII grid of heights in m")
      .number("--cell-size", "H", c.cell_size, "cells of H m that divide the sides of the grid")
      .number("--rain", "R", c.rate, "m/s per horizontal area")
      .number("--conductivity", "K", c.conductivity, "k_sat in m/s")
      .number("--suction", "S", c.suction, "at the start in Pa")
      .on("--resume", c.resume, example::resume_text)
      .common(c)
      .read(count, words);
  vd::check::positive("--end-time", c.end_time, "s");
  return c;
}

// [Zhan] Table 3, but k_sat.
vd::Material<Hillside> silty_sand(const Choices& c) {
  return {.name = "silty sand",
          .solid_density = solid_density,
          .porosity = porosity,
          .lambda = 0.89,
          .skeleton = {.elastic = {.young_modulus = 10e6, .poisson_ratio = 0.33},  // [Pa], [-]
                       .cohesion = 0,
                       .friction_angle = vd::degrees(31.8),
                       .dilation_angle = vd::degrees(-5.0),
                       .tensile_strength = 0,
                       .cone = c.cone,
                       .mobilisation = {.peak_shear_strain = 0.01, .critical_shear_strain = 0.2}},
          .retention = {.residual_saturation = 0, .a = 1.2},
          .conductivity = {.saturated_conductivity = c.conductivity}};
}

vd::Solver<Hillside> start(const Choices& c, const vd::HeightField& ground) {
  const vd::Box<2> plan = ground.extent();
  const Real h = c.cell_size;
  const Real top = h * std::ceil(ground.highest() / h + 2);
  const vd::Box<3> box({plan.low[0], plan.low[1], 0}, {plan.high[0], plan.high[1], top});
  vd::Scene<Hillside> scene{{.box = box, .cell_size = h}};
  scene.gravity = {0.0, 0.0, -9.81};
  scene.liquid = {.density = 1000, .bulk_modulus = c.bulk_modulus};
  scene.add_soil(
      vd::below(ground, box), silty_sand(c),
      {.points_per_cell = 8, .suction = c.suction, .initial_stress = vd::InitialStress::geostatic});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  for (const auto face : {vd::Face::left, vd::Face::right, vd::Face::front, vd::Face::back})
    scene.add(vd::bc::Roller{.face = face});
  return vd::Solver<Hillside>{scene,
                              {.courant = c.courant,
                               .damping = c.damping,
                               .transfer = {.pic_rate = c.pic_rate},
                               .threads = c.threads}};
}

int run(const Choices& c) {
  const vd::HeightField ground = vd::io::read_esri_grid(c.ground);
  const vd::Box<2> plan = ground.extent();
  std::printf("%s: %d x %d heights of %g to %g m over %g x %g m\n", c.ground.c_str(),
              ground.columns(), ground.rows(), ground.lowest(), ground.highest(), plan.size()[0],
              plan.size()[1]);
  std::filesystem::create_directories(c.output);
  vd::Solver<Hillside> solver = start(c, ground);
  std::printf("cells %g m, %zu points in all\n", c.cell_size,
              solver.solid().size() + solver.liquid().size());
  std::fflush(stdout);
  example::LongRun o{.folder = c.output,
                     .base = "hillside",
                     .end_time = c.end_time,
                     .frames = c.frames,
                     .resume = c.resume};
  if (!c.resume) {
    const auto report = solver.equilibrate({.tolerance = 2e-3, .max_time = 2});
    std::printf(
        "before the rain: out of balance %.1e of the weight, largest plastic shear strain %.2g\n",
        report.residual, example::largest_law_state(solver));
  }
  solver.add(vd::bc::Rain{.rate = c.rate});
  example::take_up(solver, o);

  vd::io::History slides{o.history("_slide"), {{"time", "s"}, {"largest", "m"}, {"volume", "m3"}}};
  example::Passages passages({0.01, 0.1, 1});
  example::drive(solver, o,
                 {"id", "displacement", "velocity", "porosity", "suction", "saturation",
                  "plastic_shear_strain"},
                 [&] {
                   const auto slide = example::measure_slide(solver, solid_density, porosity, 0.01);
                   passages.record(solver.time(), slide.largest);
                   slides.add({solver.time(), slide.largest, slide.volume});
                 });
  passages.print(stdout);
  return 0;
}

}  // namespace

int main(int count, char** words) {
  return example::guarded("hillside_rain", [&] { return run(read(count, words)); });
}
