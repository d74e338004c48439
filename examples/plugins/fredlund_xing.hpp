// SPDX-License-Identifier: MIT
#pragma once

// A retention curve: Fredlund and Xing (1994), with their correction that dries the soil at 1 GPa.
//
// A curve gives S of a suction >= 0 and a porosity, and dS/ds. Written for plain numbers, it is called
// once per point; written as a template it would be called for eight.

#include <cmath>
#include <numbers>

#include <vadose/policy/hydraulic.hpp>

struct FredlundXing {
  vadose::Real a = vadose::unset;         ///< suction about the air entry [Pa]
  vadose::Real n = vadose::unset;         ///< steepness [-]
  vadose::Real m = vadose::unset;         ///< [-]
  vadose::Real residual_suction = 1.5e6;  ///< of the correction [Pa]
  static constexpr vadose::Real dry = 1e9;

  void validate() const {
    vadose::check::positive("a", a, "Pa");
    vadose::check::positive("n", n, "-");
    vadose::check::positive("m", m, "-");
    vadose::check::positive("residual_suction", residual_suction, "Pa");
  }

  // S = C(s) ln(e + (s/a)^n)^(-m),  C = 1 - ln(1 + s/s_r) / ln(1 + 1 GPa/s_r)
  vadose::Real saturation(vadose::Real s, vadose::Real /*porosity*/) const noexcept {
    return correction(s) * std::pow(logarithm(s), -m);
  }
  // dS/ds [1/Pa], <= 0
  vadose::Real saturation_slope(vadose::Real s, vadose::Real /*porosity*/) const noexcept {
    if (!(s > 0) || s >= dry) return 0;
    const vadose::Real power = std::pow(s / a, n), log = logarithm(s);
    const vadose::Real of_log = n * power / s / (std::numbers::e + power);
    const vadose::Real of_correction =
        -1 / ((residual_suction + s) * std::log1p(dry / residual_suction));
    return std::pow(log, -m) * (of_correction - m * correction(s) * of_log / log);
  }

 private:
  vadose::Real logarithm(vadose::Real s) const noexcept {
    return std::log(std::numbers::e + std::pow(s / a, n));
  }
  vadose::Real correction(vadose::Real s) const noexcept {
    if (s >= dry) return 0;
    return 1 - std::log1p(s / residual_suction) / std::log1p(dry / residual_suction);
  }
};
static_assert(vadose::RetentionCurve<FredlundXing>);
