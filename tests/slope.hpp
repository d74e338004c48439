// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/model/model.hpp>
#include <vadose/policy/law/drucker_prager.hpp>

namespace vadose_test {

/// Fields of a host's own.
struct Temperature {
  static constexpr const char* name = "temperature";
  static constexpr const char* unit = "K";
};
struct Salt {
  static constexpr const char* name = "salt";
  static constexpr const char* unit = "g/kg";
};

/// Moist soil that yields, with an affine transfer and fields of a host on points of both phases.
struct Slope : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Skeleton = vadose::law::DruckerPrager;
  using Transfer = vadose::transfer::Tpic;
  using SolidUserFields = vadose::FieldSet<vadose::Sized<Temperature, 2>>;
  using LiquidUserFields = vadose::FieldSet<vadose::Sized<Salt, 1>>;
};

}  // namespace vadose_test
