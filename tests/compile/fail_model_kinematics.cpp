// expect: vadose: Kinematics must be Uniaxial
// mistake: four dimensions
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Kinematics {
#ifdef VADOSE_SHOULD_FAIL
  static constexpr int dim = 4;
#else
  static constexpr int dim = 2;
#endif
  static constexpr int stress_size = 4;
  static constexpr bool axisymmetric = false;
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Kinematics = ::Kinematics;
};
static_assert(vadose::CheckModel<Soil>::ok);
