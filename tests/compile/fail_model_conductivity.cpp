// expect: vadose: Conductivity needs `Real conductivity\(
// mistake: conductivity without `conductivity(Se, n)`
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Law {
#ifndef VADOSE_SHOULD_FAIL
  vadose::Real conductivity(vadose::Real /*Se*/, vadose::Real /*n*/) const {
    return 1;
  }
#endif
  void validate() const {}
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Conductivity = Law;
};
static_assert(vadose::CheckModel<Soil>::ok);
