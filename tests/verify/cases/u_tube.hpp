// SPDX-License-Identifier: MIT
#pragma once

#include "../../seepage.hpp"
#include "free_water.hpp"

namespace verify {

/// Coarse soil that stays saturated; k [m/s].
template <class Model>
vadose::Material<Model> plug_soil(Real porosity, Real conductivity) {
  return {.porosity = porosity,
          .lambda = 0.8,
          .retention = {.a = 100, .porosity_dependent = false},
          .conductivity = {.saturated_conductivity = conductivity, .porosity_dependent = false}};
}

/// Water swings in a U-tube with a plug of coarse, rigid soil at its lowest point. The legs move
/// against each other, so that the pressure midway stays that of rest: the case is one leg, in 1D, of
/// free water of depth L_f over half of the plug, L_p, with the mean head held at its base. With y the
/// level above rest, (L_f + L_p / n) y'' + (g L_p / k) y' + g y = 0: an effective length L = L_f + L_p / n
/// of each leg, of the whole tube twice that (w^2 = 2 g / 2 L), and a damping of g L_p / (2 k L). It
/// starts at rest with the pressures of its first acceleration. The amplitude y0 / L_f is 5 %: the
/// period changes with its square. The water is softened to K = 2 MPa: (w L / c)^2 = 0.8 %, of which the
/// period feels a third. Times in undamped periods.
struct UTubeLeg {
  static constexpr const char* name = "U-tube, inertia";
  static constexpr Real start_depth = 1, plug = 0.2, porosity = 0.4, gravity = 9.81;
  static constexpr Real rise = 0.05, depth = start_depth - rise;  ///< y0, L_f [m]

  Real conductivity = 5;    ///< k [m/s]
  Real bulk_modulus = 2e6;  ///< K [Pa]
  std::vector<Real> times = {3};
  std::vector<Resolution> resolutions = {{10}, {20}, {40}};  ///< cells in the depth

  using Physics = vadose_test::Seepage<vadose::Uniaxial>;

  static constexpr Real length() { return depth + plug / porosity; }
  Real damping() const { return gravity * plug / (2 * conductivity * length()); }
  static Real undamped() { return std::sqrt(gravity / length()); }
  Real period() const {
    return 2 * std::numbers::pi / std::sqrt(undamped() * undamped() - damping() * damping());
  }
  Real seconds(Real time) const { return time * 2 * std::numbers::pi / undamped(); }
  /// Level of the free water above rest by its mass [m]; smooth where its velocity carries sound.
  template <class Solver>
  Real level(const Solver& solver) const {
    return solver.water_balance().free / 1000 - depth;
  }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<Physics, V>;
    const Real h = start_depth / r.cells, top = plug + start_depth;
    vadose::Scene<Model> scene({.box = {Vec<1>(0.0), Vec<1>(1.6)}, .cell_size = h});
    scene.gravity[0] = -gravity;
    scene.liquid.bulk_modulus = bulk_modulus;
    // Of y'' = -g y0 / L: in the plug it counts 1 / n times.
    const Real lighter = 1000 * gravity * (1 - rise / (length() + rise));
    const auto pressure = [=](const Vec<1>& x) {
      return x[0] < plug ? 1000 * gravity * (depth + plug - x[0]) +
                               1000 * gravity * rise / (length() + rise) * x[0] / porosity
                         : lighter * (top - x[0]);
    };
    scene.add_soil(vadose::box({0.0}, {plug}), plug_soil<Model>(porosity, conductivity),
                   {.liquid_pressure = pressure});
    scene.add_water(vadose::box({plug}, {top}), {.liquid_pressure = pressure});
    scene.add(vadose::bc::PrescribedHead{.face = vadose::Face::bottom, .head = depth + plug});
    using Solver = vadose::Solver<Model, typename V::Scheme>;
    auto quantity = [*this](const Solver& s) { return level(s); };
    return Swinging<Solver, decltype(quantity)>{Solver(scene, {.courant = r.courant}), quantity};
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    Comparison swing{"period", time}, left{"decay per half period", time};
    swing.add(0, run.period() / period(), 1);
    const auto halves = static_cast<Real>(run.peaks.size() - 1);
    left.add(0, std::pow(run.peaks.back() / run.peaks.front(), 1 / halves),
             std::exp(-damping() * period() / 2));
    return {swing, left};
  }
  Real bound(const Comparison&, const Resolution&) const { return 0.02; }
};

/// The same leg over soil through which the water only seeps: it falls by d(y)/dt = -k y / L_p towards
/// the head at the base. Exact in the limit of Darcy's drag: k / (n g), 5 ms, is 1 / 2000 of L_p / k.
/// Level by the mass of the free water: that in the softened column, K = 20 MPa, is 0.025 % denser, which
/// counts as 0.12 % of the first y. Times over L_p / k.
struct FallingLeg {
  static constexpr const char* name = "U-tube, one leg falls";
  static constexpr Real plug = 0.2, start_depth = 1, rise = 0.2, porosity = 0.4, gravity = 9.81;

