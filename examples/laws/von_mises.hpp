// SPDX-License-Identifier: MIT
#pragma once

#include <numbers>

#include <vadose/policy/law.hpp>

/// Undrained clay, perfectly plastic: a complete law in plain doubles with an ordinary `if`.
struct VonMises {
  vadose::law::LinearElastic elastic;
  vadose::Real undrained_strength = vadose::unset;  ///< s_u [Pa]

  struct State {
    vadose::Real plastic_shear_strain = 0;  ///< an empty State stores nothing
  };

  void validate() const {
    elastic.validate();
    vadose::check::positive("undrained_strength", undrained_strength, "Pa");
  }

  vadose::Real p_wave_modulus(const State&) const noexcept { return elastic.p_wave_modulus(); }

  template <int N>  // 3 = uniaxial, 4 = plane strain or axisymmetric, 6 = 3D: one source for all
  vadose::Status update(const vadose::StrainStep<vadose::Real, N>& step,
                        vadose::SymTensor<vadose::Real, N>& stress, State& state) const noexcept {
    vadose::law::LinearElastic::State<vadose::Real> none;
    elastic.update(step, stress, none);  // trial stress
    const auto s = stress.deviator();
    const vadose::Real excess = s.norm() - std::numbers::sqrt2 * undrained_strength;
    if (excess <= 0) return vadose::Status::ok;
    state.plastic_shear_strain += excess / (std::numbers::sqrt2 * elastic.shear_modulus());
    stress -= (excess / s.norm()) * s;  // radial return
    return vadose::Status::ok;
  }
};
static_assert(vadose::ConstitutiveLaw<VonMises, 6>);
