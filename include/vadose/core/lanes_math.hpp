// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// exp, log, pow, expm1 and log1p of Lanes: plain vector arithmetic and bit patterns, no table, no
/// branch, the same on every target width. The scalar twins are the standard functions, so that
/// `template <class T>` code calls them unqualified.
///
/// Largest errors (tests/unit/lanes_math.cpp): exp, log, log1p 2 ulp, expm1 2.5 ulp, those in range alike;
/// pow 1e-14 relative for |y log x| < 50 (measured below 8e-16). Subnormal results are 0 and subnormal
/// arguments count as 0, as in kernels that run with FTZ and DAZ. NaN in, NaN out.

#include <cmath>

#include <vadose/core/lanes.hpp>

namespace vadose {

namespace detail {

typedef unsigned long long NativeBits __attribute__((vector_size(8 * native_width)));

VADOSE_INLINE NativeBits bits_of(NativeVector x) noexcept {
  return reinterpret_cast<NativeBits>(x);
}
VADOSE_INLINE NativeVector value_of(NativeBits x) noexcept {
  return reinterpret_cast<NativeVector>(x);
}

inline constexpr double infinity = __builtin_inf();
inline constexpr double smallest_normal = 0x1p-1022;
inline constexpr double ln2_high = 6.93147180369123816490e-01;  // 33 bits: integer multiples exact
inline constexpr double ln2_low = 1.90821492927058770002e-10;
inline constexpr double exp_overflow = 709.782712893383973096;
inline constexpr double exp_underflow = -708.396418532264106224;
inline constexpr unsigned long long mantissa_mask = 0x000fffffffffffffull;
inline constexpr unsigned long long upper_27_bits = 0xfffffffff8000000ull;

/// e^x = 2^k (1 + fraction), |log(1 + fraction)| <= ln(2)/2; shifted holds k in its low bits.
struct ReducedExponential {
  NativeVector shifted;
  NativeVector fraction;
};

/// Argument high + low, |high + low| < 2^20, with up to 26 bits more than a double holds.
VADOSE_INLINE ReducedExponential reduce_exponential(NativeVector high, NativeVector low) noexcept {
  constexpr double log2_e = 1.44269504088896338700;
  constexpr double big = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to an integer
  const NativeVector shifted = (high + low) * log2_e + big;
  const NativeVector k = shifted - big;
  const NativeVector r = (high - k * ln2_high) + (low - k * ln2_low);
  const NativeVector q = r * r;
  // Taylor series of (e^r - 1 - r) / r^2 to r^11, even and odd powers apart; remainder 4e-18
  const NativeVector even =
      ((((q * (1.0 / 479001600.0) + 1.0 / 3628800.0) * q + 1.0 / 40320.0) * q + 1.0 / 720.0) * q +
       1.0 / 24.0) *
          q +
      0.5;
  const NativeVector odd =
      ((((q * (1.0 / 6227020800.0) + 1.0 / 39916800.0) * q + 1.0 / 362880.0) * q + 1.0 / 5040.0) *
           q +
       1.0 / 120.0) *
          q +
      1.0 / 6.0;
  return {shifted, r + q * (even + r * odd)};
}

/// e^(high + low); 0 below exp_underflow, infinite above exp_overflow.
VADOSE_INLINE NativeVector exponential(NativeVector high, NativeVector low) noexcept {
  const NativeVector zero{};
  const NativeVector sum = high + low;
  const NativeMask outside = (sum > 710.0) | (sum < -710.0);
  const ReducedExponential e = reduce_exponential(outside ? zero : high, outside ? zero : low);
  const NativeVector scaled = value_of(bits_of(e.fraction + 1.0) + (bits_of(e.shifted) << 52));
  NativeVector y = sum > exp_overflow ? zero + infinity : scaled;
  y = sum < exp_underflow ? zero : y;
  return sum == sum ? y : sum;
}

/// x = 2^k (1 + f) and the pieces of log(1 + f) = f - half_square + remainder.
struct LogarithmParts {
  NativeVector k;
  NativeVector f;
  NativeVector half_square;
  NativeVector remainder;
};

/// x normal and positive; the rational approximation is the one of FDLIBM's e_log.c.
VADOSE_INLINE LogarithmParts split_logarithm(NativeVector x) noexcept {
  constexpr unsigned long long root_half = 0x3fe6a09e00000000ull;  // sqrt(1/2), shortened
  constexpr unsigned long long one = 0x3ff0000000000000ull;
  const NativeBits shifted = bits_of(x) + (one - root_half);
  LogarithmParts p;
  p.k = value_of((shifted >> 52) | 0x4330000000000000ull) - (4503599627370496.0 + 1023.0);
  p.f = value_of((shifted & mantissa_mask) + root_half) - 1.0;
  const NativeVector s = p.f / (p.f + 2.0);
  const NativeVector z = s * s;
  const NativeVector w = z * z;
  const NativeVector even = w * ((w * 1.531383769920937332e-01 + 2.222219843214978396e-01) * w +
                                 3.999999999940941908e-01);
  const NativeVector odd =
      z *
      (((w * 1.479819860511658591e-01 + 1.818357216161805012e-01) * w + 2.857142874366239149e-01) *
           w +
       6.666666666666735130e-01);
  p.half_square = 0.5 * p.f * p.f;
  p.remainder = s * (p.half_square + (even + odd));
  return p;
}

VADOSE_INLINE NativeVector logarithm(NativeVector x) noexcept {
  const NativeVector zero{};
  const LogarithmParts p = split_logarithm(x);
  NativeVector y = p.k * ln2_high - ((p.half_square - (p.remainder + p.k * ln2_low)) - p.f);
  y = x < smallest_normal ? zero - infinity : y;
  y = x < 0.0 ? zero + __builtin_nan("") : y;
  return x < infinity ? y : x;  // keeps infinity and NaN
}

/// x^y by a logarithm of about 65 bits, so that the error does not grow with |y log x|.
VADOSE_INLINE NativeVector raise(NativeVector x, NativeVector y) noexcept {
  const NativeVector zero{};
  const NativeVector one = zero + 1.0;
  const LogarithmParts p = split_logarithm(x);
  const NativeVector f_high = value_of(bits_of(p.f - p.half_square) & 0xffffffff00000000ull);
  const NativeVector f_low = ((p.f - f_high) - p.half_square) + p.remainder;
  const NativeVector k_high = p.k * ln2_high;  // exact
  const NativeVector sum = k_high + f_high;
  const NativeVector log_high = value_of(bits_of(sum) & upper_27_bits);
  const NativeVector log_low =
      (sum - log_high) + ((f_high - (sum - k_high)) + (f_low + p.k * ln2_low));
  NativeVector power = y > 1e19 ? zero + 1e19 : y;  // beyond, all but x = 1 is 0 or infinite
  power = power < -1e19 ? zero - 1e19 : power;
  const NativeVector power_high = value_of(bits_of(power) & upper_27_bits);
  const NativeVector power_low = power - power_high;
  const NativeVector high = power_high * log_high;  // exact
  NativeVector result = exponential(high, power * log_low + power_low * log_high);
  const NativeVector at_zero = y > 0.0 ? zero : zero + infinity;
  const NativeVector at_infinity = y > 0.0 ? zero + infinity : zero;
  result = x < smallest_normal ? at_zero : result;
  result = x < 0.0 ? zero + __builtin_nan("") : result;
  result = x == infinity ? at_infinity : result;
  result = x == x ? result : x;
  result = y == y ? result : y;
  return y == 0.0 ? one : result;
}

/// e^x - 1 without cancellation.
VADOSE_INLINE NativeVector exponential_less_one(NativeVector x) noexcept {
  const NativeVector zero{};
  NativeVector c = x > 709.0 ? zero + 709.0 : x;
  c = c < -50.0 ? zero - 50.0 : c;
  const ReducedExponential e = reduce_exponential(c, zero);
  const NativeVector scale = value_of((bits_of(e.shifted) << 52) + 0x3ff0000000000000ull);
  const NativeVector y = scale * e.fraction + (scale - 1.0);
  const NativeVector bounded = x > 709.0 ? zero + infinity : y;
  return x == x ? bounded : x;
}

/// e^x and e^x - 1, |x| <= 700 (or NaN, which passes through).
VADOSE_INLINE void exponentials_in_range(NativeVector x, NativeVector& value,
                                         NativeVector& less_one) noexcept {
  const ReducedExponential e = reduce_exponential(x, NativeVector{});
  const NativeBits power = bits_of(e.shifted) << 52;
  const NativeVector scale = value_of(power + 0x3ff0000000000000ull);
  const NativeVector keep_nan = 0.0 * x;
  value = value_of(bits_of(e.fraction + 1.0) + power) + keep_nan;
  less_one = scale * e.fraction + (scale - 1.0) + keep_nan;
}

/// log(x), 1e-300 <= x <= 1e300 (or NaN, which passes through).
VADOSE_INLINE NativeVector logarithm_in_range(NativeVector x) noexcept {
  const LogarithmParts p = split_logarithm(x);
  return p.k * ln2_high - ((p.half_square - (p.remainder + p.k * ln2_low)) - p.f) + 0.0 * x;
}

/// log(1 + x) without cancellation.
VADOSE_INLINE NativeVector logarithm_of_one_plus(NativeVector x) noexcept {
  const NativeVector zero{};
  const NativeVector w = x + 1.0;
  const NativeVector safe = w < 0x1p-60 ? zero + 1.0 : w;
  const NativeVector lost = x - (safe - 1.0);  // what rounding took from 1 + x
  const NativeVector correction = (w < 0x1p-60 ? zero : lost) / safe;
  return x < infinity ? logarithm(w) + (x < 0x1p60 ? correction : zero) : x;
}

}  // namespace detail

/// e^x; 0 for x < -708.39, infinite for x > 709.78.
inline Lanes exp(const Lanes& x) noexcept {
  Lanes r;
  for (int i = 0; i < detail::native_parts; ++i)
    r.part[i] = detail::exponential(x.part[i], detail::NativeVector{});
  return r;
}

/// Natural logarithm; -infinity at 0 and for subnormal x, NaN for x < 0.
inline Lanes log(const Lanes& x) noexcept {
  Lanes r;
  for (int i = 0; i < detail::native_parts; ++i) r.part[i] = detail::logarithm(x.part[i]);
  return r;
}

/// x^y for x >= 0: pow(0, y > 0) = 0, pow(x, 0) = 1, pow(0, y < 0) infinite; NaN for x < 0.
/// 0 and infinite outside the range of exp.
inline Lanes pow(const Lanes& x, const Lanes& y) noexcept {
  Lanes r;
  for (int i = 0; i < detail::native_parts; ++i) r.part[i] = detail::raise(x.part[i], y.part[i]);
  return r;
}
/// x^y with one exponent for all lanes.
inline Lanes pow(const Lanes& x, double y) noexcept {
  return pow(x, Lanes(y));
}

/// e^x - 1, accurate for small |x|; -1 below -50, infinite above 709.
inline Lanes expm1(const Lanes& x) noexcept {
  Lanes r;
  for (int i = 0; i < detail::native_parts; ++i)
    r.part[i] = detail::exponential_less_one(x.part[i]);
  return r;
}

/// log(1 + x), accurate for small |x|; -infinity at x = -1.
inline Lanes log1p(const Lanes& x) noexcept {
  Lanes r;
  for (int i = 0; i < detail::native_parts; ++i)
    r.part[i] = detail::logarithm_of_one_plus(x.part[i]);
  return r;
}

/// An exponential and what it is more than 1.
template <class T>
struct Exponentials {
  T value;     ///< e^x
  T less_one;  ///< e^x - 1
};

// For laws, which know their range: a third fewer operations, on a shorter way.

/// Both for |x| <= 700, without cancellation; NaN for NaN.
VADOSE_INLINE Exponentials<Lanes> exponentials_in_range(const Lanes& x) noexcept {
  Exponentials<Lanes> r;
  for (int i = 0; i < detail::native_parts; ++i)
    detail::exponentials_in_range(x.part[i], r.value.part[i], r.less_one.part[i]);
  return r;
}
/// e^x for |x| <= 700; NaN for NaN.
VADOSE_INLINE Lanes exp_in_range(const Lanes& x) noexcept {
  return exponentials_in_range(x).value;
}
/// Natural logarithm for 1e-300 <= x <= 1e300; NaN for NaN.
VADOSE_INLINE Lanes log_in_range(const Lanes& x) noexcept {
  Lanes r;
  for (int i = 0; i < detail::native_parts; ++i) r.part[i] = detail::logarithm_in_range(x.part[i]);
  return r;
}

// Scalar twins.
/// e^x and e^x - 1.
inline Exponentials<Real> exponentials_in_range(Real x) noexcept {
  return {std::exp(x), std::expm1(x)};
}
/// e^x.
inline Real exp_in_range(Real x) noexcept {
  return std::exp(x);
}
/// Natural logarithm.
inline Real log_in_range(Real x) noexcept {
  return std::log(x);
}
using std::exp;
using std::expm1;
using std::log;
using std::log1p;
using std::pow;

/// e^x to round-off, quickly where all x are small, as strains of a step and p/K are: below 1e-3 the next
/// term of the series is 1e-17.
template <class T>
VADOSE_INLINE T exp_of_small(const T& x) noexcept {
  if (any(T(1e-3) < abs(x))) return exp(x);
  return T(1.0) + x * (T(1.0) + x * (T(0.5) + x * (T(1.0 / 6) + x * T(1.0 / 24))));
}

}  // namespace vadose
