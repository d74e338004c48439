// expect: vadose: the model has no alias Conductivity
// mistake: model without the alias Conductivity
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Soil {
  using Interblock = vadose::interblock::KirchhoffBlend;
  using Kinematics = vadose::PlaneStrain;
  using Shape = vadose::shape::Gimp;
  using Transfer = vadose::transfer::Flip;
  using Skeleton = vadose::law::LinearElastic;
  using Liquid = vadose::law::InviscidWater;
  using Retention = vadose::swrc::AlwaysSaturated;
#ifndef VADOSE_SHOULD_FAIL
  using Conductivity = vadose::conductivity::KozenyCarman;
#endif
  using Drag = vadose::drag::Darcy;
};
static_assert(vadose::CheckModel<Soil>::ok);
