// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// How velocities go from nodes to points and back.

#include <vadose/core/error.hpp>
#include <vadose/core/real.hpp>

namespace vadose::transfer {

/// Points keep their velocity and take the nodal increment (FLIP); a part of it relaxes to the
/// interpolated velocity (PIC) at a stated rate, so that the result does not depend on the step:
/// v_p = e^(-nu dt) (v_p + dv) + (1 - e^(-nu dt)) v(x_p).
struct Flip {
  static constexpr bool affine = false;
  static constexpr bool stores_gradient = false;
  static constexpr bool blends = true;
  Real pic_rate = 1.0;  ///< nu [1/s], >= 0

  void validate() const { check::non_negative("pic_rate", pic_rate, "1/s"); }
};

/// Affine particle-in-cell: points take the interpolated velocity and its first moment
/// B = sum w v (x_I - x_p)^T; keeps angular momentum.
struct Apic {
  static constexpr bool affine = true;
  static constexpr bool stores_gradient = false;
  static constexpr bool blends = false;

  void validate() const {}
};

/// Taylor particle-in-cell: points take the interpolated velocity and its gradient.
struct Tpic {
  static constexpr bool affine = true;
  static constexpr bool stores_gradient = true;
  static constexpr bool blends = false;

  void validate() const {}
};

}  // namespace vadose::transfer
