// expect: vadose: the model has no alias Kinematics
// mistake: model without the alias Kinematics
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Soil {
  using Interblock = vadose::interblock::KirchhoffBlend;
#ifndef VADOSE_SHOULD_FAIL
  using Kinematics = vadose::PlaneStrain;
#endif
  using Shape = vadose::shape::Gimp;
  using Transfer = vadose::transfer::Flip;
  using Skeleton = vadose::law::LinearElastic;
  using Liquid = vadose::law::InviscidWater;
  using Retention = vadose::swrc::AlwaysSaturated;
  using Conductivity = vadose::conductivity::KozenyCarman;
  using Drag = vadose::drag::Darcy;
};
static_assert(vadose::CheckModel<Soil>::ok);
