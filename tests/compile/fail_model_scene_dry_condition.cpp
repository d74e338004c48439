// expect: vadose: this boundary condition acts on the liquid
// mistake: condition of the liquid in a dry scene
// SPDX-License-Identifier: MIT
#include <vadose/scene/scene.hpp>

using Soil = vadose::DryModel<vadose::PlaneStrain>;

void use(vadose::Scene<Soil>& scene) {
  scene.validate();
#ifdef VADOSE_SHOULD_FAIL
  scene.add(vadose::bc::Impermeable{vadose::Face::left});
#endif
}
