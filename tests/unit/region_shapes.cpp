// SPDX-License-Identifier: MIT
// Regions: membership, boxes around them, set operations, refused input.

#include <doctest/doctest.h>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <vadose/grid/region.hpp>

#include "../error_message.hpp"

namespace {

using vadose::Box;
using vadose::Real;
using vadose::Region;
using vadose::SetupError;
using vadose::Vec;
using vadose_test::error_message;

constexpr Real nan_value = std::numeric_limits<Real>::quiet_NaN();
constexpr Real infinity = std::numeric_limits<Real>::infinity();

/// Area of a region inside the unit square, by n x n samples.
Real sampled_area(const Region<2>& region, int n) {
  int inside = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) inside += region.contains(Vec<2>((i + 0.5) / n, (j + 0.5) / n));
  return Real(inside) / n / n;
}

bool mentions(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    if (text.find(part) == std::string::npos) return false;
  return true;
}

}  // namespace

TEST_CASE("region: boxes hold their bounds in one, two and three dimensions") {
  const auto interval = vadose::box({1.0}, {3.0});
  CHECK(interval.contains(Vec<1>(1.0)));
  CHECK(interval.contains(Vec<1>(3.0)));
  CHECK_FALSE(interval.contains(Vec<1>(0.999)));
  CHECK_FALSE(interval.contains(Vec<1>(nan_value)));

  const auto rectangle = vadose::box({0, 0}, {2, 1});
  CHECK(rectangle.contains(Vec<2>(2, 1)));
  CHECK_FALSE(rectangle.contains(Vec<2>(2, 1.001)));
  CHECK_FALSE(rectangle.contains(Vec<2>(1, nan_value)));

  const auto brick = vadose::box({0, 0, 0}, {1, 2, 3});
  CHECK(brick.contains(Vec<3>(0.5, 1.5, 2.5)));
  CHECK_FALSE(brick.contains(Vec<3>(0.5, 1.5, 3.5)));
  CHECK(brick.bounding_box().high == Vec<3>(1, 2, 3));
}

TEST_CASE("region: polygons follow the even-odd rule") {
  // the slope of a centrifuge test
  const auto slope =
      vadose::polygon({{0, 0}, {0.6, 0}, {0.6, 0.1}, {0.4, 0.1}, {0.2, 0.3}, {0, 0.3}});
  CHECK(slope.contains(Vec<2>(0.3, 0.19)));
  CHECK_FALSE(slope.contains(Vec<2>(0.3, 0.21)));
  CHECK_FALSE(slope.contains(Vec<2>(0.5, 0.11)));
  CHECK(slope.bounding_box().low == Vec<2>(0, 0));
  CHECK(slope.bounding_box().high == Vec<2>(0.6, 0.3));
  const Real exact = 0.6 * 0.1 + 0.2 * 0.2 + 0.2 * 0.2 / 2;
  CHECK(sampled_area(slope, 400) == doctest::Approx(exact).epsilon(2e-3));

  // the sense of rotation does not matter
  const auto back =
      vadose::polygon({{0, 0.3}, {0.2, 0.3}, {0.4, 0.1}, {0.6, 0.1}, {0.6, 0}, {0, 0}});
  CHECK(sampled_area(back, 400) == sampled_area(slope, 400));

  // not convex: a U
  const auto u = vadose::polygon(
      {{0, 0}, {0.9, 0}, {0.9, 0.9}, {0.6, 0.9}, {0.6, 0.3}, {0.3, 0.3}, {0.3, 0.9}, {0, 0.9}});
  CHECK_FALSE(u.contains(Vec<2>(0.45, 0.6)));
  CHECK(u.contains(Vec<2>(0.45, 0.2)));
  CHECK(sampled_area(u, 300) == doctest::Approx(0.81 - 0.18).epsilon(1e-2));
}

TEST_CASE("region: polygons that share an edge share no point and leave no gap") {
  const auto left = vadose::polygon({{0, 0}, {0.7, 0}, {0.3, 1}, {0, 1}});
  const auto right = vadose::polygon({{0.7, 0}, {1, 0}, {1, 1}, {0.3, 1}});
  int both = 0, none = 0;
  for (int i = 0; i <= 1000; ++i) {
    // on the common edge, and beside it
    const Real y = (i + 0.5) / 1001;
    for (const Real shift : {0.0, 1e-15, -1e-15}) {
      const Vec<2> x(0.7 - 0.4 * y + shift, y);
      const int count = left.contains(x) + right.contains(x);
      both += count == 2;
      none += count == 0;
    }
  }
  CHECK(both == 0);
  CHECK(none == 0);
}

TEST_CASE("region: half spaces, level sets and predicates") {
  const auto below = vadose::half_space({0.0, 0.5}, {0.0, 2.0});
  CHECK(below.contains(Vec<2>(1e9, 0.5)));
  CHECK_FALSE(below.contains(Vec<2>(0, 0.5000001)));
  CHECK(below.bounding_box().high[1] == infinity);

  const auto disc =
      vadose::level_set([](const Vec<2>& x) { return (x - Vec<2>(0.5, 0.5)).norm() - 0.25; },
                        Box<2>{{0.25, 0.25}, {0.75, 0.75}});
  CHECK(sampled_area(disc, 500) == doctest::Approx(std::numbers::pi / 16).epsilon(2e-3));

  const auto stripes = vadose::predicate([](const Vec<2>& x) { return std::fmod(x[0], 0.2) < 0.1; },
                                         Box<2>{{0.0, 0.0}, {1.0, 1.0}});
  CHECK(sampled_area(stripes, 400) == doctest::Approx(0.5).epsilon(1e-2));

  // a level that is not a number is outside
  const auto broken =
      vadose::level_set([](const Vec<1>&) { return nan_value; }, Box<1>{{0.0}, {1.0}});
  CHECK_FALSE(broken.contains(Vec<1>(0.5)));
}

