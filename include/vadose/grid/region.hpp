// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Regions of space: where soil, free water and boundary conditions are.
///
///     const auto slope = polygon({{0, 0}, {0.6, 0}, {0.4, 0.1}, {0.2, 0.3}, {0, 0.3}});
///     const auto trench = slope - box({0.1, 0.2}, {0.15, 0.3});

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <vadose/core/error.hpp>
#include <vadose/core/real.hpp>

namespace vadose {

/// Axis-aligned box [m], bounds included.
template <int Dim>
class Box {
 public:
  static_assert(Dim >= 1 && Dim <= 3, "vadose: Box has 1, 2 or 3 dimensions");

  Vec<Dim> low = Vec<Dim>::Constant(unset);   ///< smallest coordinates [m]
  Vec<Dim> high = Vec<Dim>::Constant(unset);  ///< largest coordinates [m]

  Box() = default;
  /// From the smallest and the largest coordinates [m]; nothing is checked.
  Box(const Vec<Dim>& lowest, const Vec<Dim>& highest) : low(lowest), high(highest) {}
  /// Box<2>{{x0, y0}, {x1, y1}}.
  Box(const Real (&lowest)[Dim], const Real (&highest)[Dim])
      : low(Vec<Dim>(Eigen::Map<const Vec<Dim>>(lowest))),
        high(Vec<Dim>(Eigen::Map<const Vec<Dim>>(highest))) {}

  /// All of space.
  static Box everywhere() {
    constexpr Real infinity = std::numeric_limits<Real>::infinity();
    return {Vec<Dim>(Vec<Dim>::Constant(-infinity)), Vec<Dim>(Vec<Dim>::Constant(infinity))};
  }
  /// Edge lengths [m].
  Vec<Dim> size() const { return high - low; }
  /// No point is inside (also where a bound is NaN).
  bool empty() const {
    for (int d = 0; d < Dim; ++d)
      if (!(low[d] <= high[d])) return true;
    return false;
  }
  /// x [m] is inside or on a bound; false where a coordinate is NaN.
  bool contains(const Vec<Dim>& x) const {
    for (int d = 0; d < Dim; ++d)
      if (!(x[d] >= low[d] && x[d] <= high[d])) return false;
    return true;
  }
  /// Common part; empty() where there is none.
  friend Box operator&(const Box& a, const Box& b) {
    return {Vec<Dim>(a.low.cwiseMax(b.low)), Vec<Dim>(a.high.cwiseMin(b.high))};
  }
  /// Smallest box around both; an empty one does not count.
  friend Box operator|(const Box& a, const Box& b) {
    if (a.empty()) return b;
    if (b.empty()) return a;
    return {Vec<Dim>(a.low.cwiseMin(b.low)), Vec<Dim>(a.high.cwiseMax(b.high))};
  }
};

/// A set of points, known by a membership test and a box around it. Copies share the test.
template <int Dim>
class Region {
 public:
  static constexpr int dim = Dim;

  /// Points x of `bounds` where test(x) is true. Prefer the named builders below.
  template <class Test>
  Region(Test test, const Box<Dim>& bounds)
      : test_(std::make_shared<const Holder<Test>>(std::move(test))), bounds_(bounds) {}

  /// x [m] belongs to the region.
  bool contains(const Vec<Dim>& x) const { return bounds_.contains(x) && test_->contains(x); }
  /// A box around the region; infinite where the region is unbounded, perhaps not the smallest.
  const Box<Dim>& bounding_box() const noexcept { return bounds_; }

  /// Union.
  friend Region operator|(const Region& a, const Region& b) {
    return {[a, b](const Vec<Dim>& x) { return a.contains(x) || b.contains(x); },
            a.bounds_ | b.bounds_};
  }
  /// Intersection.
  friend Region operator&(const Region& a, const Region& b) {
    return {[a, b](const Vec<Dim>& x) { return a.contains(x) && b.contains(x); },
            a.bounds_ & b.bounds_};
  }
  /// Points of a that are not in b.
  friend Region operator-(const Region& a, const Region& b) {
    return {[a, b](const Vec<Dim>& x) { return a.contains(x) && !b.contains(x); }, a.bounds_};
  }

