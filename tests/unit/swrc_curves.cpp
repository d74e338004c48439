// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include <vadose/policy/hydraulic.hpp>
#include <vadose/policy/swrc/always_saturated.hpp>
#include <vadose/policy/swrc/gardner.hpp>
#include <vadose/policy/swrc/table.hpp>
#include <vadose/policy/swrc/tarantino.hpp>
#include <vadose/policy/swrc/van_genuchten.hpp>

#include "../../examples/laws/brooks_corey.hpp"
#include "../error_message.hpp"

namespace {

using vadose::lane_count;
using vadose::Lanes;
using vadose::Real;
using vadose::SetupError;
namespace swrc = vadose::swrc;
using doctest::Approx;
using vadose_test::error_message;

constexpr Real unit_weight = 9810;

// Tables 1 to 4 of [Zhan].
constexpr swrc::Tarantino table1{.a = 12, .lambda = 0.09, .unit_weight = unit_weight};
constexpr swrc::Tarantino table2{.a = 18.4, .lambda = 0.63, .unit_weight = unit_weight};
constexpr swrc::Tarantino table3{.a = 1.2, .lambda = 0.89, .unit_weight = unit_weight};
constexpr swrc::Tarantino table4{
    .residual_saturation = 0.26, .a = 15.2, .lambda = 0.19, .unit_weight = unit_weight};

const std::vector<Real> suctions = {1e-6, 1e-3, 1, 49, 300, 1.1e3, 5e3, 2.3e4, 1.9e5, 3e6, 1e9};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A lanes value with the given suctions, cyclic from `first`.
Lanes batch(std::size_t first) {
  Lanes s(0.0);
  for (int l = 0; l < lane_count; ++l)
    s.set(l, suctions[(first + static_cast<std::size_t>(l)) % suctions.size()]);
  return s;
}

/// What every curve must satisfy at porosity n.
template <class Curve>
void check_curve(const Curve& curve, Real n, Real smallest_test_suction = 1e-3) {
  CHECK(swrc::saturation<Real>(curve, 0, n) == 1);
  CHECK(std::fabs(swrc::slope<Real>(curve, 0, n)) < std::numeric_limits<Real>::infinity());
  Real before = 1;
  for (const Real s : suctions) {
    CAPTURE(s);
    const Real value = swrc::saturation<Real>(curve, s, n);
    const Real slope = swrc::slope<Real>(curve, s, n);
    CHECK(value <= before);
    CHECK(value >= swrc::residual_saturation(curve));
    CHECK(slope <= 0);
    before = value;
    if (s >= smallest_test_suction) {
      const Real h = 1e-4 * s;
      const Real difference =
          (swrc::saturation<Real>(curve, s + h, n) - swrc::saturation<Real>(curve, s - h, n)) /
          (2 * h);
      CHECK(std::fabs(slope - difference) <= 1e-6 * std::fabs(slope) + 2e-12 / s);
      const Real dn = 1e-5;
      const Real porosity_difference =
          (swrc::saturation<Real>(curve, s, n + dn) - swrc::saturation<Real>(curve, s, n - dn)) /
          (2 * dn);
      const Real porosity_slope = swrc::porosity_slope<Real>(curve, s, n);
      CHECK(std::fabs(porosity_slope - porosity_difference) <=
            1e-6 * std::fabs(porosity_slope) + 1e-10);
    }
  }
}

/// Lanes agree with scalars to 1e-13.
template <class Curve>
void check_lanes(const Curve& curve) {
  for (std::size_t first = 0; first < suctions.size(); ++first) {
    Lanes s = batch(first);
    if (first == 0) s.set(3, 0.0);
    Lanes n(0.0);
    for (int l = 0; l < lane_count; ++l) n.set(l, 0.25 + 0.05 * l);
    const Lanes value = swrc::saturation<Lanes>(curve, s, n);
    const Lanes slope = swrc::slope<Lanes>(curve, s, n);
    const Lanes porosity_slope = swrc::porosity_slope<Lanes>(curve, s, n);
    const auto water = swrc::water_content<Lanes>(curve, -s, n, Lanes(1 / 2.2e9));
    for (int l = 0; l < lane_count; ++l) {
      const auto close = [](Real a, Real b) {
        return std::fabs(a - b) <= 1e-13 * std::fabs(b) + 1e-300;
      };
      CHECK(close(value[l], swrc::saturation<Real>(curve, s[l], n[l])));
      CHECK(close(slope[l], swrc::slope<Real>(curve, s[l], n[l])));
      CHECK(close(porosity_slope[l], swrc::porosity_slope<Real>(curve, s[l], n[l])));
      const auto scalar = swrc::water_content<Real>(curve, -s[l], n[l], 1 / 2.2e9);
      CHECK(close(water.value[l], scalar.value));
      CHECK(close(water.slope[l], scalar.slope));
    }
  }
}

template <class Curve>
void check_inverse(const Curve& curve, Real n, Real lowest) {
  for (Real target = lowest; target < 0.9995; target += 0.0321) {
    CAPTURE(target);
    const Real s = swrc::suction(curve, target, n);
    CHECK(s > 0);
    CHECK(swrc::saturation<Real>(curve, s, n) == Approx(target).epsilon(1e-12));
  }
  CHECK(swrc::suction(curve, 1.0, n) == 0);
}

/// Linear table of 5 entries.
swrc::Table measured(swrc::Table::Abscissa abscissa) {
  return swrc::Table({{500, 1}, {2e3, 0.93}, {9e3, 0.6}, {5e4, 0.31}, {1e6, 0.12}}, abscissa);
}

}  // namespace

