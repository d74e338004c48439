// expect: vadose: Transfer needs `affine`
// mistake: transfer without `blends`
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Pic {
  static constexpr bool affine = false;
#ifndef VADOSE_SHOULD_FAIL
  static constexpr bool blends = false;
#endif
  void validate() const {}
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Transfer = Pic;
};
static_assert(vadose::CheckModel<Soil>::ok);
