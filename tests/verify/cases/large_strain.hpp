// SPDX-License-Identifier: MIT
#pragma once

#include "../case.hpp"

namespace verify {

/// Kozeny and Carman's law, or k = k_0 [(1 - n_0) / (1 - n)]^2, which makes finite-strain
/// consolidation linear (Xie and Leo 2004).
struct SlurryConductivity {
  bool square_law = false;
  vadose::conductivity::KozenyCarman law = {};

  void validate() const { law.validate(); }
  Real conductivity(Real effective_saturation, Real porosity) const noexcept {
    if (!square_law) return law.conductivity<Real>(effective_saturation, porosity);
    const Real volume = (1 - law.reference_porosity) / (1 - porosity);
    return law.saturated_conductivity * volume * volume;
  }
};
static_assert(vadose::ConductivityLaw<SlurryConductivity>);

/// Consolidation of 1 m of slurry (M = 100 kPa, n_0 = 0.6) under 50 kPa, which settles by 0.39 m,
/// with a conductivity that falls with porosity: by the square law (exact) or by Kozeny and Carman's
/// (finite volumes). Times are T = c_v0 t / H^2; pressures over the load, settlement over the height.
struct LargeStrain {
  static constexpr const char* name = "large strain";
  static constexpr Real height = 1, stiffness = 1e5, load = 5e4, porosity = 0.6;

  bool square_law = true;
  int points_per_cell = 2;
  /// k_0 over 1e-4 m/s. The skeleton's wave takes 0.5 s up and down, T = 1 takes 98 s.
  Real speed_up = 10;
  Real bulk_modulus = 2e7;  ///< of the water [Pa]; it takes n M / K = 0.3 % of the load's pressure
  std::vector<Real> times = {0.1, 0.2, 0.4};
  std::vector<Resolution> resolutions = {{10}, {20}, {40}};

  struct Physics : vadose::SaturatedModel<vadose::Uniaxial> {
    using Conductivity = SlurryConductivity;
  };

  Real seconds(Real time_factor) const { return time_factor * 981 / speed_up; }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<Physics, V>;
    const Real h = height / r.cells;
    vadose::Scene<Model> scene({.box = {Vec<1>(0.0), Vec<1>(height + 2 * h)}, .cell_size = h});
    scene.liquid.bulk_modulus = bulk_modulus;
    const Real nu = 0.33;
    const vadose::Material<Model> slurry{
        .name = "slurry",
        .solid_density = 2650,
        .porosity = porosity,
        .skeleton = {.young_modulus = stiffness / oedometric_modulus(1, nu), .poisson_ratio = nu},
        .conductivity = {
            .square_law = square_law,
            .law = {.saturated_conductivity = 1e-4 * speed_up, .reference_porosity = porosity}}};
    const Real p0 = load / (1 + porosity * stiffness / bulk_modulus);
    scene.add_soil(
        vadose::box(Vec<1>(0.0), Vec<1>(height)), slurry,
        {.points_per_cell = points_per_cell, .liquid_pressure = [=](const Vec<1>&) { return p0; }});
    scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
    scene.add(vadose::bc::Traction<1>{
        .region = vadose::box(Vec<1>(height - h / points_per_cell), Vec<1>(height)),
        .traction = Vec<1>(-load)});
    scene.add(vadose::bc::ZeroSuction{});
    vadose::Solver<Model, typename V::Scheme> solver(scene, {.courant = r.courant});
    set_vertical_stress(solver, p0 - load, nu / (1 - nu));
    return solver;
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    static const Table profiles("r7_profiles.csv"), history("r7_settlement.csv");
    const char* rows = square_law ? "xie_leo_k=k0J2" : "kozeny_carman";
    Comparison pressure{"pressure", time}, settlement{"settlement", time};
    std::vector<std::pair<Real, Real>> exact = {};  // height now, pressure
    for (std::size_t i = 0; i < profiles.size(); ++i)
      if (profiles.text(i, "case") == rows && profiles.number(i, "T") == time)
        exact.emplace_back(profiles.number(i, "z_current_m"), profiles.number(i, "u_Pa"));
    for_cells(run, vadose::CellKind::soil, [&](const auto& cell) {
      const Real z = cell.centroid[0];
      pressure.add(z, cell.pressure / load, linear(exact, z) / load);
    });
    Real now = 0;  // height of the column: volume of its points
    run.solid().for_each(
        [&](std::size_t b, int l) { now += run.solid().at(vadose::field::volume, b)[l]; });
    std::vector<std::pair<Real, Real>> settled = {};
    for (std::size_t i = 0; i < history.size(); ++i)
      if (history.text(i, "case") == rows)
        settled.emplace_back(history.number(i, "T"), history.number(i, "settlement_m"));
    settlement.add(0, (height - now) / height, linear(settled, time) / height);
    return {pressure, settlement};
  }

  Real bound(const Comparison&, const Resolution&) const { return 0.01; }
};

}  // namespace verify
