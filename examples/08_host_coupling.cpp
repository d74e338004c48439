// SPDX-License-Identifier: MIT
// A host couples the solver to code of its own, step by step: a plate of 2 t/m2 on a column of soil.
// The host integrates the plate, the library the soil; each step the plate gets the soil's reaction and
// the soil the plate's velocity. The host also lets a field of its own ride along with the points, the
// work done on them; and it stops in the middle, saves both, and goes on in a new solver.
// At rest the plate has settled by m g L / E_c.

#include <cmath>
#include <cstdio>
#include <exception>

#include <vadose/vadose.hpp>

namespace vd = vadose;

/// A field of the host: any tag with a name and a unit.
struct Work {
  static constexpr const char* name = "work";
  static constexpr const char* unit = "J/m3";
};
struct Soil : vd::DryModel<vd::Uniaxial> {
  using SolidUserFields = vd::FieldSet<vd::Sized<Work, 1>>;
};

namespace {

using vd::Real;

constexpr Real length = 1, young_modulus = 10e6, stiffness = young_modulus * 0.7 / (1.3 * 0.4);

/// The host's own model.
struct Plate {
  Real mass = 2000, damping = 2e5;  // [kg/m2], [N s/m per m2]
  Real settlement = 0, velocity = 0;

  void advance(Real dt, Real reaction) {
    velocity += dt * (9.81 - (reaction + damping * velocity) / mass);
    settlement += dt * velocity;
  }
};

vd::Solver<Soil> soil_under(const Plate& plate) {
  vd::Scene<Soil> scene{{.box = {{0.0}, {1.2}}, .cell_size = 0.1}};
  scene.add_soil(vd::box({0.0}, {length}),
                 {.name = "sand",
                  .solid_density = 2650,
                  .porosity = 0.4,
                  .skeleton = {.young_modulus = young_modulus, .poisson_ratio = 0.3}});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  scene.add(vd::bc::PrescribedVelocity<1>{
      .region = vd::box({length - 0.01}, {1.2}),
      .velocity = vd::Vec<1>(-1.0),
      .time_factor = [&plate](Real) { return plate.velocity; },  // asked once per step
  });
  return vd::Solver<Soil>{scene, {.damping = 0.1}};
}

/// Mean vertical stress one to three cells below the plate, compression positive [Pa].
Real reaction(const vd::Solver<Soil>& solver) {
  Real force = 0, volume = 0;
  const auto& points = solver.solid();
  points.for_each([&](std::size_t batch, int lane) {
    const Real depth = length - points.at(vd::field::position, batch)[lane];
    if (depth < 0.1 || depth > 0.3) return;
    const Real v = points.at(vd::field::volume, batch)[lane];
    force -= v * points.at(vd::field::bishop_stress, batch)[lane];
    volume += v;
  });
  return force / volume;
}

/// Adds stress times compression to the host's field of every point.
void add_work(vd::Solver<Soil>& solver, Real compression) {
  auto& points = solver.mutable_state().solid;
  for (std::size_t b = 0; b < points.batches(); ++b)
    for (int l = 0; l < vd::lane_count; ++l)
      points.at(Work{}, b)[l] -= compression * points.at(vd::field::bishop_stress, b)[l];
}

/// One step of the host after each step of the soil.
void couple(vd::Solver<Soil>& solver, Plate& plate, Real end) {
  solver.advance_to(end, [&](const vd::StepReport& step) {
    plate.advance(step.dt, reaction(solver));
    add_work(solver, step.dt * plate.velocity / length);
  });
}

/// Work done on the soil so far, from the host's field [J/m2].
Real work(const vd::Solver<Soil>& solver) {
  Real sum = 0;
  solver.solid().for_each([&](std::size_t b, int l) {
    sum += solver.solid().at(vd::field::volume, b)[l] * solver.solid().at(Work{}, b)[l];
  });
  return sum;
}

}  // namespace

int main() try {
  Plate plate;
  vd::Solver<Soil> solver = soil_under(plate);
  couple(solver, plate, 0.2);
  vd::io::save_checkpoint("host_coupling.checkpoint", solver);

  // Another day: the scene is built again, the state comes from the file, the plate from the host.
  Plate saved = plate;
  vd::Solver<Soil> later = soil_under(saved);
  vd::io::load_checkpoint("host_coupling.checkpoint", later);
  couple(later, saved, 1);
  couple(solver, plate, 1);
  if (saved.settlement != plate.settlement) return 1;  // the same bits

  const Real expected = plate.mass * 9.81 * length / stiffness;
  const Real stored = 0.5 * stiffness * expected * expected / length;
  std::printf("settlement %.4f mm, expected %.4f mm; work %.3f J/m2, strain energy %.3f J/m2\n",
              1e3 * plate.settlement, 1e3 * expected, work(solver), stored);
  return std::fabs(plate.settlement / expected - 1) < 0.01 ? 0 : 1;
} catch (const std::exception& e) {
  std::fprintf(stderr, "host_coupling: %s\n", e.what());
  return 1;
}
