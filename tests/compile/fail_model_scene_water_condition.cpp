// expect: vadose: this boundary condition acts on soil
// mistake: condition of the soil in a scene of free water
// SPDX-License-Identifier: MIT
#include <vadose/scene/scene.hpp>

using Soil = vadose::FreeWaterModel<vadose::PlaneStrain>;

void use(vadose::Scene<Soil>& scene) {
  scene.validate();
#ifdef VADOSE_SHOULD_FAIL
  scene.add(vadose::bc::ZeroSuction{});
#endif
}
