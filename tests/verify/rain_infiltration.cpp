// SPDX-License-Identifier: MIT
// Rain, ponding, zero suction and redistribution in a rigid column of sand against Richards'
// equation (tests/reference/richards.py).

#include <doctest/doctest.h>

#include "../seepage.hpp"
#include "verify_support.hpp"

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

using vadose_test::Seepage;
using M1 = Seepage<vd::Uniaxial>;
using M2 = Seepage<vd::PlaneStrain>;
using M3 = Seepage<vd::ThreeDimensional>;

constexpr Real conductivity = 1e-4, porosity = 0.4, height = 2, gravity = 9.81;
/// Softened water. Its density at the initial suction is lower by 0.3 %, all else is the same.
constexpr Real bulk_modulus = 1e6;

template <class M>
vd::Material<M> sand() {
  return {.name = "sand",
          .porosity = porosity,
          .lambda = 0.63,
          .retention = {.a = 3, .porosity_dependent = false},
          .conductivity = {.saturated_conductivity = conductivity, .porosity_dependent = false}};
}

/// Sand of 2 m; saturation by height; room for a pond above. A strip two cells wide in 2D and 3D.
template <class M>
vd::Scene<M> sand_column(Real h, const std::function<Real(Real)>& saturation) {
  constexpr int dim = M::Kinematics::dim, up = dim - 1;
  Vec<dim> low = Vec<dim>::Zero(), high = Vec<dim>::Constant(2 * h);
  high[up] = height + 0.4;
  vd::Scene<M> scene({.box = {low, high}, .cell_size = h});
  scene.gravity[up] = -gravity;
  scene.liquid.bulk_modulus = bulk_modulus;
  for (int half = 0; half < 2; ++half) {
    Vec<dim> bottom = low, top = high;
    bottom[up] = half;
    top[up] = half + 1;
    scene.add_soil(vd::box(bottom, top), sand<M>(), {.saturation = saturation(half + 0.5)});
  }
  return scene;
}

/// Water per horizontal area [m] of a mass [kg].
template <class M>
Real depth(Real mass, Real h) {
  return mass / 1000 / std::pow(2 * h, M::Kinematics::dim - 1);
}

/// Mean of the reference S over [z - h/2, z + h/2].
Real reference_saturation(const verify::Table& table, const std::string& name, Real t, Real z,
                          Real h) {
  Real sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.number(i, "t_s") == t && table.text(i, "case") == name &&
        std::fabs(table.number(i, "z_m") - z) < 0.5 * h) {
      sum += table.number(i, "S");
      ++count;
    }
  REQUIRE(count > 0);
  return sum / count;
}

Real reference(const std::string& name, Real t, const std::string& column) {
  static const verify::Table table("richards_history.csv");
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table.number(i, "t_s") == t && table.text(i, "case") == name)
      return table.number(i, column);
  FAIL("no row ", name, " at ", t);
  return 0;
}

/// rms error of S over the cells.
template <class M>
Real profile_error(const vd::Solver<M>& solver, const std::string& name, Real h) {
  static const verify::Table table("richards_profiles.csv");
  verify::Norm norm;
  verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
    const Real z = cell.centroid[M::Kinematics::dim - 1];
    norm.add(cell.saturation - reference_saturation(table, name, std::round(solver.time()), z, h));
  });
  REQUIRE(norm.count > 0);
  return norm.rms();
}

/// Water that the cell pressures imply, sum over the points of V n S(p_c + head) exp(p / K) rho_l0 by
/// [Zhan] Eq. (12) written again, over the mass on the points, less 1.
template <class M>
Real content_error(const vd::Solver<M>& solver) {
  constexpr int dim = M::Kinematics::dim;
  constexpr Real a = 3, m = 0.63, e = porosity / (1 - porosity);
  vd::Solver<M> copy = solver;
  auto& state = copy.mutable_state();
  vd::kernel::find_pressures(state);
  Real implied = 0, mass = 0;
  state.liquid.for_each([&](std::size_t b, int l) {
    vd::Index<dim> at;
    for (int d = 0; d < dim; ++d)
      at[d] = state.grid.cell_of(state.liquid.at(vd::field::position, b, d)[l], d);
    const auto owner = state.nodes.dof[static_cast<std::size_t>(state.grid.entry(at))];
    const auto& cell = state.nodes.cell[static_cast<std::size_t>(owner)];
    Real p = cell.pressure;
    for (int d = 0; d < dim; ++d)
      p += 1000 * state.gravity[d] *
           (state.liquid.at(vd::field::position, b, d)[l] - cell.centroid[d]);
    const Real x = a * std::max(0.0, -p) * std::pow(e, (1 - m) / m) / 9810;
    implied += 1000 * state.liquid.at(vd::field::volume, b)[l] * porosity *
               std::pow(1 + std::pow(x, 1 / (1 - m)), -m) * std::exp(p / bulk_modulus);
    mass += state.liquid.at(vd::field::mass, b)[l];
  });
  return implied / mass - 1;
}

