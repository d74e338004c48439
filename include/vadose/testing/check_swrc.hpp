// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Checks that every soil-water retention curve must pass, for authors of curves:
///
///     const auto report = vadose::testing::check_swrc(MyCurve{...});
///     if (!report.ok()) std::fputs(report.text().c_str(), stderr);

#include <cmath>
#include <string>

#include <vadose/policy/hydraulic_concept.hpp>
#include <vadose/testing/report.hpp>

namespace vadose::testing {

/// Where a curve is tried.
struct SwrcCheckOptions {
  Real least_porosity = 0.3;     ///< [-]
  Real largest_porosity = 0.5;   ///< [-]
  Real least_suction = 1;        ///< [Pa]
  Real largest_suction = 1e8;    ///< [Pa]
  Real infinite_suction = 1e15;  ///< [Pa], where S must have come near S_res ...
  Real dry_tolerance = 0.1;      ///< ... to this [-]
  int points = 400;              ///< suctions per porosity
  std::uint64_t seed = 1;        ///< of the random numbers
};

namespace detail {

template <class Curve>
class SwrcCheck {
 public:
  SwrcCheck(const Curve& curve, const SwrcCheckOptions& options, Report& report)
      : curve_(curve), o_(options), report_(report), random_(options.seed) {}

  /// All checks at one porosity.
  void run(Real n) {
    n_ = n;
    residual_ = swrc::residual_saturation(curve_);
    report_.expect("limits", at("|S(0) - 1|", 0), std::fabs(S(0) - 1), 1e-12);
    if constexpr (!is_always_saturated<Curve>) {
      const Real dry = S(o_.infinite_suction);
      report_.expect("limits", at("S - S_res of dry soil", o_.infinite_suction), dry - residual_,
                     o_.dry_tolerance);
      report_.expect("limits", at("S_res - S of dry soil", o_.infinite_suction), residual_ - dry,
                     1e-12);
    }
    slope(0);
    Real s_before = 0, before = S(0);
    for (int i = 0; i < o_.points; ++i) {
      const Real s = o_.least_suction * std::pow(o_.largest_suction / o_.least_suction,
                                                 (i + random_(0, 1)) / o_.points);
      const Real now = S(s);
      report_.expect("S never rises with suction", at("S less that at the suction before", s),
                     s > s_before ? now - before : 0, 1e-12);
      report_.expect("S in [S_res, 1]", at("S - 1", s), now - 1, 1e-12);
      report_.expect("S in [S_res, 1]", at("S_res - S", s), residual_ - now, 1e-12);
      slope(s);
      differences(s);
      inverse(s);
      lanes(s);
      s_before = s;
      before = now;
    }
  }

 private:
  Real S(Real s) const { return swrc::saturation<Real>(curve_, s, n_); }

  void slope(Real s) {
    const Real slope = swrc::slope<Real>(curve_, s, n_);
    report_.expect("slope is never positive", at("dS/ds [1/Pa]", s), slope, 0);
    report_.expect("slope is never positive", at("|dS/ds| is finite [1/Pa]", s), std::fabs(slope),
                   1e300);
    const auto both = swrc::saturation_and_slope<Real>(curve_, s, n_);
    report_.expect("S and slope together", at("less S by itself", s),
                   std::fabs(both.saturation - S(s)), 1e-12);
    report_.expect("S and slope together", at("less the slope by itself, times s", s),
                   std::fabs(both.slope - slope) * s, 1e-12);
  }

  /// Both slopes against differences. A curve may have kinks; they count where both sides agree.
  void differences(Real s) {
    const Real h = 1e-5 * s;
    const Real left = (S(s) - S(s - h)) / h, right = (S(s + h) - S(s)) / h;
    const Real round_off = 1e-15 / h, kink = std::fabs(left - right);
    report_.expect("slope against difference", at("error of s dS/ds", s),
                   s * std::fabs(swrc::slope<Real>(curve_, s, n_) - 0.5 * (left + right)),
                   s * (kink + 10 * round_off) + 1e-9);
    const Real d = 1e-5 * n_;
    const Real central =
        (swrc::saturation<Real>(curve_, s, n_ + d) - swrc::saturation<Real>(curve_, s, n_ - d)) /
        (2 * d);
    report_.expect("dS/dn against difference", at("error of dS/dn", s),
                   std::fabs(swrc::porosity_slope<Real>(curve_, s, n_) - central),
                   1e-6 + 1e-4 * std::fabs(central));
  }

  /// The suction of S(s) has that S; where the curve is steep enough it is s.
  void inverse(Real s) {
    const Real target = S(s);
    if (!(target < 1 - 1e-9) || !(target > residual_ + 1e-9)) return;
    const Real back = swrc::suction(curve_, target, n_);
    report_.expect("suction is the inverse", at("error of S", s), std::fabs(S(back) - target),
                   1e-9);
    if (std::fabs(s * swrc::slope<Real>(curve_, s, n_)) > 1e-3)
      report_.expect("suction is the inverse", at("error of s over s", s), std::fabs(back / s - 1),
                     1e-6);
  }

  void lanes(Real s) {
    Lanes suctions;
    for (int l = 0; l < lane_count; ++l) suctions.set(l, s * (1 + 0.1 * l));
    const Lanes values = swrc::saturation<Lanes>(curve_, suctions, Lanes(n_));
    const Lanes slopes = swrc::slope<Lanes>(curve_, suctions, Lanes(n_));
    for (int l = 0; l < lane_count; ++l) {
      const Real x = suctions[l];
      report_.expect("lanes agree with numbers", at("S", x), std::fabs(values[l] - S(x)), 1e-12);
      report_.expect("lanes agree with numbers", at("s dS/ds", x),
                     x * std::fabs(slopes[l] - swrc::slope<Real>(curve_, x, n_)), 1e-11);
    }
  }

  std::string at(const std::string& what, Real s) const {
    char buffer[80];
    std::snprintf(buffer, sizeof buffer, " at s = %.6g Pa, n = %.4g", s, n_);
    return what + buffer;
  }

  const Curve& curve_;
  const SwrcCheckOptions& o_;
  Report& report_;
  Random random_;
  Real n_ = 0, residual_ = 0;
};

}  // namespace detail

/// Checks a curve with its parameters over a range of suctions and porosities: S(0) = 1, S falls to
/// S_res and never rises; dS/ds <= 0, finite and the slope of S; dS/dn likewise; suction(S) is the
/// inverse; eight points at once as one by one; the optional members agree with the mandatory ones.
template <RetentionCurve Curve>
Report check_swrc(const Curve& curve, const SwrcCheckOptions& options = {}) {
  Report report;
  detail::SwrcCheck<Curve> check(curve, options, report);
  for (int i = 0; i < 3; ++i)
    check.run(options.least_porosity +
              0.5 * i * (options.largest_porosity - options.least_porosity));
  return report;
}

}  // namespace vadose::testing
