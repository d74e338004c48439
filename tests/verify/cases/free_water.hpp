// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <limits>

#include "../case.hpp"

namespace verify {

/// Free water in the plane between smooth walls, softened to a stated bulk modulus.
using PlaneWater = vadose::FreeWaterModel<vadose::PlaneStrain>;

/// Calls f(position, velocity, mass, volume) for every point of water.
template <class Solver, class F>
void for_water(const Solver& solver, F&& f) {
  const auto& points = solver.liquid();
  points.for_each([&](std::size_t b, int l) {
    Vec<2> x, v;
    for (int d = 0; d < 2; ++d) {
      x[d] = points.at(vadose::field::position, b, d)[l];
      v[d] = points.at(vadose::field::velocity, b, d)[l];
    }
    f(x, v, points.at(vadose::field::mass, b)[l], points.at(vadose::field::volume, b)[l]);
  });
}

/// Water at rest in a tank, its points moved at random: largest departure of the cell pressures from
/// those at rest, over that at the bottom; times in s.
struct StillWater {
  static constexpr const char* name = "still water";
  static constexpr Real length = 0.4, depth = 0.5, gravity = 9.81;

  Real jitter = 0;          ///< of the points [cell size]
  Real bulk_modulus = 1e7;  ///< K [Pa]
  std::vector<Real> times = {0.5, 1};
  std::vector<Resolution> resolutions = {{10}};  ///< cells in the depth

  Real seconds(Real time) const { return time; }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<PlaneWater, V>;
    const Real h = depth / r.cells;
    vadose::Scene<Model> scene({.box = {{0, 0}, {length, depth + 2 * h}}, .cell_size = h});
    scene.gravity[1] = -gravity;
    scene.liquid.bulk_modulus = bulk_modulus;
    scene.add_water(vadose::box({0, 0}, {length, depth}),
                    {.jitter = jitter, .seed = 7, .surface_level = depth});
    return vadose::Solver<Model, typename V::Scheme>(scene, {.courant = r.courant});
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    Comparison pressure{"pressure", time};
    const Real scale = 1000 * gravity * depth;
    for_cells(run, vadose::CellKind::free, [&](const auto& cell) {
      pressure.add(cell.centroid[1], cell.pressure / scale, 1 - cell.centroid[1] / depth);
    });
    return {pressure};
  }
  Real bound(const Comparison&, const Resolution&) const {
    return jitter > 0 ? 0.01 : 1e-3 / (1000 * gravity * depth) + depth / bulk_modulus * 1e4;
  }
};

/// A run that keeps the times at which a quantity passes zero and its largest value since then.
template <class Solver, class Quantity>
struct Swinging {
  Solver solver;
  Quantity quantity;
  std::vector<Real> zeros = {};
  std::vector<Real> peaks = {};  ///< of every half period that has ended
  Real before = 0, peak = 0;     ///< after the last step, and since the last zero

  void advance_to(Real t) {
    while (solver.time() < t) {
      const auto report = solver.step(t);
      if (report.status != vadose::Status::ok) throw vadose::InstabilityError(report);
      const Real now = quantity(solver);
      if (before * now < 0) {
        zeros.push_back(report.time - report.dt * now / (now - before));
        peaks.push_back(peak);
        peak = 0;
      }
      peak = std::max(peak, std::fabs(now));
      before = now;
    }
  }
  /// Mean over the full half periods so far; unset if there is none.
  Real period() const {
    return zeros.size() < 2
               ? vadose::unset
               : 2 * (zeros.back() - zeros.front()) / static_cast<Real>(zeros.size() - 1);
  }
  std::int64_t steps() const { return solver.steps(); }
  std::size_t points() const { return solver.liquid().size(); }
  auto water_balance() const { return solver.water_balance(); }
  const Swinging& present() const { return *this; }
};

/// Standing wave in a tank of 1 m, 0.5 m deep: starts flat with the velocities of the first mode of
/// linear theory, v = U cosh or sinh(k z) / sinh(k h). The part of the velocities in that mode goes
/// with cos(w t): period over 2 pi / w, w^2 = g k tanh(k h). K = 1 MPa is c = 32 m/s, Mach 3e-3 of the
/// points and 0.5 % of density at the bottom. Times in periods.
struct Sloshing {
  static constexpr const char* name = "sloshing";
  static constexpr Real length = 1, depth = 0.5, gravity = 9.81;

  Real speed = 0.1;         ///< U at the surface [m/s]; amplitude U / w = 19 mm
  Real bulk_modulus = 1e6;  ///< K [Pa]
  std::vector<Real> times = {3};
  std::vector<Resolution> resolutions = {{10}, {20}, {40}};

