// expect: vadose: add_soil needs a model with a Skeleton
// mistake: soil in a scene of free water
// SPDX-License-Identifier: MIT
#include <vadose/scene/scene.hpp>

using Soil = vadose::FreeWaterModel<vadose::PlaneStrain>;

void use(vadose::Scene<Soil>& scene) {
  scene.validate();
#ifdef VADOSE_SHOULD_FAIL
  scene.add_soil(vadose::box({0.0, 0.0}, {1.0, 1.0}), {});
#endif
}