 private:
  struct Membership {
    Membership() = default;
    Membership(const Membership&) = delete;
    Membership& operator=(const Membership&) = delete;
    virtual ~Membership() = default;
    virtual bool contains(const Vec<Dim>& x) const = 0;
  };
  template <class Test>
  struct Holder final : Membership {
    explicit Holder(Test t) : test(std::move(t)) {}
    bool contains(const Vec<Dim>& x) const override { return test(x); }
    Test test;
  };

  std::shared_ptr<const Membership> test_;
  Box<Dim> bounds_;
};

namespace check {

/// Name of coordinate `axis`: x, y, z.
inline std::string axis_name(int axis) {
  return std::string(1, static_cast<char>('x' + axis));
}

/// Every bound finite and low < high.
template <int Dim>
void proper_box(const std::string& name, const Box<Dim>& box) {
  for (int d = 0; d < Dim; ++d) {
    finite(name + " low " + axis_name(d), box.low[d], "m");
    if (!is_finite(box.high[d]) || !(box.high[d] > box.low[d]))
      fail(name + " high " + axis_name(d), box.high[d], joined({"(", text(box.low[d]), ", inf)"}),
           "m");
  }
}

}  // namespace check

namespace detail {

using Point2 = std::array<Real, 2>;

/// Twice the signed area of the triangle a b c.
inline Real turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// c lies in the box of the segment a b (used for collinear points).
inline bool between(const Point2& a, const Point2& b, const Point2& c) {
  for (std::size_t d = 0; d < 2; ++d)
    if (c[d] < std::min(a[d], b[d]) || c[d] > std::max(a[d], b[d])) return false;
  return true;
}

/// The closed segments a b and c d have a common point.
inline bool segments_meet(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const Real abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  if (((abc > 0 && abd < 0) || (abc < 0 && abd > 0)) &&
      ((cda > 0 && cdb < 0) || (cda < 0 && cdb > 0)))
    return true;
  return (abc == 0 && between(a, b, c)) || (abd == 0 && between(a, b, d)) ||
         (cda == 0 && between(c, d, a)) || (cdb == 0 && between(c, d, b));
}

/// Raises SetupError unless the vertices bound a simple polygon of positive area.
inline void check_polygon(const std::vector<Point2>& v) {
  const std::size_t n = v.size();
  if (n < 3) check::fail("polygon vertex count", static_cast<Real>(n), "[3, inf)", "-");
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t d = 0; d < 2; ++d)
      check::finite("polygon vertex " + std::to_string(i) + (d == 0 ? " x" : " y"), v[i][d], "m");
  Real area = 0, extent = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Point2& next = v[(i + 1) % n];
    area += turn(v[0], v[i], next) / 2;
    for (std::size_t d = 0; d < 2; ++d) extent = std::max(extent, std::abs(v[i][d] - v[0][d]));
    if (next == v[i])
      check::fail("polygon edge " + std::to_string(i) + " length", 0, "(0, inf)", "m");
  }
  if (!(std::abs(area) > 1e-12 * extent * extent))
    check::fail("polygon area", std::abs(area), "(0, inf)", "m2");
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t after = (i + 1) % n;
    if (turn(v[i], v[after], v[(i + 2) % n]) == 0 && between(v[i], v[after], v[(i + 2) % n]))
      throw SetupError("polygon edges " + std::to_string(i) + " and " + std::to_string(after) +
                       " overlap [m], allowed: a simple polygon");
    for (std::size_t j = i + 2; j < n; ++j) {
      if ((j + 1) % n == i) continue;  // neighbours share a vertex
      if (segments_meet(v[i], v[after], v[j], v[(j + 1) % n]))
        throw SetupError("polygon edges " + std::to_string(i) + " and " + std::to_string(j) +
                         " intersect [m], allowed: a simple polygon");
    }
  }
}