TEST_CASE("region: union, intersection and difference with their boxes") {
  const auto a = vadose::box({0.0, 0.0}, {0.6, 1.0});
  const auto b = vadose::box({0.4, 0.0}, {1.0, 0.5});
  CHECK(sampled_area(a | b, 200) == doctest::Approx(0.6 + 0.3 - 0.1));
  CHECK(sampled_area(a & b, 200) == doctest::Approx(0.1));
  CHECK(sampled_area(a - b, 200) == doctest::Approx(0.5));
  CHECK((a | b).bounding_box().high == Vec<2>(1.0, 1.0));
  CHECK((a & b).bounding_box().low == Vec<2>(0.4, 0.0));
  CHECK((a & b).bounding_box().high == Vec<2>(0.6, 0.5));
  CHECK((a - b).bounding_box().high == a.bounding_box().high);
  // De Morgan on the unit square, and the copy keeps what it was made of
  const auto unit = vadose::box({0.0, 0.0}, {1.0, 1.0});
  CHECK(sampled_area(unit - (a | b), 200) == sampled_area((unit - a) & (unit - b), 200));
  // an empty intersection holds nothing and does not enlarge a union
  const auto apart = vadose::box({0.0, 0.0}, {0.1, 0.1}) & vadose::box({5.0, 5.0}, {6.0, 6.0});
  CHECK(apart.bounding_box().empty());
  CHECK((apart | a).bounding_box().high == a.bounding_box().high);
  CHECK(sampled_area(apart, 50) == 0);
  // bounded again after intersection with a half space
  const auto cut = a & vadose::half_space({0.0, 0.25}, {0.0, 1.0});
  CHECK(cut.bounding_box().high == Vec<2>(0.6, 1.0));
  CHECK(sampled_area(cut, 200) == doctest::Approx(0.15));
}

TEST_CASE("region: wrong input is refused with name, value, range and unit") {
  struct Wrong {
    std::vector<std::string> parts;
    void (*build)();
  };
  const Wrong table[] = {
      {{"box high y", "= 1 ", "(1, inf)", "[m]"},
       [] {
         vadose::box({0.0, 1.0}, {1.0, 1.0});
       }},
      {{"box high x", "= -1 ", "(0, inf)", "[m]"}, [] { vadose::box({0.0}, {-1.0}); }},
      {{"box low z", "nan", "[m]"},
       [] {
         vadose::box({0, 0, nan_value}, {1, 1, 1});
       }},
      {{"box high x", "inf", "[m]"}, [] { vadose::box({0.0}, {infinity}); }},
      {{"polygon vertex count", "= 2 ", "[3, inf)", "[-]"},
       [] {
         vadose::polygon({{0, 0}, {1, 1}});
       }},
      {{"polygon vertex count", "= 0 "}, [] { vadose::polygon({}); }},
      {{"polygon vertex 1 y", "nan", "[m]"},
       [] {
         vadose::polygon({{0, 0}, {1, nan_value}, {1, 1}});
       }},
      {{"polygon vertex 2 x", "inf", "[m]"},
       [] {
         vadose::polygon({{0, 0}, {1, 0}, {infinity, 1}});
       }},
      {{"polygon area", "= 0 ", "(0, inf)", "[m2]"},
       [] {
         vadose::polygon({{0, 0}, {1, 1}, {2, 2}});
       }},
      {{"polygon edge 1 length", "= 0 ", "(0, inf)", "[m]"},
       [] {
         vadose::polygon({{0, 0}, {1, 0}, {1, 0}, {0, 1}});
       }},
      // a bow tie of unequal wings
      {{"polygon edges 0 and 2 intersect", "simple polygon"},
       [] {
         vadose::polygon({{0, 0}, {2, 2}, {2, 0}, {0, 1}});
       }},
      // a vertex on another edge
      {{"polygon edges", "intersect", "simple polygon"},
       [] {
         vadose::polygon({{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}});
       }},
      // a spike
      {{"polygon edges", "overlap", "simple polygon"},
       [] {
         vadose::polygon({{0, 0}, {3, 0}, {2, 0}, {2, 2}, {0, 2}});
       }},
      {{"half_space normal length", "= 0 ", "(0, inf)"},
       [] {
         vadose::half_space({0.0, 0.0}, {0.0, 0.0});
       }},
      {{"half_space point y", "nan", "[m]"},
       [] {
         vadose::half_space({0.0, nan_value}, {0.0, 1.0});
       }},
      {{"level_set box high x", "= 0 ", "(0, inf)", "[m]"},
       [] {
         vadose::level_set([](const Vec<1>&) { return 0.0; }, Box<1>{{0.0}, {0.0}});
       }},
      {{"predicate box low x", "nan", "[m]"},
       [] { vadose::predicate([](const Vec<1>&) { return true; }, Box<1>{}); }},
  };
  for (const Wrong& wrong : table) {
    const std::string message = error_message<SetupError>(wrong.build);
    CAPTURE(message);
    CAPTURE(wrong.parts.front());
    CHECK(mentions(message, wrong.parts));
  }
}
