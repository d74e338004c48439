// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Eight doubles computed at once. Library policies and kernels are written once as
/// `template <class T>` for T = Real and T = Lanes; branches become select(mask, a, b).

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <vadose/core/real.hpp>

#ifdef __AVX512F__
#include <immintrin.h>
#endif

// Kernels are inlined whole: a batch then stays in registers. Under the address sanitizer that would
// only multiply its checks (ten times the compile time with clang 14).
#if defined(__SANITIZE_ADDRESS__)
#define VADOSE_INLINE inline
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define VADOSE_INLINE inline
#endif
#endif
#ifndef VADOSE_INLINE
#define VADOSE_INLINE __attribute__((always_inline)) inline
#endif

namespace vadose {

/// Number of points in a batch.
inline constexpr int lane_count = 8;

namespace detail {

/// Doubles per native vector. Wider vectors than the target has make compilers spill everything.
#if defined(__AVX512F__)
inline constexpr int native_width = 8;
#elif defined(__AVX__)
inline constexpr int native_width = 4;
#else
inline constexpr int native_width = 2;
#endif
inline constexpr int native_parts = lane_count / native_width;

typedef double NativeVector __attribute__((vector_size(8 * native_width)));
typedef long long NativeMask __attribute__((vector_size(8 * native_width)));
typedef int NativeInts __attribute__((vector_size(4 * native_width)));

/// Whether any element of a mask (all bits of it or none) is set.
VADOSE_INLINE bool is_any_set(NativeMask mask) noexcept {
#if defined(__AVX512F__)
  return _mm512_test_epi64_mask(static_cast<__m512i>(mask), static_cast<__m512i>(mask)) != 0;
#elif defined(__AVX__)
  return __builtin_ia32_movmskpd256(reinterpret_cast<NativeVector>(mask)) != 0;
#elif defined(__SSE2__)
  return __builtin_ia32_movmskpd(reinterpret_cast<NativeVector>(mask)) != 0;
#else
  long long bits = 0;
  for (int l = 0; l < native_width; ++l) bits |= mask[l];
  return bits != 0;
#endif
}

}  // namespace detail

/// One truth value per lane.
struct LaneMask {
  detail::NativeMask part[detail::native_parts];  ///< all bits set: true

  VADOSE_INLINE friend LaneMask operator&(LaneMask a, const LaneMask& b) noexcept {
    for (int i = 0; i < detail::native_parts; ++i) a.part[i] = a.part[i] & b.part[i];
    return a;
  }
  VADOSE_INLINE friend LaneMask operator|(LaneMask a, const LaneMask& b) noexcept {
    for (int i = 0; i < detail::native_parts; ++i) a.part[i] = a.part[i] | b.part[i];
    return a;
  }
  VADOSE_INLINE friend LaneMask operator!(LaneMask a) noexcept {
    for (int i = 0; i < detail::native_parts; ++i) a.part[i] = ~a.part[i];
    return a;
  }
  VADOSE_INLINE bool operator[](int lane) const noexcept {
    return part[lane / detail::native_width][lane % detail::native_width] != 0;
  }
  /// True in at least one lane.
  VADOSE_INLINE friend bool any(const LaneMask& mask) noexcept {
    detail::NativeMask joined = mask.part[0];
    for (int i = 1; i < detail::native_parts; ++i) joined = joined | mask.part[i];
    return detail::is_any_set(joined);
  }
  /// True in all lanes.
  VADOSE_INLINE friend bool all(const LaneMask& mask) noexcept { return !any(!mask); }
};

/// Eight doubles; arithmetic is lane by lane. Never stored in long-lived data: points are plain
/// arrays of double, loaded and stored batch by batch.
struct Lanes {
  detail::NativeVector part[detail::native_parts];  ///< the numbers, as the machine has them

  Lanes() = default;
  /// The same number in all lanes.
  VADOSE_INLINE Lanes(double s) noexcept {  // NOLINT(google-explicit-constructor): acts as a number
    for (int i = 0; i < detail::native_parts; ++i) part[i] = s - detail::NativeVector{};
  }

