// SPDX-License-Identifier: MIT
// Loading of unsaturated soil at S = 0.86, [Zhan] 4.1: undrained pressure and its decay against
// closed forms of the equations that are solved.

#include <doctest/doctest.h>

#include "verify_support.hpp"

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

struct Clay : vd::UnsaturatedModel<vd::Uniaxial> {};

constexpr Real saturation = 0.86, height = 1, cell_size = 0.1;

/// Small-load response of the initial state, from the laws of Table 1 written out.
struct ClosedForm {
  Real suction, stiffness, storage, beta, chi, conductivity;
  bool coupled;  ///< S depends on porosity

  ClosedForm(Real young_modulus, bool porosity_dependent) : coupled(porosity_dependent) {
    constexpr Real n = verify::table1::porosity, lambda = verify::table1::lambda;
    constexpr Real power = 1 / (1 - lambda), b = (1 - lambda) / lambda;
    const Real x = std::pow(std::pow(saturation, -1 / lambda) - 1, 1 / power);
    const Real scale = verify::table1::a * std::pow(n / (1 - n), b) / 9810;
    suction = x / scale;
    const Real xn = std::pow(x, power);
    // dS/dln x < 0
    const Real log_slope = -lambda * power * xn * std::pow(1 + xn, -lambda - 1);
    const Real capacity = -log_slope / suction;
    const Real porosity_slope = porosity_dependent ? log_slope * b / (n * (1 - n)) : 0;
    storage = n * (saturation / verify::table1::bulk_modulus + capacity);
    beta = saturation + n * (1 - n) * porosity_slope;
    chi = saturation - suction * capacity;
    stiffness = verify::oedometric_modulus(young_modulus, verify::table1::poisson_ratio) +
                suction * (1 - n) * porosity_slope;
    const Real bracket = 1 - std::pow(1 - std::pow(saturation, 1 / lambda), lambda);
    conductivity = std::sqrt(saturation) * bracket * bracket;  // relative
  }
  /// dp/dq of undrained loading.
  Real undrained() const { return beta / (stiffness * storage + beta * chi); }
  /// Consolidation coefficient [m2/s] at saturated conductivity k.
  Real consolidation(Real k) const {
    return k * conductivity / 9810 / (storage + beta * chi / stiffness);
  }
  /// Speed of the compression wave with the water locked to the grains [m/s].
  Real wave_speed() const {
    constexpr Real n = verify::table1::porosity;
    const Real density = (1 - n) * verify::table1::solid_density + n * saturation * 1000;
    return std::sqrt((stiffness + beta * chi / storage) / density);
  }
};

vd::Solver<Clay> start(Real young_modulus, bool porosity_dependent, Real conductivity, Real load,
                       const vd::TimeFactor& factor) {
  const ClosedForm exact(young_modulus, porosity_dependent);
  vd::Scene<Clay> scene({.box = {Vec<1>(0.0), Vec<1>(height + 0.2)}, .cell_size = cell_size});
  scene.add_soil(vd::box(Vec<1>(0.0), Vec<1>(height)),
                 verify::clay<Clay>(young_modulus, porosity_dependent, conductivity),
                 {.saturation = saturation});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  const auto surface = vd::box(Vec<1>(height - 0.5 * cell_size), Vec<1>(height + 0.1));
  scene.add(
      vd::bc::Traction<1>{.region = surface, .traction = Vec<1>(-load), .time_factor = factor});
  scene.add(vd::bc::PrescribedPressure<1>{.region = surface, .pressure = -exact.suction});
  // The skeleton starts in balance with the suction: total stress 0.
  vd::Solver<Clay> solver(scene);
  auto& solid = solver.mutable_state().solid;
  for (std::size_t b = 0; b < solid.batches(); ++b)
    for (int i = 0; i < 3; ++i)
      for (int l = 0; l < vd::lane_count; ++l)
        solid.at(vd::field::bishop_stress, b, i)[l] = -saturation * exact.suction;
  return solver;
}

/// Runs with and without the load, side by side. Their difference is the response to the load
/// alone, whatever is left out of balance at the start.
struct Pair {
  vd::Solver<Clay> loaded, idle;

  Pair(Real young_modulus, bool porosity_dependent, Real conductivity, Real load,
       const vd::TimeFactor& factor = {})
      : loaded(start(young_modulus, porosity_dependent, conductivity, load, factor)),
        idle(start(young_modulus, porosity_dependent, conductivity, 0, factor)) {}
  /// Calls f(height of the cell, pressure from the load).
  template <class F>
  void for_cells(F&& f) const {
    std::vector<Real> rest;
    verify::for_cells(idle, vd::CellKind::soil,
                      [&](const auto& cell) { rest.push_back(cell.pressure); });
    std::size_t i = 0;
    verify::for_cells(loaded, vd::CellKind::soil,
                      [&](const auto& cell) { f(cell.centroid[0], cell.pressure - rest[i++]); });
  }
};

