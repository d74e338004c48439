// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cmath>

#include <vadose/policy/conductivity/gardner.hpp>
#include <vadose/policy/conductivity/mualem.hpp>
#include <vadose/policy/conductivity/power.hpp>
#include <vadose/policy/hydraulic.hpp>
#include <vadose/policy/interblock/arithmetic.hpp>
#include <vadose/policy/interblock/kirchhoff_blend.hpp>
#include <vadose/policy/interblock/upstream.hpp>
#include <vadose/policy/kirchhoff.hpp>
#include <vadose/policy/swrc/always_saturated.hpp>
#include <vadose/policy/swrc/gardner.hpp>
#include <vadose/policy/swrc/tarantino.hpp>

#include "../../examples/laws/brooks_corey.hpp"

namespace {

using vadose::KirchhoffMean;
using vadose::Lanes;
using vadose::Real;
namespace swrc = vadose::swrc;
namespace conductivity = vadose::conductivity;
using doctest::Approx;

/// Adaptive Simpson rule to relative accuracy 1e-9 of the running estimate.
template <class F>
Real simpson(const F& f, Real a, Real fa, Real b, Real fb, Real m, Real fm, Real whole, int depth) {
  const Real l = 0.5 * (a + m), r = 0.5 * (m + b);
  const Real fl = f(l), fr = f(r);
  const Real left = (m - a) / 6 * (fa + 4 * fl + fm);
  const Real right = (b - m) / 6 * (fm + 4 * fr + fb);
  if (depth == 0 || std::fabs(left + right - whole) <= 1e-9 * std::fabs(left + right))
    return left + right + (left + right - whole) / 15;
  return simpson(f, a, fa, m, fm, l, fl, left, depth - 1) +
         simpson(f, m, fm, b, fb, r, fr, right, depth - 1);
}

template <class F>
Real integrate(const F& f, Real a, Real b) {
  const Real m = 0.5 * (a + b), fa = f(a), fm = f(m), fb = f(b);
  return simpson(f, a, fa, b, fb, m, fm, (b - a) / 6 * (fa + 4 * fm + fb), 28);
}

/// Integral of k over suction from s_a < s_b, piece by piece so that no kink of k lies inside.
template <class Curve, class Law>
Real quadrature(const Curve& curve, const Law& law, Real n, Real s_a, Real s_b, Real kink) {
  const auto k = [&](Real s) {
    const Real se = swrc::effective_saturation<Real>(curve, swrc::saturation<Real>(curve, s, n));
    return conductivity::value<Real>(law, se, n);
  };
  // substitution s = e^u, pieces of a factor 4
  const auto in_log = [&](Real u) { return k(std::exp(u)) * std::exp(u); };
  Real sum = 0, low = s_a;
  if (low < 1e-9) {
    sum += k(0.5e-9) * (std::fmin(1e-9, s_b) - low);
    low = 1e-9;
  }
  while (low < s_b) {
    Real high = std::fmin(4 * low, s_b);
    if (low < kink * (1 - 1e-12) && high > kink) high = kink;
    sum += integrate(in_log, std::log(low), std::log(high));
    low = high;
  }
  return sum;
}

/// Compares the table with quadrature over pairs of pressures; returns the largest relative error.
template <class Curve, class Law>
Real worst_error(const Curve& curve, const Law& law, Real n, Real n_ref, Real kink) {
  const KirchhoffMean<Curve, Law> table(curve, law, n_ref);
  const Real suctions[] = {0, 1e-3, 0.7, 30, 48, 55, 400, 3e3, 3.1e3, 2.4e4, 1.9e5, 2e6};
  Real worst = 0;
  for (const Real wet : suctions)
    for (const Real dry : suctions) {
      if (dry <= wet) continue;
      const Real exact = quadrature(curve, law, n, wet, dry, kink) / (dry - wet);
      const Real error = std::fabs(table.mean(-dry, -wet, n) / exact - 1);
      worst = std::fmax(worst, error);
      CHECK(table.mean(-wet, -dry, n) == table.mean(-dry, -wet, n));
    }
  return worst;
}

struct Soil {
  swrc::Tarantino curve;
  conductivity::Mualem law;
};

Soil soil(Real a, Real lambda, Real n, Real k) {
  return {{.a = a, .lambda = lambda, .unit_weight = 9810},
          {.saturated_conductivity = k, .reference_porosity = n, .lambda = lambda}};
}

const Soil clay = soil(12, 0.09, 0.4, 9.8e-4);            // [Zhan] Table 1
const Soil coarse_sand = soil(18.4, 0.63, 0.4, 4.41e-6);  // Table 2
const Soil silty_sand = soil(1.2, 0.89, 0.48, 2.77e-3);   // Table 3

}  // namespace

