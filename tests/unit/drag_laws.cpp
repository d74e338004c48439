// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <utility>

#include <vadose/core/error.hpp>
#include <vadose/policy/drag/darcy.hpp>
#include <vadose/policy/drag/forchheimer.hpp>
#include <vadose/policy/drag/implicit_drag.hpp>
#include <vadose/policy/hydraulic.hpp>

namespace {

using vadose::lane_count;
using vadose::Lanes;
using vadose::Real;
namespace drag = vadose::drag;
using doctest::Approx;

constexpr Real unit_weight = 9810;

/// A user's law in plain doubles.
struct ConstantDrag {
  void validate() const {}
  Real coefficient(Real, Real saturation, Real, Real) const { return saturation > 0.5 ? 3e5 : 1e5; }
};

struct Case {
  Real liquid, solid, dt_drag, dt_quadratic;
};

/// Masses and drags over many orders of magnitude.
Case random_case(std::mt19937_64& engine) {
  std::uniform_real_distribution<Real> exponent(-9, 9);
  const auto draw = [&] { return std::pow(10.0, exponent(engine)); };
  return {draw(), draw(), draw(), draw()};
}

}  // namespace

static_assert(vadose::DragLaw<ConstantDrag>);
static_assert(!vadose::QuadraticDrag<drag::Darcy>);

TEST_CASE("drag: Darcy's coefficient reproduces Darcy's law") {
  const Real n = 0.4, s = 0.7, k = 2e-5;
  const Real c = drag::coefficient<Real>(drag::Darcy{}, n, s, k, unit_weight);
  CHECK(c == Approx(n * s * unit_weight / k).epsilon(1e-15));
  // force per mixture volume n S c w balances -n S dp/dx; the flux is n S w = -k/gamma dp/dx
  const Real gradient = 3000;
  const Real w = gradient / c;
  CHECK(n * s * w == Approx(k / unit_weight * gradient).epsilon(1e-14));
  const Lanes lanes =
      drag::coefficient<Lanes>(drag::Darcy{}, Lanes(n), Lanes(s), Lanes(k), Lanes(unit_weight));
  CHECK(lanes[3] == Approx(c).epsilon(1e-15));
  CHECK(drag::quadratic<Real>(drag::Darcy{}, n, s, k, unit_weight, 1000) == 0);
}

TEST_CASE("drag: Forchheimer's law is Ergun's equation on a bed of spheres") {
  const drag::Forchheimer law{.viscosity = 1.1e-3};
  const Real n = 0.42, diameter = 2e-3, density = 998;
  const Real permeability = diameter * diameter * n * n * n / (150 * (1 - n) * (1 - n));
  const Real k = permeability * unit_weight / law.viscosity;
  for (const Real flux : {1e-4, 1e-2, 0.3}) {
    const Real w = flux / n;
    const Real force = drag::coefficient<Real>(law, n, 1, k, unit_weight) * w +
                       drag::quadratic<Real>(law, n, 1, k, unit_weight, density) * w * w;
    const Real ergun =
        150 * law.viscosity * (1 - n) * (1 - n) / (n * n * n * diameter * diameter) * flux +
        1.75 * density * (1 - n) / (n * n * n * diameter) * flux * flux;
    CHECK(force == Approx(ergun).epsilon(1e-13));  // per liquid volume = pressure gradient
  }
  const Lanes lanes = drag::quadratic<Lanes>(law, Lanes(n), Lanes(0.5), Lanes(k),
                                             Lanes(unit_weight), Lanes(density));
  CHECK(lanes[5] == Approx(law.quadratic<Real>(n, 0.5, k, unit_weight, density)).epsilon(1e-14));
  CHECK_THROWS_AS(drag::Forchheimer{.viscosity = 0}.validate(), vadose::SetupError);
  CHECK_THROWS_AS(drag::Forchheimer{.ergun_linear = -1}.validate(), vadose::SetupError);
  CHECK_THROWS_AS(drag::Forchheimer{.ergun_quadratic = vadose::unset}.validate(),
                  vadose::SetupError);
  CHECK_NOTHROW(law.validate());
}

TEST_CASE("drag: a user's plain-double law is called lane by lane") {
  Lanes saturation(0.0);
  for (int l = 0; l < lane_count; ++l) saturation.set(l, 0.125 * l);
  const Lanes c = drag::coefficient<Lanes>(ConstantDrag{}, Lanes(0.4), saturation, Lanes(1e-5),
                                           Lanes(unit_weight));
  CHECK(c[4] == 1e5);
  CHECK(c[5] == 3e5);
}

