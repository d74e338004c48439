// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Mean conductivity of a face from the integral of k over pressure (Kirchhoff's transform), and
/// its blend with the upstream conductivity.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <vadose/core/error.hpp>
#include <vadose/policy/hydraulic_concept.hpp>

namespace vadose {

/// Face conductivity (k_up G + k_K |dp|) / (G + |dp|) [m/s]: the upstream value for gravity, the
/// Kirchhoff mean for suction. G = rho_l |g . dx| [Pa] the pressure head of the face in gravity, dp
/// [Pa] the pressure difference across it; k_up where both are 0.
template <class T>
T blend_conductivity(T upstream, T kirchhoff, T gravity_head, T pressure_difference) noexcept {
  const T drop = abs(pressure_difference);
  const T total = gravity_head + drop;
  const T mean = (upstream * gravity_head + kirchhoff * drop) / max(total, T(1e-300));
  return select(total > T(0.0), mean, upstream);
}

/// k_K = int_{p_a}^{p_b} k dp / (p_b - p_a), built once per material at set-up.
///
/// For curves that depend on x = suction_scale(n) s only and conductivities k_sat(n) k_r(S_e) one
/// table of Phi(x) = int_0^x k_r dx' serves every porosity. Other policies are tabulated over the
/// suction at the reference porosity and scaled by k(1, n) / k(1, n_ref): their retention curve is
/// then taken as independent of porosity, in this mean only.
///
/// Phi and the rest of the integral, Psi(x) = int_x^inf, are stored as logarithms over log(x),
/// cubic with exact derivatives, so that differences keep their relative accuracy both near
/// saturation and far in dry soil. Relative error of the mean below 1e-6 for smooth k_r, about
/// 1e-5 across a kink. Beyond x = 1e8 k is constant, below x = 1e-10 Phi is linear.
template <class Retention, class Conductivity>
class KirchhoffMean {
 public:
  /// The transform factorises exactly.
  static constexpr bool scales =
      ScalingRetention<Retention> && FactorisingConductivity<Conductivity>;

  /// Tabulates the integral; policies must be valid, reference porosity [-] in (0, 1).
  KirchhoffMean(const Retention& retention, const Conductivity& conductivity,
                Real reference_porosity)
      : retention_(retention), conductivity_(conductivity), reference_(reference_porosity) {
    check::inside("reference_porosity", reference_porosity, 0, 1, "-");
    saturated_reference_ = conductivity::saturated<Real>(conductivity_, reference_);
    scale_reference_ = scale<Real>(reference_);
    check::positive("saturated conductivity", saturated_reference_, "m/s");
    tabulate();
  }

  /// Mean conductivity [m/s] between two liquid pressures [Pa] at porosity [-]; k(p) where they are
  /// equal. Symmetric in the pressures.
  Real mean(Real pressure_a, Real pressure_b, Real porosity) const noexcept {
    const Real saturated = conductivity::saturated<Real>(conductivity_, porosity);
    const Real wet = std::max(pressure_a, pressure_b);
    const Real dry = std::min(pressure_a, pressure_b);
    if (dry >= 0) return saturated;
    const Real unit = scale<Real>(porosity);
    const Real x_wet = unit * std::max(-wet, 0.0);
    const Real x_dry = unit * -dry;
    if (wet < 0 && x_dry - x_wet <= 1e-5 * x_dry)  // closer than the table resolves: midpoint
      return saturated * relative<Real>(0.5 * (x_wet + x_dry));
    const Real positive = std::max(wet, 0.0) * unit;
    return saturated * (positive + integral(x_wet, x_dry)) / (positive + (x_dry - x_wet));
  }

