// expect: vadose: Retention needs `void validate\(\)
// mistake: retention without `validate()`
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Curve {
  vadose::Real saturation(vadose::Real /*s*/, vadose::Real /*n*/) const { return 1; }
  vadose::Real saturation_slope(vadose::Real /*s*/, vadose::Real /*n*/) const { return 0; }
#ifndef VADOSE_SHOULD_FAIL
  void validate() const {}
#endif
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Retention = Curve;
};
static_assert(vadose::CheckModel<Soil>::ok);