TEST_CASE("drag: the implicit solve satisfies its equations and conserves momentum") {
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<Real> speed(-3, 3);
  for (int i = 0; i < 20000; ++i) {
    const Case c = random_case(engine);
    const Real vl = speed(engine), vs = speed(engine);
    Real vl_new = vl, vs_new = vs;
    drag::implicit_drag<Real>(c.liquid, c.solid, c.dt_drag, vl_new, vs_new);
    const Real momentum = c.liquid * vl + c.solid * vs;
    const Real size = c.liquid * std::fabs(vl) + c.solid * std::fabs(vs);
    REQUIRE(std::fabs(c.liquid * vl_new + c.solid * vs_new - momentum) <= 1e-15 * size);
    const Real expected = (vl - vs) / (1 + c.dt_drag * (1 / c.liquid + 1 / c.solid));
    REQUIRE(std::fabs(vl_new - vs_new - expected) <= 2e-15 * (std::fabs(vl) + std::fabs(vs)));
  }
}

TEST_CASE("drag: exact limits of the implicit solve") {
  Real vl = 1, vs = -2;
  drag::implicit_drag<Real>(2, 3, 0, vl, vs);  // no drag
  CHECK(vl == 1);
  CHECK(vs == -2);
  drag::implicit_drag<Real>(2, 3, 1e30, vl, vs);  // locked
  CHECK(vl == Approx(-0.8).epsilon(1e-15));
  CHECK(vs == Approx(-0.8).epsilon(1e-15));
  vl = 1;
  vs = -2;
  for (const auto& masses : {std::pair{0.0, 3.0}, std::pair{2.0, 0.0}, std::pair{0.0, 0.0}}) {
    for (const Real dt_drag : {0.0, 5.0, 1e30}) {
      drag::implicit_drag<Real>(masses.first, masses.second, dt_drag, vl, vs);
      CHECK(vl == 1);
      CHECK(vs == -2);
    }
  }
  // a nodal mass near nothing follows the heavy phase and does not disturb it
  drag::implicit_drag<Real>(1e-200, 3, 1.0, vl, vs);
  CHECK(vl == Approx(-2).epsilon(1e-15));
  CHECK(vs == -2);
}

TEST_CASE("drag: two uniform phases decay as exp(-a t)") {
  // a = n_l rho_m g / ((1-n) rho_s k) for saturated soil
  const Real n = 0.4, rho_l = 1000, rho_s = 2650, k = 1e-3, volume = 0.02;
  const Real ml = n * rho_l * volume, ms = (1 - n) * rho_s * volume;
  const Real d = n * drag::Darcy{}.coefficient<Real>(n, 1, k, unit_weight) * volume;
  const Real a = n * unit_weight * (n * rho_l + (1 - n) * rho_s) / ((1 - n) * rho_s * rho_l * k);
  CHECK(d * (1 / ml + 1 / ms) == Approx(a).epsilon(1e-13));
  Real previous = 0;
  for (const int steps : {100, 200}) {
    const Real end = 1 / a, dt = end / steps;
    Real vl = 1, vs = 0;
    for (int i = 0; i < steps; ++i) drag::implicit_drag<Real>(ml, ms, dt * d, vl, vs);
    const Real error = vl - vs - std::exp(-1.0);
    CHECK(std::fabs(error) < 0.6 / steps);
    if (previous != 0) CHECK(previous / error == Approx(2).epsilon(0.02));  // first order
    previous = error;
  }
}