static_assert(vadose::RetentionCurve<BrooksCorey>);
static_assert(!vadose::ScalingRetention<BrooksCorey>);
static_assert(vadose::is_always_saturated<swrc::AlwaysSaturated>);
static_assert(!vadose::is_always_saturated<swrc::Tarantino>);
static_assert(std::is_trivially_copyable_v<swrc::Tarantino>);

TEST_CASE("retention: reference numbers of the paper's four soils") {
  struct Row {
    const swrc::Tarantino* soil;
    Real n, saturation, suction, porosity_slope, coupling;
  };
  // Independent evaluation: suction, dS/dn and S + n (1-n) dS/dn at a given saturation.
  const Row rows[] = {{&table1, 0.40, 0.86, 187657.4354, -2.912689056, 0.1609546267},
                      {&table1, 0.40, 0.893, 114201.3578, -2.662688012, 0.2539548771},
                      {&table1, 0.40, 0.976, 16979.47417, -0.9620046543, 0.745118883},
                      {&table2, 0.40, 0.042, 4342.957317, -0.1738578597, 0.000274113676},
                      {&table2, 0.40, 0.126, 2251.701987, -0.5054036115, 0.00470313325},
                      {&table3, 0.48, 0.33, 9121.867708, -0.9416862357, 0.09495511557},
                      {&table4, 0.40, 0.493, 500382.2859, -0.9686167038, 0.2605319911},
                      {&table4, 0.40, 0.8, 11737.23508, -1.821468522, 0.3628475548}};
  for (const Row& row : rows) {
    CAPTURE(row.suction);
    CHECK(swrc::suction(*row.soil, row.saturation, row.n) == Approx(row.suction).epsilon(1e-9));
    CHECK(row.soil->saturation<Real>(row.suction, row.n) == Approx(row.saturation).epsilon(1e-9));
    const Real slope = swrc::porosity_slope<Real>(*row.soil, row.suction, row.n);
    CHECK(slope == Approx(row.porosity_slope).epsilon(1e-9));
    CHECK(row.saturation + row.n * (1 - row.n) * slope == Approx(row.coupling).epsilon(1e-6));
  }
  CHECK(-table1.saturation_slope<Real>(187657.4354, 0.4) == Approx(3.684e-7).epsilon(2e-4));
  CHECK(table3.saturation<Real>(9.2e3, 0.48) == Approx(0.314).epsilon(2e-3));
  CHECK(table1.saturation<Real>(114e3, 0.4) == Approx(0.8931).epsilon(1e-4));
  CHECK(table1.saturation<Real>(17e3, 0.4) == Approx(0.9760).epsilon(1e-4));
  // a e^b is van Genuchten's alpha: Carsel and Parrish's sand and sandy clay
  CHECK(table2.suction_scale(0.4) * unit_weight == Approx(14.5).epsilon(1e-3));
  CHECK(table4.suction_scale(0.4) * unit_weight == Approx(2.70).epsilon(1e-3));
}

