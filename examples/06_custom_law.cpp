// SPDX-License-Identifier: MIT
// A constitutive law of one's own: laws/von_mises.hpp, clay that yields at constant volume. A block
// of it is compressed in plane strain between smooth platens. Whatever the elastic numbers, the
// vertical stress ends at -2 s_u.

#include <cmath>
#include <cstdio>
#include <exception>

#include <vadose/vadose.hpp>

#include "laws/von_mises.hpp"

namespace vd = vadose;

struct Clay : vd::DryModel<vd::PlaneStrain> {
  using Skeleton = VonMises;
};

namespace {

vd::Real mean_vertical_stress(const vd::Solver<Clay>& solver) {
  vd::Real force = 0, volume = 0;
  solver.solid().for_each([&](std::size_t batch, int lane) {
    const vd::Real v = solver.solid().at(vd::field::volume, batch)[lane];
    force += v * solver.solid().at(vd::field::bishop_stress, batch, 1)[lane];
    volume += v;
  });
  return force / volume;
}

}  // namespace

int main() try {
  const vd::Real strength = 20e3;  // s_u [Pa]
  const vd::Material<Clay> clay{
      .name = "clay",
      .solid_density = 2700,
      .porosity = 0.4,
      .skeleton = {.elastic = {.young_modulus = 10e6, .poisson_ratio = 0.49},
                   .undrained_strength = strength},
  };
  vd::Scene<Clay> scene{{.box = {{0.0, 0.0}, {1.5, 1.2}}, .cell_size = 0.1}};
  scene.add_soil(vd::box({0.0, 0.0}, {1.0, 1.0}), clay);
  scene.add(vd::bc::Roller{.face = vd::Face::bottom});
  scene.add(vd::bc::Roller{.face = vd::Face::left});
  scene.add(vd::bc::PrescribedVelocity<2>{
      // the upper platen
      .region = vd::box({0.0, 0.95}, {1.5, 1.2}),
      .velocity = {vd::unset, -0.005},
  });

  vd::Solver<Clay> solver{scene, {.damping = 0.2}};
  for (int i = 1; i <= 5; ++i) {
    solver.advance_to(0.6 * i);
    std::printf("shortened by %.1f %%: vertical stress %.2f kPa\n", 0.3 * i,
                1e-3 * mean_vertical_stress(solver));
  }
  const vd::Real expected = -2 * strength;
  const vd::Real error = mean_vertical_stress(solver) / expected - 1;
  std::printf("expected %.2f kPa, error %.2f %%\n", 1e-3 * expected, 100 * error);
  return std::fabs(error) < 0.03 ? 0 : 1;
} catch (const std::exception& e) {
  std::fprintf(stderr, "custom_law: %s\n", e.what());
  return 1;
}
