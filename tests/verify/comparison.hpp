// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "verify_support.hpp"

namespace verify {

/// One quantity at one time: computed and reference values, both over the load or the range.
struct Comparison {
  /// At a place [m], of a cell its centre; a value without a place has 0.
  struct Value {
    Real place, computed, reference;
  };

  std::string quantity;
  Real time = 0;  ///< in the case's unit of time
  std::vector<Value> values = {};

  void add(Real place, Real computed, Real reference) {
    values.push_back({place, computed, reference});
  }
  /// Norms of computed - reference.
  Norm norm() const {
    Norm norm;
    for (const Value& v : values) norm.add(v.computed - v.reference);
    return norm;
  }
};

}  // namespace verify
