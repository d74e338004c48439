// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/policy/interblock_concept.hpp>
#include <vadose/policy/kirchhoff.hpp>

namespace vadose::interblock {

/// The default: upstream for what gravity drives, the mean over the pressures between (Kirchhoff) for what
/// suction drives, weighted by both, see blend_conductivity. DEVIATION: [Zhan] takes k at the points.
struct KirchhoffBlend {
  /// The blend [m/s].
  template <class Integral, class T>
  static T mean(const Integral& integral, const FaceState<T>& face) noexcept {
    return blend_conductivity<T>(face.upstream,
                                 integral.mean(face.pressure_a, face.pressure_b, face.porosity),
                                 face.gravity_head, face.pressure_b - face.pressure_a);
  }
};

}  // namespace vadose::interblock
