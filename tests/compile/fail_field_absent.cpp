// expect: vadose: this model does not store the field that is asked for
// mistake: reads a field that the model does not store
// SPDX-License-Identifier: MIT
#include <vadose/solver/solver.hpp>

// A dry skeleton has no liquid pressure.
using Points = vadose::State<vadose::DryModel<vadose::PlaneStrain>>::Solid;

inline double read(const Points& points) {
#ifdef VADOSE_SHOULD_FAIL
  return points.at(vadose::field::liquid_pressure, 0)[0];
#else
  return points.at(vadose::field::volume, 0)[0];
#endif
}

double use(const Points& points);
double use(const Points& points) {
  return read(points);
}
