// expect: vadose: the material is one of another model
// mistake: material of another model
// SPDX-License-Identifier: MIT
#include <vadose/scene/scene.hpp>

using Soil = vadose::SaturatedModel<vadose::PlaneStrain>;
using Other = vadose::UnsaturatedModel<vadose::PlaneStrain>;

#ifdef VADOSE_SHOULD_FAIL
using Sand = vadose::Material<Other>;
#else
using Sand = vadose::Material<Soil>;
#endif

void use(vadose::Scene<Soil>& scene, const Sand& sand) {
  scene.add_soil(vadose::box({0.0, 0.0}, {1.0, 1.0}), sand, {.water_table = 1});
}
