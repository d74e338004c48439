// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <vadose/core/error.hpp>
#include <vadose/core/real.hpp>

namespace vadose {

/// Monotone cubic interpolation of (x, y) pairs (Fritsch and Carlson 1980, slopes of Fritsch and
/// Butland 1984): passes through the entries, is once continuously differentiable and never
/// overshoots. Constant outside the entries. Real only; built at set-up.
class MonotoneTable {
 public:
  /// Value and derivative of the interpolant.
  struct Point {
    Real value;  ///< interpolated y
    Real slope;  ///< dy/dx
  };

  MonotoneTable() = default;

  /// x strictly increasing; y monotone, in the direction given by its first and last entry.
  /// Throws SetupError that names the table and the entry (counted from 1).
  MonotoneTable(const std::string& name, std::vector<Real> x, std::vector<Real> y)
      : x_(std::move(x)), y_(std::move(y)) {
    check_entries(name);
    set_slopes();
  }

  bool empty() const noexcept { return x_.empty(); }       ///< no entries
  std::size_t size() const noexcept { return x_.size(); }  ///< number of entries
  Real front() const noexcept { return x_.front(); }       ///< first x
  Real back() const noexcept { return x_.back(); }         ///< last x

  /// Interpolant at x.
  Point at(Real x) const noexcept {
    if (x <= x_.front()) return {y_.front(), 0};
    if (x >= x_.back()) return {y_.back(), 0};
    const auto next = std::upper_bound(x_.begin(), x_.end(), x);
    return inside(static_cast<std::size_t>(next - x_.begin()) - 1, x);
  }

  /// Smallest x at which the interpolant reaches y on the way from the first entry to the last;
  /// the end entries' x beyond the range of y.
  Real inverse(Real y) const noexcept {
    const bool falling = y_.back() < y_.front();
    const auto reached = [&](Real value) { return falling ? value <= y : value >= y; };
    if (reached(y_.front())) return x_.front();
    if (!reached(y_.back())) return x_.back();
    std::size_t i = 0;
    while (!reached(y_[i + 1])) ++i;
    Real low = x_[i];
    Real high = x_[i + 1];
    for (int k = 0; k < 100; ++k) {
      const Real middle = low + (high - low) / 2;
      if (!(middle > low && middle < high)) break;
      (reached(inside(i, middle).value) ? high : low) = middle;
    }
    return high;
  }

 private:
  static void refuse(const std::string& name, std::size_t entry, const std::string& what) {
    throw SetupError(name + ": entry " + std::to_string(entry + 1) + ": " + what);
  }

  void check_entries(const std::string& name) const {
    if (x_.size() != y_.size()) throw SetupError(name + ": as many abscissae as values needed");
    if (x_.size() < 2) throw SetupError(name + ": at least 2 entries needed");
    for (std::size_t i = 0; i < x_.size(); ++i)
      if (!is_finite(x_[i]) || !is_finite(y_[i])) refuse(name, i, "not finite");
    const bool falling = y_.back() < y_.front();
    for (std::size_t i = 1; i < x_.size(); ++i) {
      if (!(x_[i] > x_[i - 1])) refuse(name, i, "abscissa not above that of the entry before");
      if (falling ? y_[i] > y_[i - 1] : y_[i] < y_[i - 1])
        refuse(name, i,
               "value " + check::text(y_[i]) + " after " + check::text(y_[i - 1]) +
                   " breaks the monotone order");
    }
  }

  void set_slopes() {
    const std::size_t n = x_.size();
    slope_.assign(n, 0);
    if (n == 2) {
      slope_[0] = slope_[1] = secant(0);
      return;
    }
    for (std::size_t i = 1; i + 1 < n; ++i) slope_[i] = inner_slope(i);
    slope_[0] = end_slope(x_[1] - x_[0], x_[2] - x_[1], secant(0), secant(1));
    slope_[n - 1] =
        end_slope(x_[n - 1] - x_[n - 2], x_[n - 2] - x_[n - 3], secant(n - 2), secant(n - 3));
  }

  Real secant(std::size_t i) const noexcept { return (y_[i + 1] - y_[i]) / (x_[i + 1] - x_[i]); }

  /// Weighted harmonic mean of the neighbouring secants; 0 where one of them is.
  Real inner_slope(std::size_t i) const noexcept {
    const Real left = secant(i - 1);
    const Real right = secant(i);
    if (!(left * right > 0)) return 0;
    const Real h_left = x_[i] - x_[i - 1];
    const Real h_right = x_[i + 1] - x_[i];
    const Real w_left = 2 * h_right + h_left;
    const Real w_right = h_right + 2 * h_left;
    return (w_left + w_right) / (w_left / left + w_right / right);
  }

  /// Three-point slope at an end, limited so that the interpolant stays monotone.
  static Real end_slope(Real h, Real h_next, Real secant_here, Real secant_next) noexcept {
    const Real slope = ((2 * h + h_next) * secant_here - h * secant_next) / (h + h_next);
    if (slope * secant_here <= 0) return 0;
    return std::fabs(slope) > 3 * std::fabs(secant_here) ? 3 * secant_here : slope;
  }

  Point inside(std::size_t i, Real x) const noexcept {
    const Real h = x_[i + 1] - x_[i];
    const Real t = (x - x_[i]) / h;
    const Real rise = y_[i + 1] - y_[i];
    const Real a = h * slope_[i] - rise;
    const Real b = rise - h * slope_[i + 1];
    const Real value = y_[i] + t * (rise + (1 - t) * (a * (1 - t) + b * t));
    const Real slope = (rise + (1 - 2 * t) * (a * (1 - t) + b * t) + t * (1 - t) * (b - a)) / h;
    const auto [low, high] = std::minmax(y_[i], y_[i + 1]);
    return {std::clamp(value, low, high), slope};
  }

  std::vector<Real> x_;
  std::vector<Real> y_;
  std::vector<Real> slope_;
};

}  // namespace vadose
