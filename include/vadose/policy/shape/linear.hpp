// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/core/lanes.hpp>

namespace vadose::shape {

/// Linear hat functions, two nodes per axis: the standard material point method.
struct Linear {
  static constexpr int support = 2;              ///< nodes per axis
  static constexpr bool uses_half_size = false;  ///< no particle domain
  static constexpr const char* name = "linear";

  /// Values w[2] and slopes dw[2] (per cell) at u [cells]; returns the first node's index.
  template <class T>
  VADOSE_INLINE static T weights(const T& u, const T& /*half*/, T* w, T* dw) noexcept {
    const T first = floor(u);
    const T d = u - first;
    w[0] = T(1.0) - d;
    w[1] = d;
    dw[0] = T(-1.0);
    dw[1] = T(1.0);
    return first;
  }
};

}  // namespace vadose::shape