  /// Reads eight doubles; p is 64-byte aligned.
  VADOSE_INLINE static Lanes load(const double* p) noexcept {
    Lanes r;
    for (int i = 0; i < detail::native_parts; ++i)
      r.part[i] = *reinterpret_cast<const detail::NativeVector*>(p + i * detail::native_width);
    return r;
  }
  /// Writes eight doubles; p is 64-byte aligned.
  VADOSE_INLINE void store(double* p) const noexcept {
    for (int i = 0; i < detail::native_parts; ++i)
      *reinterpret_cast<detail::NativeVector*>(p + i * detail::native_width) = part[i];
  }

  VADOSE_INLINE double operator[](int lane) const noexcept {
    return part[lane / detail::native_width][lane % detail::native_width];
  }
  /// Changes one lane.
  VADOSE_INLINE void set(int lane, double value) noexcept {
    part[lane / detail::native_width][lane % detail::native_width] = value;
  }

  VADOSE_INLINE friend Lanes operator+(Lanes a, const Lanes& b) noexcept { return a += b; }
  VADOSE_INLINE friend Lanes operator-(Lanes a, const Lanes& b) noexcept { return a -= b; }
  VADOSE_INLINE friend Lanes operator*(Lanes a, const Lanes& b) noexcept { return a *= b; }
  VADOSE_INLINE friend Lanes operator/(Lanes a, const Lanes& b) noexcept { return a /= b; }
  VADOSE_INLINE Lanes& operator+=(const Lanes& b) noexcept {
    for (int i = 0; i < detail::native_parts; ++i) part[i] = part[i] + b.part[i];
    return *this;
  }
  VADOSE_INLINE Lanes& operator-=(const Lanes& b) noexcept {
    for (int i = 0; i < detail::native_parts; ++i) part[i] = part[i] - b.part[i];
    return *this;
  }
  VADOSE_INLINE Lanes& operator*=(const Lanes& b) noexcept {
    for (int i = 0; i < detail::native_parts; ++i) part[i] = part[i] * b.part[i];
    return *this;
  }
  VADOSE_INLINE Lanes& operator/=(const Lanes& b) noexcept {
    for (int i = 0; i < detail::native_parts; ++i) part[i] = part[i] / b.part[i];
    return *this;
  }
  VADOSE_INLINE Lanes operator-() const noexcept {
    Lanes r;
    for (int i = 0; i < detail::native_parts; ++i) r.part[i] = -part[i];
    return r;
  }

  VADOSE_INLINE friend LaneMask operator<(const Lanes& a, const Lanes& b) noexcept {
    LaneMask r;
    for (int i = 0; i < detail::native_parts; ++i) r.part[i] = a.part[i] < b.part[i];
    return r;
  }
  VADOSE_INLINE friend LaneMask operator<=(const Lanes& a, const Lanes& b) noexcept {
    LaneMask r;
    for (int i = 0; i < detail::native_parts; ++i) r.part[i] = a.part[i] <= b.part[i];
    return r;
  }
  VADOSE_INLINE friend LaneMask operator>(const Lanes& a, const Lanes& b) noexcept { return b < a; }
  VADOSE_INLINE friend LaneMask operator>=(const Lanes& a, const Lanes& b) noexcept {
    return b <= a;
  }
  VADOSE_INLINE friend LaneMask operator==(const Lanes& a, const Lanes& b) noexcept {
    LaneMask r;
    for (int i = 0; i < detail::native_parts; ++i) r.part[i] = a.part[i] == b.part[i];
    return r;
  }

  /// mask ? a : b.
  VADOSE_INLINE friend Lanes select(const LaneMask& mask, const Lanes& a, const Lanes& b) noexcept {
    Lanes r;
    for (int i = 0; i < detail::native_parts; ++i) r.part[i] = mask.part[i] ? a.part[i] : b.part[i];
    return r;
  }
  /// The smaller one.
  VADOSE_INLINE friend Lanes min(const Lanes& a, const Lanes& b) noexcept {
    return select(b < a, b, a);
  }
  /// The larger one.
  VADOSE_INLINE friend Lanes max(const Lanes& a, const Lanes& b) noexcept {
    return select(a < b, b, a);
  }
  /// Absolute value.
  VADOSE_INLINE friend Lanes abs(const Lanes& a) noexcept { return select(a < Lanes(0.0), -a, a); }
  /// Square root.
  VADOSE_INLINE friend Lanes sqrt(Lanes a) noexcept {
#if defined(__AVX512F__)
    a.part[0] = static_cast<detail::NativeVector>(
        _mm512_maskz_sqrt_pd(0xff, static_cast<__m512d>(a.part[0])));
#else
    for (int i = 0; i < detail::native_parts; ++i)
      for (int l = 0; l < detail::native_width; ++l) a.part[i][l] = __builtin_sqrt(a.part[i][l]);
#endif
    return a;
  }
  /// Largest integer not above a; |a| < 2^51.
  VADOSE_INLINE friend Lanes floor(const Lanes& a) noexcept {
    constexpr double big = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to an integer
    Lanes r;
    for (int i = 0; i < detail::native_parts; ++i) {
      const detail::NativeVector rounded = (a.part[i] + big) - big;
      r.part[i] = rounded > a.part[i] ? rounded - 1.0 : rounded;
    }
    return r;
  }