TEST_CASE("mean conductivity: eight faces at once as one by one") {
  const swrc::Tarantino curve{.a = 1.5, .lambda = 0.25, .unit_weight = 9810};
  const conductivity::Mualem law{
      .saturated_conductivity = 1e-5, .reference_porosity = 0.4, .lambda = 0.25};
  const KirchhoffMean<swrc::Tarantino, conductivity::Mualem> mean(curve, law, 0.4);
  const Real pressures[] = {2e3, 0, -1e-4, -30, -30.0001, -4e3, -2e5, -1e8, -1e13};
  for (const Real a : pressures)
    for (const Real n : {0.2, 0.4, 0.6}) {
      Lanes b, porosity(n);
      for (int l = 0; l < vadose::lane_count; ++l) b.set(l, pressures[l + (l % 2)]);
      const Lanes together = mean.mean(Lanes(a), b, porosity);
      for (int l = 0; l < vadose::lane_count; ++l)
        CHECK(together[l] == Approx(mean.mean(a, b[l], n)).epsilon(1e-11));
    }
}

TEST_CASE("kirchhoff: means agree with adaptive quadrature for the paper's soils") {
  const auto kink = [](const Soil& s, Real n) { return 1e-3 / s.curve.suction_scale(n); };
  CHECK(worst_error(clay.curve, clay.law, 0.4, 0.4, kink(clay, 0.4)) <= 1e-6);
  conductivity::Mualem no_floor = silty_sand.law;
  no_floor.relative_floor = 0;
  CHECK(worst_error(silty_sand.curve, no_floor, 0.48, 0.48, kink(silty_sand, 0.48)) <= 1e-6);
  // the floor of k_r is a second kink
  CHECK(worst_error(silty_sand.curve, silty_sand.law, 0.48, 0.48, kink(silty_sand, 0.48)) <= 2e-5);
  CHECK(worst_error(coarse_sand.curve, coarse_sand.law, 0.4, 0.4, kink(coarse_sand, 0.4)) <= 1e-6);
}

TEST_CASE("kirchhoff: one table serves other porosities, table built at the reference") {
  static_assert(KirchhoffMean<swrc::Tarantino, conductivity::Mualem>::scales);
  for (const Real n : {0.35, 0.45})
    CHECK(worst_error(clay.curve, clay.law, n, 0.4, 1e-3 / clay.curve.suction_scale(n)) <= 1e-6);
}

TEST_CASE("kirchhoff: exponential conductivity in closed form") {
  const swrc::Gardner curve{.residual_saturation = 0.1, .alpha = 1.3, .unit_weight = 9810};
  conductivity::Gardner law{.saturated_conductivity = 1e-5, .reference_porosity = 0.4};
  law.relative_floor = 0;
  const KirchhoffMean<swrc::Gardner, conductivity::Gardner> table(curve, law, 0.4);
  const Real c = 1.3 / 9810;
  for (const Real wet : {0.0, 10.0, 2e3, 3e4})
    for (const Real step : {1e-2, 3.0, 500.0, 2e4, 3e5}) {
      const Real exact = 1e-5 * std::exp(-c * wet) * -std::expm1(-c * step) / (c * step);
      CAPTURE(wet);
      CAPTURE(step);
      // S_e far from 1 has absolute accuracy 1e-16 only: leave the far tail
      CHECK(table.mean(-wet, -wet - step, 0.4) == Approx(exact).epsilon(1e-6).scale(0));
    }
}

TEST_CASE("kirchhoff: pressures of either sign, equal and close pressures") {
  const KirchhoffMean<swrc::Tarantino, conductivity::Mualem> table(clay.curve, clay.law, 0.4);
  const auto k = [](Real p, Real n) {
    const Real s = clay.curve.saturation<Real>(std::fmax(-p, 0.0), n);
    return clay.law.conductivity<Real>(s, n);
  };
  CHECK(table.mean(5e3, 5e3, 0.4) == k(5e3, 0.4));
  CHECK(table.mean(0, 7e3, 0.4) == Approx(9.8e-4).epsilon(1e-14));
  CHECK(table.mean(0, 0, 0.35) == Approx(k(0, 0.35)).epsilon(1e-14));
  for (const Real p : {-1e-4, -20.0, -3e3, -2e5}) {
    CHECK(table.mean(p, p, 0.43) == Approx(k(p, 0.43)).epsilon(1e-12).scale(0));
    for (const Real step : {1e-9, 1e-7, 0.9e-5, 1.1e-5, 1e-4}) {  // across the switch to midpoint
      const Real middle = p * (1 + 0.5 * step);
      CHECK(table.mean(p, p * (1 + step), 0.43) == Approx(k(middle, 0.43)).epsilon(2e-6).scale(0));
    }
  }
  // across p = 0 the two parts add by length
  const Real wet = table.mean(0, 4e3, 0.4) * 4e3, dry = table.mean(0, -6e3, 0.4) * 6e3;
  CHECK(table.mean(4e3, -6e3, 0.4) == Approx((wet + dry) / 1e4).epsilon(1e-12));
  // additive over adjoining intervals and between the end values
  const Real a = table.mean(-10, -900, 0.4) * 890, b = table.mean(-900, -5e4, 0.4) * 49100;
  CHECK(table.mean(-10, -5e4, 0.4) * 49990 == Approx(a + b).epsilon(1e-8));
  CHECK(table.mean(-10, -5e4, 0.4) < k(-10, 0.4));
  CHECK(table.mean(-10, -5e4, 0.4) > k(-5e4, 0.4));
  // beyond the table
  CHECK(table.mean(-1e13, -2e13, 0.4) == Approx(9.8e-4 * 1e-12).epsilon(1e-6).scale(0));
}

