// SPDX-License-Identifier: MIT
#pragma once

namespace vadose::law {

/// Water without viscous stress: its whole stress is the liquid pressure. Models recognise it by
/// `inviscid` and compute nothing.
struct InviscidWater {
  static constexpr bool inviscid = true;  ///< no viscous stress

  /// Nothing to check.
  void validate() const {}
};

}  // namespace vadose::law