/// Mean S and its spread over the cells of a row, by row; the lower half of the rows first.
template <class M>
std::vector<verify::Norm> rows_of_saturation(const vd::Solver<M>& solver, Real h) {
  std::vector<verify::Norm> rows(static_cast<std::size_t>(std::lround(height / h)));
  verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
    const auto row = static_cast<std::size_t>(cell.centroid[M::Kinematics::dim - 1] / h);
    rows[row].add(cell.saturation);
  });
  return rows;
}

/// Rain below capacity.
template <class M>
void check_rain(Real h, Real bound, const std::vector<Real>& times) {
  auto scene = sand_column<M>(h, [](Real) { return 0.3; });
  scene.add(vd::bc::Rain{.rate = 0.3 * conductivity});
  vd::Solver<M> solver(scene);
  for (const Real t : times) {
    solver.advance_to(t);
    const auto w = solver.water_balance();
    const Real error = profile_error(solver, "rain0.3", h);
    const Real taken = depth<M>(w.pore - w.initial, h);
    MESSAGE("dim ", M::Kinematics::dim, " h ", h, " t ", t, ": rms S ", error, ", taken ", taken,
            " m, closure ", w.relative_closure(), ", content of the pressures / mass - 1 ",
            content_error(solver), ", steps ", solver.steps());
    CHECK(error <= bound);
    CHECK(std::fabs(content_error(solver)) <= 1e-10);
    CHECK(verify::close(taken, reference("rain0.3", t, "inflow_m"), 0.01));
    CHECK(std::fabs(w.relative_closure()) <= 1e-12);
    CHECK(w.free == 0);
  }
}

/// The same rain on a strip and on a column: the same rows of S.
template <class M>
void check_strip(Real h, const std::vector<Real>& times) {
  auto wide = sand_column<M>(h, [](Real) { return 0.3; });
  auto narrow = sand_column<M1>(h, [](Real) { return 0.3; });
  wide.add(vd::bc::Rain{.rate = 0.3 * conductivity});
  narrow.add(vd::bc::Rain{.rate = 0.3 * conductivity});
  vd::Solver<M> strip(wide);
  vd::Solver<M1> column(narrow);
  for (const Real t : times) {
    strip.advance_to(t);
    column.advance_to(t);
    const auto a = rows_of_saturation(strip, h);
    const auto b = rows_of_saturation(column, h);
    verify::Norm difference, spread;
    for (std::size_t i = 0; i < a.size(); ++i) {
      REQUIRE(a[i].count == 1 << (M::Kinematics::dim - 1));
      difference.add(a[i].mean() - b[i].mean());
      spread.add(a[i].max - a[i].mean());
    }
    const auto w = strip.water_balance();
    MESSAGE("dim ", M::Kinematics::dim, " h ", h, " t ", t, ": S from that of 1D by at most ",
            difference.max, ", across the strip ", spread.max, ", closure ", w.relative_closure(),
            ", steps ", strip.steps(), " and ", column.steps());
    CHECK(difference.max <= 1e-9);
    CHECK(spread.max <= 1e-9);
    CHECK(std::fabs(w.relative_closure()) <= 1e-12);
  }
}

/// Redistribution in a closed column.
void check_closed_column(const std::string& name, Real h, Real bound,
                         const std::vector<Real>& times) {
  const Real low = name == "rise" ? 0.9 : 0.2;
  vd::Solver<M1> solver(sand_column<M1>(h, [low](Real z) { return z < 1 ? low : 1.1 - low; }));
  for (const Real t : times) {
    solver.advance_to(t);
    const Real error = profile_error(solver, name, h);
    MESSAGE(name, " h ", h, " t ", t, ": rms S ", error, ", steps ", solver.steps());
    CHECK(error <= bound);
    CHECK(std::fabs(solver.water_balance().relative_closure()) <= 1e-12);
  }
}

}  // namespace

