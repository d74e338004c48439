// expect: vadose: Drag needs `void validate\(\)
// mistake: drag without `validate()`
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Law {
  vadose::Real coefficient(vadose::Real /*n*/, vadose::Real /*S*/, vadose::Real /*k*/,
                           vadose::Real /*unit_weight*/) const {
    return 1;
  }
#ifndef VADOSE_SHOULD_FAIL
  void validate() const {}
#endif
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Drag = Law;
};
static_assert(vadose::CheckModel<Soil>::ok);