TEST_CASE("retention: the centrifuge's gravity in Eq. (12) would saturate Table 3") {
  swrc::Tarantino wrong = table3;
  wrong.unit_weight = 30 * unit_weight;
  CHECK(wrong.saturation<Real>(9.2e3, 0.48) > 0.999);
}

TEST_CASE("retention: slopes, limits and order of all curves") {
  check_curve(table1, 0.4);
  check_curve(table2, 0.4);
  check_curve(table3, 0.48);
  check_curve(table4, 0.4);
  swrc::Tarantino frozen = table1;
  frozen.porosity_dependent = false;
  frozen.reference_porosity = 0.4;
  check_curve(frozen, 0.3);
  CHECK(frozen.saturation<Real>(5e4, 0.3) ==
        Approx(table1.saturation<Real>(5e4, 0.4)).epsilon(1e-14));
  check_curve(
      swrc::VanGenuchten{
          .residual_saturation = 0.1, .a = 3.6, .lambda = 0.36, .unit_weight = unit_weight},
      0.4);
  check_curve(swrc::Gardner{.residual_saturation = 0.2, .alpha = 1.5, .unit_weight = unit_weight},
              0.4);
  check_curve(swrc::AlwaysSaturated{}, 0.4);
  check_curve(measured(swrc::Table::Abscissa::logarithmic), 0.4);
  check_curve(measured(swrc::Table::Abscissa::linear), 0.4);
  check_curve(BrooksCorey{.air_entry = 800, .pore_index = 0.7}, 0.4);
}

TEST_CASE("retention: closed forms") {
  const swrc::VanGenuchten curve{
      .residual_saturation = 0.1, .a = 3.6, .lambda = 0.36, .unit_weight = unit_weight};
  const swrc::Gardner exponential{
      .residual_saturation = 0.2, .alpha = 1.5, .unit_weight = unit_weight};
  for (const Real s : suctions) {
    const Real x = std::pow(3.6 * s / unit_weight, 1 / 0.64);
    CHECK(curve.saturation<Real>(s, 0.4) ==
          Approx(0.1 + 0.9 * std::pow(1 + x, -0.36)).epsilon(1e-13));
    CHECK(exponential.saturation<Real>(s, 0.4) ==
          Approx(0.2 + 0.8 * std::exp(-1.5 * s / unit_weight)).epsilon(1e-14));
    const Real e = 0.48 / 0.52;
    const Real y = std::pow(1.2 * s / unit_weight * std::pow(e, 0.11 / 0.89), 1 / 0.11);
    CHECK(table3.saturation<Real>(s, 0.48) == Approx(std::pow(1 + y, -0.89)).epsilon(1e-12));
  }
  // At high suction e S does not depend on the void ratio.
  const auto water_ratio = [](Real n) { return n / (1 - n) * table1.saturation<Real>(1e9, n); };
  CHECK(water_ratio(0.35) == Approx(water_ratio(0.45)).epsilon(1e-4));
  // Tarantino at the void ratio 1 is van Genuchten.
  const swrc::VanGenuchten twin{.a = 12, .lambda = 0.09, .unit_weight = unit_weight};
  CHECK(table1.saturation<Real>(3e3, 0.5) ==
        Approx(twin.saturation<Real>(3e3, 0.1)).epsilon(1e-14));
}

