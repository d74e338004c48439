// SPDX-License-Identifier: MIT
// One of two translation units that include everything; see two_units_a.cpp.
#include <vadose/vadose.hpp>

vadose::Real turned_right_angle();

vadose::Real turned_right_angle() {
  return vadose::degrees(90.0);
}
