// expect: vadose: Interblock needs `static T mean\(
// mistake: conductivity between cells without `mean(integral, face)`
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Harmonic {
#ifndef VADOSE_SHOULD_FAIL
  template <class Integral, class T>
  static T mean(const Integral& integral, const vadose::FaceState<T>& face) {
    const T a = integral.mean(face.pressure_a, face.pressure_a, face.porosity);
    const T b = integral.mean(face.pressure_b, face.pressure_b, face.porosity);
    return T(2.0) * a * b / (a + b);
  }
#endif
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Interblock = Harmonic;
};
static_assert(vadose::CheckModel<Soil>::ok);
