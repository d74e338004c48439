// SPDX-License-Identifier: MIT
#pragma once

// Shape functions: halfway between linear hats and quadratic B-splines.
//
// A basis has two or three nodes per axis (support); with three, the middle one is the nearest. Values
// must add up to 1, slopes to 0, and values times node positions to the position. A wider basis is not
// possible: blocks of the grid see one node below and two above.

#include <vadose/core/lanes.hpp>

struct MixedSpline {
  static constexpr int support = 3;
  static constexpr bool uses_half_size = false;  ///< true: a point has a domain, as GIMP's
  static constexpr const char* name = "mixed_spline";

  // u: position in cells. Writes values and slopes (per cell); returns the first node.
  template <class T>
  static T weights(const T& u, const T& /*half*/, T* w, T* dw) noexcept {
    using vadose::max;
    using vadose::select;
    const T half(0.5), zero(0.0), one(1.0);
    const T first = floor(u - half);
    const T d = u - first - one;  // from the middle node, in [-1/2, 1/2)
    const T left = half - d, right = half + d;
    const T below = max(zero - d, zero), above = max(d, zero);
    w[0] = half * (half * left * left + below);
    w[2] = half * (half * right * right + above);
    w[1] = one - w[0] - w[2];
    dw[0] = half * (select(d < zero, zero - one, zero) - left);
    dw[2] = half * (right + select(d < zero, zero, one));
    dw[1] = zero - dw[0] - dw[2];
    return first;
  }
};
