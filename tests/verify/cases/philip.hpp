// SPDX-License-Identifier: MIT
#pragma once

#include "../../seepage.hpp"
#include "../case.hpp"

namespace verify {

/// Horizontal infiltration into rigid clay of [Zhan] Table 1 at -20 kPa from a face at p = 0, against
/// Philip's similarity solution: inflow = sorptivity sqrt(t), S a function of x / sqrt(t). Times [s]
/// of Table 1's k; inflow over its reference, S over its range.
struct Philip {
  static constexpr const char* name = "philip";
  static constexpr Real length = 2, pressure = -2e4;

  Real speed_up = 10;  ///< of k_sat and so of time
  /// Of the conductivity: Philip's solution has none. The default, 1e-3, straightens k_r below 49 Pa.
  Real linear_below = 0;
  std::vector<Real> times = {25, 50, 100};
  std::vector<Resolution> resolutions = {{20}, {40}, {80}};

  using Physics = vadose_test::Seepage<vadose::Uniaxial>;

  Real seconds(Real time) const { return time / speed_up; }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<Physics, V>;
    vadose::Scene<Model> scene(
        {.box = {Vec<1>(0.0), Vec<1>(length)}, .cell_size = length / r.cells});
    const vadose::Material<Model> soil{
        .name = "clay",
        .porosity = table1::porosity,
        .lambda = table1::lambda,
        .retention = {.a = table1::a, .porosity_dependent = false},
        .conductivity = {.saturated_conductivity = speed_up * table1::conductivity,
                         .porosity_dependent = false,
                         .linear_below = linear_below}};
    scene.add_soil(vadose::box(Vec<1>(0.0), Vec<1>(length)), soil,
                   {.liquid_pressure = [](const Vec<1>&) { return pressure; }});
    scene.add(vadose::bc::PrescribedPressure<1>{.face = vadose::Face::bottom, .pressure = 0});
    return vadose::Solver<Model, typename V::Scheme>(scene, {.courant = r.courant});
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    static const Table profile("r4_philip_similarity.csv"), sorptivity("r4_philip_sorptivity.csv");
    std::vector<std::pair<Real, Real>> exact = {{0, 1}};
    for (std::size_t i = 0; i < profile.size(); ++i)
      if (profile.text(i, "soil") == "Table1_20kPa")
        exact.emplace_back(profile.number(i, "phi_x_over_sqrt_t"), profile.number(i, "Sr"));
    const Real first = exact.back().second;
    exact.emplace_back(1, first);
    const Real half = 0.5 * run.state().grid.cell_size();
    Comparison content{"saturation", time}, inflow{"inflow", time};
    for_cells(run, vadose::CellKind::soil, [&](const auto& cell) {
      Norm mean;
      for (int i = -4; i <= 4; ++i)
        mean.add(linear(exact, (cell.centroid[0] + half * i / 4.5) / std::sqrt(time)));
      content.add(cell.centroid[0], cell.saturation / (1 - first), mean.mean() / (1 - first));
    });
    Real s = 0;
    for (std::size_t i = 0; i < sorptivity.size(); ++i)
      if (sorptivity.text(i, "soil") == "Table1_20kPa")
        s = sorptivity.number(i, "sorptivity_m_per_sqrt_s");
    const auto water = run.water_balance();
    inflow.add(0, (water.inflow - water.outflow) / 1000 / (s * std::sqrt(time)), 1);
    return {content, inflow};
  }

  Real bound(const Comparison&, const Resolution& r) const { return r.cells >= 40 ? 0.02 : 0.05; }
};

}  // namespace verify
