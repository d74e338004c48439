// expect: vadose: the model has neither Skeleton nor Liquid
// mistake: neither soil nor water
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Soil : vadose::DryModel<vadose::PlaneStrain> {
#ifdef VADOSE_SHOULD_FAIL
  using Skeleton = vadose::NoSkeleton;
#endif
};
static_assert(vadose::CheckModel<Soil>::ok);