TEST_CASE("kirchhoff: policies that do not scale use the suction at the reference porosity") {
  const BrooksCorey curve{.residual_saturation = 0.05, .air_entry = 800, .pore_index = 0.7};
  const conductivity::PowerLaw law{
      .saturated_conductivity = 1e-5, .reference_porosity = 0.4, .exponent = 5};
  static_assert(!KirchhoffMean<BrooksCorey, conductivity::PowerLaw>::scales);
  CHECK(worst_error(curve, law, 0.4, 0.4, 800) <= 2e-5);  // a kink at the air entry
  const KirchhoffMean<BrooksCorey, conductivity::PowerLaw> table(curve, law, 0.4);
  const Real ratio = law.saturated<Real>(0.3) / 1e-5;
  CHECK(table.mean(-500, -9e3, 0.3) == Approx(ratio * table.mean(-500, -9e3, 0.4)).epsilon(1e-14));
  CHECK(table.mean(-500, -9e3, 0.4) < 1e-5);
  CHECK(table.mean(-100, -700, 0.4) == Approx(1e-5).epsilon(1e-9));
  const KirchhoffMean<swrc::AlwaysSaturated, conductivity::PowerLaw> full(swrc::AlwaysSaturated{},
                                                                          law, 0.4);
  CHECK(full.mean(-3e4, 2e4, 0.4) == Approx(1e-5).epsilon(1e-12));
}

TEST_CASE("kirchhoff: blend with the upstream conductivity") {
  CHECK(vadose::blend_conductivity<Real>(3, 1, 0, 0) == 3);
  CHECK(vadose::blend_conductivity<Real>(3, 1, 5, 0) == 3);
  CHECK(vadose::blend_conductivity<Real>(3, 1, 0, -5) == 1);
  CHECK(vadose::blend_conductivity<Real>(3, 1, 5, -5) == Approx(2).epsilon(1e-15));
  CHECK(vadose::blend_conductivity<Real>(3, 1, 15, 5) == Approx(2.5).epsilon(1e-15));
  const Lanes lanes = vadose::blend_conductivity<Lanes>(Lanes(3), Lanes(1), Lanes(15), Lanes(-5));
  CHECK(lanes[6] == Approx(2.5).epsilon(1e-15));
  CHECK(vadose::blend_conductivity<Lanes>(Lanes(3), Lanes(1), Lanes(0), Lanes(0))[1] == 3);
}

TEST_CASE("kirchhoff: means of conductivity between cells") {
  const KirchhoffMean<swrc::Tarantino, conductivity::Mualem> table(clay.curve, clay.law, 0.4);
  const vadose::FaceState<Real> face{-2e4, -5e3, 0.38, 3e-8, 5e3};
  const Real a = table.mean(-2e4, -2e4, 0.38), b = table.mean(-5e3, -5e3, 0.38);
  namespace interblock = vadose::interblock;
  CHECK(interblock::Upstream::mean(table, face) == 3e-8);
  CHECK(interblock::Arithmetic::mean(table, face) == Approx((a + b) / 2).epsilon(1e-14));
  const Real between = table.mean(-2e4, -5e3, 0.38);
  CHECK(interblock::KirchhoffBlend::mean(table, face) ==
        Approx((3e-8 * 5e3 + between * 1.5e4) / 2e4).epsilon(1e-14));
  const vadose::FaceState<Lanes> faces{face.pressure_a, face.pressure_b, face.porosity,
                                       face.upstream, face.gravity_head};
  CHECK(interblock::Arithmetic::mean(table, faces)[5] == Approx((a + b) / 2).epsilon(1e-9));
}

TEST_CASE("kirchhoff: invalid set-up is refused") {
  using Mean = KirchhoffMean<swrc::Tarantino, conductivity::Mualem>;
  CHECK_THROWS_AS(Mean(clay.curve, clay.law, 1.0), vadose::SetupError);
  CHECK_THROWS_AS(Mean(clay.curve, clay.law, vadose::unset), vadose::SetupError);
}
