// expect: vadose: Liquid needs `inviscid`
// mistake: liquid without `inviscid`
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Water {
#ifndef VADOSE_SHOULD_FAIL
  static constexpr bool inviscid = true;
#endif
  void validate() const {}
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Liquid = Water;
};
static_assert(vadose::CheckModel<Soil>::ok);
