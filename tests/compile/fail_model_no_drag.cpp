// expect: vadose: the model has no alias Drag
// mistake: model without the alias Drag
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
  using Conductivity = vadose::conductivity::KozenyCarman;
#ifndef VADOSE_SHOULD_FAIL
  using Drag = vadose::drag::Darcy;
#endif
};
static_assert(vadose::CheckModel<Soil>::ok);
