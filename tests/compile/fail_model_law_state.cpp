// expect: vadose: Skeleton needs a State
// mistake: law without `State`
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct History {};
struct Law {
#ifndef VADOSE_SHOULD_FAIL
  using State = History;
#endif
  template <int N>
  vadose::Status update(const vadose::StrainStep<vadose::Real, N>& /*step*/,
                        vadose::SymTensor<vadose::Real, N>& /*stress*/, History& /*state*/) const {
    return vadose::Status::ok;
  }
  vadose::Real p_wave_modulus(const History& /*state*/) const {
    return 1;
  }
  void validate() const {}
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Skeleton = Law;
};
static_assert(vadose::CheckModel<Soil>::ok);