  Real conductivity = 0.02;  ///< k [m/s]
  Real bulk_modulus = 2e7;   ///< K [Pa]
  std::vector<Real> times = {0.5, 1, 2};
  std::vector<Resolution> resolutions = {{10}, {20}, {40}};  ///< cells in the depth

  using Physics = vadose_test::Seepage<vadose::Uniaxial>;

  Real seconds(Real time) const { return time * plug / conductivity; }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<Physics, V>;
    constexpr Real top = plug + start_depth, head = top - rise;
    vadose::Scene<Model> scene(
        {.box = {Vec<1>(0.0), Vec<1>(1.6)}, .cell_size = start_depth / r.cells});
    scene.gravity[0] = -gravity;
    scene.liquid.bulk_modulus = bulk_modulus;
    scene.add_soil(vadose::box({0.0}, {plug}), plug_soil<Model>(porosity, conductivity),
                   {.liquid_pressure = [](const Vec<1>& x) {
                     return 1000 * gravity * (head + rise * x[0] / plug - x[0]);
                   }});
    scene.add_water(vadose::box({plug}, {top}), {.surface_level = top});
    scene.add(vadose::bc::PrescribedHead{.face = vadose::Face::bottom, .head = head});
    return vadose::Solver<Model, typename V::Scheme>(scene, {.courant = r.courant});
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    Comparison fall{"level", time};
    const Real depth = run.water_balance().free / 1000;
    fall.add(0, (depth - (start_depth - rise)) / rise, std::exp(-time));
    return {fall};
  }
  Real bound(const Comparison&, const Resolution&) const { return 0.02; }
};

/// Two ponds in the plane, parted by rigid soil that lets practically nothing pass, level out through
/// saturated rigid soil below it: d(dh)/dt = -2 k A_p / (L_p A_r) dh, A_p and L_p height and length of
/// what lets water pass, A_r the width of each pond. The pressure in the ponds is hydrostatic, the flow
/// between them uniform, so that this is exact in the limit of Darcy's drag: k / (n g), 5 ms, is
/// 1 / 2000 of the time in which the ponds level out. Times over that; differences over the first.
struct UTubePonds {
  static constexpr const char* name = "U-tube, Darcy";
  static constexpr Real width = 0.4, length = 0.2, passage = 0.2, porosity = 0.4, gravity = 9.81;
  static constexpr Real high = 0.9, low = 0.5, ground = 1;

  Real conductivity = 0.02;  ///< k [m/s]
  Real bulk_modulus = 2e6;   ///< K [Pa]
  std::vector<Real> times = {0.25, 0.5, 1};
  std::vector<Resolution> resolutions = {{10}, {20}};  ///< cells in the length

  using Physics = vadose_test::Seepage<vadose::PlaneStrain>;

  Real rate() const { return 2 * conductivity * passage / (length * width); }
  Real seconds(Real time) const { return time / rate(); }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<Physics, V>;
    constexpr Real right = width + length, end = right + width;
    vadose::Scene<Model> scene({.box = {{0, 0}, {end, 1.2}}, .cell_size = end / r.cells});
    scene.gravity[1] = -gravity;
    scene.liquid.bulk_modulus = bulk_modulus;
    const auto pressure = [](const Vec<2>& x) {
      const Real share = std::clamp((x[0] - width) / length, 0.0, 1.0);
      return 1000 * gravity * (high + (low - high) * share - x[1]);
    };
    vadose::Material<Model> soil{
        .porosity = porosity,
        .lambda = 0.8,
        .retention = {.residual_saturation = 0.01, .a = 100, .porosity_dependent = false},
        .conductivity = {.saturated_conductivity = conductivity, .porosity_dependent = false}};
    scene.add_soil(vadose::box({width, 0}, {right, passage}), soil, {.liquid_pressure = pressure});
    soil.conductivity.saturated_conductivity = 1e-9;
    scene.add_soil(vadose::box({width, passage}, {right, ground}), soil,
                   {.liquid_pressure = pressure});
    scene.add_water(vadose::box({0, 0}, {width, high}), {.surface_level = high});
    scene.add_water(vadose::box({right, 0}, {end, low}), {.surface_level = low});
    return vadose::Solver<Model, typename V::Scheme>(scene, {.courant = r.courant});
  }

  /// Difference of the levels [m].
  template <class Run>
  static Real difference(const Run& run) {
    Real levels = 0;
    for_water(run, [&](const Vec<2>& x, const Vec<2>&, Real, Real volume) {
      if (x[0] < width) levels += volume / width;
      if (x[0] > width + length) levels -= volume / width;
    });
    return levels;
  }
  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    Comparison fall{"difference of levels", time};
    fall.add(0, difference(run) / (high - low), std::exp(-time));
    return {fall};
  }
  Real bound(const Comparison&, const Resolution&) const { return 0.02; }
};

}  // namespace verify
