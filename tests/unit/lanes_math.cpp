// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include <vadose/core/lanes_math.hpp>

namespace {

using vadose::lane_count;
using vadose::Lanes;

/// Distance of a computed value from the exact one in units of the last place of the exact one.
double ulps(double value, long double exact) {
  const double rounded = static_cast<double>(exact);
  int exponent = 0;
  std::frexp(rounded, &exponent);
  const double ulp = std::ldexp(1.0, exponent - 53);
  return static_cast<double>(std::fabs(static_cast<long double>(value) - exact) /
                             static_cast<long double>(ulp));
}

/// Largest error in ulp over a stream of arguments, eight at a time.
template <class LaneFunction, class ExactFunction, class Next>
double worst_ulps(LaneFunction f, ExactFunction exact, Next next, int batches) {
  double worst = 0;
  for (int b = 0; b < batches; ++b) {
    Lanes x(0.0);
    for (int l = 0; l < lane_count; ++l) x.set(l, next());
    const Lanes y = f(x);
    for (int l = 0; l < lane_count; ++l)
      worst = std::max(worst, ulps(y[l], exact(static_cast<long double>(x[l]))));
  }
  return worst;
}

/// Evenly spaced numbers.
struct Sweep {
  double x, step;
  double operator()() {
    x += step;
    return x;
  }
};

/// Uniform numbers.
struct Random {
  std::mt19937_64 engine{20240611u};
  std::uniform_real_distribution<double> draw;
  Random(double low, double high) : draw(low, high) {}
  double operator()() { return draw(engine); }
};

/// Random bit patterns of positive normal numbers: every binade equally often.
struct RandomBits {
  std::mt19937_64 engine{77u};
  double operator()() {
    const std::uint64_t exponent = 1 + engine() % 2046;
    return std::bit_cast<double>((exponent << 52) | (engine() >> 12));
  }
};

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

const auto lane_exp = [](const Lanes& x) { return exp(x); };
const auto lane_log = [](const Lanes& x) { return log(x); };
const auto lane_expm1 = [](const Lanes& x) { return expm1(x); };
const auto lane_log1p = [](const Lanes& x) { return log1p(x); };
const auto exact_exp = [](long double x) { return std::exp(x); };
const auto exact_log = [](long double x) { return std::log(x); };
const auto exact_expm1 = [](long double x) { return std::expm1(x); };
const auto exact_log1p = [](long double x) { return std::log1p(x); };

}  // namespace

TEST_CASE("lanes math: exp within 2 ulp over the normal range") {
  CHECK(worst_ulps(lane_exp, exact_exp, Sweep{-708.39, 1418.1 / 80000}, 10000) <= 2.0);
  CHECK(worst_ulps(lane_exp, exact_exp, Sweep{-1.0, 2.0 / 80000}, 10000) <= 2.0);
  CHECK(worst_ulps(lane_exp, exact_exp, Random(-708.3, 709.7), 10000) <= 2.0);
}

TEST_CASE("lanes math: log within 2 ulp over the normal range and close to 1") {
  CHECK(worst_ulps(lane_log, exact_log, RandomBits{}, 20000) <= 2.0);
  CHECK(worst_ulps(lane_log, exact_log, Sweep{0.4, 2.0 / 80000}, 10000) <= 2.0);
  CHECK(worst_ulps(lane_log, exact_log, Sweep{1 - 1e-6, 1.3e-11}, 10000) <= 2.0);
}

TEST_CASE("lanes math: exp_of_small is exp, within 2 ulp on both sides of where its series ends") {
  const auto lanes = [](const Lanes& x) { return vadose::exp_of_small(x); };
  const auto exact = [](long double x) { return std::exp(x); };
  CHECK(worst_ulps(lanes, exact, Random(-1e-3, 1e-3), 10000) <= 1);
  CHECK(worst_ulps(lanes, exact, Random(-2e-3, 2e-3), 10000) <= 2);
  CHECK(worst_ulps(lanes, exact, Random(-700, 709), 10000) <= 2);
  CHECK(vadose::exp_of_small(vadose::Real(1e-4)) == doctest::Approx(std::exp(1e-4)).epsilon(3e-16));
  CHECK(vadose::exp_of_small(vadose::Real(2)) == std::exp(vadose::Real(2)));
  CHECK(vadose::exp_of_small(vadose::Real(0)) == 1);
  CHECK(std::isnan(vadose::exp_of_small(std::nan(""))));
}

