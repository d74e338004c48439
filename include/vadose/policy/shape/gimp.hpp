// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/core/lanes.hpp>

namespace vadose::shape {

/// Generalised interpolation functions: hat functions averaged over the point's domain of half
/// size l <= 1/2 cell along each axis (axis-aligned, updated with the stretch).
/// S = (1/V_p) int chi_p N dOmega, [Zhan] Eq. (17).
struct Gimp {
  static constexpr int support = 3;             ///< nodes per axis
  static constexpr bool uses_half_size = true;  ///< particle domain of half size l
  static constexpr const char* name = "gimp";

  /// Values w[3] and slopes dw[3] (per cell) at u [cells] with half size 0 < half <= 0.5
  /// [cells]; returns the first node's index.
  template <class T>
  VADOSE_INLINE static T weights(const T& u, const T& half, T* w, T* dw) noexcept {
    const T first = floor(u - T(0.5));
    const T d = u - first - T(1.0);  // from the middle node, in [-1/2, 1/2)
    const T over = T(0.5) / half;
    const T distance = abs(d);
    w[1] = select(distance < half, T(1.0) - (d * d + half * half) * over, T(1.0) - distance);
    dw[1] = select(distance < half, T(-2.0) * d * over, select(d > T(0.0), T(-1.0), T(1.0)));
    outer(T(1.0) + d, half, over, w[0], dw[0]);
    dw[0] = -dw[0];
    outer(T(1.0) - d, half, over, w[2], dw[2]);
    return first;
  }

 private:
  /// Value and slope towards the node of a node at distance in [1/2, 3/2].
  template <class T>
  VADOSE_INLINE static void outer(const T& distance, const T& half, const T& over, T& w,
                                  T& dw) noexcept {
    const T overlap = max(T(1.0) + half - distance, T(0.0));
    const auto inside = distance < T(1.0) - half;
    w = select(inside, T(1.0) - distance, T(0.5) * overlap * overlap * over);
    dw = select(inside, T(1.0), overlap * over);
  }
};

}  // namespace vadose::shape
