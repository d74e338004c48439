// SPDX-License-Identifier: MIT
// One of two translation units that include everything; see two_units_b.cpp.
#include <vadose/vadose.hpp>

vadose::Real turned_right_angle();

int main() {
  return turned_right_angle() == vadose::degrees(90.0) ? 0 : 1;
}