TEST_CASE("rain below capacity, 1D, h = 0.1 m") {
  check_rain<M1>(0.1, 0.015, {600, 1500});
}
TEST_CASE("rain below capacity, strip of 2D") {
  check_rain<M2>(0.1, 0.015, {600});
}
TEST_CASE("rain on a strip of 2D is rain on a column") {
  check_strip<M2>(0.1, {300});
}
TEST_CASE("closed column: capillary rise and drainage") {
  check_closed_column("rise", 0.1, 0.02, {600, 1800});
  check_closed_column("drainage", 0.1, 0.02, {600, 1800});
}
namespace {

/// Green and Ampt's sharp front after rain r > k: ponding when k (1 + psi dtheta / F) = r; then
/// F - F_p - psi dtheta ln((F + psi dtheta) / (F_p + psi dtheta)) = k (t - t_p). psi dtheta is the one
/// number of the soil in it. Bouwer's psi = integral of k_r ds over the suctions up to the initial one,
/// dtheta = n (1 - S_0), is for a sharp front; this sand's is not. Its error against Richards here is the
/// model's own: ponding 12 % late (109.3 s of 97.6 s), 5.2, 4.4 and 0.9 % too much water at 300, 600 and
/// 1200 s. The run is held to that plus its own bounds.
struct GreenAmpt {
  Real psi_dtheta;  ///< [m]

  Real ponding_depth(Real rate) const { return psi_dtheta * conductivity / (rate - conductivity); }
  Real ponding_time(Real rate) const { return ponding_depth(rate) / rate; }
  Real infiltrated(Real rate, Real t) const {
    const Real first = ponding_depth(rate), after = t - ponding_time(rate);
    if (after <= 0) return rate * t;
    Real f = first + conductivity * after + std::sqrt(2 * psi_dtheta * conductivity * after);
    for (int i = 0; i < 20; ++i)  // Newton
      f -= (f - first - conductivity * after -
            psi_dtheta * std::log((f + psi_dtheta) / (first + psi_dtheta))) *
           (f + psi_dtheta) / f;
    return f;
  }
};

/// Bouwer's wetting-front suction [m] for this sand from S = 0.3, by the trapezoidal rule.
Real wetting_front_suction() {
  constexpr Real a = 3, m = 0.63, e = porosity / (1 - porosity);
  const Real alpha = a * std::pow(e, (1 - m) / m);  // [1/m]
  const Real last = std::pow(std::pow(0.3, -1 / m) - 1, 1 - m) / alpha;
  const auto relative = [&](Real s) {
    const Real se = std::pow(1 + std::pow(alpha * s, 1 / (1 - m)), -m);
    const Real inner = 1 - std::pow(1 - std::pow(se, 1 / m), m);
    return std::sqrt(se) * inner * inner;
  };
  const int n = 20000;
  Real sum = 0;
  for (int i = 0; i < n; ++i)
    sum += 0.5 * (relative(last * i / n) + relative(last * (i + 1) / n)) * last / n;
  return sum;
}

/// Rain of 3 k_sat: when water stands on the ground, and how deep.
void check_ponding(Real h, const std::vector<Real>& times, Real bound) {
  auto scene = sand_column<M1>(h, [](Real) { return 0.3; });
  scene.add(vd::bc::Rain{.rate = 3 * conductivity});
  vd::Solver<M1> solver(scene);
  const Real expected = reference("rain3", 300, "ponding_s");
  Real ponding = vd::unset;
  for (Real t = 10; !vd::is_finite(ponding) && t < 2 * expected; t += 1) {
    solver.advance_to(t);
    if (solver.water_balance().film > 0.01) ponding = t;
  }
  MESSAGE("ponding after ", ponding, " s, Richards ", expected);
  CHECK(verify::close(ponding, expected, 0.05));
  const GreenAmpt front{wetting_front_suction() * porosity * (1 - 0.3)};
  const Real late = front.ponding_time(3 * conductivity);
  MESSAGE("Green and Ampt: suction ", wetting_front_suction(), " m, ponding after ", late, " s");
  CHECK(verify::close(late, expected, 0.13));
  CHECK(verify::close(ponding, late, 0.13 + 0.05));
  for (const Real t : times) {
    solver.advance_to(t);
    const auto w = solver.water_balance();
    const Real pond = (w.film + w.free) / 1000;
    MESSAGE("t ", t, " s: pond ", pond, " m (film ", w.film / 1000, "), Richards ",
            reference("rain3", t, "pond_m"), ", taken ", (w.pore - w.initial) / 1000, ", Richards ",
            reference("rain3", t, "inflow_m"), ", rms S ", profile_error(solver, "rain3", h),
            ", closure ", w.relative_closure(), ", steps ", solver.steps());
    if (t > 100)  // at 100 s Richards' pond is 0.02 mm
      CHECK(verify::close(pond, reference("rain3", t, "pond_m"), bound));
    const Real taken = (w.pore - w.initial) / 1000, richards = reference("rain3", t, "inflow_m");
    const Real sharp = front.infiltrated(3 * conductivity, t);
    CHECK(verify::close(taken, richards, 0.02));
    MESSAGE("Green and Ampt take in ", sharp, " m, ", 100 * (sharp / richards - 1),
            " % more than Richards and ", 100 * (sharp / taken - 1), " % more than the run");
    CHECK(verify::close(sharp, richards, 0.06));
    CHECK(verify::close(taken, sharp, 0.06 + 0.02));
    CHECK(std::fabs(w.relative_closure()) <= 1e-12);
  }
}

/// p = 0 held at the ground; `cut`: the sand is higher by this part of a cell, a multiple of 1/4.
void check_zero_suction(Real h, const std::vector<Real>& times, Real cut = 0) {
  auto scene = sand_column<M1>(h, [](Real) { return 0.3; });
  if (cut > 0)
    scene.add_soil(vd::box({height}, {height + cut * h}), sand<M1>(),
                   {.points_per_cell = 4, .saturation = 0.3});
  scene.add(vd::bc::ZeroSuction{});
  vd::Solver<M1> solver(scene);
  for (const Real t : times) {
    solver.advance_to(t);
    const auto w = solver.water_balance();
    const Real inflow = (w.inflow - w.outflow) / 1000,
               expected = reference("zero_suction", t, "inflow_m");
    MESSAGE("zero suction, h ", h, " cut ", cut, " t ", t, ": inflow ", inflow, " m, Richards ",
            expected, " (", 100 * (inflow / expected - 1), " %), closure ", w.relative_closure(),
            ", steps ", solver.steps());
    CHECK(verify::close(inflow, expected, 0.05));
    if (cut == 0) {
      const Real error = profile_error(solver, "zero_suction", h);
      MESSAGE("rms S ", error);
      CHECK(error <= 0.015);
    }
    CHECK(std::fabs(w.relative_closure()) <= 1e-12);
  }
}

}  // namespace

