// SPDX-License-Identifier: MIT
#pragma once

#include "../../seepage.hpp"
#include "../case.hpp"

namespace verify {

/// A run that keeps the mean of a quantity over its last `window` seconds.
template <class Solver, class Quantity>
struct Metered {
  Solver solver;
  Quantity quantity;
  Real window;                  ///< [s]
  Vec<3> sum = Vec<3>::Zero();  ///< of the quantity times the step
  Real span = 0;                ///< time in the sum [s]

  void advance_to(Real t) {
    solver.advance_to(t - window);
    sum.setZero();
    span = 0;
    while (solver.time() < t) {
      const auto report = solver.step(t);
      if (report.status != vadose::Status::ok) throw vadose::InstabilityError(report);
      sum += report.dt * quantity(solver);
      span += report.dt;
    }
  }
  Vec<3> mean() const { return (1 / span) * sum; }
  std::int64_t steps() const { return solver.steps(); }
  std::size_t points() const { return solver.solid().size() + solver.liquid().size(); }
  auto water_balance() const { return solver.water_balance(); }
  const auto& state() const { return solver.state(); }
  const Metered& present() const { return *this; }
};

/// Steady seepage through a rectangular dam of coarse, rigid soil, 1 m x 1 m, between reservoirs of 1
/// and 0.2 m, with a seepage face above the lower one. The discharge q = k (h1^2 - h2^2) / (2 L) is
/// exact (Charny), the free surface is that of r8_dam_freesurface.csv; both without capillarity, which
/// here is a fringe of about 1 / a = 1 cm. The water is softened to bulk_modulus: c = sqrt(K / rho) = 45
/// m/s against pore velocities of up to q / n h2, Mach 1e-2, and 0.5 % of density at the base. k is
/// large to be at rest soon: n g / k is still 40 times the rate at which the dam fills. It starts with
/// Dupuit's surface and fills up to the true one; what goes through it a second is q / (n x 0.7 m2) =
/// 9 % of its water. Discharges are means over the last 3 s: from step to step that of a wall changes
/// as points pass from cell to cell.
struct DamSeepage {
  static constexpr const char* name = "dam seepage";
  static constexpr Real length = 1, upper = 1, lower = 0.2, porosity = 0.4, gravity = 9.81;

  Real conductivity = 0.05;        ///< k [m/s]
  Real bulk_modulus = 2e6;         ///< K [Pa]
  Real air_entry = 100;            ///< a [1/m]
  std::vector<Real> times = {15};  ///< [s]
  std::vector<Resolution> resolutions = {{10}, {20}, {40}};

  using Physics = vadose_test::Seepage<vadose::PlaneStrain>;

  static Real discharge(Real k) { return k * (upper * upper - lower * lower) / (2 * length); }
  Real seconds(Real time) const { return time; }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<Physics, V>;
    namespace bc = vadose::bc;
    vadose::Scene<Model> scene({.box = {{0, 0}, {length, upper}}, .cell_size = length / r.cells});
    scene.gravity[1] = -gravity;
    scene.liquid.bulk_modulus = bulk_modulus;
    const vadose::Material<Model> soil{
        .porosity = porosity,
        .lambda = 0.8,
        .retention = {.residual_saturation = 0.01, .a = air_entry, .porosity_dependent = false},
        .conductivity = {.saturated_conductivity = conductivity, .porosity_dependent = false}};
    // Starts with Dupuit's surface.
    const auto pressure = [](const Vec<2>& x) {
      const Real level = std::sqrt(upper * upper - (upper * upper - lower * lower) * x[0] / length);
      return 1000 * gravity * (level - x[1]);
    };
    scene.add_soil(vadose::box({0, 0}, {length, upper}), soil, {.liquid_pressure = pressure});
    scene.add(bc::Reservoir{.face = vadose::Face::left, .level = upper});
    scene.add(bc::Reservoir{.face = vadose::Face::right, .level = lower});
    using Solver = vadose::Solver<Model, typename V::Scheme>;
    const int columns = r.cells;
    auto discharges = [columns](const Solver& solver) {
      return Vec<3>{flux(solver, 0), flux(solver, columns / 2), flux(solver, columns)};
    };
    return Metered<Solver, decltype(discharges)>{
        .solver = Solver(scene, {.courant = r.courant}), .quantity = discharges, .window = 3};
  }

  /// Discharge through the plane of lower faces of column i of the cells [m2/s].
  template <class Run>
  static Real flux(const Run& run, int i) {
    const auto& state = run.state();
    Real sum = 0;
    for (int j = 0; j < state.grid.cells()[1]; ++j)
      sum += state.nodes.face[static_cast<std::size_t>(state.grid.entry({i, j})) * 2].flux;
    return sum;
  }
  /// Height at which p = 0 in column i [m].
  template <class Run>
  static Real surface(const Run& run, int i) {
    const auto& state = run.state();
    const auto cell = [&](int j) {
      return state.nodes.cell[static_cast<std::size_t>(state.grid.entry({i, j}))];
    };
    int j = 1;
    while (j + 1 < state.grid.cells()[1] && cell(j).pressure > 0) ++j;
    const auto a = cell(j - 1), b = cell(j);
    return a.centroid[1] + (b.centroid[1] - a.centroid[1]) * a.pressure / (a.pressure - b.pressure);
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    Comparison discharges{"discharge", time}, level{"free surface", time};
    const int columns = run.state().grid.cells()[0];
    for (int i = 0; i < 3; ++i)
      discharges.add(length * i / 2, run.mean()[i] / discharge(conductivity), 1);
    std::vector<std::pair<Real, Real>> reference;
    static const Table table("r8_dam_freesurface.csv");
    for (std::size_t i = 0; i < table.size(); ++i)
      if (table.text(i, "case") == "1x1_tw0.2")
        reference.emplace_back(table.number(i, "x_m"), table.number(i, "y_freesurface_m"));
    for (int i = 0; i < columns; ++i) {
      const Real x = length * (i + 0.5) / columns;
      level.add(x, surface(run, i) / upper, linear(reference, x) / upper);
    }
    return {discharges, level};
  }

  Real bound(const Comparison& c, const Resolution&) const {
    return c.quantity == "discharge" ? 0.03 : 0.05;
  }
};

}  // namespace verify
