// expect: vadose: -ffast-math breaks NaN tests and floor\(\)
// flags: -ffast-math
// mistake: compiled with -ffast-math
// SPDX-License-Identifier: MIT
#include <vadose/core/real.hpp>

bool usable(vadose::Real x) {
  return vadose::is_finite(x);
}