  /// Writes the lanes as integers, rounded towards zero; p is 32-byte aligned.
  VADOSE_INLINE void store_integers(int* p) const noexcept {
    for (int i = 0; i < detail::native_parts; ++i)
      *reinterpret_cast<detail::NativeInts*>(p + i * detail::native_width) =
          __builtin_convertvector(part[i], detail::NativeInts);
  }

  /// Sum over the lanes, from the first to the last.
  VADOSE_INLINE friend double sum(const Lanes& a) noexcept {
    double s = 0;
    for (int l = 0; l < lane_count; ++l) s += a[l];
    return s;
  }
  /// Largest lane.
  VADOSE_INLINE friend double max_lane(const Lanes& a) noexcept {
#if defined(__AVX512F__)
    const auto larger = [](detail::NativeVector u, detail::NativeVector v) {
      return u > v ? u : v;
    };
    detail::NativeVector m = a.part[0];
    m = larger(m, __builtin_shufflevector(m, m, 4, 5, 6, 7, 0, 1, 2, 3));
    m = larger(m, __builtin_shufflevector(m, m, 2, 3, 0, 1, 6, 7, 4, 5));
    m = larger(m, __builtin_shufflevector(m, m, 1, 0, 3, 2, 5, 4, 7, 6));
    return m[0];
#else
    detail::NativeVector joined = a.part[0];
    for (int i = 1; i < detail::native_parts; ++i) joined = a.part[i] > joined ? a.part[i] : joined;
    double m = joined[0];
    for (int l = 1; l < detail::native_width; ++l) m = joined[l] > m ? joined[l] : m;
    return m;
#endif
  }
  /// Smallest lane.
  VADOSE_INLINE friend double min_lane(const Lanes& a) noexcept {
    double m = a[0];
    for (int l = 1; l < lane_count; ++l) m = a[l] < m ? a[l] : m;
    return m;
  }
};

/// f(0) .. f(7), for numbers that lie apart. They go straight into registers: a wide load of what was
/// just stored one by one would wait until all of it has reached the cache.
template <class F>
VADOSE_INLINE Lanes lanes_of(F&& f) noexcept {
  Lanes r;
  for (int i = 0; i < detail::native_parts; ++i) {
    const int l = i * detail::native_width;
    if constexpr (detail::native_width == 8)
      r.part[i] = detail::NativeVector{f(l),     f(l + 1), f(l + 2), f(l + 3),
                                       f(l + 4), f(l + 5), f(l + 6), f(l + 7)};
    else if constexpr (detail::native_width == 4)
      r.part[i] = detail::NativeVector{f(l), f(l + 1), f(l + 2), f(l + 3)};
    else
      r.part[i] = detail::NativeVector{f(l), f(l + 1)};
  }
  return r;
}

// Scalar twins, so that `template <class T>` code reads the same for T = Real.
using std::abs;
using std::floor;
using std::max;
using std::min;
using std::sqrt;
/// mask ? a : b, also lane by lane.
VADOSE_INLINE double select(bool mask, double a, double b) noexcept {
  return mask ? a : b;
}
/// mask itself: any lane of one.
VADOSE_INLINE bool any(bool mask) noexcept {
  return mask;
}
/// mask itself: all lanes of one.
VADOSE_INLINE bool all(bool mask) noexcept {
  return mask;
}

/// T is Real or Lanes.
template <class T>
concept Numeric = std::is_same_v<T, Real> || std::is_same_v<T, Lanes>;

/// a / b where b > 0, else `otherwise`.
template <Numeric T>
VADOSE_INLINE T ratio_or(const T& a, const T& b, const T& otherwise) noexcept {
  return select(b > T(0.0), a / max(b, T(1e-300)), otherwise);
}

}  // namespace vadose
