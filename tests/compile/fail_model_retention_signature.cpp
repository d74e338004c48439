// expect: vadose: Retention needs `Real saturation\(
// mistake: retention whose `saturation` takes no porosity
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Curve {
#ifdef VADOSE_SHOULD_FAIL
  vadose::Real saturation(vadose::Real /*s*/) const {
#else
  vadose::Real saturation(vadose::Real /*s*/, vadose::Real /*n*/) const {
#endif
      return 1;
} vadose::Real saturation_slope(vadose::Real /*s*/, vadose::Real /*n*/) const {
  return 0;
}
void validate() const {}
}
;

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Retention = Curve;
};
static_assert(vadose::CheckModel<Soil>::ok);
