// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include <vadose/policy/conductivity/constant.hpp>
#include <vadose/policy/conductivity/gardner.hpp>
#include <vadose/policy/conductivity/kozeny_carman.hpp>
#include <vadose/policy/conductivity/mualem.hpp>
#include <vadose/policy/conductivity/power.hpp>
#include <vadose/policy/conductivity/table.hpp>
#include <vadose/policy/hydraulic.hpp>
#include <vadose/policy/swrc/gardner.hpp>
#include <vadose/policy/swrc/tarantino.hpp>

#include "../error_message.hpp"

namespace {

using vadose::lane_count;
using vadose::Lanes;
using vadose::Real;
using vadose::SetupError;
namespace conductivity = vadose::conductivity;
using doctest::Approx;
using vadose_test::error_message;

constexpr conductivity::Mualem mualem(Real lambda) {
  return {.saturated_conductivity = 9.8e-4, .reference_porosity = 0.4, .lambda = lambda};
}

/// Mualem's law without regularisation in extended precision, 1 - S_e^(1/lambda) kept accurate.
long double formula(Real effective, Real lambda) {
  const long double se = effective;
  const long double m = lambda;
  const long double rest = -std::expm1(std::log1p(se - 1) / m);
  const long double bracket = 1 - std::pow(rest, m);
  return std::sqrt(se) * bracket * bracket;
}

/// A user's law in plain doubles.
struct CubicUser {
  void validate() const {}
  Real conductivity(Real se, Real n) const { return se > 0.1 ? 1e-5 * n * se * se * se : 1e-8 * n; }
};

template <class Law>
void refused(const Law& law, const std::string& words) {
  const std::string text = error_message<SetupError>([&] { law.validate(); });
  CAPTURE(text);
  CHECK(text.find(words) != std::string::npos);
}

/// Never decreasing in S_e, k(1, n_ref) = k_sat, lanes equal to scalars, factors multiply.
template <class Law>
void check_law(const Law& law, Real saturated) {
  CHECK_NOTHROW(law.validate());
  CHECK(conductivity::value<Real>(law, 1, 0.4) == Approx(saturated).epsilon(1e-14));
  Real before = 0;
  for (int i = 0; i <= 200; ++i) {
    const Real se = i / 200.0;
    const Real k = conductivity::value<Real>(law, se, 0.37);
    CHECK(k > 0);
    CHECK(k >= before);
    before = k;
  }
  Lanes se(0.0);
  Lanes n(0.0);
  const Real values[lane_count] = {0, 1e-6, 0.03, 0.4, 0.86, 0.9999, 1 - 1e-12, 1};
  for (int l = 0; l < lane_count; ++l) {
    se.set(l, values[l]);
    n.set(l, 0.2 + 0.06 * l);
  }
  const Lanes k = conductivity::value<Lanes>(law, se, n);
  for (int l = 0; l < lane_count; ++l)
    CHECK(k[l] == Approx(conductivity::value<Real>(law, se[l], n[l])).epsilon(1e-13).scale(0));
  if constexpr (vadose::FactorisingConductivity<Law>) {
    const Real product = law.saturated(0.33) * law.relative(0.7);
    CHECK(conductivity::value<Real>(law, 0.7, 0.33) == Approx(product).epsilon(1e-15));
  }
}

}  // namespace

static_assert(vadose::ConductivityLaw<CubicUser>);
static_assert(!vadose::FactorisingConductivity<CubicUser>);

TEST_CASE("conductivity: laws grow with saturation, lanes equal scalars") {
  check_law(conductivity::Constant{.saturated_conductivity = 2e-5}, 2e-5);
  check_law(conductivity::KozenyCarman{.saturated_conductivity = 2e-5, .reference_porosity = 0.4},
            2e-5);
  for (const Real lambda : {0.09, 0.19, 0.36, 0.5, 0.63, 0.89}) check_law(mualem(lambda), 9.8e-4);
  check_law(conductivity::Gardner{.saturated_conductivity = 2e-5, .reference_porosity = 0.4}, 2e-5);
  check_law(
      conductivity::PowerLaw{
          .saturated_conductivity = 2e-5, .reference_porosity = 0.4, .exponent = 3.7},
      2e-5);
  check_law(conductivity::Table({.saturated_conductivity = 2e-5, .reference_porosity = 0.4},
                                {{0, 1e-9}, {0.3, 1e-4}, {0.6, 0.02}, {0.9, 0.5}, {1, 1}}),
            2e-5);
  check_law(CubicUser{}, 1e-5 * 0.4);
}