TEST_CASE("lanes math: exp, expm1 and log for laws are those of any number within their range") {
  const auto exp_in = [](const Lanes& x) { return vadose::exp_in_range(x); };
  const auto less_one = [](const Lanes& x) { return vadose::exponentials_in_range(x).less_one; };
  const auto log_in = [](const Lanes& x) { return vadose::log_in_range(x); };
  CHECK(worst_ulps(exp_in, exact_exp, Random(-700, 700), 10000) <= 2);
  CHECK(worst_ulps(exp_in, exact_exp, Random(-1, 1), 10000) <= 2);
  for (const double range : {700.0, 40.0, 1.1, 1e-5})
    CHECK(worst_ulps(less_one, exact_expm1, Random(-range, range), 10000) <= 2.5);
  Random exponent(-300, 300);
  CHECK(worst_ulps(
            log_in, exact_log, [&] { return std::pow(10.0, exponent()); }, 10000) <= 2);
  CHECK(worst_ulps(log_in, exact_log, Sweep{0.4, 2.0 / 80000}, 10000) <= 2);
  CHECK(log_in(Lanes(1.0))[0] == 0);
  CHECK(exp_in(Lanes(0.0))[0] == 1);
  CHECK(less_one(Lanes(0.0))[0] == 0);
  CHECK(std::isnan(exp_in(Lanes(not_a_number))[0]));
  CHECK(std::isnan(less_one(Lanes(not_a_number))[0]));
  CHECK(std::isnan(log_in(Lanes(not_a_number))[0]));
  CHECK(vadose::exp_in_range(2.0) == std::exp(2.0));
  CHECK(vadose::exponentials_in_range(2.0).less_one == std::expm1(2.0));
  CHECK(vadose::log_in_range(2.0) == std::log(2.0));
}

TEST_CASE("lanes math: expm1 within 2.5 ulp and log1p within 2 ulp, small arguments included") {
  CHECK(worst_ulps(lane_expm1, exact_expm1, Random(-40, 40), 10000) <= 2.5);
  CHECK(worst_ulps(lane_expm1, exact_expm1, Random(-1.1, 1.1), 10000) <= 2.5);
  CHECK(worst_ulps(lane_expm1, exact_expm1, Random(-1e-5, 1e-5), 10000) <= 2.5);
  CHECK(worst_ulps(lane_expm1, exact_expm1, Random(40, 708.9), 2000) <= 2.5);
  CHECK(worst_ulps(lane_log1p, exact_log1p, Random(-0.99999, 2), 10000) <= 2.0);
  CHECK(worst_ulps(lane_log1p, exact_log1p, Random(-1e-5, 1e-5), 10000) <= 2.0);
  CHECK(worst_ulps(lane_log1p, exact_log1p, RandomBits{}, 10000) <= 2.0);
}

TEST_CASE("lanes math: pow is accurate whatever |y log x|") {
  Random log_x(-40, 40), exponent(-60, 60);
  double worst = 0, worst_far = 0;
  for (int b = 0; b < 30000; ++b) {
    Lanes x(1.0), y(1.0);
    for (int l = 0; l < lane_count; ++l) {
      x.set(l, std::exp(log_x() * (l % 2 == 0 ? 1.0 : 0.01)));
      y.set(l, exponent() * (l % 3 == 0 ? 1.0 : 0.03));
    }
    const Lanes r = pow(x, y);
    for (int l = 0; l < lane_count; ++l) {
      const long double exact = std::pow(static_cast<long double>(x[l]), y[l]);
      const double size = std::fabs(y[l] * std::log(x[l]));
      if (size >= 700) continue;
      const double error = static_cast<double>(std::fabs(r[l] / exact - 1.0L));
      (size < 50 ? worst : worst_far) = std::max(size < 50 ? worst : worst_far, error);
    }
  }
  CHECK(worst <= 1e-15);  // the contract is 1e-14
  CHECK(worst_far <= 1e-14);
  const Lanes r = pow(Lanes(2.5), -3.25);
  CHECK(r[5] == doctest::Approx(std::pow(2.5, -3.25)).epsilon(1e-15));
}