constexpr Real stiff = 10e6, soft = 3e6;

}  // namespace

TEST_CASE("undrained ratio: the closed form of the test against the reference table") {
  const verify::Table table("r2_undrained_readings.csv");
  int compared = 0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table.text(i, "e^b") != "n" || table.text(i, "modulus") != "E_oed" ||
        table.text(i, "p dS in d(chi p)") != "True")
      continue;
    const ClosedForm exact(1e6 * table.number(i, "E_MPa"), table.text(i, "dS/dn term") == "True");
    CHECK(verify::close(exact.undrained(), table.number(i, "p0_over_q"), 1e-6));
    CHECK(verify::close(exact.suction, 1e3 * table.number(i, "suction_kPa"), 1e-9));
    ++compared;
  }
  CHECK(compared == 4);
}

TEST_CASE("unsaturated soil at rest under its own suction") {
  auto solver = start(stiff, true, verify::table1::conductivity, 0, {});
  const ClosedForm exact(stiff, true);
  for (int i = 0; i < 2000; ++i) solver.step();
  verify::Norm norm;
  verify::for_cells(solver, vd::CellKind::soil,
                    [&](const auto& cell) { norm.add(cell.pressure + exact.suction); });
  MESSAGE("largest |dp| ", norm.max, " Pa, speed ", verify::largest_speed(solver.solid()), " m/s");
  CHECK(norm.max <= 1);
}

TEST_CASE("unsaturated consolidation: undrained pressure ratio, mean over the first P1 periods") {
  const Real load = 100;
  for (const Real young_modulus : {stiff, soft})
    for (const bool porosity_dependent : {true, false}) {
      CAPTURE(young_modulus);
      CAPTURE(porosity_dependent);
      const ClosedForm exact(young_modulus, porosity_dependent);
      Pair pair(young_modulus, porosity_dependent, verify::table1::conductivity, load);
      const Real period = 4 * height / exact.wave_speed();
      // Trapezoidal mean over 4 periods, weights of a Hann window: insensitive to their length.
      verify::Norm cells;
      std::vector<Real> sum(20, 0.0), weight(20, 0.0);
      while (pair.loaded.time() < 4 * period) {
        const auto step = pair.loaded.step();
        REQUIRE(step.status == vd::Status::ok);
        pair.idle.advance_to(step.time);
        const Real w = step.dt * (1 - std::cos(std::numbers::pi * step.time / (2 * period)));
        pair.for_cells([&](Real z, Real p) {
          const auto i = static_cast<std::size_t>(z / cell_size);
          sum[i] += w * p / load;
          weight[i] += w;
        });
      }
      for (std::size_t i = 0; i < 9; ++i) {  // the cell at the drained surface is left out
        CHECK(weight[i] > 0);
        cells.add(sum[i] / weight[i]);
      }
      MESSAGE("E ", young_modulus, std::string(porosity_dependent ? " coupled" : " frozen"),
              ": dp/dq ", cells.mean(), ", closed form ", exact.undrained(), ", ratio ",
              cells.mean() / exact.undrained(), "; at the base ", sum[0] / weight[0]);
      CHECK(verify::close(cells.mean(), exact.undrained(), 0.02));
    }
}

TEST_CASE("unsaturated consolidation: decay, k scaled up 300 times") {
  // The load comes within 5 periods of the compression wave, 1/300 of the consolidation time or
  // less; time counts from the middle of the ramp.
  const Real load = 100, k = 300 * verify::table1::conductivity;
  for (const Real young_modulus : {stiff, soft})
    for (const bool porosity_dependent : {true, false}) {
      CAPTURE(young_modulus);
      CAPTURE(porosity_dependent);
      const ClosedForm exact(young_modulus, porosity_dependent);
      const Real ramp = 5 * 4 * height / exact.wave_speed();
      Pair pair(young_modulus, porosity_dependent, k, load,
                [=](Real t) { return std::min(1.0, t / ramp); });
      for (const Real tv : {0.05, 0.1, 0.3, 0.6}) {
        const Real t = 0.5 * ramp + tv * height * height / exact.consolidation(k);
        pair.loaded.advance_to(t);
        pair.idle.advance_to(t);
        verify::Norm norm;
        pair.for_cells([&](Real z, Real p) {
          const Real depth = height - z, half = 0.5 * cell_size;
          norm.add(p / load -
                   exact.undrained() * verify::terzaghi_mean(depth - half, depth + half, tv));
        });
        MESSAGE("E ", young_modulus, std::string(porosity_dependent ? " coupled" : " frozen"),
                " Tv ", tv, ": rms ", 100 * norm.rms(), " % of the load, ",
                100 * norm.rms() / exact.undrained(), " % of p0, mean ", 100 * norm.mean(),
                " %, steps ", pair.loaded.steps());
        CHECK(norm.rms() <= 0.01);
      }
    }
}
