// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <type_traits>

#include <vadose/policy/shape/gimp.hpp>
#include <vadose/policy/shape/linear.hpp>
#include <vadose/policy/shape/quadratic_b_spline.hpp>
#include <vadose/policy/transfer/transfer.hpp>
#include <vadose/solver/scheme.hpp>

#include "../changed_model.hpp"

namespace verify {

/// Numerical choices of a run; the physics is the case's.
template <class ShapeType = vadose::shape::Gimp, class TransferType = vadose::transfer::Flip,
          class SchemeType = vadose::scheme::Explicit>
struct Variant {
  using Shape = ShapeType;
  using Transfer = TransferType;
  using Scheme = SchemeType;

  /// "gimp flip explicit".
  static std::string name() {
    const char* transfer = std::is_same_v<Transfer, vadose::transfer::Flip>   ? "flip"
                           : std::is_same_v<Transfer, vadose::transfer::Apic> ? "apic"
                                                                              : "tpic";
    return std::string(Shape::name) + ' ' + transfer + ' ' + Scheme::name;
  }
};

/// A model of the physics of `Physics` with the choices of a variant.
template <class Physics, class V>
using With =
    vadose_test::With<Physics, typename Physics::Skeleton, typename V::Transfer, typename V::Shape>;

}  // namespace verify
