// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Symmetric second-order tensors of stress [Pa, tension +] and strain [-, extension +].

#include <vadose/core/lanes.hpp>

namespace vadose {

/// Symmetric tensor with N stored components: the three normals first, then N - 3 *tensorial*
/// shears (never engineering shears).
/// N = 3: xx yy zz (uniaxial); N = 4: + xy (plane strain, axisymmetric r z theta rz);
/// N = 6: + xy yz zx (three-dimensional).
template <class T, int N>
struct SymTensor {
  static_assert(N == 3 || N == 4 || N == 6, "SymTensor: N must be 3, 4 or 6");
  static constexpr int size = N;  ///< stored components

  T component[N] = {};  ///< in the order above

  VADOSE_INLINE T& operator[](int i) noexcept { return component[i]; }
  VADOSE_INLINE const T& operator[](int i) const noexcept { return component[i]; }

  /// First invariant, sum of the normals.
  VADOSE_INLINE T trace() const noexcept { return component[0] + component[1] + component[2]; }
  /// Mean of the normals.
  VADOSE_INLINE T mean() const noexcept { return trace() * T(1.0 / 3.0); }
  /// The tensor less its mean on the normals.
  VADOSE_INLINE SymTensor deviator() const noexcept {
    SymTensor s = *this;
    const T m = mean();
    for (int i = 0; i < 3; ++i) s.component[i] -= m;
    return s;
  }
  /// Full contraction a:b, shears counted twice.
  VADOSE_INLINE friend T contract(const SymTensor& a, const SymTensor& b) noexcept {
    T s = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    for (int i = 3; i < N; ++i) s += T(2.0) * a[i] * b[i];
    return s;
  }
  /// Frobenius norm.
  VADOSE_INLINE T norm() const noexcept { return sqrt(contract(*this, *this)); }

  VADOSE_INLINE SymTensor& operator+=(const SymTensor& b) noexcept {
    for (int i = 0; i < N; ++i) component[i] += b[i];
    return *this;
  }
  VADOSE_INLINE SymTensor& operator-=(const SymTensor& b) noexcept {
    for (int i = 0; i < N; ++i) component[i] -= b[i];
    return *this;
  }
  VADOSE_INLINE SymTensor& operator*=(const T& s) noexcept {
    for (int i = 0; i < N; ++i) component[i] *= s;
    return *this;
  }
  VADOSE_INLINE friend SymTensor operator+(SymTensor a, const SymTensor& b) noexcept {
    return a += b;
  }
  VADOSE_INLINE friend SymTensor operator-(SymTensor a, const SymTensor& b) noexcept {
    return a -= b;
  }
  VADOSE_INLINE friend SymTensor operator*(const T& s, SymTensor a) noexcept { return a *= s; }

  /// Adds s to the three normals.
  VADOSE_INLINE void add_isotropic(const T& s) noexcept {
    for (int i = 0; i < 3; ++i) component[i] += s;
  }
};

/// What a constitutive law is given: the strain increment of one step.
template <class T, int N>
struct StrainStep {
  SymTensor<T, N> increment;  ///< strain increment [-], extension +, tensorial shears
  Real dt = 0;                ///< time step [s]
};

}  // namespace vadose
