// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// A running sum whose error does not grow with the number of terms.

#include <vadose/core/real.hpp>

namespace vadose {

/// Kahan's sum: equal small terms are rounded alike, and a million of them would drift by 1e-11.
class CompensatedSum {
 public:
  /// Adds a term.
  CompensatedSum& operator+=(Real term) noexcept {
    const Real corrected = term - carry_;
    const Real next = sum_ + corrected;
    carry_ = (next - sum_) - corrected;
    sum_ = next;
    return *this;
  }
  /// The sum.
  operator Real() const noexcept { return sum_; }  // NOLINT(google-explicit-constructor)

 private:
  Real sum_ = 0, carry_ = 0;
};

}  // namespace vadose
