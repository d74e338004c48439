// SPDX-License-Identifier: MIT
// A laterally fixed dry column, 1 m, E = 10 MPa, nu = 0.33, rho = 1560 kg/m3: settlement and stress
// at rest, sudden gravity, free vibration; against closed forms.

#include <doctest/doctest.h>

#include "verify_support.hpp"

#include <vadose/policy/shape/linear.hpp>
#include <vadose/policy/shape/quadratic_b_spline.hpp>

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

template <class K, class S, class T>
struct Dry : vd::DryModel<K> {
  using Shape = S;
  using Transfer = T;
};

constexpr Real height = 1, gravity = 9.81, cell_size = 0.05, density = 1560;

template <class M>
vd::Solver<M> start(Real g, const vd::SolverOptions<M>& options = {},
                    Real young_modulus = verify::table1::young_modulus) {
  constexpr int dim = M::Kinematics::dim, up = dim - 1;
  Vec<dim> low = Vec<dim>::Zero(), high = Vec<dim>::Constant(3 * cell_size), top = high;
  high[up] = height + 4 * cell_size;
  top[up] = height;
  vd::Scene<M> scene({.box = {low, high}, .cell_size = cell_size});
  scene.gravity[up] = -g;
  scene.add_soil(vd::box(low, top), {.solid_density = verify::table1::solid_density,
                                     .porosity = verify::table1::porosity,
                                     .skeleton = {.young_modulus = young_modulus,
                                                  .poisson_ratio = verify::table1::poisson_ratio}});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  return vd::Solver<M>(scene, options);
}

/// Displacement of the grains at height z, linear between the rows of points next to it.
template <class M>
Real displacement(const vd::Solver<M>& solver, Real z) {
  constexpr int up = M::Kinematics::dim - 1;
  std::vector<std::pair<Real, Real>> all;  // initial height, displacement
  solver.solid().for_each([&](std::size_t b, int l) {
    const Real u = solver.displacement(b, l)[up];
    all.emplace_back(solver.solid().at(vd::field::position, b, up)[l] - u, u);
  });
  std::sort(all.begin(), all.end());
  const Real gap = 1e-3 * cell_size;  // points of one row differ by round-off
  auto above = std::upper_bound(all.begin(), all.end(), std::make_pair(z, Real(1)));
  if (above == all.end()) --above;
  if (above->first < all.front().first + gap)
    above =
        std::upper_bound(all.begin(), all.end(), std::make_pair(all.front().first + gap, Real(1)));
  auto below = above;
  while (below != all.begin() && above->first - below->first < gap) --below;
  const Real t = (z - below->first) / (above->first - below->first);
  return (1 - t) * below->second + t * above->second;
}

template <class M>
void check_static() {
  constexpr int up = M::Kinematics::dim - 1;
  auto solver = start<M>(gravity);
  // Displacements count from the start, so not by equilibrate(): strong damping instead.
  solver.mutable_state().options.damping = 0.7;
  solver.advance_to(1.0);
  CHECK(verify::largest_speed(solver.solid()) <= 1e-5);
  const verify::Table table("r9_column_static.csv");
  REQUIRE(table.size() > 10);
  const Real largest = std::fabs(table.number(table.size() - 1, "u_z_m"));
  const Real base = density * gravity * height;
  verify::Norm settlement, vertical, horizontal;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Real z = table.number(i, "z_m");
    settlement.add((displacement(solver, z) - table.number(i, "u_z_m")) / largest);
  }
  // Mean stress of each row of cells: one value per cell is what the balance of its nodes fixes.
  std::vector<verify::Norm> rows(40), sides(40);
  solver.solid().for_each([&](std::size_t b, int l) {
    const auto& points = solver.solid();
    const Real z = points.at(vd::field::position, b, up)[l] - solver.displacement(b, l)[up];
    const auto row = static_cast<std::size_t>(z / cell_size);
    const Real expected = table.interpolate("z_m", "sigma_zz_Pa", z);
    const Real side = table.interpolate("z_m", "sigma_xx_K0_Pa", z);
    rows[row].add((points.at(vd::field::bishop_stress, b, up)[l] - expected) / base);
    sides[row].add((points.at(vd::field::bishop_stress, b, up == 0 ? 1 : 0)[l] - side) / base);
  });
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i].count > 0) {
      vertical.add(rows[i].mean());
      horizontal.add(sides[i].mean());
    }
  const Real top = displacement(solver, height) / table.number(table.size() - 1, "u_z_m") - 1;
  MESSAGE(std::string(M::Shape::name), " dim ", up + 1, ": settlement at the top off by ",
          100 * top, " %, largest error of u ", 100 * settlement.max, " %, of sigma_zz ",
          100 * vertical.max, " %, of sigma_xx ", 100 * horizontal.max, " % of their largest");
  CHECK(std::fabs(top) <= 0.01);
  CHECK(settlement.max <= 0.01);
  CHECK(vertical.max <= 0.01);
  CHECK(horizontal.max <= 0.01);
}

