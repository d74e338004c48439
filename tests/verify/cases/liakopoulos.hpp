// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

#include "../case.hpp"

namespace verify {

/// Retention of Liakopoulos' Del Monte sand, S = 1 - 1.9722e-11 s^2.4279 (s in Pa).
struct DelMonteRetention {
  void validate() const {}
  Real saturation(Real s, Real /*porosity*/) const noexcept {
    return 1 - 1.9722e-11 * std::pow(std::max(s, Real(0)), 2.4279);
  }
  Real saturation_slope(Real s, Real /*porosity*/) const noexcept {
    return -1.9722e-11 * 2.4279 * std::pow(std::max(s, Real(0)), 1.4279);
  }
  Real saturation_porosity_slope(Real /*s*/, Real /*porosity*/) const noexcept { return 0; }
};
static_assert(vadose::RetentionCurve<DelMonteRetention>);

/// Its conductivity, k_r = 1 - 2.207 (1 - S)^1.0121.
struct DelMonteConductivity {
  Real saturated_conductivity = vadose::unset;  ///< [m/s]

  void validate() const {
    vadose::check::positive("saturated_conductivity", saturated_conductivity, "m/s");
  }
  Real conductivity(Real saturation, Real /*porosity*/) const noexcept {
    const Real dry = std::max(1 - saturation, Real(0));
    return saturated_conductivity * std::max(1 - 2.207 * std::pow(dry, 1.0121), 1e-6);
  }
};
static_assert(vadose::ConductivityLaw<DelMonteConductivity>);

/// Drainage of 1 m of elastic sand through its base (Liakopoulos 1965), from steady flow at p = 0,
/// against coupled finite volumes. Times [s] of the true conductivity. Pressure over 1 m of water,
/// settlement of the top over its last value in the reference.
struct Liakopoulos {
  static constexpr const char* name = "liakopoulos";
  static constexpr Real height = 1, porosity = 0.2975;

  /// Of k_sat = 4.41e-6 m/s and so of time. The skeleton's wave takes 0.1 s up and down.
  Real speed_up = 100;
  Real bulk_modulus = 1e8;                ///< of the water [Pa]: n / K is 0.8 % of 1 / E_c
  vadose::QuasiStatic quasi_static = {};  ///< of a semi-implicit run
  std::vector<Real> times = {300, 600, 1200};
  std::vector<Resolution> resolutions = {{10}, {20}, {40}};

  struct Physics : vadose::UnsaturatedModel<vadose::Uniaxial> {
    using Retention = DelMonteRetention;
    using Conductivity = DelMonteConductivity;
  };

  Real seconds(Real time) const { return time / speed_up; }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<Physics, V>;
    const Real h = height / r.cells;
    vadose::Scene<Model> scene({.box = {Vec<1>(0.0), Vec<1>(height + 2 * h)}, .cell_size = h});
    scene.gravity[0] = -9.81;
    scene.liquid.bulk_modulus = bulk_modulus;
    const Real nu = 0.4;
    const vadose::Material<Model> sand{
        .name = "sand",
        .solid_density = 2000,
        .porosity = porosity,
        .skeleton = {.young_modulus = 1.3e6, .poisson_ratio = nu},
        .conductivity = {.saturated_conductivity = speed_up * 4.5e-13 * 9810 / 1e-3}};
    scene.add_soil(vadose::box(Vec<1>(0.0), Vec<1>(height)), sand,
                   {.liquid_pressure = [](const Vec<1>&) { return 0; },
                    .initial_stress = vadose::InitialStress::geostatic,
                    .lateral_stress_ratio = nu / (1 - nu)});
    scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
    scene.add(vadose::bc::PrescribedPressure<1>{.face = vadose::Face::bottom, .pressure = 0});
    return vadose::Solver<Model, typename V::Scheme>(
        scene, {.courant = r.courant, .quasi_static = quasi_static});
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    static const Table table("liakopoulos_reference.csv");
    std::vector<std::pair<Real, Real>> exact, settled;
    Real last = 0;
    for (std::size_t i = 0; i < table.size(); ++i) {
      if (table.number(i, "z_m") > 0.9) last = std::min(last, table.number(i, "u_m"));
      if (table.number(i, "t_s") != time) continue;
      exact.emplace_back(table.number(i, "z_m"), table.number(i, "p_Pa"));
      settled.emplace_back(table.number(i, "z_m"), table.number(i, "u_m"));
    }
    Comparison pressure{"pressure", time}, settlement{"settlement", time};
    for_cells(run, vadose::CellKind::soil, [&](const auto& cell) {
      const Real z = cell.centroid[0];
      pressure.add(z, cell.pressure / (9810 * height), linear(exact, z) / (9810 * height));
    });
    Real top = 0, moved = 0;
    run.solid().for_each([&](std::size_t b, int l) {
      const Real u = run.displacement(b, l)[0];
      const Real z = run.solid().at(vadose::field::position, b, 0)[l] - u;
      if (z < top) return;
      top = z;
      moved = u;
    });
    settlement.add(top, moved / last, linear(settled, top) / last);
    return {pressure, settlement};
  }

  Real bound(const Comparison&, const Resolution&) const { return 0.02; }
};

}  // namespace verify