/// Even-odd rule. An edge is evaluated upwards whatever its sense, so that of two polygons with a
/// common edge exactly one holds a point near it.
inline bool inside_polygon(const std::vector<Point2>& v, Real x, Real y) {
  bool inside = false;
  for (std::size_t i = 0, j = v.size() - 1; i < v.size(); j = i++) {
    if ((v[i][1] > y) == (v[j][1] > y)) continue;
    const Point2& low = v[i][1] < v[j][1] ? v[i] : v[j];
    const Point2& high = v[i][1] < v[j][1] ? v[j] : v[i];
    if (x < low[0] + (y - low[1]) / (high[1] - low[1]) * (high[0] - low[0])) inside = !inside;
  }
  return inside;
}

template <int Dim>
Vec<Dim> to_vec(const Real (&values)[Dim]) {
  return Vec<Dim>(Eigen::Map<const Vec<Dim>>(values));
}

}  // namespace detail

/// Axis-aligned box, bounds included; box({x0}, {x1}) is an interval. Refuses low >= high.
template <int Dim>
Region<Dim> box(const Vec<Dim>& low, const Vec<Dim>& high) {
  const Box<Dim> bounds(low, high);
  check::proper_box("box", bounds);
  return {[](const Vec<Dim>&) { return true; }, bounds};
}
/// The same from lists of numbers: box({0.0, 0.0}, {1.0, 2.0}).
template <int Dim>
Region<Dim> box(const Real (&low)[Dim], const Real (&high)[Dim]) {
  return box<Dim>(detail::to_vec(low), detail::to_vec(high));
}

/// Simple polygon by its vertices [m] in either sense of rotation, even-odd rule. Refuses fewer
/// than 3 vertices, repeated vertices, edges that meet, zero area and values that are not finite.
inline Region<2> polygon(const std::vector<std::array<Real, 2>>& vertices) {
  detail::check_polygon(vertices);
  Box<2> bounds({vertices[0][0], vertices[0][1]}, {vertices[0][0], vertices[0][1]});
  for (const auto& v : vertices) bounds = bounds | Box<2>({v[0], v[1]}, {v[0], v[1]});
  return {[vertices](const Vec<2>& x) { return detail::inside_polygon(vertices, x[0], x[1]); },
          bounds};
}

/// Points behind a plane: (x - point) . normal <= 0. `point` [m]; `normal` of any length > 0 points
/// out of the region. Unbounded: intersect it with a bounded region before soil is put there.
template <int Dim>
Region<Dim> half_space(const Vec<Dim>& point, const Vec<Dim>& normal) {
  for (int d = 0; d < Dim; ++d) {
    check::finite("half_space point " + check::axis_name(d), point[d], "m");
    check::finite("half_space normal " + check::axis_name(d), normal[d], "-");
  }
  check::positive("half_space normal length", normal.norm(), "-");
  return {[point, normal](const Vec<Dim>& x) { return (x - point).dot(normal) <= 0; },
          Box<Dim>::everywhere()};
}
/// The same from lists of numbers.
template <int Dim>
Region<Dim> half_space(const Real (&point)[Dim], const Real (&normal)[Dim]) {
  return half_space<Dim>(detail::to_vec(point), detail::to_vec(normal));
}

/// Points of `bounds` where function(x) <= 0; a value that is not a number counts as outside.
template <int Dim, class Function>
Region<Dim> level_set(Function function, const Box<Dim>& bounds) {
  check::proper_box("level_set box", bounds);
  return {[f = std::move(function)](const Vec<Dim>& x) { return f(x) <= 0; }, bounds};
}

/// Points of `bounds` where test(x) is true.
template <int Dim, class Test>
Region<Dim> predicate(Test test, const Box<Dim>& bounds) {
  check::proper_box("predicate box", bounds);
  return {[f = std::move(test)](const Vec<Dim>& x) { return static_cast<bool>(f(x)); }, bounds};
}

}  // namespace vadose
