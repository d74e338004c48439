// SPDX-License-Identifier: MIT
#pragma once

#include "../verify_support.hpp"

namespace verify {

/// Response of the clay of [Zhan] Table 1 at a degree of saturation to a small load, from its laws
/// written out.
struct UnsaturatedClosedForm {
  Real suction, stiffness, storage, beta, chi, conductivity;

  UnsaturatedClosedForm(Real young_modulus, bool porosity_dependent, Real saturation = 0.86) {
    constexpr Real n = table1::porosity, lambda = table1::lambda;
    constexpr Real power = 1 / (1 - lambda), b = (1 - lambda) / lambda;
    const Real x = std::pow(std::pow(saturation, -1 / lambda) - 1, 1 / power);
    const Real scale = table1::a * std::pow(n / (1 - n), b) / 9810;
    suction = x / scale;
    const Real xn = std::pow(x, power);
    // dS/dln x < 0
    const Real log_slope = -lambda * power * xn * std::pow(1 + xn, -lambda - 1);
    const Real capacity = -log_slope / suction;
    const Real porosity_slope = porosity_dependent ? log_slope * b / (n * (1 - n)) : 0;
    storage = n * (saturation / table1::bulk_modulus + capacity);
    beta = saturation + n * (1 - n) * porosity_slope;
    chi = saturation - suction * capacity;
    stiffness = oedometric_modulus(young_modulus, table1::poisson_ratio) +
                suction * (1 - n) * porosity_slope;
    const Real bracket = 1 - std::pow(1 - std::pow(saturation, 1 / lambda), lambda);
    conductivity = std::sqrt(saturation) * bracket * bracket;  // relative
    density = (1 - n) * table1::solid_density + n * saturation * 1000;
  }
  /// dp/dq of undrained loading.
  Real undrained() const { return beta / (stiffness * storage + beta * chi); }
  /// Consolidation coefficient [m2/s] at saturated conductivity k.
  Real consolidation(Real k) const {
    return k * conductivity / 9810 / (storage + beta * chi / stiffness);
  }
  /// Speed of the compression wave with the water locked to the grains [m/s].
  Real wave_speed() const { return std::sqrt((stiffness + beta * chi / storage) / density); }

 private:
  Real density;
};

}  // namespace verify