  /// The same of eight faces.
  Lanes mean(const Lanes& pressure_a, const Lanes& pressure_b,
             const Lanes& porosity) const noexcept {
    const Lanes zero(0.0), one(1.0);
    const Lanes saturated = conductivity::saturated<Lanes>(conductivity_, porosity);
    const Lanes wet = max(pressure_a, pressure_b), dry = min(pressure_a, pressure_b);
    const Lanes unit = scale<Lanes>(porosity);
    const Lanes x_wet = unit * max(-wet, zero), x_dry = unit * max(-dry, zero);
    const Lanes positive = max(wet, zero) * unit;
    const Lanes width = max(positive + (x_dry - x_wet), Lanes(1e-300));
    const LaneMask close = (wet < zero) & (x_dry - x_wet <= Lanes(1e-5) * x_dry);
    Lanes ratio(0.0);
    if (!all(close)) ratio = (positive + integral(x_wet, x_dry)) / width;
    if (any(close)) ratio = select(close, relative<Lanes>(Lanes(0.5) * (x_wet + x_dry)), ratio);
    return saturated * select(dry < zero, ratio, one);
  }

 private:
  static constexpr Real first_ = 1e-10;
  static constexpr Real last_ = 1e8;
  static constexpr int per_decade_ = 128;
  static constexpr int cells_ = 18 * per_decade_;
  static constexpr Real head_scale_ = 1 / 9810.0;  // x of policies that do not scale: head [m]

  /// log of a positive function at the nodes, and its derivative to log(x).
  struct Curve {
    std::vector<Real> value;
    std::vector<Real> slope;

    Real at(std::size_t i, Real t, Real width) const noexcept {
      const Real rise = value[i + 1] - value[i];
      const Real a = width * slope[i] - rise;
      const Real b = rise - width * slope[i + 1];
      return std::exp(value[i] + t * (rise + (1 - t) * (a * (1 - t) + b * t)));
    }
  };

  template <class T>
  T scale([[maybe_unused]] const T& porosity) const noexcept {
    if constexpr (scales) {
      return swrc::suction_scale<T>(retention_, porosity);
    } else {
      return T(head_scale_);
    }
  }

  /// k / k_sat at scaled suction x.
  template <class T>
  T relative(const T& x) const noexcept {
    const T s = swrc::saturation<T>(retention_, x / T(scale_reference_), T(reference_));
    const T effective = swrc::effective_saturation<T>(retention_, s);
    if constexpr (scales) {
      return conductivity::relative<T>(conductivity_, effective);
    } else {
      return conductivity::value<T>(conductivity_, effective, T(reference_)) /
             T(saturated_reference_);
    }
  }

  /// int k_r dx over log(x) from low to low + width, 5-point Gauss.
  Real cell_integral(Real low, Real width) const noexcept {
    constexpr Real abscissa[3] = {0, 0.538469310105683091036, 0.906179845938663992798};
    constexpr Real weight[3] = {0.568888888888888888889, 0.478628670499366468041,
                                0.236926885056189087514};
    const Real middle = low + 0.5 * width;
    Real sum = 0;
    for (int i = -2; i <= 2; ++i) {
      const int j = i < 0 ? -i : i;
      const Real x = std::exp(middle + (i < 0 ? -0.5 : 0.5) * width * abscissa[j]);
      sum += weight[j] * relative<Real>(x) * x;
    }
    return 0.5 * width * sum;
  }

  void tabulate() {
    log_first_ = std::log(first_);
    width_ = std::log(10.0) / per_decade_;
    std::vector<Real> cell(cells_);
    for (int i = 0; i < cells_; ++i)
      cell[static_cast<std::size_t>(i)] = cell_integral(log_first_ + i * width_, width_);
    Real below = 0;
    for (int i = 400; i > 0; --i) below += cell_integral(log_first_ - 0.1 * i, 0.1);
    relative_last_ = relative<Real>(last_);
    const Real above = std::max(relative_last_ * last_, 1e-290);  // k_r may underflow
    fill(from_wet_, cell, below, false);
    fill(to_dry_, cell, above, true);
    split_ = 0;
    while (split_ < cells_ && from_wet_.value[index(split_)] < to_dry_.value[index(split_)])
      ++split_;
  }

  static std::size_t index(int i) noexcept { return static_cast<std::size_t>(i); }

