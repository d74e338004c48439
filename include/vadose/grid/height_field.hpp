// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Ground given by heights on a regular grid, and the region below it.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <vadose/core/error.hpp>
#include <vadose/grid/region.hpp>

namespace vadose {

/// Heights z [m] at the centres of square cells, bilinear between them, constant along the normal of
/// the border beyond the outermost centres. x points east, y north.
class HeightField {
 public:
  /// `heights` row by row from south to north, each from west to east; (x, y) is the centre of the
  /// first one [m]. Raises SetupError on a size that does not fit and on heights that are not finite.
  HeightField(int columns, int rows, Real x, Real y, Real cell_size, std::vector<Real> heights)
      : columns_(columns),
        rows_(rows),
        x_(x),
        y_(y),
        cell_size_(cell_size),
        heights_(std::move(heights)) {
    check::in_context("height field", [&] {
      check::within("columns", columns, 1, 1e6, "-");
      check::within("rows", rows, 1, 1e6, "-");
      check::finite("x of the first height", x, "m");
      check::finite("y of the first height", y, "m");
      check::positive("cell_size", cell_size, "m");
      const auto size = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
      if (heights_.size() != size)
        check::fail("number of heights", static_cast<Real>(heights_.size()),
                    check::joined({"{", std::to_string(size), "}"}), "-");
      for (std::size_t i = 0; i < size; ++i) check::finite(place(i), heights_[i], "m");
    });
  }

  int columns() const noexcept { return columns_; }       ///< from west to east
  int rows() const noexcept { return rows_; }             ///< from south to north
  Real cell_size() const noexcept { return cell_size_; }  ///< [m]
  /// Area covered by the cells [m].
  Box<2> extent() const {
    const Real half = 0.5 * cell_size_;
    return {{x_ - half, y_ - half},
            {x_ + (columns_ - 0.5) * cell_size_, y_ + (rows_ - 0.5) * cell_size_}};
  }
  Real lowest() const { return *std::min_element(heights_.begin(), heights_.end()); }   ///< [m]
  Real highest() const { return *std::max_element(heights_.begin(), heights_.end()); }  ///< [m]

  /// Height of the ground [m] at (x, y) [m].
  Real operator()(Real x, Real y) const noexcept {
    const Between along = between(x, x_, columns_), up = between(y, y_, rows_);
    const Real south = mix(at(along.first, up.first), at(along.last, up.first), along.part);
    const Real north = mix(at(along.first, up.last), at(along.last, up.last), along.part);
    return mix(south, north, up.part);
  }

 private:
  /// Two neighbouring centres and the way from the first to the last [-].
  struct Between {
    int first, last;
    Real part;
  };
  Between between(Real x, Real start, int count) const noexcept {
    const Real place = std::clamp((x - start) / cell_size_, Real(0), Real(count - 1));
    const int first = std::min(static_cast<int>(place), std::max(count - 2, 0));
    return {first, std::min(first + 1, count - 1), place - first};
  }
  static Real mix(Real a, Real b, Real part) noexcept { return (1 - part) * a + part * b; }
  Real at(int column, int row) const noexcept {
    return heights_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                    static_cast<std::size_t>(column)];
  }
  std::string place(std::size_t i) const {
    const auto columns = static_cast<std::size_t>(columns_);
    return check::joined({"height of column ", std::to_string(i % columns), ", row ",
                          std::to_string(i / columns), " from the south"});
  }

  int columns_, rows_;
  Real x_, y_, cell_size_;
  std::vector<Real> heights_;
};

/// Part of `box` [m] that lies below the ground. The field must cover the box; refuses one that does
/// not, and ground above the box.
inline Region<3> below(HeightField ground, const Box<3>& box) {
  check::proper_box("box", box);
  const Box<2> extent = ground.extent();
  for (int d = 0; d < 2; ++d) {
    const std::string range = check::joined({"[", check::text(extent.low[d]), ", ",
                                             check::text(extent.high[d]), "] of the height field"});
    const Real slack = 1e-9 * (extent.high[d] - extent.low[d]);
    if (!(box.low[d] >= extent.low[d] - slack))
      check::fail("box low " + check::axis_name(d), box.low[d], range, "m");
    if (!(box.high[d] <= extent.high[d] + slack))
      check::fail("box high " + check::axis_name(d), box.high[d], range, "m");
  }
  return {[ground = std::move(ground)](const Vec<3>& x) { return x[2] <= ground(x[0], x[1]); },
          box};
}

}  // namespace vadose
