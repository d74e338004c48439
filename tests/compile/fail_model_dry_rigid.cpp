// expect: vadose: Skeleton law::Rigid without Liquid
// mistake: rigid soil without water
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Soil : vadose::DryModel<vadose::PlaneStrain> {
#ifdef VADOSE_SHOULD_FAIL
  using Skeleton = vadose::law::Rigid;
#endif
};
static_assert(vadose::CheckModel<Soil>::ok);
