// expect: vadose: a model with NoSkeleton takes Retention swrc::AlwaysSaturated
// mistake: retention curve without soil
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Soil : vadose::FreeWaterModel<vadose::PlaneStrain> {
#ifdef VADOSE_SHOULD_FAIL
  using Retention = vadose::swrc::Tarantino;
#endif
};
static_assert(vadose::CheckModel<Soil>::ok);
