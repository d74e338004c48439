// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Principal values and directions of a symmetric tensor, for a number or for lanes.

#include <vadose/core/sym_tensor.hpp>

namespace vadose::law::detail {

/// Symmetric 3x3 matrix and the rotations that made it diagonal: direction i is column i.
/// Tensors of 3 components are diagonal already, those of 4 need one rotation.
template <class T, int N>
class PrincipalStress {
 public:
  /// Cyclic Jacobi rotations. Backward stable for equal and nearly equal values.
  VADOSE_INLINE explicit PrincipalStress(const SymTensor<T, N>& stress) noexcept {
    const T zero(0.0), one(1.0);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        matrix_[i][j] = zero;
        axes_[i][j] = i == j ? one : zero;
      }
      matrix_[i][i] = stress[i];
    }
    if constexpr (N >= 4) matrix_[0][1] = stress[3];
    if constexpr (N == 6) {
      matrix_[1][2] = stress[4];
      matrix_[0][2] = stress[5];
    }
    diagonalise();
  }

  /// Principal value i, in no order.
  VADOSE_INLINE const T& operator[](int i) const noexcept { return matrix_[i][i]; }

  /// Adds to a tensor the one that has principal value change[i] along direction i.
  VADOSE_INLINE void add(const T (&change)[3], SymTensor<T, N>& stress) const noexcept {
    const auto entry = [&](int a, int b) {
      T sum = change[0] * axes_[a][0] * axes_[b][0];
      for (int i = 1; i < 3; ++i) sum += change[i] * axes_[a][i] * axes_[b][i];
      return sum;
    };
    if constexpr (N == 3) {
      for (int i = 0; i < 3; ++i) stress[i] += change[i];
    } else {
      for (int i = 0; i < 3; ++i) stress[i] += entry(i, i);
      stress[3] += entry(0, 1);
      if constexpr (N == 6) {
        stress[4] += entry(1, 2);
        stress[5] += entry(0, 2);
      }
    }
  }

 private:
  VADOSE_INLINE void diagonalise() noexcept {
    if constexpr (N == 4) rotate<0, 1>();
    if constexpr (N == 6) {
      constexpr int most_sweeps = 8;
      for (int sweep = 0; sweep < most_sweeps && any(off_diagonal()); ++sweep) {
        rotate<0, 1>();
        rotate<0, 2>();
        rotate<1, 2>();
      }
    }
  }

  /// True where the off-diagonal part still matters.
  VADOSE_INLINE auto off_diagonal() const noexcept {
    const T off = abs(matrix_[0][1]) + abs(matrix_[0][2]) + abs(matrix_[1][2]);
    const T on = abs(matrix_[0][0]) + abs(matrix_[1][1]) + abs(matrix_[2][2]);
    return off > T(1e-17) * on;
  }

  /// Rotation in the plane of axes P < Q that makes entry (P, Q) zero.
  template <int P, int Q>
  VADOSE_INLINE void rotate() noexcept {
    constexpr int r = 3 - P - Q;
    const T zero(0.0), one(1.0);
    const T off = matrix_[P][Q];
    const T gap = matrix_[Q][Q] - matrix_[P][P];
    const T length = abs(gap) + sqrt(gap * gap + T(4.0) * off * off);
    const T sign = select(gap < zero, -one, one);
    const auto turns = length > zero;
    const T tangent = select(turns, T(2.0) * sign * off / select(turns, length, one), zero);
    const T cosine = one / sqrt(one + tangent * tangent);
    const T sine = tangent * cosine;
    matrix_[P][P] -= tangent * off;
    matrix_[Q][Q] += tangent * off;
    matrix_[P][Q] = zero;
    turn(upper(P, r), upper(Q, r), cosine, sine);
    for (int i = 0; i < 3; ++i) turn(axes_[i][P], axes_[i][Q], cosine, sine);
  }

  VADOSE_INLINE T& upper(int i, int j) noexcept { return i < j ? matrix_[i][j] : matrix_[j][i]; }

  VADOSE_INLINE static void turn(T& p, T& q, const T& cosine, const T& sine) noexcept {
    const T old = p;
    p = cosine * old - sine * q;
    q = sine * old + cosine * q;
  }

  T matrix_[3][3];  ///< upper triangle is used
  T axes_[3][3];    ///< [component][direction]
};

}  // namespace vadose::law::detail
