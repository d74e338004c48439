// SPDX-License-Identifier: MIT
// The library against the straightforward implementation of the same equations that its speed is compared
// with (points in no order, no lanes, no tiles): plane strain here, space in the long tier.

#include "naive.hpp"

TEST_CASE("dry soil in plane strain is that of the straightforward implementation") {
  check_agreement<speed::Dry<vadose::PlaneStrain>>();
}

TEST_CASE("unsaturated soil in plane strain is that of the straightforward implementation") {
  check_agreement<speed::Unsaturated<vadose::PlaneStrain>>();
}