  static Real wave_number() { return std::numbers::pi / length; }
  static Real period() {
    return 2 * std::numbers::pi /
           std::sqrt(gravity * wave_number() * std::tanh(wave_number() * depth));
  }
  Real seconds(Real time) const { return time * period(); }
  static Vec<2> mode(const Vec<2>& x) {
    const Real k = wave_number(), over = 1 / std::sinh(k * depth);
    return {-std::sin(k * x[0]) * std::cosh(k * x[1]) * over,
            std::cos(k * x[0]) * std::sinh(k * x[1]) * over};
  }
  /// Part of the velocities in the mode.
  template <class Solver>
  static Real amplitude(const Solver& solver) {
    Real part = 0, all = 0;
    for_water(solver, [&](const Vec<2>& x, const Vec<2>& v, Real m, Real) {
      const Vec<2> phi = mode(x);
      part += m * v.dot(phi);
      all += m * phi.dot(phi);
    });
    return part / all;
  }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<PlaneWater, V>;
    const Real h = length / r.cells;
    vadose::Scene<Model> scene({.box = {{0, 0}, {length, depth + 2 * h}}, .cell_size = h});
    scene.gravity[1] = -gravity;
    scene.liquid.bulk_modulus = bulk_modulus;
    scene.add_water(vadose::box({0, 0}, {length, depth}), {.surface_level = depth});
    using Solver = vadose::Solver<Model, typename V::Scheme>;
    Solver solver(scene, {.courant = r.courant});
    auto& water = solver.mutable_state().liquid;
    water.for_each([&](std::size_t b, int l) {
      const Vec<2> v = speed * mode({water.at(vadose::field::position, b, 0)[l],
                                     water.at(vadose::field::position, b, 1)[l]});
      for (int d = 0; d < 2; ++d) water.at(vadose::field::velocity, b, d)[l] = v[d];
    });
    auto quantity = [](const Solver& s) { return amplitude(s); };
    return Swinging<Solver, decltype(quantity)>{solver, quantity};
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    Comparison swing{"period", time}, left{"amplitude left", time};
    swing.add(0, run.period() / period(), 1);
    left.add(0, run.peaks.back() / speed, 1);
    return {swing, left};
  }
  Real bound(const Comparison& c, const Resolution& r) const {
    if (c.quantity != "period" || r.cells < 20) return std::numeric_limits<Real>::infinity();
    return 0.02;
  }
};

/// A column of water 0.05715 m (a) wide and twice as high falls, against Martin and Moyce (1952): the
/// front z / a over T = t sqrt(2 g / a) and the height left at the wall h / (2 a) over t sqrt(g / a).
/// Times in T. The front is where 1 % of the water has gone further: single points fly ahead. Errors of
/// the front over its largest value, 4.
struct DamBreak {
  static constexpr const char* name = "dam break";
  static constexpr Real width = 0.05715, gravity = 9.81, farthest_front = 4;

  Real bulk_modulus = 2e5;  ///< K [Pa]: c = 14 m/s, seven times the front
  std::vector<Real> times = {1.19, 1.98, 2.65, 3.33};
  std::vector<Resolution> resolutions = {{8}, {16}};  ///< cells across the column

  Real seconds(Real time) const { return time / std::sqrt(2 * gravity / width); }

  template <class V>
  auto start(const Resolution& r) const {
    using Model = With<PlaneWater, V>;
    vadose::Scene<Model> scene(
        {.box = {{0, 0}, {6 * width, 3 * width}}, .cell_size = width / r.cells});
    scene.gravity[1] = -gravity;
    scene.liquid.bulk_modulus = bulk_modulus;
    scene.add_water(vadose::box({0, 0}, {width, 2 * width}), {.surface_level = 2 * width});
    return vadose::Solver<Model, typename V::Scheme>(scene, {.courant = r.courant});
  }

  /// Where 1 % of the water has gone further [m].
  template <class Run>
  static Real front(const Run& run) {
    std::vector<std::pair<Real, Real>> ahead;
    Real total = 0, gone = 0;
    for_water(run, [&](const Vec<2>& x, const Vec<2>&, Real m, Real) {
      ahead.emplace_back(x[0], m);
      total += m;
    });
    std::sort(ahead.begin(), ahead.end());
    while (gone + ahead.back().second < 0.01 * total) {
      gone += ahead.back().second;
      ahead.pop_back();
    }
    return ahead.back().first;
  }
  /// Depth of the water in the first column of cells [m].
  template <class Run>
  static Real depth_at_wall(const Run& run) {
    const Real h = run.state().grid.cell_size();
    Real depth = 0;
    for_water(run, [&](const Vec<2>& x, const Vec<2>&, Real, Real volume) {
      if (x[0] < h) depth += volume / h;
    });
    return depth;
  }

  template <class Run>
  std::vector<Comparison> compare(const Run& run, Real time) const {
    static const Table table("r8_martin_moyce.csv");
    std::vector<std::pair<Real, Real>> fronts, heights;
    for (std::size_t i = 0; i < table.size(); ++i) {
      const std::string series = table.text(i, "series");
      if (series == "front_table2")
        fronts.emplace_back(table.number(i, "T"), table.number(i, "Z_or_H"));
      if (series == "height_table6")
        heights.emplace_back(table.number(i, "T"), table.number(i, "Z_or_H"));
    }
    Comparison reached{"front", time}, left{"height at the wall", time};
    reached.add(0, front(run) / width / farthest_front, linear(fronts, time) / farthest_front);
    left.add(0, depth_at_wall(run) / (2 * width), linear(heights, time / std::numbers::sqrt2));
    return {reached, left};
  }
  /// The gate of the experiment takes its time: the height is no measure of the first moments.
  Real bound(const Comparison& c, const Resolution&) const {
    return c.quantity == "front" ? 0.05 : std::numeric_limits<Real>::infinity();
  }
};

}  // namespace verify
