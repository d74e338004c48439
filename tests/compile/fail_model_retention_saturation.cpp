// expect: vadose: Retention needs `Real saturation\(
// mistake: retention without `saturation(s, n)`
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Curve {
#ifndef VADOSE_SHOULD_FAIL
  vadose::Real saturation(vadose::Real /*s*/, vadose::Real /*n*/) const {
    return 1;
  }
#endif
  vadose::Real saturation_slope(vadose::Real /*s*/, vadose::Real /*n*/) const {
    return 0;
  }
  void validate() const {}
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Retention = Curve;
};
static_assert(vadose::CheckModel<Soil>::ok);
