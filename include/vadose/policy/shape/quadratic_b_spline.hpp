// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/core/lanes.hpp>

namespace vadose::shape {

/// Quadratic B-splines centred on the nodes, three nodes per axis. At a wall the function of the
/// node outside is folded onto the two nodes inside (see kernel/stencil.hpp), which keeps linear
/// reproduction and makes the wall node interpolatory.
struct QuadraticBSpline {
  static constexpr int support = 3;              ///< nodes per axis
  static constexpr bool uses_half_size = false;  ///< no particle domain
  static constexpr const char* name = "quadratic_b_spline";

  /// Values w[3] and slopes dw[3] (per cell) at u [cells]; returns the first node's index.
  template <class T>
  VADOSE_INLINE static T weights(const T& u, const T& /*half*/, T* w, T* dw) noexcept {
    const T first = floor(u - T(0.5));
    const T d = u - first - T(1.0);  // from the middle node, in [-1/2, 1/2)
    const T left = T(0.5) - d;
    const T right = T(0.5) + d;
    w[0] = T(0.5) * left * left;
    w[1] = T(0.75) - d * d;
    w[2] = T(0.5) * right * right;
    dw[0] = -left;
    dw[1] = T(-2.0) * d;
    dw[2] = right;
    return first;
  }
};

}  // namespace vadose::shape