TEST_CASE("lanes math: limits and special values") {
  const auto value = [](double x, auto f) { return f(Lanes(x))[3]; };
  CHECK(value(0.0, lane_exp) == 1.0);
  CHECK(value(-infinite, lane_exp) == 0.0);
  CHECK(value(-1e300, lane_exp) == 0.0);
  CHECK(value(-709.0, lane_exp) == 0.0);
  CHECK(value(709.78, lane_exp) == doctest::Approx(std::exp(709.78)).epsilon(1e-13));
  CHECK(value(710.0, lane_exp) == infinite);
  CHECK(value(infinite, lane_exp) == infinite);
  CHECK(std::isnan(value(not_a_number, lane_exp)));

  CHECK(value(1.0, lane_log) == 0.0);
  CHECK(value(0.0, lane_log) == -infinite);
  CHECK(value(infinite, lane_log) == infinite);
  CHECK(std::isnan(value(-1.0, lane_log)));
  CHECK(std::isnan(value(-infinite, lane_log)));
  CHECK(std::isnan(value(not_a_number, lane_log)));

  CHECK(value(0.0, lane_expm1) == 0.0);
  CHECK(value(-infinite, lane_expm1) == -1.0);
  CHECK(value(infinite, lane_expm1) == infinite);
  CHECK(std::isnan(value(not_a_number, lane_expm1)));
  CHECK(value(1e-200, lane_expm1) == 1e-200);

  CHECK(value(0.0, lane_log1p) == 0.0);
  CHECK(value(-1.0, lane_log1p) == -infinite);
  CHECK(value(1e-200, lane_log1p) == 1e-200);
  CHECK(value(-1e-200, lane_log1p) == -1e-200);
  CHECK(value(infinite, lane_log1p) == infinite);
  CHECK(std::isnan(value(-2.0, lane_log1p)));
  CHECK(std::isnan(value(not_a_number, lane_log1p)));

  const auto raised = [](double x, double y) { return pow(Lanes(x), y)[6]; };
  CHECK(raised(0.0, 0.3) == 0.0);
  CHECK(raised(0.0, 0.0) == 1.0);
  CHECK(raised(0.0, -2.0) == infinite);
  CHECK(raised(1.0, 1e200) == 1.0);
  CHECK(raised(1.0 + 1e-15, -1e200) == 0.0);
  CHECK(raised(0.9, -infinite) == infinite);
  CHECK(raised(3.0, 0.0) == 1.0);
  CHECK(raised(infinite, -0.5) == 0.0);
  CHECK(raised(infinite, 0.5) == infinite);
  CHECK(raised(10.0, 400.0) == infinite);
  CHECK(raised(10.0, -400.0) == 0.0);
  CHECK(std::isnan(raised(-2.0, 0.5)));
  CHECK(std::isnan(raised(not_a_number, 0.5)));
  CHECK(std::isnan(raised(2.0, not_a_number)));
}

TEST_CASE("lanes math: lanes do not influence each other") {
  Lanes x(0.0);
  const double values[lane_count] = {-infinite, -3.0, 0.0, 1e-9, 2.5, 800.0, not_a_number, -700.0};
  for (int l = 0; l < lane_count; ++l) x.set(l, values[l]);
  const Lanes y = exp(x);
  for (int l = 0; l < lane_count; ++l) {
    if (l == 6) {
      CHECK(std::isnan(y[l]));
    } else {
      CHECK(y[l] == exp(Lanes(values[l]))[0]);
    }
  }
}
