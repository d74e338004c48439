// SPDX-License-Identifier: MIT
#pragma once

#include <doctest/doctest.h>

#include "benchmarks/speed/agreement.hpp"

/// Every quantity of every point agrees to 1e-10 of its largest value after 100 steps of 4000 points.
template <class M>
void check_agreement() {
  const auto all = speed::disagreements<M>(4000, 100);
  REQUIRE(!all.empty());
  for (const auto& one : all) {
    INFO(one.quantity);
    CHECK(one.relative <= 1e-10);
  }
}
