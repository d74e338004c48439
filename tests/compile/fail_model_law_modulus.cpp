// expect: vadose: Skeleton needs `Real p_wave_modulus\(
// mistake: law without `p_wave_modulus(state)`
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Law {
  struct State {};
  template <int N>
  vadose::Status update(const vadose::StrainStep<vadose::Real, N>& /*step*/,
                        vadose::SymTensor<vadose::Real, N>& /*stress*/, State& /*state*/) const {
    return vadose::Status::ok;
  }
#ifndef VADOSE_SHOULD_FAIL
  vadose::Real p_wave_modulus(const State& /*state*/) const {
    return 1;
  }
#endif
  void validate() const {}
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Skeleton = Law;
};
static_assert(vadose::CheckModel<Soil>::ok);
