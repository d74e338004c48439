// expect: vadose: the model has no alias Retention
// mistake: model without the alias Retention
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Soil {
  using Interblock = vadose::interblock::KirchhoffBlend;
  using Kinematics = vadose::PlaneStrain;
  using Shape = vadose::shape::Gimp;
  using Transfer = vadose::transfer::Flip;
  using Skeleton = vadose::law::LinearElastic;
  using Liquid = vadose::law::InviscidWater;
#ifndef VADOSE_SHOULD_FAIL
  using Retention = vadose::swrc::AlwaysSaturated;
#endif
  using Conductivity = vadose::conductivity::KozenyCarman;
  using Drag = vadose::drag::Darcy;
};
static_assert(vadose::CheckModel<Soil>::ok);
