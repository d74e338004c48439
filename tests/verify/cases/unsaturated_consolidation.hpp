// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

#include "../case.hpp"
#include "unsaturated_closed_form.hpp"

namespace verify {

/// A loaded run and one without the load, side by side: their difference is the response to the
/// load alone, whatever is left out of balance at the start.
template <class Solver>
struct LoadedAndIdle {
  Solver loaded, idle;

  void advance_to(Real t) {
    loaded.advance_to(t);
    idle.advance_to(t);
  }
  std::int64_t steps() const { return loaded.steps() + idle.steps(); }
  std::size_t points() const { return loaded.solid().size() + loaded.liquid().size(); }
  /// See verify::present.
  LoadedAndIdle present() const { return {verify::present(loaded), verify::present(idle)}; }

  /// Calls f(height of the cell, pressure from the load).
  template <class F>
  void for_cells(F&& f) const {
    std::vector<Real> rest;
    verify::for_cells(idle, vadose::CellKind::soil,
                      [&](const auto& cell) { rest.push_back(cell.pressure); });
    std::size_t i = 0;
    verify::for_cells(loaded, vadose::CellKind::soil,
                      [&](const auto& cell) { f(cell.centroid[0], cell.pressure - rest[i++]); });
  }
};

/// Consolidation of a column of clay of 1 m at S = 0.86, [Zhan] 4.1, surface held at its first
/// suction. A small load against the series of the linearised equations; times are the time factors
/// of that series, from the middle of the ramp. Pressures over the load.
struct UnsaturatedConsolidation {
  static constexpr const char* name = "unsaturated consolidation";
  static constexpr Real saturation = 0.86, height = 1;

  Real young_modulus = table1::young_modulus;  ///< [Pa]
  bool porosity_dependent = true;              ///< retention and conductivity follow porosity
  Real load = 100;                             ///< [Pa]
  /// k_sat over Table 1's: k at S = 0.86 is 3e-7 m/s, 6000 s to T_v = 1. Inertia stays small: the
  /// load comes within 5 periods of the wave, 1/300 of the consolidation time or less.
  Real speed_up = 300;
  vadose::QuasiStatic quasi_static = {};  ///< of a semi-implicit run
  std::vector<Real> times = {0.05, 0.1, 0.3, 0.6};
  std::vector<Resolution> resolutions = {{10}, {20}, {40}};

  using Physics = vadose::UnsaturatedModel<vadose::Uniaxial>;

  UnsaturatedClosedForm closed_form() const { return {young_modulus, porosity_dependent}; }
  Real conductivity() const { return speed_up * table1::conductivity; }
  Real ramp() const { return 5 * 4 * height / closed_form().wave_speed(); }
  Real seconds(Real time_factor) const {
    return 0.5 * ramp() +
           time_factor * height * height / closed_form().consolidation(conductivity());
  }

  /// One column with the load q(t).
  template <class V>
  auto column(const Resolution& r, Real full_load, const vadose::TimeFactor& factor) const {
    using Model = With<Physics, V>;
    const Real h = height / r.cells;
    vadose::Scene<Model> scene({.box = {Vec<1>(0.0), Vec<1>(height + 2 * h)}, .cell_size = h});
    scene.add_soil(vadose::box(Vec<1>(0.0), Vec<1>(height)),
                   clay<Model>(young_modulus, porosity_dependent, conductivity()),
                   {.saturation = saturation});
    scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
    const auto surface = vadose::box(Vec<1>(height - 0.5 * h), Vec<1>(height + h));
    const Real suction = closed_form().suction;
    scene.add(vadose::bc::Traction<1>{
        .region = surface, .traction = Vec<1>(-full_load), .time_factor = factor});
    scene.add(vadose::bc::PrescribedPressure<1>{.region = surface, .pressure = -suction});
    vadose::Solver<Model, typename V::Scheme> solver(
        scene, {.courant = r.courant, .quasi_static = quasi_static});
    // The skeleton starts in balance with the suction: total stress 0.
    set_vertical_stress(solver, -saturation * suction, 1);
    return solver;
  }
  /// A loaded and an idle column; the load comes at once or by a factor of time.
  template <class V>
  auto pair(const Resolution& r, const vadose::TimeFactor& factor = {}) const {
    auto idle = column<V>(r, 0, factor);
    return LoadedAndIdle<decltype(idle)>{column<V>(r, load, factor), idle};
  }
  template <class V>
  auto start(const Resolution& r) const {
    return pair<V>(r, [t_full = ramp()](Real t) { return std::min(Real(1), t / t_full); });
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time_factor) const {
    const UnsaturatedClosedForm exact = closed_form();
    const Real half = 0.5 * run.loaded.state().grid.cell_size();
    Comparison pressure{"pressure", time_factor};
    run.for_cells([&](Real z, Real p) {
      const Real depth = height - z;
      pressure.add(z, p / load,
                   exact.undrained() * terzaghi_mean((depth - half) / height,
                                                     (depth + half) / height, time_factor));
    });
    return {pressure};
  }

  Real bound(const Comparison&, const Resolution&) const { return 0.01; }
};

}  // namespace verify
