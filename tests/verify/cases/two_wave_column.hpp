// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>

#include "terzaghi.hpp"

namespace verify {

/// A run that keeps p [Pa] and sigma' [Pa] at three heights after every step. Cells hold the pressures
/// at the start of a step: those belong to the row before.
template <class Solver>
struct Recorded {
  static constexpr std::array<Real, 3> heights = {0.25, 0.5, 0.75};
  struct Row {
    Real time;
    std::array<Real, 3> pressure, stress;
  };

  Solver solver;
  std::vector<Row> rows = {};

  void advance_to(Real t) {
    while (solver.time() < t) {
      const auto report = solver.step(t);
      if (report.status != vadose::Status::ok) throw vadose::InstabilityError(report);
      if (!rows.empty()) rows.back().pressure = pressures(solver);
      rows.push_back({report.time, {}, stresses()});
    }
    rows.back().pressure = pressures(verify::present(solver));
  }
  std::int64_t steps() const { return solver.steps(); }
  std::size_t points() const { return solver.solid().size() + solver.liquid().size(); }
  const Recorded& present() const { return *this; }

  /// When a history first passes a value, linear between steps; unset if never.
  template <class F>
  Real passes(Real value, F&& history) const {
    for (std::size_t i = 1; i < rows.size(); ++i) {
      const Real a = history(rows[i - 1]) / value, b = history(rows[i]) / value;
      if (a < 1 && b >= 1)
        return rows[i - 1].time + (1 - a) / (b - a) * (rows[i].time - rows[i - 1].time);
    }
    return vadose::unset;
  }
  /// Mean of a history from a time to another.
  template <class F>
  Real mean(Real from, Real to, F&& history) const {
    Norm norm;
    for (const Row& r : rows)
      if (r.time >= from && r.time <= to) norm.add(history(r));
    return norm.mean();
  }

 private:
  /// Values of (height, value) at the heights.
  static std::array<Real, 3> at_heights(std::vector<std::pair<Real, Real>>& profile) {
    std::sort(profile.begin(), profile.end());
    std::array<Real, 3> values;
    for (std::size_t i = 0; i < heights.size(); ++i) values[i] = linear(profile, heights[i]);
    return values;
  }
  static std::array<Real, 3> pressures(const Solver& of) {
    std::vector<std::pair<Real, Real>> profile;
    for_cells(of, vadose::CellKind::soil,
              [&](const auto& cell) { profile.emplace_back(cell.centroid[0], cell.pressure); });
    return at_heights(profile);
  }
  std::array<Real, 3> stresses() const {
    std::vector<std::pair<Real, Real>> profile;
    solver.solid().for_each([&](std::size_t b, int l) {
      profile.emplace_back(solver.solid().at(vadose::field::position, b, 0)[l],
                           solver.solid().at(vadose::field::bishop_stress, b, 0)[l]);
    });
    return at_heights(profile);
  }
};

/// Both compression waves in a saturated column of 1 m, [Zhan] Table 1, under a load that comes
/// within a ramp of 1/2 (1 - cos), p = 0 at the top. Low k: the history of p against the modal
/// series (rms over times, over the load). High k (hardly any drag): arrival of half the step and
/// height of it for the fast wave (in p) and the slow one (in sigma') over their closed forms.
struct TwoWaveColumn {
  static constexpr const char* name = "two waves";
  static constexpr Real height = 1, load = 1e4;
  static constexpr Real fast = 1863.521286, slow = 77.56875228;  ///< drag-free speeds [m/s]
  static constexpr Real ramp = 0.2 * height / fast;              ///< [s]

  bool high_conductivity = false;      ///< 1 m/s, else 9.8e-4 m/s
  std::vector<Real> times = {2.1e-3};  ///< [s]
  std::vector<Resolution> resolutions = {{25}, {50}, {100}};

  using Physics = Terzaghi::Physics;

  static TwoWaveColumn high() { return {.high_conductivity = true, .times = {13e-3}}; }
  Real seconds(Real time) const { return time; }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<Physics, V>;
    const Real h = height / r.cells;
    vadose::Scene<Model> scene({.box = {Vec<1>(0.0), Vec<1>(height + 2 * h)}, .cell_size = h});
    auto material = saturated_soil<Model>(high_conductivity ? 1 : table1::conductivity);
    material.conductivity.porosity_dependent = false;
    scene.add_soil(vadose::box(Vec<1>(0.0), Vec<1>(height)), material,
                   {.liquid_pressure = [](const Vec<1>&) { return 0; }});
    scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
    scene.add(vadose::bc::Traction<1>{
        .region = vadose::box(Vec<1>(height - h / 2), Vec<1>(height)),
        .traction = Vec<1>(-load),
        .time_factor = [](Real t) {
          return t < ramp ? 0.5 * (1 - std::cos(std::numbers::pi * t / ramp)) : 1;
        }});
    scene.add(vadose::bc::ZeroSuction{});
    using Solver = vadose::Solver<Model, typename V::Scheme>;
    return Recorded<Solver>{Solver(scene, {.courant = r.courant})};
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    return high_conductivity ? fronts(run, time) : histories(run, time);
  }
  template <class Run>
  std::vector<Comparison> histories(const Run& run, Real time) const {
    static const Table table("r5_ramp_column.csv");
    std::vector<Comparison> result;
    for (std::size_t i = 0; i < Run::heights.size(); ++i) {
      Comparison pressure{"pressure at " + vadose::check::text(Run::heights[i]) + " m", time};
      std::vector<std::pair<Real, Real>> history;
      for (const auto& row : run.rows) history.emplace_back(row.time, row.pressure[i]);
      for (std::size_t j = 0; j < table.size(); ++j)
        if (table.number(j, "z_m") == Run::heights[i] && table.number(j, "t_s") <= time) {
          const Real t = table.number(j, "t_s");
          pressure.add(t, linear(history, t) / load, table.number(j, "p_Pa") / load);
        }
      result.push_back(pressure);
    }
    return result;
  }
  template <class Run>
  std::vector<Comparison> fronts(const Run& run, Real time) const {
    constexpr Real fast_step = 0.6102, slow_step = -0.9990;  // over the load
    Comparison fast_arrival{"arrival of the fast wave", time};
    Comparison fast_height{"height of the fast wave", time};
    Comparison slow_arrival{"arrival of the slow wave", time};
    Comparison slow_height{"height of the slow wave", time};
    for (std::size_t i = 0; i < Run::heights.size(); ++i) {
      const Real z = Run::heights[i], way = height - z;
      const auto pressure = [&](const auto& row) { return row.pressure[i] / load; };
      const auto stress = [&](const auto& row) { return row.stress[i] / load; };
      const Real at_fast = way / fast + ramp / 2, at_slow = way / slow + ramp / 2;
      fast_arrival.add(z, run.passes(0.5 * fast_step, pressure) / at_fast, 1);
      // Until it comes back from the base.
      fast_height.add(z, run.mean(at_fast + ramp / 2, (height + z) / fast, pressure) / fast_step,
                      1);
      slow_arrival.add(z, run.passes(0.5 * slow_step, stress) / at_slow, 1);
      slow_height.add(z, run.mean(at_slow + 0.1 * height / slow, time, stress) / slow_step, 1);
    }
    return {fast_arrival, fast_height, slow_arrival, slow_height};
  }

  Real bound(const Comparison&, const Resolution&) const { return 0.03; }
};

}  // namespace verify
