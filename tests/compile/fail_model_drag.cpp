// expect: vadose: Drag needs `Real coefficient\(
// mistake: drag without `coefficient(n, S, k, unit_weight)`
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Law {
#ifndef VADOSE_SHOULD_FAIL
  vadose::Real coefficient(vadose::Real /*n*/, vadose::Real /*S*/, vadose::Real /*k*/,
                           vadose::Real /*unit_weight*/) const {
    return 1;
  }
#endif
  void validate() const {}
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Drag = Law;
};
static_assert(vadose::CheckModel<Soil>::ok);
