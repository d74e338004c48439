// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// What the checks of this folder find. They need no test framework.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <vadose/core/real.hpp>

namespace vadose::testing {

/// One thing found wrong.
struct Failure {
  std::string check;  ///< which check, e.g. "frame indifference"
  std::string what;   ///< where, and what was expected
  Real value = 0;     ///< what was found
  Real bound = 0;     ///< largest value allowed
};

/// What a check of a policy found. It keeps the worst failure of each check and counts the rest.
class Report {
 public:
  bool ok() const noexcept { return failures_.empty(); }  ///< no check failed
  /// One per check that failed.
  const std::vector<Failure>& failures() const noexcept { return failures_; }
  std::size_t comparisons() const noexcept { return comparisons_; }  ///< numbers compared

  /// Whether a check of this name failed.
  bool failed(const std::string& check) const {
    return std::any_of(failures_.begin(), failures_.end(),
                       [&](const Failure& f) { return f.check == check; });
  }

  /// Notes a failure unless value <= bound; a value that is not finite fails.
  void expect(const std::string& check, const std::string& what, Real value, Real bound) {
    ++comparisons_;
    if (is_finite(value) && value <= bound) return;
    for (Failure& f : failures_) {
      if (f.check != check) continue;
      const bool worse = is_finite(f.value) && (!is_finite(value) || value > f.value);
      if (worse) f = {check, what, value, bound};
      return;
    }
    failures_.push_back({check, what, value, bound});
  }

  /// A few lines for people.
  std::string text() const {
    if (ok()) return std::to_string(comparisons_) + " comparisons, nothing wrong\n";
    std::string all;
    for (const Failure& f : failures_) {
      char numbers[80];
      std::snprintf(numbers, sizeof numbers, ": %.6g, at most %.6g allowed\n", f.value, f.bound);
      all += f.check + ": " + f.what + numbers;
    }
    return all;
  }

 private:
  std::vector<Failure> failures_;
  std::size_t comparisons_ = 0;
};

namespace detail {

/// Repeatable numbers in [low, high).
class Random {
 public:
  explicit Random(std::uint64_t seed) noexcept : state_(seed * 2654435769u + 1) {}
  Real operator()(Real low, Real high) noexcept {
    state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
    return low + (high - low) * static_cast<Real>(state_ >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

}  // namespace detail
}  // namespace vadose::testing
