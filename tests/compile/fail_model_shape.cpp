// expect: vadose: Shape needs `support` and `weights
// mistake: shape functions without `weights`
// SPDX-License-Identifier: MIT
#include <vadose/model/check_model.hpp>

struct Nearest {
  static constexpr int support = 2;
#ifndef VADOSE_SHOULD_FAIL
  template <class T>
  static T weights(const T& u, const T& /*half*/, T* w, T* dw) noexcept {
    w[0] = T(1.0), w[1] = T(0.0), dw[0] = dw[1] = T(0.0);
    return u;
  }
#endif
};

struct Soil : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Shape = Nearest;
};
static_assert(vadose::CheckModel<Soil>::ok);
