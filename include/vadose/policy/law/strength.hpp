// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Cohesion, friction and dilation of frictional laws, constant or mobilised by plastic shear.

#include <cmath>
#include <string>

#include <vadose/core/error.hpp>
#include <vadose/core/lanes.hpp>

namespace vadose::law {

/// Value of `tensile_strength` that leaves the tension to cohesion and friction alone.
inline constexpr Real no_cut_off = std::numeric_limits<Real>::infinity();

/// Value of a strength of `Mobilisation` that equals the law's own (peak) value.
inline constexpr Real as_peak = unset;

/// Cohesion [Pa], friction and dilation angle [rad] of the Mohr-Coulomb envelope.
template <class T>
struct Strength {
  T cohesion = T(as_peak);        ///< c [Pa], >= 0
  T friction_angle = T(as_peak);  ///< phi [rad], in [0, pi/2)
  T dilation_angle = T(as_peak);  ///< psi [rad], in (-pi/2, phi]
};

/// Measure of accumulated plastic shear strain, from deviatoric plastic increments de.
enum class ShearMeasure : unsigned char {
  engineering,  ///< int sqrt(2 de:de), the engineering shear strain of simple shear
  equivalent,   ///< int sqrt(2/3 de:de) = engineering / sqrt(3), the axial strain of triaxial tests
};

/// Strength mobilised by plastic shear strain: piecewise linear from onset (0) over the law's own
/// values at the peak to critical, after Bandara and Soga (2015) as used by [Zhan] 4.4. Off unless
/// critical_shear_strain > 0. Softening makes results depend on the cell size: scale
/// critical_shear_strain with reference over actual cell size where that matters.
/// DEVIATION: the papers state neither the measure of shear nor the interpolated quantity; here
/// the measure is an option and the angles themselves are interpolated.
struct Mobilisation {
  Real peak_shear_strain = 0;      ///< plastic shear strain at the peak [-], >= 0
  Real critical_shear_strain = 0;  ///< plastic shear strain at the critical state [-]; 0: off
  Strength<Real> onset = {};       ///< at zero plastic shear; as_peak: constant up to the peak
  /// At the critical state.
  Strength<Real> critical = {.cohesion = as_peak, .friction_angle = as_peak, .dilation_angle = 0};
  ShearMeasure measure = ShearMeasure::engineering;  ///< of plastic shear

  /// True when the strength changes with plastic shear.
  bool active() const noexcept { return critical_shear_strain != 0; }
};

namespace detail {

/// sin x for |x| <= pi/2, error below 3e-16; the same for a number and for lanes.
template <class T>
VADOSE_INLINE T sine(const T& x) noexcept {
  const T y = x * x;
  T sum(1.0);
  for (int n = 22; n >= 2; n -= 2) sum = T(1.0) - y * sum * T(1.0 / (n * (n + 1)));
  return x * sum;
}

/// cos x for |x| <= pi/2, error below 3e-16; the same for a number and for lanes.
template <class T>
VADOSE_INLINE T cosine(const T& x) noexcept {
  const T y = x * x;
  T sum(1.0);
  for (int n = 23; n >= 1; n -= 2) sum = T(1.0) - y * sum * T(1.0 / (n * (n + 1)));
  return sum;
}

/// Throws SetupError unless the three values make a Mohr-Coulomb envelope.
inline void validate_strength(const std::string& prefix, const Strength<Real>& strength) {
  constexpr Real right_angle = std::numbers::pi / 2;
  const Real friction = strength.friction_angle;
  const Real dilation = strength.dilation_angle;
  check::non_negative(prefix + "cohesion", strength.cohesion, "Pa");
  if (!is_finite(friction) || friction < 0 || friction >= right_angle)
    check::fail(prefix + "friction_angle", friction, "[0, pi/2)", "rad");
  if (friction == 0 && strength.cohesion == 0)
    check::fail(prefix + "friction_angle", friction, "(0, pi/2), as the cohesion is 0,", "rad");
  if (!is_finite(dilation) || dilation <= -right_angle || dilation > friction)
    check::fail(prefix + "dilation_angle", dilation, "(-pi/2, friction_angle]", "rad");
}

/// Throws SetupError unless the cut-off is no_cut_off or a finite stress >= 0.
inline void validate_tensile_strength(Real tensile_strength) {
  if (tensile_strength != no_cut_off)
    check::non_negative("tensile_strength", tensile_strength, "Pa");
}

/// Strength as a function of plastic shear strain, ready for use.
struct StrengthPath {
  Strength<Real> onset, rise, fall;  ///< value at 0, change up to the peak, change after it
  Real peak = 0;                     ///< plastic shear strain at the peak
  Real per_rise = 0, per_fall = 0;   ///< 1 / lengths of the two branches

  StrengthPath() = default;
  StrengthPath(const Mobilisation& mobilisation, const Strength<Real>& at_peak) noexcept
      : peak(mobilisation.peak_shear_strain) {
    const auto start = resolved(mobilisation.onset, at_peak);
    const auto end = resolved(mobilisation.critical, at_peak);
    const Real length = mobilisation.critical_shear_strain - peak;
    onset = peak > 0 ? start : at_peak;
    rise = difference(at_peak, onset);
    fall = difference(end, at_peak);
    per_rise = peak > 0 ? 1 / peak : 0;
    per_fall = length > 0 ? 1 / length : 0;
  }

  /// Strength at accumulated plastic shear strain gamma >= 0.
  template <class T>
  VADOSE_INLINE Strength<T> at(const T& gamma) const noexcept {
    const T zero(0.0), one(1.0);
    const T risen = min(gamma * T(per_rise), one);
    const T fallen = max(zero, min((gamma - T(peak)) * T(per_fall), one));
    const auto value = [&](Real from, Real up, Real down) {
      return T(from) + T(up) * risen + T(down) * fallen;
    };
    return {value(onset.cohesion, rise.cohesion, fall.cohesion),
            value(onset.friction_angle, rise.friction_angle, fall.friction_angle),
            value(onset.dilation_angle, rise.dilation_angle, fall.dilation_angle)};
  }

  /// The given strength with as_peak replaced.
  static Strength<Real> resolved(const Strength<Real>& given,
                                 const Strength<Real>& at_peak) noexcept {
    const auto pick = [](Real a, Real b) { return is_finite(a) ? a : b; };
    return {pick(given.cohesion, at_peak.cohesion),
            pick(given.friction_angle, at_peak.friction_angle),
            pick(given.dilation_angle, at_peak.dilation_angle)};
  }

 private:
  static Strength<Real> difference(const Strength<Real>& a, const Strength<Real>& b) noexcept {
    return {a.cohesion - b.cohesion, a.friction_angle - b.friction_angle,
            a.dilation_angle - b.dilation_angle};
  }
};

/// Throws SetupError unless the mobilisation is off or makes sense with the peak values.
inline void validate_mobilisation(const Mobilisation& mobilisation, const Strength<Real>& at_peak) {
  if (!mobilisation.active()) return;
  check::non_negative("mobilisation.peak_shear_strain", mobilisation.peak_shear_strain, "-");
  const Real critical = mobilisation.critical_shear_strain;
  if (!is_finite(critical) || critical <= mobilisation.peak_shear_strain)
    check::fail("mobilisation.critical_shear_strain", critical, "(peak_shear_strain, inf)", "-");
  validate_strength("mobilisation.onset.", StrengthPath::resolved(mobilisation.onset, at_peak));
  validate_strength("mobilisation.critical.",
                    StrengthPath::resolved(mobilisation.critical, at_peak));
}

}  // namespace detail

}  // namespace vadose::law
