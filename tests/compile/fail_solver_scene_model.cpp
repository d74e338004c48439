// expect: vadose: the scene is one of another model
// mistake: scene of another model
// SPDX-License-Identifier: MIT
#include <vadose/solver/solver.hpp>

using Soil = vadose::DryModel<vadose::PlaneStrain>;
using Other = vadose::DryModel<vadose::Axisymmetric>;

#ifdef VADOSE_SHOULD_FAIL
vadose::Solver<Soil> start(const vadose::Scene<Other>& scene) {
  return vadose::Solver<Soil>(scene, {.courant = 0.4});
}
#else
bool good(const vadose::Scene<Other>& scene, const vadose::Solver<Soil>& solver) {
  return scene.soils().empty() && solver.time() == 0;
}
#endif