TEST_CASE("retention: extreme suction and negative suction are safe") {
  for (const auto* soil : {&table1, &table2, &table3, &table4}) {
    for (const Real s : {0.0, 1e-300, 1e-30, 1e9, 1e30, -5.0}) {
      const auto both = soil->saturation_and_slope<Real>(s, 0.4);
      CHECK(vadose::is_finite(both.saturation));
      CHECK(vadose::is_finite(both.slope));
      const auto lanes = soil->saturation_and_slope<Lanes>(Lanes(s), Lanes(0.4));
      CHECK(lanes.saturation[1] == Approx(both.saturation).epsilon(1e-13));
      CHECK(vadose::is_finite(lanes.slope[1]));
      if (s <= 0) CHECK(both.saturation == 1);
      if (s <= 0) CHECK(both.slope == 0);
      if (s <= 0) CHECK(lanes.saturation[2] == 1);
      if (s <= 0) CHECK(lanes.slope[2] == 0);
    }
  }
  const swrc::Tarantino steep{.a = 12, .lambda = 0.995, .unit_weight = unit_weight};
  CHECK(steep.saturation<Real>(1e9, 0.4) == Approx(0).epsilon(1e-200));
  CHECK(vadose::is_finite(steep.saturation_slope<Real>(1e9, 0.4)));
  CHECK(steep.saturation<Lanes>(Lanes(1e9), Lanes(0.4))[0] < 1e-100);
}

TEST_CASE("retention: inverse round trip, closed form and bisection") {
  check_inverse(table1, 0.4, 0.3);
  check_inverse(table2, 0.4, 0.01);
  check_inverse(table3, 0.48, 0.01);
  check_inverse(table4, 0.4, 0.33);
  check_inverse(
      swrc::VanGenuchten{
          .residual_saturation = 0.1, .a = 3.6, .lambda = 0.36, .unit_weight = unit_weight},
      0.4, 0.15);
  check_inverse(swrc::Gardner{.residual_saturation = 0.2, .alpha = 1.5, .unit_weight = unit_weight},
                0.4, 0.25);
  check_inverse(measured(swrc::Table::Abscissa::logarithmic), 0.4, 0.13);
  check_inverse(measured(swrc::Table::Abscissa::linear), 0.4, 0.13);
  const BrooksCorey user{.residual_saturation = 0.05, .air_entry = 800, .pore_index = 0.7};
  check_inverse(user, 0.4, 0.07);
  CHECK(swrc::suction(user, 0.5, 0.4) ==
        Approx(800 * std::pow(0.95 / 0.45, 1 / 0.7)).epsilon(1e-12));
  CHECK(swrc::suction(user, 0.01, 0.4) == std::numeric_limits<Real>::infinity());
  CHECK(swrc::suction(table4, 0.26, 0.4) == std::numeric_limits<Real>::infinity());
  CHECK(swrc::suction(measured(swrc::Table::Abscissa::linear), 0.05, 0.4) ==
        std::numeric_limits<Real>::infinity());
}

TEST_CASE("retention: lanes equal scalars") {
  check_lanes(table1);
  check_lanes(table3);
  check_lanes(table4);
  check_lanes(swrc::VanGenuchten{
      .residual_saturation = 0.1, .a = 3.6, .lambda = 0.36, .unit_weight = unit_weight});
  check_lanes(swrc::Gardner{.residual_saturation = 0.2, .alpha = 1.5, .unit_weight = unit_weight});
  check_lanes(swrc::AlwaysSaturated{});
  check_lanes(measured(swrc::Table::Abscissa::logarithmic));
  check_lanes(BrooksCorey{.air_entry = 800, .pore_index = 0.7});
}

