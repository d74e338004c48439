// expect: vadose: Retention needs `Real saturation_slope\(
// mistake: retention without `saturation_slope(s, n)`
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Curve {
  vadose::Real saturation(vadose::Real /*s*/, vadose::Real /*n*/) const { return 1; }
#ifndef VADOSE_SHOULD_FAIL
  vadose::Real saturation_slope(vadose::Real /*s*/, vadose::Real /*n*/) const {
    return 0;
  }
#endif
  void validate() const {}
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Retention = Curve;
};
static_assert(vadose::CheckModel<Soil>::ok);
