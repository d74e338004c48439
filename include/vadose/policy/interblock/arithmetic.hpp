// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/policy/interblock_concept.hpp>

namespace vadose::interblock {

/// (k_a + k_b) / 2, the mean that interpolation between points amounts to.
struct Arithmetic {
  /// The mean of k at both pressures [m/s].
  template <class Integral, class T>
  static T mean(const Integral& integral, const FaceState<T>& face) noexcept {
    return T(0.5) * (integral.mean(face.pressure_a, face.pressure_a, face.porosity) +
                     integral.mean(face.pressure_b, face.pressure_b, face.porosity));
  }
};

}  // namespace vadose::interblock