/// A soft column under its own weight w per volume at the start, with Cauchy stress M ln J: its height
/// becomes (M / w) (1 - exp(-w H / M)).
template <class M>
void check_finite_strain() {
  const Real modulus = 5 * density * gravity * height;
  const Real unit = verify::oedometric_modulus(1, verify::table1::poisson_ratio);
  auto solver = start<M>(gravity, {.damping = 0.7}, modulus / unit);
  solver.advance_to(5);
  CHECK(verify::largest_speed(solver.solid()) <= 1e-4);
  Real now = 0;
  const Real width = std::pow(3 * cell_size, M::Kinematics::dim - 1);
  solver.solid().for_each(
      [&](std::size_t b, int l) { now += solver.solid().at(vd::field::volume, b)[l] / width; });
  const Real settled = height - 5 * height * (1 - std::exp(-0.2));
  MESSAGE("settlement ", height - now, " m, closed form ", settled);
  CHECK(std::fabs(height - now - settled) <= 0.01 * settled);
  CHECK(std::fabs(-displacement(solver, height) - settled) <= 0.01 * settled);
}

/// Period of the free vibration of the first mode from the zeros of the mean velocity along it.
template <class M>
void check_vibration(const char* name, Real least_amplitude,
                     const vd::SolverOptions<M>& options = {}) {
  constexpr int up = M::Kinematics::dim - 1;
  const verify::Table table("r9_bar_vibration.csv");
  const Real v0 = table.number(0, "v0_m_s"), k = std::numbers::pi / (2 * height);
  auto solver = start<M>(0, options);
  auto& solid = solver.mutable_state().solid;
  for (std::size_t b = 0; b < solid.batches(); ++b)
    for (int l = 0; l < vd::lane_count; ++l)
      solid.at(vd::field::velocity, b, up)[l] =
          v0 * std::sin(k * solid.at(vd::field::position, b, up)[l]);
  const auto mode = [&] {
    Real sum = 0, weight = 0;
    solver.solid().for_each([&](std::size_t b, int l) {
      const Real shape = std::sin(k * solid.at(vd::field::position, b, up)[l]);
      sum += shape * solver.displacement(b, l)[up];
      weight += shape * shape;
    });
    return sum / weight;
  };
  std::vector<Real> zeros;
  verify::Norm error;
  const Real largest = table.number(0, "v0_m_s") / (k * 97.45627848);
  const Real end = 0.21;  // five periods
  Real before = 0, swing = 0, amplitude = 0;
  while (solver.time() < end) {
    const auto step = solver.step();
    REQUIRE(step.status == vd::Status::ok);
    const Real now = mode();
    if (before * now < 0) {
      zeros.push_back(step.time - step.dt * now / (now - before));
      amplitude = swing;  // of the half period that ends here
      swing = 0;
    }
    swing = std::max(swing, std::fabs(now));
    before = now;
    if (step.time < 0.04)
      error.add((now - table.interpolate("t_s", "u_top_m", step.time)) / largest);
  }
  REQUIRE(zeros.size() >= 8);
  const Real period = 2 * (zeros.back() - zeros.front()) / static_cast<Real>(zeros.size() - 1);
  const Real exact = 4 * height / 97.45627848;
  MESSAGE(std::string(name), " ", std::string(M::Shape::name), " dim ", up + 1, ": period off by ",
          100 * (period / exact - 1), " %, first period rms ", 100 * error.rms(),
          " % of the amplitude; amplitude at the end ", amplitude / largest);
  CHECK(std::fabs(period / exact - 1) <= 0.01);
  CHECK(amplitude / largest >= least_amplitude);
  CHECK(amplitude / largest <= 1.01);
}

