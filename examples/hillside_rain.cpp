// SPDX-License-Identifier: MIT
// A three-dimensional hillside from a height grid (plain ESRI ASCII) under rain: loose silty sand,
// held by suction, slides where it gets wet.
//
//   hillside_rain [--ground examples/data/hillside.asc] [--cell-size 1] ...   --help lists the flags
//   hillside_rain --cell-size 0.5                   a million points
//
// The soil is that of [Zhan] Table 3 at 1 g, its cone matched in plane strain, with a k_sat of 0.16
// m/s, 60 times the printed one, and rain of as much: so the storm is 60 times as fast and as strong as
// the one it stands for. What does not soak in runs off. The sides of the box are smooth walls, its
// base is rough, the water is 100 times softer than water.

#include <algorithm>
#include <cmath>
#include <cstdio>
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
  Real rate = 0.16;          // of the rain [m/s]
  Real conductivity = 0.16;  // k_sat [m/s]
  Real suction = 9.2e3;      // at the start [Pa]

  Choices()
      : RunChoices{.scheme = example::Scheme::explicit_steps,
                   .end_time = 5,
                   .bulk_modulus = 2.2e7,
                   .courant = 0.45,
                   .frames = 5} {}
};

Choices read(int count, char** words) {
  Choices c;
  example::Flags("hillside_rain: rain on a three-dimensional slope from a height grid")
      .word("--ground", "FILE", c.ground, "ESRI ASCII grid of heights in m")
      .number("--cell-size", "H", c.cell_size, "cells of H m that divide the sides of the grid")
      .number("--rain", "R", c.rate, "m/s per horizontal area")
      .number("--conductivity", "K", c.conductivity, "k_sat in m/s")
      .number("--suction", "S", c.suction, "at the start in Pa")
      .stepping(c)
      .check(c)
      .common(c)
      .read(count, words);
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

template <class S>
vd::Solver<Hillside, S> start(const Choices& c, const vd::HeightField& ground) {
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
  return vd::Solver<Hillside, S>{scene, example::solver_options<Hillside, S>(c)};
}

template <class S>
example::Outcome run(const Choices& c) {
  const vd::HeightField ground = vd::io::read_esri_grid(c.ground);
  const vd::Box<2> plan = ground.extent();
  std::printf("%s: %d x %d heights of %g to %g m over %g x %g m\n", c.ground.c_str(),
              ground.columns(), ground.rows(), ground.lowest(), ground.highest(), plan.size()[0],
              plan.size()[1]);
  example::LongRun o = example::long_run(c, "hillside");
  vd::Solver<Hillside, S> solver = start<S>(c, ground);
  std::printf("%s, cells %g m, water of K = %g Pa, %zu points in all\n", S::name, c.cell_size,
              c.bulk_modulus, solver.solid().size() + solver.liquid().size());
  std::fflush(stdout);
  example::bring_to_rest(solver, o, {.tolerance = 2e-3, .max_time = 2});
  solver.add(vd::bc::Rain{.rate = c.rate});
  example::take_up(solver, o);

  vd::io::History slides{o.history("_slide"), {{"time", "s"}, {"largest", "m"}, {"volume", "m3"}}};
  example::Slide slide;
  example::Passages passages({0.01, 0.1, 1});
  example::drive(solver, o,
                 {"id", "displacement", "velocity", "porosity", "suction", "saturation",
                  "plastic_shear_strain"},
                 [&] {
                   slide = example::measure_slide(solver, solid_density, porosity, 0.01);
                   passages.record(solver.time(), slide.largest);
                   slides.add({solver.time(), slide.largest, slide.volume});
                 });
  passages.print(stdout);
  return {slide, solver.water_balance()};
}

example::Outcome choose(const Choices& c) {
  return c.scheme == example::Scheme::semi_implicit ? run<vd::scheme::SemiImplicit>(c)
                                                    : run<vd::scheme::Explicit>(c);
}

// All rain that fell is in the ground or on it.
int check(Choices c) {
  c.cell_size = 2;
  c.end_time = 1;
  c.frames = 1;
  const vd::WaterBalance w = choose(c).water;
  const vd::Box<2> plan = vd::io::read_esri_grid(c.ground).extent();
  const Real fallen = 1000 * c.rate * plan.size()[0] * plan.size()[1] * c.end_time;
  return example::expect("water gained over rain fallen",
                         (w.pore + w.free + w.film - w.initial) / fallen, 0.999, 1.001) +
         example::expect("closure of the water ledger", w.relative_closure(), -1e-12, 1e-12);
}

}  // namespace

int main(int count, char** words) {
  return example::guarded("hillside_rain", [&] {
    const Choices c = read(count, words);
    if (c.check) return check(c);
    choose(c);
    return 0;
  });
}
