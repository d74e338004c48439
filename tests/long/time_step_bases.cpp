// SPDX-License-Identifier: MIT
// Every basis is stable at the default Courant number, in the plane and in space.

#include <doctest/doctest.h>

#include "../verify/kicked_block.hpp"

namespace vd = vadose;

TEST_CASE("time step: hat functions are stable at the default C") {
  verify::check_default<vd::PlaneStrain, vd::shape::Linear>();
  verify::check_default<vd::ThreeDimensional, vd::shape::Linear>();
}
TEST_CASE("time step: splines are stable at the default C") {
  verify::check_default<vd::PlaneStrain, vd::shape::QuadraticBSpline>();
  verify::check_default<vd::ThreeDimensional, vd::shape::QuadraticBSpline>();
}
