// expect: vadose: the model has no alias Interblock
// mistake: model without the alias Interblock
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Soil {
  using Drag = vadose::drag::Darcy;
  using Kinematics = vadose::PlaneStrain;
  using Shape = vadose::shape::Gimp;
  using Transfer = vadose::transfer::Flip;
  using Skeleton = vadose::law::LinearElastic;
  using Liquid = vadose::law::InviscidWater;
  using Retention = vadose::swrc::AlwaysSaturated;
  using Conductivity = vadose::conductivity::KozenyCarman;
#ifndef VADOSE_SHOULD_FAIL
  using Interblock = vadose::interblock::KirchhoffBlend;
#endif
};
static_assert(vadose::CheckModel<Soil>::ok);
