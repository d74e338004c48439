// expect: vadose: Skeleton needs `Status update\(
// mistake: law whose `update` is not const
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Law {
  struct State {};
  template <int N>
  vadose::Status update(const vadose::StrainStep<vadose::Real, N>& /*step*/,
                        vadose::SymTensor<vadose::Real, N>& /*stress*/, State& /*state*/)
#ifndef VADOSE_SHOULD_FAIL
      const
#endif
  {
    return vadose::Status::ok;
  }
  vadose::Real p_wave_modulus(const State& /*state*/) const {
    return 1;
  }
  void validate() const {}
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Skeleton = Law;
};
static_assert(vadose::CheckModel<Soil>::ok);