TEST_CASE("conductivity: Kozeny-Carman, Eq. (16), and its switch") {
  conductivity::KozenyCarman law{.saturated_conductivity = 9.8e-4, .reference_porosity = 0.4};
  const Real c = 9.8e-4 * 0.36 / 0.064;
  for (const Real n : {0.1, 0.35, 0.4, 0.55, 0.9})
    CHECK(law.saturated<Real>(n) == Approx(c * n * n * n / ((1 - n) * (1 - n))).epsilon(1e-14));
  law.porosity_dependent = false;
  CHECK(law.saturated<Real>(0.55) == 9.8e-4);
  conductivity::Mualem other = mualem(0.3);
  other.porosity_dependent = false;
  CHECK(other.conductivity<Real>(1, 0.7) == Approx(9.8e-4).epsilon(1e-15));
}

TEST_CASE("conductivity: Mualem's k_r at reference values") {
  struct Row {
    Real lambda, se, relative;
  };
  const Row rows[] = {
      {0.09, 0.7, 2.490796512e-06},  {0.09, 0.86, 0.0003165899447}, {0.09, 0.893, 0.0008316613877},
      {0.09, 0.95, 0.005093293133},  {0.09, 0.99, 0.03336891513},   {0.09, 0.999, 0.1110433391},
      {0.63, 0.05, 6.596288163e-06}, {0.63, 0.1, 8.477615465e-05},  {0.63, 0.5, 0.03580731054},
      {0.63, 0.95, 0.6226002448},    {0.63, 0.999, 0.9653499513},   {0.89, 0.05, 0.0002119685542},
      {0.89, 0.3, 0.02991913903},    {0.89, 0.893, 0.6813880667}};
  for (const Row& row : rows) {
    CAPTURE(row.lambda);
    CAPTURE(row.se);
    CHECK(mualem(row.lambda).relative<Real>(row.se) == Approx(row.relative).epsilon(1e-9).scale(0));
  }
  conductivity::Mualem no_floor = mualem(0.09);
  no_floor.relative_floor = 0;
  CHECK(no_floor.relative<Real>(0.3) == Approx(1.065414458e-14).epsilon(1e-9).scale(0));
  CHECK(mualem(0.09).relative<Real>(0.05) == 1e-12);
  CHECK(mualem(0.09).relative<Real>(0) == 1e-12);
  CHECK(mualem(0.09).relative<Real>(1) == 1);
}

TEST_CASE("conductivity: Mualem's k_r keeps its accuracy at both ends") {
  for (const Real lambda : {0.19, 0.36, 0.63, 0.89}) {
    conductivity::Mualem law = mualem(lambda);
    law.relative_floor = 0;
    law.linear_below = 0;
    CAPTURE(lambda);
    for (Real dry = 1e-4; dry > 1e-16; dry *= 0.07) {
      const Real near_one = 1 - dry;
      CHECK(law.relative<Real>(near_one) ==
            Approx(static_cast<Real>(formula(near_one, lambda))).epsilon(1e-13));
      // small S_e: k_r -> lambda^2 S_e^(1/2 + 2/lambda)
      const Real u = std::pow(dry, 1 / lambda);
      const Real leading = std::sqrt(dry) * lambda * lambda * u * u;
      if (leading < 1e-280) continue;
      CHECK(law.relative<Real>(dry) == Approx(leading).epsilon(2 * u + 1e-11).scale(0));
      CHECK(law.relative<Lanes>(Lanes(dry))[0] ==
            Approx(law.relative<Real>(dry)).epsilon(1e-12).scale(0));
    }
  }
}

TEST_CASE("conductivity: regularisation at saturation is a line that starts where stated") {
  const conductivity::Mualem law = mualem(0.09);
  const vadose::swrc::Tarantino curve{.a = 12, .lambda = 0.09, .unit_weight = 9810};
  const Real suction = 1e-3 / curve.suction_scale(0.4);
  CHECK(suction == Approx(49).epsilon(0.01));
  const Real limit = law.limit_of_line();
  CHECK(limit == Approx(curve.saturation<Real>(suction, 0.4)).epsilon(1e-14));
  const Real at_limit = law.relative<Real>(limit);
  CHECK(at_limit == Approx(static_cast<Real>(formula(limit, 0.09))).epsilon(1e-10));
  CHECK(at_limit == Approx(0.24).epsilon(0.05));
  for (const Real t : {0.0, 0.1, 0.5, 0.9, 1.0}) {
    const Real se = limit + t * (1 - limit);
    CHECK(law.relative<Real>(se) == Approx(at_limit + t * (1 - at_limit)).epsilon(1e-9));
    CHECK(law.relative<Lanes>(Lanes(se))[7] == Approx(law.relative<Real>(se)).epsilon(1e-13));
  }
  // Below the limit it is Mualem's law; the slope to suction is finite at s = 0.
  CHECK(law.relative<Real>(0.999) ==
        Approx(static_cast<Real>(formula(0.999, 0.09))).epsilon(1e-12));
  const auto drop = [&](Real s) {
    return (1 - law.relative<Real>(curve.saturation<Real>(s, 0.4))) / s;
  };
  CHECK(drop(1e-3) < drop(40));
  conductivity::Mualem bare = law;
  bare.linear_below = 0;
  CHECK(bare.limit_of_line() == 1);
  CHECK(1 - bare.relative<Real>(curve.saturation<Real>(0.05, 0.4)) > 0.4);  // 0.55 at 0.05 Pa
  CHECK(bare.relative<Real>(1) == 1);
  // No trace of it in the sands.
  for (const Real lambda : {0.63, 0.89}) {
    conductivity::Mualem plain = mualem(lambda);
    plain.linear_below = 0;
    for (const Real dry : {1e-2, 1e-4, 1e-6})
      CHECK(mualem(lambda).relative<Real>(1 - dry) == plain.relative<Real>(1 - dry));
  }
  // adopt() stores the limit, with the same result.
  conductivity::Mualem stored = law;
  vadose::adopt_shared(stored, vadose::SharedParameters{9810, 0.4, 0.09});
  CHECK(stored.linear_from == limit);
  CHECK(stored.relative<Real>(0.9999999) == law.relative<Real>(0.9999999));
}

