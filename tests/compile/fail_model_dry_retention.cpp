// expect: vadose: a model with NoLiquid takes Retention swrc::AlwaysSaturated
// mistake: retention curve in a dry model
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Soil : vadose::DryModel<vadose::PlaneStrain> {
#ifdef VADOSE_SHOULD_FAIL
  using Retention = vadose::swrc::Tarantino;
#endif
};
static_assert(vadose::CheckModel<Soil>::ok);