TEST_CASE("retention: tables pass through their entries, stay monotone and refuse disorder") {
  for (const auto abscissa : {swrc::Table::Abscissa::logarithmic, swrc::Table::Abscissa::linear}) {
    const swrc::Table curve = measured(abscissa);
    CHECK_NOTHROW(curve.validate());
    CHECK(curve.saturation(500, 0.4) == 1);
    CHECK(curve.saturation(2e3, 0.4) == Approx(0.93).epsilon(1e-14));
    CHECK(curve.saturation(9e3, 0.4) == Approx(0.6).epsilon(1e-14));
    CHECK(curve.saturation(1e6, 0.4) == 0.12);
    CHECK(curve.saturation(1e8, 0.4) == 0.12);
    CHECK(curve.saturation_slope(1e8, 0.4) == 0);
    Real before = 1;
    for (Real s = 400; s < 2e6; s *= 1.01) {
      const Real value = curve.saturation(s, 0.4);
      CHECK(value <= before);
      CHECK(curve.saturation_slope(s, 0.4) <= 0);
      before = value;
    }
  }
  // A flat stretch stays flat.
  const swrc::Table flat({{10, 1}, {100, 0.5}, {1000, 0.5}, {10000, 0.2}});
  CHECK(flat.saturation(300, 0.4) == Approx(0.5).epsilon(1e-15));
  CHECK(flat.suction(0.5, 0.4) == Approx(100).epsilon(1e-6));
  // A table sampled from a smooth curve reproduces it.
  std::vector<swrc::Table::Entry> samples{{1e-6, 1}};
  for (Real s = 1; s < 1e6; s *= 1.15) samples.push_back({s, table2.saturation<Real>(s, 0.4)});
  const swrc::Table sampled(samples);
  for (Real s = 10; s < 5e5; s *= 1.37)
    CHECK(sampled.saturation(s, 0.4) == Approx(table2.saturation<Real>(s, 0.4)).epsilon(2e-3));

  using Entries = std::vector<swrc::Table::Entry>;
  const auto refused = [](const Entries& entries, const std::string& words) {
    const std::string text = error_message<SetupError>([&] { const swrc::Table table(entries); });
    CAPTURE(text);
    CHECK(contains(text, words));
  };
  refused({{1, 1}, {10, 0.7}, {100, 0.8}, {1000, 0.1}}, "entry 3");
  refused({{1, 1}, {10, 0.7}, {10, 0.6}}, "entry 3");
  refused({{1, 0.9}, {10, 0.7}}, "entry 1");
  refused({{0, 1}, {10, 0.7}}, "suction = 0");
  refused({{1, 1}, {10, -0.7}}, "saturation = -0.7");
  refused({{1, 1}, {std::nan(""), 0.7}}, "entry 2");
  refused({{1, 1}}, "at least 2");
  CHECK(contains(error_message<SetupError>([] { swrc::Table{}.validate(); }), "no entries"));
}

TEST_CASE("retention: validate names the parameter that is wrong") {
  const auto refused = [](auto curve, const std::string& words) {
    const std::string text = error_message<SetupError>([&] { curve.validate(); });
    CAPTURE(text);
    CHECK(contains(text, words));
  };
  CHECK_NOTHROW(table1.validate());
  refused(swrc::Tarantino{.lambda = 0.1, .unit_weight = 9810}, "a = nan");
  refused(swrc::Tarantino{.a = -1, .lambda = 0.1, .unit_weight = 9810}, "a = -1");
  refused(swrc::Tarantino{.a = 1, .lambda = 1, .unit_weight = 9810}, "lambda = 1 outside (0, 1)");
  refused(swrc::Tarantino{.a = 1, .lambda = 0, .unit_weight = 9810}, "lambda = 0");
  refused(swrc::Tarantino{.a = 1, .lambda = 0.1}, "unit_weight");
  refused(swrc::Tarantino{.residual_saturation = 1, .a = 1, .lambda = 0.1, .unit_weight = 9810},
          "residual_saturation = 1 outside [0, 1)");
  refused(
      swrc::Tarantino{
          .residual_saturation = vadose::unset, .a = 1, .lambda = 0.1, .unit_weight = 9810},
      "residual_saturation = nan");
  refused(swrc::Tarantino{.a = 1, .lambda = 0.1, .unit_weight = 9810, .porosity_dependent = false},
          "reference_porosity");
  refused(swrc::VanGenuchten{.a = 1, .lambda = 1.2, .unit_weight = 9810}, "lambda = 1.2");
  refused(
      swrc::VanGenuchten{.residual_saturation = -0.1, .a = 1, .lambda = 0.2, .unit_weight = 9810},
      "residual_saturation");
  refused(swrc::Gardner{.alpha = 0, .unit_weight = 9810}, "alpha = 0");
  refused(swrc::Gardner{.alpha = 1}, "unit_weight");
  refused(BrooksCorey{.pore_index = 1}, "air_entry");
}

