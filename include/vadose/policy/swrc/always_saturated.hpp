// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/policy/hydraulic_concept.hpp>

namespace vadose::swrc {

/// S = 1 at any suction: saturated soil, which may carry negative liquid pressure.
struct AlwaysSaturated {
  /// Kernels leave out everything that belongs to partial saturation.
  static constexpr bool always_saturated = true;
  static constexpr Real residual_saturation = 0;  ///< [-]

  void validate() const noexcept {}

  /// 1 [-].
  template <class T>
  T saturation(T /*suction*/, T /*porosity*/) const noexcept {
    return T(1.0);
  }
  /// 0 [1/Pa].
  template <class T>
  T saturation_slope(T /*suction*/, T /*porosity*/) const noexcept {
    return T(0.0);
  }
  /// 0 [-].
  template <class T>
  T saturation_porosity_slope(T /*suction*/, T /*porosity*/) const noexcept {
    return T(0.0);
  }
  /// Suction is undetermined; 0 [Pa] by convention.
  Real suction(Real /*saturation*/, Real /*porosity*/) const noexcept { return 0; }
};

static_assert(RetentionCurve<AlwaysSaturated>);

}  // namespace vadose::swrc
