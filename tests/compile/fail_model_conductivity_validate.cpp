// expect: vadose: Conductivity needs `void validate\(\)
// mistake: conductivity without `validate()`
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Law {
  vadose::Real conductivity(vadose::Real /*Se*/, vadose::Real /*n*/) const { return 1; }
#ifndef VADOSE_SHOULD_FAIL
  void validate() const {}
#endif
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Conductivity = Law;
};
static_assert(vadose::CheckModel<Soil>::ok);
