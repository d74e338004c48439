// SPDX-License-Identifier: MIT
#pragma once

// A constitutive law: elastic soil that cracks where its mean stress exceeds a limit.
//
// A law is a small struct of parameters. It adds to the Bishop stress (tension positive, rotated
// already) what a strain increment does to it, and keeps the history of a point in its State.

#include <vadose/policy/law.hpp>

struct NoTension {
  vadose::law::LinearElastic elastic;
  vadose::Real tensile_strength = 0;  ///< largest mean stress [Pa], >= 0

  // One number per point, stored because it is there; an empty State stores nothing.
  template <class T>
  struct State {
    T opening{0.0};  ///< volumetric strain of the cracks so far [-]
  };

  // Output files get the numbers of the state under these names.
  static constexpr std::array<vadose::law::StateOutput, 1> outputs() noexcept {
    return {{{"opening", "-", 0}}};
  }

  // Refuse what makes no sense; the message names value, unit and allowed range.
  void validate() const {
    elastic.validate();
    vadose::check::non_negative("tensile_strength", tensile_strength, "Pa");
  }

  // Limits the time step: no uniaxial stiffness of the law may be larger.
  vadose::Real p_wave_modulus(const State<vadose::Real>&) const noexcept {
    return elastic.p_wave_modulus();
  }

  // T is one point or eight (Lanes), N the number of stress components of the model. No branches on
  // values: min, max and select() work for both.
  template <class T, int N>
  vadose::Status update(const vadose::StrainStep<T, N>& step, vadose::SymTensor<T, N>& stress,
                        State<T>& state) const noexcept {
    using vadose::max;
    vadose::law::LinearElastic::State<T> none;
    elastic.update(step, stress, none);
    const T excess = max(stress.mean() - T(tensile_strength), T(0.0));
    stress.add_isotropic(T(0.0) - excess);
    state.opening += excess * T(1 / elastic.bulk_modulus());
    return vadose::Status::ok;
  }
};
static_assert(vadose::ConstitutiveLaw<NoTension, 6>);
