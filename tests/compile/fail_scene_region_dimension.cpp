// expect: vadose: the region has another dimension than the scene
// mistake: region of another dimension
// SPDX-License-Identifier: MIT
#include <vadose/scene/scene.hpp>

using Soil = vadose::DryModel<vadose::PlaneStrain>;

void use(vadose::Scene<Soil>& scene, const vadose::Material<Soil>& sand) {
#ifdef VADOSE_SHOULD_FAIL
  scene.add_soil(vadose::box({0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}), sand, {.suction = 0});
#else
  scene.add_soil(vadose::box({0.0, 0.0}, {1.0, 1.0}), sand, {});
#endif
}
