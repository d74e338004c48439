// SPDX-License-Identifier: MIT
#pragma once

#include <limits>

#include <vadose/policy/law/drucker_prager.hpp>

#include "../case.hpp"

namespace verify {

/// A slab of unsaturated soil on a slope of 45 degrees, held by suction alone: it slides on the lowest
/// row of cells once S s falls below
///   (S s)_crit = gamma z (sin b - cos b f) / f,  f = sin phi.
/// The ends are free and the rest of the slab is strong: then this is exact for any length, since the
/// strength is linear in the normal stress, whose sum is the weight. The soil keeps its volume (psi = 0),
/// so that its suction stays: then a plane of no extension carries sin phi times its normal stress, not
/// tan phi. Hardly any water moves. Times in s; way down the slope over the depth.
struct SlopeWithSuction {
  static constexpr const char* name = "slope with suction";
  static constexpr Real depth = 1, length = 4, gravity = 9.81, friction = 0.62, porosity = 0.4;
  static constexpr Real solid_density = 2600, saturation = 0.7;

  Real suction_ratio = 1.03;  ///< S s over its critical value [-]
  std::vector<Real> times = {1.5, 2.5};
  std::vector<Resolution> resolutions = {{6}};  ///< cells in the depth

  struct Physics : vadose::UnsaturatedModel<vadose::PlaneStrain> {
    using Skeleton = vadose::law::DruckerPrager;
  };

  static Real unit_weight() {
    return ((1 - porosity) * solid_density + porosity * saturation * 1000) * gravity;
  }
  /// (S s)_crit [Pa].
  static Real critical() {
    return unit_weight() * depth * std::sqrt(0.5) * (1 - friction) / friction;
  }
  Real seconds(Real time) const { return time; }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<Physics, V>;
    const Real h = depth / r.cells, slope = std::numbers::pi / 4;
    vadose::Scene<Model> scene(
        {.box = {{-2 * h, 0}, {length + 4 * h, depth + 2 * h}}, .cell_size = h});
    scene.gravity = gravity * Vec<2>(std::sin(slope), -std::cos(slope));
    const Real suction = suction_ratio * critical() / saturation;
    vadose::Material<Model> base{
        .name = "base",
        .solid_density = solid_density,
        .porosity = porosity,
        .lambda = 0.63,
        .skeleton = {.elastic = {.young_modulus = 10e6, .poisson_ratio = 0.3},
                     .friction_angle = std::asin(friction)},
        .retention = {.porosity_dependent = false},
        .conductivity = {.saturated_conductivity = 1e-12, .porosity_dependent = false}};
    // a such that S = 0.7 at the suction: alpha s = (S^(-1/lambda) - 1)^(1 - lambda).
    const Real e = porosity / (1 - porosity), b = (1 - base.lambda) / base.lambda;
    base.retention.a = std::pow(std::pow(saturation, -1 / base.lambda) - 1, 1 - base.lambda) *
                       9810 / (suction * std::pow(e, b));
    vadose::Material<Model> strong = base;
    strong.name = "slab";
    strong.skeleton.cohesion = 1e6;
    const vadose::SoilOptions<2> wet{.saturation = saturation};
    scene.add_soil(vadose::box({0, 0}, {length, h}), base, wet);
    scene.add_soil(vadose::box({0, h}, {length, depth}), strong, wet);
    scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
    vadose::Solver<Model, typename V::Scheme> solver(scene, {.courant = r.courant, .damping = 0.1});
    set_vertical_stress(solver, -saturation * suction, 1);  // no total stress
    return solver;
  }

  /// Mean way of the slab down the slope [m].
  template <class Run>
  static Real way(const Run& run) {
    Norm way;
    run.solid().for_each([&](std::size_t b, int l) { way.add(run.displacement(b, l)[0]); });
    return way.mean();
  }
  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    Comparison slid{"way down", time};
    slid.add(0, way(run) / depth, 0);
    return {slid};
  }
  Real bound(const Comparison&, const Resolution&) const {
    return std::numeric_limits<Real>::infinity();
  }
};

}  // namespace verify
