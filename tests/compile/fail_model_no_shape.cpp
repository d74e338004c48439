// expect: vadose: the model has no alias Shape
// mistake: model without the alias Shape
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Soil {
  using Interblock = vadose::interblock::KirchhoffBlend;
  using Kinematics = vadose::PlaneStrain;
#ifndef VADOSE_SHOULD_FAIL
  using Shape = vadose::shape::Gimp;
#endif
  using Transfer = vadose::transfer::Flip;
  using Skeleton = vadose::law::LinearElastic;
  using Liquid = vadose::law::InviscidWater;
  using Retention = vadose::swrc::AlwaysSaturated;
  using Conductivity = vadose::conductivity::KozenyCarman;
  using Drag = vadose::drag::Darcy;
};
static_assert(vadose::CheckModel<Soil>::ok);
