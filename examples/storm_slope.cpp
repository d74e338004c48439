// SPDX-License-Identifier: MIT
// A slope of silty sand, 3 m high and 3 : 4 steep, under a storm of its own time: a day of rain, seconds of
// failure. Steps of seconds while the water soaks in, of a millisecond or less while the slope slides, and
// again of seconds when it has come to rest; nobody tells the solver when.
//
//   storm_slope [--cell-size 0.25] [--end-time 82800] ...   --help lists the flags
//
// Water has its true compressibility. k_sat is 5e-6 m/s, the rain 4e-6 m/s (14 mm/h), the suction 15 kPa at
// first. Steeper than its angle of friction, 30 degrees, the soil stands by suction alone. The base is rough,
// the left side smooth; water leaves at the right.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include <examples/support/flags.hpp>
#include <examples/support/long_run.hpp>
#include <vadose/vadose.hpp>

namespace vd = vadose;

struct Storm : vd::UnsaturatedModel<vd::PlaneStrain> {
  using Skeleton = vd::law::DruckerPrager;
};
using Solver = vd::Solver<Storm, vd::scheme::SemiImplicit>;

namespace {

using vd::Real;

constexpr Real solid_density = 2670, porosity = 0.45;  // [kg/m3], [-]
constexpr Real hour = 3600;                            // [s]

struct Choices : example::RunChoices {
  Real cell_size = 0.25;  // [m]
  Real rate = 4e-6;       // of the rain [m/s]

  Choices() : RunChoices{.end_time = 23 * hour, .damping = 0, .frames = 23} {}
};

Choices read(int count, char** words) {
  Choices c;
  example::Flags("storm_slope: a day of rain, seconds of failure")
      .number("--cell-size", "H", c.cell_size, "cells of H m")
      .number("--rain", "R", c.rate, "m/s per horizontal area")
      .quasi_static(c)
      .check(c)
      .resume(c)
      .common(c)
      .read(count, words);
  return c;
}

Solver start(const Choices& c) {
  vd::Scene<Storm> scene{{.box = {{0, 0}, {10, 5}}, .cell_size = c.cell_size}};
  scene.gravity = {0.0, -9.81};
  scene.liquid = {.density = 1000, .bulk_modulus = c.bulk_modulus};
  scene.add_soil(
      vd::polygon({{0, 0}, {10, 0}, {10, 1}, {7, 1}, {3, 4}, {0, 4}}),
      {.name = "silty sand",
       .solid_density = solid_density,
       .porosity = porosity,
       .lambda = 0.6,
       .skeleton = {.elastic = {.young_modulus = 10e6, .poisson_ratio = 0.33},
                    .cohesion = 0,
                    .friction_angle = vd::degrees(30),
                    .dilation_angle = 0,
                    .tensile_strength = 0,
                    .cone = c.cone,
                    .mobilisation = {.peak_shear_strain = 0.01, .critical_shear_strain = 0.2}},
       .retention = {.a = 1.0},
       .conductivity = {.saturated_conductivity = 5e-6}},
      {.points_per_cell = 4, .suction = 15e3, .initial_stress = vd::InitialStress::geostatic});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  scene.add(vd::bc::Roller{.face = vd::Face::left});
  scene.add(vd::bc::Roller{.face = vd::Face::right});
  scene.add(vd::bc::SeepageFace{.face = vd::Face::right});
  return Solver{scene, example::solver_options<Storm, vd::scheme::SemiImplicit>(c)};
}

Real largest_speed(const Solver& solver) {
  Real most = 0;
  solver.solid().for_each([&](std::size_t b, int l) {
    const auto v = [&](int d) { return solver.solid().at(vd::field::velocity, b, d)[l]; };
    most = std::max<Real>(most, std::hypot(v(0), v(1)));
  });
  return most;
}

// Rows of the history come with steps, not times: what happens within seconds is to be seen.
class Course {
 public:
  Course(const std::string& path, std::int64_t every)
      : file_(path, {{"time", "s"}, {"displacement", "m"}, {"speed", "m/s"}, {"step", "s"}}),
        every_(every) {}
  void record(const Solver& solver, const vd::StepReport& step) {
    if (step.step % every_ != 0) return;
    const auto slide = example::measure_slide(solver, solid_density, porosity, 0.01);
    file_.add({step.time, slide.largest, largest_speed(solver), step.dt});
    passages_.record(step.time, slide.largest);
  }
  void print(std::FILE* out) const { passages_.print(out); }

 private:
  vd::io::History file_;
  std::int64_t every_;
  example::Passages passages_{{0.001, 0.01, 0.05}};
};

vd::WaterBalance run(const Choices& c) {
  example::LongRun o = example::long_run(c, "storm");
  o.records = 1;
  Solver solver = start(c);
  example::bring_to_rest(solver, o, {.tolerance = 1e-3, .max_time = 5});
  solver.add(vd::bc::Rain{.rate = c.rate});
  example::take_up(solver, o);
  Course course{o.history("_course"), 20};
  example::drive(
      solver, o, {"id", "displacement", "velocity", "suction", "saturation"}, [] {},
      [&](const vd::StepReport& step) { course.record(solver, step); });
  course.print(stdout);
  return solver.water_balance();
}

// For two hours all rain soaks in.
int check(Choices c) {
  c.cell_size = 0.5;
  c.end_time = 2 * hour;
  c.frames = 1;
  const vd::WaterBalance water = run(c);
  return example::expect("water in the pores over rain fallen",
                         (water.pore - water.initial) / (1000 * 10 * c.rate * c.end_time), 0.999,
                         1.001) +
         example::expect("closure of the water ledger", water.relative_closure(), -1e-12, 1e-12);
}

}  // namespace

int main(int count, char** words) {
  return example::guarded("storm_slope", [&] {
    const Choices c = read(count, words);
    if (c.check) return check(c);
    run(c);
    return 0;
  });
}
