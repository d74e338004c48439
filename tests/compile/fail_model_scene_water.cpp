// expect: vadose: add_water needs a model with a Liquid
// mistake: water in a dry scene
// SPDX-License-Identifier: MIT
#include <vadose/scene/scene.hpp>

using Soil = vadose::DryModel<vadose::PlaneStrain>;

void use(vadose::Scene<Soil>& scene) {
  scene.validate();
#ifdef VADOSE_SHOULD_FAIL
  scene.add_water(vadose::box({0.0, 0.0}, {1.0, 1.0}));
#endif
}
