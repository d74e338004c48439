// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "../../seepage.hpp"
#include "../case.hpp"

namespace verify {

/// A pond of free liquid points sinks into 10 m of rigid or elastic clay, [Zhan] 4.2, Figs. 8 and 9,
/// against coupled finite volumes. Times [s]; S as it is (its range is 0.11), pond and heave at the
/// end over their references.
template <class SkeletonLaw>
struct Pond {
  static constexpr bool rigid = std::is_same_v<SkeletonLaw, vadose::law::Rigid>;
  static constexpr const char* name = rigid ? "pond on rigid clay" : "pond on elastic clay";
  static constexpr Real height = 10, gravity = 9.81, top_pressure = -114e3;

  Real depth = 0.5;  ///< of the pond [m]
  /// Ten times softer than water, of which the pores then hold more: see held_by_softness().
  Real bulk_modulus = 2.2e8;
  std::vector<Real> times = {50, 100, 200, end()};
  std::vector<Resolution> resolutions = {{10}, {20}, {40}};

  using Physics = std::conditional_t<rigid, vadose_test::Seepage<vadose::Uniaxial>,
                                     vadose::UnsaturatedModel<vadose::Uniaxial>>;

  /// What is left of 0.5 m, and the heave, at the end [m].
  static constexpr Real end() { return rigid ? 300 : 500; }
  static constexpr Real left() { return rigid ? 0.2155 : 0.1402; }
  static constexpr Real heave() { return rigid ? 0 : 0.0753; }
  Real seconds(Real time) const { return time; }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<Physics, V>;
    vadose::Scene<Model> scene(
        {.box = {Vec<1>(0.0), Vec<1>(height + 1)}, .cell_size = height / r.cells});
    scene.gravity[0] = -gravity;
    scene.liquid.bulk_modulus = bulk_modulus;
    vadose::Material<Model> clay = {.name = "clay",
                                    .porosity = table1::porosity,
                                    .lambda = table1::lambda,
                                    .retention = {.a = table1::a, .porosity_dependent = !rigid},
                                    .conductivity = {.saturated_conductivity = table1::conductivity,
                                                     .porosity_dependent = !rigid}};
    vadose::SoilOptions<1> options{.water_table = height + top_pressure / (1000 * gravity)};
    if constexpr (!rigid) {
      clay.solid_density = table1::solid_density;
      clay.skeleton = {.young_modulus = table1::young_modulus,
                       .poisson_ratio = table1::poisson_ratio};
      options.initial_stress = vadose::InitialStress::geostatic;
      scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
    }
    scene.add_soil(vadose::box({0.0}, {height}), clay, options);
    scene.add_water(vadose::box({height}, {height + depth}), {.surface_level = height + depth});
    vadose::Solver<Model, typename V::Scheme> solver(
        scene, {.courant = r.courant, .damping = rigid ? 0.0 : 0.05});
    if constexpr (!rigid) {
      // The pond rests on the soil before it may sink in.
      if (!(solver.equilibrate({.tolerance = 1e-5, .max_time = 20}).residual < 1e-4))
        throw std::runtime_error("no equilibrium under the pond");
    }
    return solver;
  }

  /// Depth of the water on the ground [m]: below half a cell it is a film.
  static Real water_above(const vadose::WaterBalance& w) { return (w.free + w.film) / 1000; }
  template <class Solver>
  static Real largest_heave(const Solver& solver) {
    Real most = -1;
    solver.solid().for_each(
        [&](std::size_t b, int l) { most = std::max(most, solver.displacement(b, l)[0]); });
    return most;
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    return time < end() ? profile(run, time) : final_state(run, time);
  }
  template <class Run>
  std::vector<Comparison> profile(const Run& run, Real time) const {
    static const Table table("r3_pond_profiles.csv");
    std::vector<std::pair<Real, Real>> rows;
    for (std::size_t i = 0; i < table.size(); ++i)
      if (table.text(i, "case") == (rigid ? "rigid_pond0.5" : "full_pond0.5") &&
          table.number(i, "t_s") == time)
        rows.emplace_back(table.number(i, "z_m"), table.number(i, "Sr"));
    Comparison content{"saturation", time};
    const Real half = 0.5 * run.state().grid.cell_size();
    for_cells(run, vadose::CellKind::soil, [&](const auto& cell) {
      const Real z = cell.centroid[0];
      Norm mean;  // of the reference over the cell
      for (int i = -4; i <= 4; ++i)
        mean.add(
            linear(rows, std::clamp(z + half * i / 4.5, rows.front().first, rows.back().first)));
      content.add(z, cell.saturation, mean.mean());
    });
    return {content};
  }
  /// Water that the pores hold only because it is softer than water [m]: n H mean(p) / K, 1 mm.
  template <class Run>
  Real held_by_softness(const Run& run) const {
    constexpr Real true_modulus = 2.2e9;
    Real sum = 0;
    for_cells(run, vadose::CellKind::soil, [&](const auto& cell) {
      const Real p = std::max<Real>(0, cell.pressure);
      sum += cell.pore_volume * (std::exp(p / bulk_modulus) - std::exp(p / true_modulus));
    });
    return sum;
  }
  template <class Run>
  std::vector<Comparison> final_state(const Run& run, Real time) const {
    Comparison pond{"pond left", time}, risen{"heave", time}, base{"base pressure", time};
    pond.add(height, (water_above(run.water_balance()) + held_by_softness(run)) / left(), 1);
    Real lowest = 1e9, pressure = 0;
    for_cells(run, vadose::CellKind::soil, [&](const auto& cell) {
      if (cell.centroid[0] >= lowest) return;
      lowest = cell.centroid[0];
      pressure = cell.pressure + 1000 * gravity * lowest;
    });
    base.add(0, pressure / (1000 * gravity * (height + left() + heave())), 1);
    std::vector<Comparison> result = {pond, base};
    if constexpr (!rigid) {
      risen.add(height, largest_heave(run) / heave(), 1);
      result.push_back(risen);
    }
    return result;
  }

  Real bound(const Comparison& c, const Resolution&) const {
    return c.quantity == "saturation" || c.quantity == "base pressure" ? 0.01 : 0.02;
  }
};

}  // namespace verify