TEST_CASE("retention: shared numbers fill only what is unset") {
  const vadose::SharedParameters shared{
      .liquid_unit_weight = 9810, .reference_porosity = 0.4, .lambda = 0.3};
  swrc::Tarantino curve{.a = 2, .lambda = 0.2};
  vadose::adopt_shared(curve, shared);
  CHECK(curve.lambda == 0.2);
  CHECK(curve.unit_weight == 9810);
  CHECK(curve.reference_porosity == 0.4);
  CHECK_NOTHROW(curve.validate());
  swrc::VanGenuchten other{.a = 2};
  vadose::adopt_shared(other, shared);
  CHECK(other.lambda == 0.3);
  BrooksCorey user{.air_entry = 1, .pore_index = 1};
  vadose::adopt_shared(user, shared);  // has no adopt(): left alone
  CHECK(user.air_entry == 1);
}

TEST_CASE("retention: water content is one smooth increasing function of pressure") {
  const Real compliance = 1 / 2.2e9;
  const auto at = [&](Real p) { return swrc::water_content<Real>(table1, p, 0.4, compliance); };
  CHECK(at(0).value == 0.4);
  CHECK(at(0).slope == Approx(0.4 * compliance).epsilon(1e-14));
  CHECK(at(1e6).value == Approx(0.4 * std::exp(1e6 * compliance)).epsilon(1e-14));
  CHECK(at(1e6).slope == Approx(at(1e6).value * compliance).epsilon(1e-14));
  Real before = 0;
  for (const Real p : {-1e9, -1e7, -1e5, -1e3, -10.0, -0.1, 0.0, 10.0, 1e5, 1e7}) {
    CAPTURE(p);
    CHECK(at(p).value > before);
    CHECK(at(p).slope > 0);
    before = at(p).value;
    if (p == 0) continue;
    const Real h = 1e-4 * std::fabs(p);
    const Real difference = (at(p + h).value - at(p - h).value) / (2 * h);
    CHECK(at(p).slope == Approx(difference).epsilon(1e-6 + 1e-12 / (std::fabs(p) * at(p).slope)));
  }
  const auto saturated = swrc::water_content<Real>(swrc::AlwaysSaturated{}, -1e5, 0.3, compliance);
  CHECK(saturated.value == Approx(0.3 * std::exp(-1e5 * compliance)).epsilon(1e-15));
  CHECK(saturated.slope == Approx(saturated.value * compliance).epsilon(1e-15));
}

TEST_CASE("retention: effective saturation is limited to 0 and 1") {
  CHECK(swrc::effective_saturation<Real>(table4, 0.26) == 0);
  CHECK(swrc::effective_saturation<Real>(table4, 0.1) == 0);
  CHECK(swrc::effective_saturation<Real>(table4, 1.0) == 1);
  CHECK(swrc::effective_saturation<Real>(table4, 0.63) == Approx(0.5).epsilon(1e-14));
  CHECK(swrc::effective_saturation<Lanes>(table4, Lanes(0.63))[4] == Approx(0.5).epsilon(1e-14));
  CHECK(swrc::effective_saturation<Real>(measured(swrc::Table::Abscissa::linear), 0.4) == 0.4);
}
