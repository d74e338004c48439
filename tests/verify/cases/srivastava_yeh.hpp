// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/policy/conductivity/gardner.hpp>
#include <vadose/policy/swrc/gardner.hpp>

#include "../case.hpp"

namespace verify {

/// Rain on 1 m of rigid soil with exponential curves over a water table (Srivastava and Yeh 1991):
/// from steady flow of 0.1 k_sat to 0.9 k_sat. Times are alpha k_sat t / (theta_s - theta_r).
/// Effective saturation; its range is 0.1 to 1.
struct SrivastavaYeh {
  static constexpr const char* name = "srivastava-yeh";
  static constexpr Real height = 1, porosity = 0.4, residual = 0.15, alpha = 10;

  Real conductivity = 1e-3;  ///< k_sat [m/s]; the solution depends on k_sat t only
  Real bulk_modulus = 1e6;   ///< of the water [Pa]: at -2.3 kPa its density is 0.2 % lower
  std::vector<Real> times = {0.2941176471, 0.5882352941, 1.470588235, 2.941176471};
  std::vector<Resolution> resolutions = {{10}, {20}, {40}};

  struct Physics : vadose::UnsaturatedModel<vadose::Uniaxial> {
    using Skeleton = vadose::law::Rigid;
    using Retention = vadose::swrc::Gardner;
    using Conductivity = vadose::conductivity::Gardner;
  };

  Real seconds(Real time) const {
    return time * porosity * (1 - residual) / (alpha * conductivity);
  }
  /// k_r of the steady flow at the start.
  static Real steady(Real z) { return 0.1 + 0.9 * std::exp(-alpha * z); }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<Physics, V>;
    const Real h = height / r.cells;
    vadose::Scene<Model> scene({.box = {Vec<1>(0.0), Vec<1>(height + 2 * h)}, .cell_size = h});
    scene.gravity[0] = -9.81;
    scene.liquid.bulk_modulus = bulk_modulus;
    const vadose::Material<Model> soil{
        .name = "soil",
        .porosity = porosity,
        .retention = {.residual_saturation = residual, .alpha = alpha},
        .conductivity = {.saturated_conductivity = conductivity, .porosity_dependent = false}};
    scene.add_soil(
        vadose::box(Vec<1>(0.0), Vec<1>(height)), soil,
        {.liquid_pressure = [](const Vec<1>& x) { return 9810 / alpha * std::log(steady(x[0])); }});
    scene.add(vadose::bc::PrescribedPressure<1>{.face = vadose::Face::bottom, .pressure = 0});
    scene.add(vadose::bc::Rain{.rate = 0.9 * conductivity});
    return vadose::Solver<Model, typename V::Scheme>(scene, {.courant = r.courant});
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    static const Table table("r4_srivastava_yeh.csv");
    std::vector<std::pair<Real, Real>> exact;
    for (std::size_t i = 0; i < table.size(); ++i)
      if (std::fabs(table.number(i, "t_dimless") - time) < 1e-6)
        exact.emplace_back(table.number(i, "z_m"), table.number(i, "kr"));
    const Real half = 0.5 * run.state().grid.cell_size();
    Comparison content{"effective saturation", time};
    for_cells(run, vadose::CellKind::soil, [&](const auto& cell) {
      const Real z = cell.centroid[0];
      Norm mean;  // S_e = k_r over the cell
      for (int i = -4; i <= 4; ++i) mean.add(linear(exact, z + half * i / 4.5));
      content.add(z, (cell.saturation - residual) / (1 - residual) / 0.9, mean.mean() / 0.9);
    });
    return {content};
  }

  Real bound(const Comparison&, const Resolution& r) const { return r.cells >= 20 ? 0.02 : 0.05; }
};

}  // namespace verify
