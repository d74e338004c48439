// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// 8 x 8 transposes between "one field of eight points" and "eight numbers of one point".

#include <vadose/core/lanes.hpp>

namespace vadose {

/// Eight numbers whose low half is `low` and high half is `high`.
VADOSE_INLINE Lanes halves(double low, double high) noexcept {
  Lanes r;
  for (int i = 0; i < detail::native_parts; ++i)
    for (int l = 0; l < detail::native_width; ++l)
      r.part[i][l] = i * detail::native_width + l < lane_count / 2 ? low : high;
  return r;
}

/// Lanes 4 .. 7, then 0 .. 3. A template for the same reason as transpose().
template <class L>
requires std::is_same_v<L, Lanes> VADOSE_INLINE L swap_halves(const L& a)
noexcept {
  using V = std::remove_cvref_t<decltype(a.part[0])>;
  constexpr int parts = lane_count / static_cast<int>(sizeof(V) / sizeof(double));
  L r;
  if constexpr (parts == 1)
    r.part[0] = __builtin_shufflevector(a.part[0], a.part[0], 4, 5, 6, 7, 0, 1, 2, 3);
  else
    for (int i = 0; i < parts; ++i) r.part[i] = a.part[(i + parts / 2) % parts];
  return r;
}

/// Lanes 0 .. 3 in both halves. A template for the same reason as transpose().
template <class L>
requires std::is_same_v<L, Lanes> VADOSE_INLINE L low_twice(const L& a)
noexcept {
  using V = std::remove_cvref_t<decltype(a.part[0])>;
  constexpr int parts = lane_count / static_cast<int>(sizeof(V) / sizeof(double));
  L r;
  if constexpr (parts == 1)
    r.part[0] = __builtin_shufflevector(a.part[0], a.part[0], 0, 1, 2, 3, 0, 1, 2, 3);
  else
    for (int i = 0; i < parts; ++i) r.part[i] = a.part[i % (parts / 2)];
  return r;
}

/// Transposes eight Lanes in place: row[i][l] <-> row[l][i].
/// A template only so that the branches for other widths are never instantiated.
template <class L>
requires std::is_same_v<L, Lanes> VADOSE_INLINE void transpose(L (&row)[lane_count]) noexcept {
  using V = std::remove_cvref_t<decltype(row[0].part[0])>;
  constexpr int width = sizeof(V) / sizeof(double);
  if constexpr (width == 8) {
    V t[8], u[8];
    for (int i = 0; i < 8; i += 2) {
      const V a = row[i].part[0], b = row[i + 1].part[0];
      t[i] = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
      t[i + 1] = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    }
    for (int i = 0; i < 8; i += 4)
      for (int j = 0; j < 2; ++j) {
        const V a = t[i + j], b = t[i + 2 + j];
        u[i + j] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
        u[i + 2 + j] = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
      }
    for (int j = 0; j < 4; ++j) {
      row[j].part[0] = __builtin_shufflevector(u[j], u[4 + j], 0, 1, 2, 3, 8, 9, 10, 11);
      row[4 + j].part[0] = __builtin_shufflevector(u[j], u[4 + j], 4, 5, 6, 7, 12, 13, 14, 15);
    }
  } else if constexpr (width == 4) {
    L out[lane_count];
    for (int r = 0; r < 2; ++r)
      for (int c = 0; c < 2; ++c) {
        const V a = row[4 * r].part[c], b = row[4 * r + 1].part[c];
        const V d = row[4 * r + 2].part[c], e = row[4 * r + 3].part[c];
        const V ab0 = __builtin_shufflevector(a, b, 0, 4, 2, 6);
        const V ab1 = __builtin_shufflevector(a, b, 1, 5, 3, 7);
        const V de0 = __builtin_shufflevector(d, e, 0, 4, 2, 6);
        const V de1 = __builtin_shufflevector(d, e, 1, 5, 3, 7);
        out[4 * c].part[r] = __builtin_shufflevector(ab0, de0, 0, 1, 4, 5);
        out[4 * c + 1].part[r] = __builtin_shufflevector(ab1, de1, 0, 1, 4, 5);
        out[4 * c + 2].part[r] = __builtin_shufflevector(ab0, de0, 2, 3, 6, 7);
        out[4 * c + 3].part[r] = __builtin_shufflevector(ab1, de1, 2, 3, 6, 7);
      }
    for (int i = 0; i < lane_count; ++i) row[i] = out[i];
  } else {
    L out[lane_count];
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c) {
        const V a = row[2 * r].part[c], b = row[2 * r + 1].part[c];
        out[2 * c].part[r] = __builtin_shufflevector(a, b, 0, 2);
        out[2 * c + 1].part[r] = __builtin_shufflevector(a, b, 1, 3);
      }
    for (int i = 0; i < lane_count; ++i) row[i] = out[i];
  }
}

}  // namespace vadose