TEST_CASE("Green and Ampt's sharp front against the reference table") {
  // There: head and suction of 0.6 m, dtheta = 0.4 and k = 1e-3 m/s, ponded at once.
  const verify::Table table("r4_green_ampt.csv");
  REQUIRE(table.size() > 10);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Real t = table.number(i, "t_constant_head_s") * 1e-3 / conductivity;
    const Real depth = 0.4 * table.number(i, "front_depth_m");
    CHECK(verify::close(GreenAmpt{0.6 * 0.4}.infiltrated(1e6, t), depth, 1e-6));
  }
}
TEST_CASE("rain above capacity: ponding time and pond depth") {
  check_ponding(0.05, {100, 300, 600}, 0.05);
}
TEST_CASE("zero suction") {
  check_zero_suction(0.05, {100, 300, 600});
}
TEST_CASE("zero suction on ground that ends in a sliver") {
  check_zero_suction(0.1, {100}, 0.25);
}

TEST_SUITE("long") {
  TEST_CASE("rain above capacity to 1200 s") {
    check_ponding(0.05, {100, 300, 600, 1200}, 0.05);
  }
  TEST_CASE("zero suction to 1800 s") {
    check_zero_suction(0.05, {100, 300, 600, 900, 1200, 1800});
  }
  TEST_CASE("rain below capacity to 4500 s, 1D, 2D and 3D") {
    check_rain<M1>(0.1, 0.015, {600, 1500, 3000, 4500});
    check_rain<M1>(0.05, 0.008, {600, 1500, 3000, 4500});
    check_rain<M2>(0.1, 0.015, {600, 1500, 3000, 4500});
    check_rain<M3>(0.1, 0.015, {600, 1500, 3000, 4500});
  }
  TEST_CASE("closed column to 5400 s") {
    for (const char* name : {"rise", "drainage"})
      check_closed_column(name, 0.1, 0.02, {600, 1800, 5400});
  }
}
