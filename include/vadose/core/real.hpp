// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Scalar and small-vector types of the public interface.

#include <Eigen/Core>
#include <bit>
#include <cstdint>
#include <limits>
#include <numbers>

#ifdef __FAST_MATH__
#error \
    "vadose: -ffast-math breaks NaN tests and floor(); use -O3 -fno-math-errno -fno-trapping-math instead"
#endif

namespace vadose {

/// The one floating-point type. Single precision is not offered: near J = 1 its spacing times
/// a bulk modulus of 2.2 GPa is 0.2 kPa of liquid pressure.
using Real = double;

/// Small vector of the public interface (positions [m], velocities [m/s], gravity [m/s2]).
/// Never aligned, so that its layout does not depend on compiler flags.
template <int N>
using Vec = Eigen::Matrix<Real, N, 1, Eigen::DontAlign>;

/// Default of a mandatory parameter; every check rejects it with the parameter's name.
inline constexpr Real unset = std::numeric_limits<Real>::quiet_NaN();

/// True unless x is NaN or infinite; tests the exponent bits, so that no flag can fold it away.
constexpr bool is_finite(Real x) noexcept {
  return (std::bit_cast<std::uint64_t>(x) & 0x7ff0000000000000ull) != 0x7ff0000000000000ull;
}

/// Angle in radians from degrees.
constexpr Real degrees(Real angle) noexcept {
  return angle * (std::numbers::pi / 180.0);
}

/// Integer power x^N of a scalar or of lanes.
template <int N, class T>
constexpr T power(T x) noexcept {
  static_assert(N >= 0);
  if constexpr (N == 0) {
    return T(1.0);
  } else {
    T y = x;
    for (int i = 1; i < N; ++i) y = y * x;
    return y;
  }
}

/// Standard gravity used for *reference* unit weights [m/s2]; never the scene's gravity.
inline constexpr Real reference_gravity = 9.81;

}  // namespace vadose