TEST_CASE(
    "drag: the quadratic solve satisfies its root equation, conserves momentum and direction") {
  std::mt19937_64 engine(6);
  std::uniform_real_distribution<Real> speed(-3, 3);
  for (int i = 0; i < 20000; ++i) {
    const Case c = random_case(engine);
    Real vl[3], vs[3], w[3], momentum[3];
    for (int d = 0; d < 3; ++d) {
      vl[d] = speed(engine);
      vs[d] = speed(engine);
      w[d] = vl[d] - vs[d];
      momentum[d] = c.liquid * vl[d] + c.solid * vs[d];
    }
    drag::implicit_drag<Real, 3>(c.liquid, c.solid, c.dt_drag, c.dt_quadratic, vl, vs);
    const Real before = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    Real square = 0;
    for (int d = 0; d < 3; ++d) {
      square += (vl[d] - vs[d]) * (vl[d] - vs[d]);
      const Real size = c.liquid * (std::fabs(vl[d]) + 3) + c.solid * (std::fabs(vs[d]) + 3);
      REQUIRE(std::fabs(c.liquid * vl[d] + c.solid * vs[d] - momentum[d]) <= 1e-15 * size);
    }
    // the relative velocity is a difference of velocities: absolute accuracy 1e-15 of the speeds
    const Real after = std::sqrt(square);
    const long double beta =
        1 / static_cast<long double>(c.liquid) + 1 / static_cast<long double>(c.solid);
    const long double linear = 1 + c.dt_drag * beta, quadratic = c.dt_quadratic * beta;
    const long double root =
        2 * before / (linear + std::sqrt(linear * linear + 4 * quadratic * before));
    REQUIRE(std::fabs((linear + quadratic * root) * root - before) <= 1e-15L * before);
    REQUIRE(std::fabs(after - static_cast<Real>(root)) <= 1e-14);
    REQUIRE(std::fabs((vl[0] - vs[0]) - w[0] * static_cast<Real>(root) / before) <= 1e-14);
  }
}

TEST_CASE("drag: quadratic solve without quadratic part is the linear one; empty nodes stay") {
  Real vl[2] = {1, 0.5}, vs[2] = {-1, 0.2};
  drag::implicit_drag<Real, 2>(2, 3, 1.7, 0, vl, vs);
  for (int d = 0; d < 2; ++d) {
    Real l = d == 0 ? 1 : 0.5, s = d == 0 ? -1 : 0.2;
    drag::implicit_drag<Real>(2, 3, 1.7, l, s);
    CHECK(vl[d] == Approx(l).epsilon(1e-15));
    CHECK(vs[d] == Approx(s).epsilon(1e-15));
  }
  Real a[2] = {1, 2}, b[2] = {3, 4};
  drag::implicit_drag<Real, 2>(0, 3, 1.7, 5, a, b);
  drag::implicit_drag<Real, 2>(0, 0, 0, 0, a, b);
  CHECK(a[1] == 2);
  CHECK(b[1] == 4);
  Real same[2] = {3, 4};
  drag::implicit_drag<Real, 2>(1, 3, 1.7, 5, same, b);  // no relative velocity
  CHECK(same[0] == 3);
}

TEST_CASE("drag: lanes equal scalars") {
  std::mt19937_64 engine(7);
  Lanes ml(0.0), ms(0.0), dt_drag(0.0), dt_quadratic(0.0);
  for (int l = 0; l < lane_count; ++l) {
    const Case c = random_case(engine);
    ml.set(l, l == 2 ? 0 : c.liquid);
    ms.set(l, l == 3 ? 0 : c.solid);
    dt_drag.set(l, l == 4 ? 0 : c.dt_drag);
    dt_quadratic.set(l, l == 5 ? 0 : c.dt_quadratic);
  }
  Lanes vl(1.5), vs(-0.3);
  drag::implicit_drag<Lanes>(ml, ms, dt_drag, vl, vs);
  Lanes wl[2] = {Lanes(1.5), Lanes(0.1)}, ws[2] = {Lanes(-0.3), Lanes(2.0)};
  drag::implicit_drag<Lanes, 2>(ml, ms, dt_drag, dt_quadratic, wl, ws);
  for (int l = 0; l < lane_count; ++l) {
    Real l1 = 1.5, s1 = -0.3;
    drag::implicit_drag<Real>(ml[l], ms[l], dt_drag[l], l1, s1);
    CHECK(vl[l] == Approx(l1).epsilon(1e-14));
    CHECK(vs[l] == Approx(s1).epsilon(1e-14));
    Real l2[2] = {1.5, 0.1}, s2[2] = {-0.3, 2.0};
    drag::implicit_drag<Real, 2>(ml[l], ms[l], dt_drag[l], dt_quadratic[l], l2, s2);
    for (int d = 0; d < 2; ++d) {
      CHECK(wl[d][l] == Approx(l2[d]).epsilon(1e-13));
      CHECK(ws[d][l] == Approx(s2[d]).epsilon(1e-13));
    }
  }
}