template <class K, class S>
using WithFlip = Dry<K, S, vd::transfer::Flip>;

/// Sudden gravity: the top swings between 0 and twice the static settlement.
template <class M>
void check_sudden_gravity() {
  auto solver = start<M>(gravity);
  const verify::Table table("r9_column_gravity_on.csv");
  verify::Norm error;
  Real largest = 0;
  for (std::size_t i = 0; i < table.size(); ++i)
    largest = std::max(largest, std::fabs(table.number(i, "u_top_m")));
  for (std::size_t i = 1; i < table.size(); i += 2) {
    solver.advance_to(table.number(i, "t_s"));
    error.add((displacement(solver, height) - table.number(i, "u_top_m")) / largest);
  }
  MESSAGE(std::string(M::Shape::name), ": sudden gravity, rms ", 100 * error.rms(),
          " % of the largest, max ", 100 * error.max, " %");
  CHECK(error.rms() <= 0.03);
}

}  // namespace

TEST_CASE("dry column at rest: settlement, stress, K0") {
  check_static<WithFlip<vd::Uniaxial, vd::shape::Linear>>();
  check_static<WithFlip<vd::Uniaxial, vd::shape::Gimp>>();
  check_static<WithFlip<vd::Uniaxial, vd::shape::QuadraticBSpline>>();
  check_static<WithFlip<vd::PlaneStrain, vd::shape::Gimp>>();
}

TEST_CASE("dry column: settlement by 9 % under its own weight") {
  check_finite_strain<WithFlip<vd::Uniaxial, vd::shape::Gimp>>();
}

TEST_CASE("dry column: free vibration of the first mode") {
  using K = vd::Uniaxial;
  check_vibration<Dry<K, vd::shape::Linear, vd::transfer::Flip>>("FLIP", 0.8);
  check_vibration<Dry<K, vd::shape::Gimp, vd::transfer::Flip>>("FLIP", 0.8);
  check_vibration<Dry<K, vd::shape::QuadraticBSpline, vd::transfer::Flip>>("FLIP", 0.8);
  check_vibration<Dry<K, vd::shape::Gimp, vd::transfer::Apic>>("APIC", 0.5);
  check_vibration<Dry<K, vd::shape::Gimp, vd::transfer::Tpic>>("TPIC", 0.5);
  check_vibration<Dry<K, vd::shape::QuadraticBSpline, vd::transfer::Apic>>("APIC", 0.5);
  check_vibration<Dry<K, vd::shape::QuadraticBSpline, vd::transfer::Tpic>>("TPIC", 0.5);
  check_vibration<Dry<vd::PlaneStrain, vd::shape::Gimp, vd::transfer::Flip>>("FLIP", 0.8);
}

TEST_CASE("dry column: sudden gravity") {
  check_sudden_gravity<WithFlip<vd::Uniaxial, vd::shape::Linear>>();
  check_sudden_gravity<WithFlip<vd::Uniaxial, vd::shape::Gimp>>();
  check_sudden_gravity<WithFlip<vd::Uniaxial, vd::shape::QuadraticBSpline>>();
}
