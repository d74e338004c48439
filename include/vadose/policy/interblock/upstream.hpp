// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/policy/interblock_concept.hpp>

namespace vadose::interblock {

/// k of the side the water comes from: never oscillates, but lets fronts that suction drives run ahead.
struct Upstream {
  /// k of the upstream side [m/s].
  template <class Integral, class T>
  static T mean(const Integral& /*integral*/, const FaceState<T>& face) noexcept {
    return face.upstream;
  }
};

}  // namespace vadose::interblock
