// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <type_traits>

#include <vadose/policy/interblock/arithmetic.hpp>
#include <vadose/policy/interblock/kirchhoff_blend.hpp>
#include <vadose/policy/interblock/upstream.hpp>
#include <vadose/policy/shape/gimp.hpp>
#include <vadose/policy/shape/linear.hpp>
#include <vadose/policy/shape/quadratic_b_spline.hpp>
#include <vadose/policy/transfer/transfer.hpp>
#include <vadose/solver/scheme.hpp>

#include "../changed_model.hpp"

namespace verify {

/// Numerical choices of a run; the physics is the case's.
template <class ShapeType = vadose::shape::Gimp, class TransferType = vadose::transfer::Flip,
          class SchemeType = vadose::scheme::Explicit,
          class InterblockType = vadose::interblock::KirchhoffBlend>
struct Variant {
  using Shape = ShapeType;
  using Transfer = TransferType;
  using Scheme = SchemeType;
  using Interblock = InterblockType;

  /// "gimp flip explicit".
  static std::string name() {
    const char* transfer = std::is_same_v<Transfer, vadose::transfer::Flip>   ? "flip"
                           : std::is_same_v<Transfer, vadose::transfer::Apic> ? "apic"
                                                                              : "tpic";
    const char* faces = std::is_same_v<Interblock, vadose::interblock::Upstream>     ? " upstream k"
                        : std::is_same_v<Interblock, vadose::interblock::Arithmetic> ? " mean k"
                                                                                     : "";
    return std::string(Shape::name) + ' ' + transfer + ' ' + Scheme::name + faces;
  }
};

/// A model with another conductivity between cells.
template <class Model, class InterblockType>
struct Between : Model {
  using Interblock = InterblockType;
};

/// A model of the physics of `Physics` with the choices of a variant.
template <class Physics, class V>
using With = vadose_test::With<
    std::conditional_t<std::is_same_v<typename V::Interblock, typename Physics::Interblock>,
                       Physics, Between<Physics, typename V::Interblock>>,
    typename Physics::Skeleton, typename V::Transfer, typename V::Shape>;

}  // namespace verify
