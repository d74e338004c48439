// SPDX-License-Identifier: MIT
// The library against the straightforward implementation of the same equations, in space.

#include "../verify/naive.hpp"

TEST_CASE("dry soil in space is that of the straightforward implementation") {
  check_agreement<speed::Dry<vadose::ThreeDimensional>>();
}

TEST_CASE("unsaturated soil in space is that of the straightforward implementation") {
  check_agreement<speed::Unsaturated<vadose::ThreeDimensional>>();
}
