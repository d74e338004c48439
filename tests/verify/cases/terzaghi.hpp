// SPDX-License-Identifier: MIT
#pragma once

#include "../case.hpp"

namespace verify {

/// Consolidation of a saturated column of 1 m, [Zhan] 4.1, Table 1, against Terzaghi's series with
/// the storage of the water. Times are time factors T_v; pressures over the load.
struct Terzaghi {
  static constexpr const char* name = "terzaghi";
  static constexpr Real height = 1;

  Real conductivity = table1::conductivity;  ///< [m/s]
  Real load = 1e4;                           ///< [Pa]
  Real jitter = 0;                           ///< random offsets of the points [cell size]
  Real top_fill = 1;  ///< part of the uppermost cell that soil fills; four points per cell if < 1
  std::vector<Real> times = {0.05, 0.1, 0.3, 0.6};
  std::vector<Resolution> resolutions = {{10}, {20}, {40}};

  using Physics = vadose::SaturatedModel<vadose::Uniaxial>;

  static Real stiffness() {
    return oedometric_modulus(table1::young_modulus, table1::poisson_ratio);
  }
  /// Pressure right after loading over the load.
  static Real undrained() {
    return 1 / (1 + table1::porosity * stiffness() / table1::bulk_modulus);
  }
  Real seconds(Real time_factor) const {
    const Real storage = 1 / stiffness() + table1::porosity / table1::bulk_modulus;
    return time_factor * height * height * 9810 * storage / conductivity;
  }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<Physics, V>;
    const Real h = height / (r.cells - 1 + top_fill);
    vadose::Scene<Model> scene({.box = {Vec<1>(0.0), Vec<1>((r.cells + 2) * h)}, .cell_size = h});
    // Terzaghi's k does not change with porosity (Kozeny and Carman's by 0.5 % at 10 kPa).
    auto material = saturated_soil<Model>(conductivity);
    material.conductivity.porosity_dependent = false;
    const Real p0 = undrained() * load;
    const int per_cell = top_fill < 1 ? 4 : 2;
    scene.add_soil(vadose::box(Vec<1>(0.0), Vec<1>(height)), material,
                   {.points_per_cell = per_cell,
                    .jitter = jitter,
                    .seed = 5,
                    .liquid_pressure = [=](const Vec<1>&) { return p0; }});
    scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
    scene.add(vadose::bc::Traction<1>{
        .region = vadose::box(Vec<1>(height - h / per_cell), Vec<1>(height)),
        .traction = Vec<1>(-load)});
    scene.add(vadose::bc::ZeroSuction{});
    vadose::Solver<Model, typename V::Scheme> solver(scene, {.courant = r.courant});
    // What the water leaves of the load, the skeleton carries from the start.
    set_vertical_stress(solver, p0 - load, table1::poisson_ratio / (1 - table1::poisson_ratio));
    return solver;
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time_factor) const {
    Comparison pressure{"pressure", time_factor};
    const Real h = run.state().grid.cell_size();
    for_cells(run, vadose::CellKind::soil, [&](const auto& cell) {
      const Real depth = height - cell.centroid[0], half = 0.5 * h * cell.fill;
      pressure.add(cell.centroid[0], cell.pressure / load,
                   undrained() * terzaghi_mean((depth - half) / height, (depth + half) / height,
                                               time_factor));
    });
    return {pressure};
  }

  Real bound(const Comparison& c, const Resolution& r) const {
    if (jitter > 0 || top_fill < 1) return 0.02;
    if (r.cells >= 20) return 0.0035;
    return c.time < 0.1 ? 0.01 : 0.005;
  }
};

}  // namespace verify
