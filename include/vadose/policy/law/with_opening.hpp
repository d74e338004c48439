// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <concepts>
#include <cstddef>

#include <vadose/policy/law/law_concept.hpp>

namespace vadose::law {

/// Law L has a cut-off and says what it takes: its `prepared()`, or L itself, offers
/// `update(step, stress, state, opening)`, where opening becomes the volume strain beyond what the cut-off
/// lets the soil carry [-], 0 where it does not act.
template <class L>
concept HasCutOff = HasState<L> && requires(const PreparedOf<L>& law, SymTensor<Real, 3>& stress,
                                            StateOf<L, Real>& state, Real& opening) {
  { law.update(StrainStep<Real, 3>{}, stress, state, opening) } -> std::same_as<Status>;
};

/// A law with a cut-off (DruckerPrager, MohrCoulomb) that remembers how far soil has been pulled apart
/// there, and carries no pressure until its grains are back where they parted. Without it, soil that is
/// torn and pressed in turn takes up stress at whatever volume it has, and so swells without end: the runout
/// of a slide of cohesionless soil had porosities of 0.96 under pressure, then one below 0.
///   sigma_m = min(limit, sigma_m + K (d(eps_v) + opening)),  opening = what the cut-off took / K.
/// DEVIATION: not in [Zhan].
/// Its strain follows the volume of the point, also where dispersed grains no longer do.
template <class Base>
struct WithOpening : Base {
  static_assert(HasCutOff<Base>,
                "vadose: law::WithOpening needs a law with a cut-off: update(step, stress, state, "
                "opening) of it or its prepared(), as law::DruckerPrager has it");

  static constexpr bool remembers_opening =
      true;  ///< asks for strains that are those of the volume

  /// State of the law, and the opening.
  template <class T>
  struct State {
    StateOf<Base, T> base{};  ///< of the law
    T opening{0.0};           ///< volume strain since the grains parted [-], >= 0
  };

  /// Outputs of the law, and the opening.
  static constexpr auto outputs() noexcept {
    constexpr auto of_base = vadose::law::outputs<Base>();
    std::array<StateOutput, of_base.size() + 1> list{};
    for (std::size_t i = 0; i < of_base.size(); ++i) list[i] = of_base[i];
    list[of_base.size()] = {"opening", "-", state_size<Base>};
    return list;
  }

  /// Numbers of the law derived once.
  class Prepared {
   public:
    /// That of the law.
    template <class T>
    using State = WithOpening::State<T>;

    /// Derives the numbers.
    explicit Prepared(const Base& law) noexcept : law_(vadose::law::prepared(law)) {}

    /// Stress at the end of a step: of the law, as if the opening belonged to the strain of this step.
    template <class T, int N>
    VADOSE_INLINE Status update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                                State<T>& state) const noexcept {
      StrainStep<T, N> whole = step;
      whole.increment.add_isotropic(T(1.0 / 3.0) * state.opening);
      return law_.update(whole, stress, state.base, state.opening);
    }

   private:
    PreparedOf<Base> law_;
  };
  /// See Prepared.
  Prepared prepared() const noexcept { return Prepared(*this); }

  /// What a new point starts with: that of the law, closed.
  State<Real> initial_state() const noexcept {
    const Base& law = *this;
    return {load_state<Base, Real>(vadose::law::initial_state(law).data()), 0};
  }

  /// Oedometric modulus [Pa], that of the law.
  Real p_wave_modulus(const State<Real>& state) const noexcept {
    return Base::p_wave_modulus(state.base);
  }
  /// Shear modulus [Pa], that of the law.
  Real shear_modulus(const State<Real>& state) const noexcept {
    const Base& law = *this;
    std::array<Real, static_cast<std::size_t>(state_size<Base>) + 1> numbers{};
    store_state<Base, Real>(state.base, numbers.data());
    return vadose::law::shear_modulus(law, numbers.data());
  }

  /// Stress at the end of a step; see the class.
  template <class T, int N>
  Status update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                State<T>& state) const noexcept {
    return prepared().update(step, stress, state);
  }
};

}  // namespace vadose::law
