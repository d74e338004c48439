// expect: vadose: Scene::add takes a condition of vadose::bc
// mistake: a number as boundary condition
// SPDX-License-Identifier: MIT
#include <vadose/scene/scene.hpp>

using Soil = vadose::SaturatedModel<vadose::PlaneStrain>;

void use(vadose::Scene<Soil>& scene) {
  scene.validate();
#ifdef VADOSE_SHOULD_FAIL
  scene.add(3.0);
#endif
}