TEST_CASE("conductivity: Gardner's k is exponential in suction with Gardner's retention") {
  const vadose::swrc::Gardner curve{.residual_saturation = 0.1, .alpha = 1.3, .unit_weight = 9810};
  const conductivity::Gardner law{.saturated_conductivity = 1e-5, .reference_porosity = 0.4};
  for (const Real s : {0.0, 100.0, 5e3, 4e4}) {
    const Real se = vadose::swrc::effective_saturation<Real>(curve, curve.saturation<Real>(s, 0.4));
    CHECK(law.conductivity<Real>(se, 0.4) ==
          Approx(1e-5 * std::exp(-1.3 * s / 9810)).epsilon(1e-12).scale(0));
  }
  CHECK(law.relative<Real>(0) == 1e-12);
}

TEST_CASE("conductivity: power law and table") {
  const conductivity::PowerLaw law{
      .saturated_conductivity = 1e-5, .reference_porosity = 0.4, .exponent = 3};
  CHECK(law.relative<Real>(0.2) == Approx(0.008).epsilon(1e-14));
  CHECK(law.relative<Lanes>(Lanes(0.2))[0] == Approx(0.008).epsilon(1e-14));
  CHECK(law.relative<Lanes>(Lanes(0.0))[0] == 1e-12);
  const conductivity::Table table({.saturated_conductivity = 1e-5, .reference_porosity = 0.4},
                                  {{0.1, 1e-6}, {0.5, 0.1}, {1, 1}});
  CHECK(table.relative(0.5) == Approx(0.1).epsilon(1e-15));
  CHECK(table.relative(0.02) == 1e-6);
  CHECK(table.conductivity(1, 0.4) == Approx(1e-5).epsilon(1e-14));
}

TEST_CASE("conductivity: validate names the parameter that is wrong") {
  refused(conductivity::Constant{}, "saturated_conductivity");
  refused(conductivity::Constant{.saturated_conductivity = -1}, "saturated_conductivity = -1");
  refused(conductivity::KozenyCarman{.saturated_conductivity = 1}, "reference_porosity");
  refused(conductivity::KozenyCarman{.saturated_conductivity = 1, .reference_porosity = 1},
          "reference_porosity = 1");
  refused(mualem(vadose::unset), "lambda");
  refused(mualem(1.0), "lambda = 1 outside (0, 1)");
  refused(mualem(-0.5), "lambda = -0.5");
  conductivity::Mualem law = mualem(0.5);
  law.linear_below = -1;
  refused(law, "linear_below = -1");
  law = mualem(0.5);
  law.relative_floor = 1;
  refused(law, "relative_floor = 1");
  refused(conductivity::Gardner{.saturated_conductivity = 0, .reference_porosity = 0.4},
          "saturated_conductivity = 0");
  refused(conductivity::PowerLaw{.saturated_conductivity = 1, .reference_porosity = 0.4},
          "exponent");
  refused(conductivity::Table{}, "saturated_conductivity");
  using Entries = std::vector<conductivity::Table::Entry>;
  const auto table_refused = [](const Entries& entries, const std::string& words) {
    const std::string text = error_message<SetupError>([&] {
      const conductivity::Table table({.saturated_conductivity = 1, .reference_porosity = 0.4},
                                      entries);
    });
    CAPTURE(text);
    CHECK(text.find(words) != std::string::npos);
  };
  table_refused({{0, 0.1}, {0.5, 0.05}, {1, 1}}, "entry 2");
  table_refused({{0, 0.1}, {0.5, 0.3}}, "entry 2");
  table_refused({{0, 0}, {1, 1}}, "relative = 0");
  table_refused({{-0.1, 0.1}, {1, 1}}, "effective_saturation = -0.1");
  table_refused({}, "at least 2");
}
