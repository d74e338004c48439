// SPDX-License-Identifier: MIT
#pragma once

#include <limits>

#include <vadose/policy/law/drucker_prager.hpp>

#include "../case.hpp"

namespace verify {

/// A strip load on undrained clay without weight, c = 10 kPa: Prandtl's collapse at q = (2 + pi) c. Half
/// of the strip, 1 m, beside a plane of symmetry. The load grows to a first part of it, is held, and
/// grows to a second. Times in s; settlement under the load over its half width.
struct Footing {
  static constexpr const char* name = "footing";
  static constexpr Real half_width = 1, cohesion = 1e4, ramp = 1;

  Real first = 0.95, second = 1.05;  ///< parts of (2 + pi) c [-]
  std::vector<Real> times = {2, 2.5, 3, 3.5};
  std::vector<Resolution> resolutions = {{4}, {8}};  ///< cells under the half strip

  struct Physics : vadose::SaturatedModel<vadose::PlaneStrain> {
    using Skeleton = vadose::law::DruckerPrager;
  };

  Real seconds(Real time) const { return time; }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<Physics, V>;
    const Real h = half_width / r.cells, width = 5 * half_width, depth = 2.5 * half_width;
    vadose::Scene<Model> scene({.box = {{0, 0}, {width, depth + 2 * h}}, .cell_size = h});
    scene.liquid.bulk_modulus = 3e7;
    const vadose::Material<Model> clay{
        .name = "clay",
        .solid_density = 2650,
        .porosity = 0.4,
        .skeleton = {.elastic = {.young_modulus = 500 * cohesion, .poisson_ratio = 0.3},
                     .cohesion = cohesion,
                     .friction_angle = 0},
        .conductivity = {.saturated_conductivity = 1e-12}};
    scene.add_soil(vadose::box({0, 0}, {width, depth}), clay,
                   {.liquid_pressure = [](const Vec<2>&) { return 0; }});
    scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
    scene.add(vadose::bc::Traction<2>{
        .region = vadose::box({0, depth - 0.5 * h}, {half_width, depth}),
        .traction = {0, -(2 + std::numbers::pi) * cohesion},
        .time_factor = [from = first, to = second](Real t) {
          return t < 2.5 ? from * std::min(Real(1), t / ramp)
                         : from + (to - from) * std::min(Real(1), (t - 2.5) / 0.5);
        }});
    return vadose::Solver<Model, typename V::Scheme>(scene,
                                                     {.courant = r.courant, .damping = 0.05});
  }

  /// Settlement under the load [m].
  template <class Run>
  static Real settlement(const Run& run) {
    Norm mean;
    run.solid().for_each([&](std::size_t b, int l) {
      const Vec<2> u = run.displacement(b, l);
      const Real x = run.solid().at(vadose::field::position, b, 0)[l] - u[0];
      const Real y = run.solid().at(vadose::field::position, b, 1)[l] - u[1];
      if (x < half_width && y > 2.5 * half_width - 0.5 * run.state().grid.cell_size())
        mean.add(-u[1]);
    });
    return mean.mean();
  }
  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    Comparison settled{"settlement", time};
    settled.add(0, settlement(run) / half_width, 0);
    return {settled};
  }
  Real bound(const Comparison&, const Resolution&) const {
    return std::numeric_limits<Real>::infinity();
  }
};

}  // namespace verify