  /// Running sum of the cell integrals, from the wet end or from the dry end.
  void fill(Curve& curve, const std::vector<Real>& cell, Real sum, bool from_dry_end) {
    curve.value.assign(cell.size() + 1, 0);
    curve.slope.assign(cell.size() + 1, 0);
    for (int k = 0; k <= cells_; ++k) {
      const int i = from_dry_end ? cells_ - k : k;
      if (k > 0) sum += cell[index(from_dry_end ? i : i - 1)];
      const Real x = std::exp(log_first_ + i * width_);
      curve.value[index(i)] = std::log(sum);
      curve.slope[index(i)] = (from_dry_end ? -1 : 1) * x * relative<Real>(x) / sum;
    }
  }

  /// int_{x_wet}^{x_dry} k_r dx.
  Real integral(Real x_wet, Real x_dry) const noexcept {
    Real beyond = 0;
    if (x_dry > last_) {
      beyond = relative_last_ * (x_dry - std::max(x_wet, last_));
      if (x_wet >= last_) return beyond;
      x_dry = last_;
    }
    const Real t_wet = (std::log(std::max(x_wet, first_)) - log_first_) / width_;
    const Real t_dry = (std::log(std::max(x_dry, first_)) - log_first_) / width_;
    if (t_wet >= split_) return beyond + at(to_dry_, t_wet) - at(to_dry_, t_dry);
    const Real wet = at(from_wet_, t_wet) * std::min(x_wet / first_, 1.0);
    const Real dry = at(from_wet_, t_dry) * std::min(x_dry / first_, 1.0);
    return beyond + dry - wet;
  }

  Lanes integral(const Lanes& x_wet, const Lanes& x_dry) const noexcept {
    const Lanes last(last_), first(first_), one(1.0);
    const Lanes beyond = Lanes(relative_last_) * max(x_dry - max(x_wet, last), Lanes(0.0));
    const Lanes low = min(x_wet, last), high = min(x_dry, last);
    const auto place = [&](const Lanes& x) {
      return (log_in_range(max(x, first)) - Lanes(log_first_)) * Lanes(1 / width_);
    };
    const Lanes t_low = place(low), t_high = place(high);
    const LaneMask dry_side = t_low >= Lanes(split_);
    const Lanes a = at(dry_side, t_low) * select(dry_side, one, min(low / first, one));
    const Lanes b = at(dry_side, t_high) * select(dry_side, one, min(high / first, one));
    return beyond + select(dry_side, a - b, b - a);
  }

  /// Value of either curve, lane by lane, at place t of the table.
  Lanes at(const LaneMask& dry_side, const Lanes& t) const noexcept {
    const Lanes zero(0.0);
    const Lanes cell = min(select(t > zero, floor(t), zero), Lanes(cells_ - 1.0));  // NaN: 0
    alignas(32) int number[lane_count];
    cell.store_integers(number);
    alignas(64) double value[2][lane_count], slope[2][lane_count];
    for (int l = 0; l < lane_count; ++l) {
      const Curve& curve = dry_side[l] ? to_dry_ : from_wet_;
      for (int i = 0; i < 2; ++i) {
        value[i][l] = curve.value[index(number[l] + i)];
        slope[i][l] = curve.slope[index(number[l] + i)];
      }
    }
    const Lanes f = t - cell, rest = Lanes(1.0) - f, width(width_);
    const Lanes rise = Lanes::load(value[1]) - Lanes::load(value[0]);
    const Lanes a = width * Lanes::load(slope[0]) - rise;
    const Lanes b = rise - width * Lanes::load(slope[1]);
    return exp_in_range(Lanes::load(value[0]) + f * (rise + rest * (a * rest + b * f)));
  }

  Real at(const Curve& curve, Real t) const noexcept {
    const int i = std::clamp(static_cast<int>(t), 0, cells_ - 1);
    return curve.at(index(i), t - i, width_);
  }

  Retention retention_;
  Conductivity conductivity_;
  Real reference_;
  Real saturated_reference_ = 0;
  Real scale_reference_ = 1;
  Real relative_last_ = 0;  ///< k_r at the end of the table
  Real log_first_ = 0;
  Real width_ = 0;
  int split_ = 0;
  Curve from_wet_;
  Curve to_dry_;
};

}  // namespace vadose
