// expect: vadose: the model has no alias Transfer
// mistake: model without the alias Transfer
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Soil {
  using Interblock = vadose::interblock::KirchhoffBlend;
  using Kinematics = vadose::PlaneStrain;
  using Shape = vadose::shape::Gimp;
#ifndef VADOSE_SHOULD_FAIL
  using Transfer = vadose::transfer::Flip;
#endif
  using Skeleton = vadose::law::LinearElastic;
  using Liquid = vadose::law::InviscidWater;
  using Retention = vadose::swrc::AlwaysSaturated;
  using Conductivity = vadose::conductivity::KozenyCarman;
  using Drag = vadose::drag::Darcy;
};
static_assert(vadose::CheckModel<Soil>::ok);
