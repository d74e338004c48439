// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The contract of a constitutive law, access to its state, and the adapter that runs any law on
/// eight points at once.
///
/// A law is a small value type with
/// - `State`, the history of one point: either `template <class T> struct State` whose members
///   are all T (T = Real or Lanes), or a plain `struct State` whose members are all Real. It may
///   be empty; then nothing is stored;
/// - `template <class T, int N> Status update(const StrainStep<T, N>& step,
///   SymTensor<T, N>& stress, State<T>& state) const noexcept`, or the same with Real only.
///   `stress` is the Bishop stress [Pa, tension +], already co-rotated; the law adds what the
///   strain increment does to it. With T = Lanes it is written without branches, by select();
/// - `Real p_wave_modulus(const State<Real>&) const noexcept`, the oedometric modulus E_c [Pa]
///   that limits the time step;
/// - `void validate() const`, which throws SetupError through vadose::check.
///
/// Optional: `shear_modulus(state)`, the elastic G [Pa] that an implicit skeleton takes;
/// `static constexpr bool scalar_only = true` (its update is a template but holds
/// ordinary branches), `outputs()` (numbers of the state that go to files), `initial_state()`
/// (where defaults of State are not enough), `prepared()` (derived numbers computed once).

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <type_traits>
#include <utility>

#include <vadose/core/error.hpp>
#include <vadose/core/lanes.hpp>
#include <vadose/core/sym_tensor.hpp>

namespace vadose::law {

namespace detail {

template <class L>
concept TemplateState = requires {
  typename L::template State<Real>;
};

template <class L>
concept PlainState = !TemplateState<L> && requires {
  typename L::State;
};

template <class L, class T>
struct StateType {};
template <TemplateState L, class T>
struct StateType<L, T> {
  using type = typename L::template State<T>;
};
template <PlainState L, class T>
requires(std::is_same_v<T, Real> || std::is_empty_v<typename L::State>) struct StateType<L, T> {
  using type = typename L::State;
};

template <class S>
concept NumbersOnly = std::is_trivially_copyable_v<S> && std::is_default_constructible_v<S> &&
    (std::is_empty_v<S> || (sizeof(S) % sizeof(Real) == 0 && alignof(S) == alignof(Real)));

template <class L>
concept ScalarOnly = requires {
  requires L::scalar_only;
};

}  // namespace detail

/// State of law L for T = Real or Lanes. A plain State exists for Real only, unless it is empty.
template <class L, class T>
using StateOf = typename detail::StateType<L, T>::type;

/// L names a State made of numbers only (trivially copyable, default constructible).
template <class L>
concept HasState = requires {
  typename StateOf<L, Real>;
}
&&detail::NumbersOnly<StateOf<L, Real>>;

/// Count of Reals that a point stores for law L; 0 for an empty State.
template <HasState L>
inline constexpr int state_size = std::is_empty_v<StateOf<L, Real>>
                                      ? 0
                                      : static_cast<int>(sizeof(StateOf<L, Real>) / sizeof(Real));

/// `Status update(const StrainStep<Real, N>&, SymTensor<Real, N>&, State&) const` exists.
template <class L, int N>
concept HasUpdate = HasState<L> && requires(const L& law, const StrainStep<Real, N>& step,
                                            SymTensor<Real, N>& stress, StateOf<L, Real>& state) {
  { law.update(step, stress, state) } -> std::same_as<Status>;
};

/// `Real p_wave_modulus(const State&) const` exists.
template <class L>
concept HasModulus = HasState<L> && requires(const L& law, const StateOf<L, Real>& state) {
  { law.p_wave_modulus(state) } -> std::convertible_to<Real>;
};

/// `void validate() const` exists.
template <class L>
concept HasValidate = requires(const L& law) {
  law.validate();
};

/// L's update accepts eight points at once and L does not refuse it by `scalar_only`.
template <class L, int N>
concept LaneLaw = !detail::ScalarOnly<L> && HasState<L> &&
                  requires(const L& law, const StrainStep<Lanes, N>& step,
                           SymTensor<Lanes, N>& stress, StateOf<L, Lanes>& state) {
  { law.update(step, stress, state) } -> std::same_as<Status>;
};

/// A skeleton without deformation (`static constexpr bool rigid = true`).
template <class L>
concept RigidLaw = requires {
  requires L::rigid;
};

/// L knows how far its soil has been pulled apart (`static constexpr bool remembers_opening = true`): its
/// volume strain must be that of the volume.
template <class L>
concept RemembersOpening = requires {
  requires L::remembers_opening;
};

}  // namespace vadose::law

namespace vadose {

/// L meets the whole contract of a law for stresses of N components (3, 4 or 6).
template <class L, int N>
concept ConstitutiveLaw =
    law::HasState<L> && law::HasUpdate<L, N> && law::HasModulus<L> && law::HasValidate<L>;

/// Law of the liquid's deviatoric stress: a marker `inviscid`, and unless it is true
/// `viscous_stress(rate)`, the deviatoric stress [Pa] of a rate of deformation [1/s].
template <class L, int N>
concept LiquidLaw = law::HasValidate<L> && requires {
  { L::inviscid } -> std::convertible_to<bool>;
} &&(L::inviscid || requires(const L& law, const SymTensor<Lanes, N>& rate) {
  { law.viscous_stress(rate) } -> std::same_as<SymTensor<Lanes, N>>;
});

}  // namespace vadose

namespace vadose::law {

using vadose::ConstitutiveLaw;
using vadose::LiquidLaw;

/// One number of a law's state that goes to output files.
struct StateOutput {
  const char* name;  ///< name of the field
  const char* unit;  ///< its unit, "-" where it has none
  int index;         ///< which number of the State, from 0
};

/// What law L offers for output: its `static constexpr std::array<StateOutput, n> outputs()`, or
/// nothing.
template <HasState L>
constexpr auto outputs() noexcept {
  if constexpr (requires { L::outputs(); })
    return L::outputs();
  else
    return std::array<StateOutput, 0>{};
}

/// State of one point from its stored numbers; `numbers` holds state_size<L> of them.
template <HasState L, class T>
VADOSE_INLINE StateOf<L, T> load_state(const T* numbers) noexcept {
  using S = StateOf<L, T>;
  constexpr std::size_t size = static_cast<std::size_t>(state_size<L>);
  if constexpr (size == 0) {
    static_cast<void>(numbers);
    return S{};
  } else {
    static_assert(sizeof(S) == size * sizeof(T),
                  "vadose: State<T> must hold members of type T only");
    std::array<T, size> copy;
    for (std::size_t i = 0; i < size; ++i) copy[i] = numbers[i];
    return std::bit_cast<S>(copy);
  }
}

/// Writes the state_size<L> numbers of one point's state.
template <HasState L, class T>
VADOSE_INLINE void store_state(const StateOf<L, T>& state, T* numbers) noexcept {
  constexpr std::size_t size = static_cast<std::size_t>(state_size<L>);
  if constexpr (size == 0) {
    static_cast<void>(state);
    static_cast<void>(numbers);
  } else {
    const auto copy = std::bit_cast<std::array<T, size>>(state);
    for (std::size_t i = 0; i < size; ++i) numbers[i] = copy[i];
  }
}

/// Numbers a new point starts with: `law.initial_state()` where L has one, else State's defaults.
template <HasState L>
std::array<Real, static_cast<std::size_t>(state_size<L>)> initial_state(const L& law) noexcept {
  std::array<Real, static_cast<std::size_t>(state_size<L>)> numbers{};
  if constexpr (requires { law.initial_state(); })
    store_state<L, Real>(law.initial_state(), numbers.data());
  else
    store_state<L, Real>(StateOf<L, Real>{}, numbers.data());
  return numbers;
}

/// Oedometric modulus E_c [Pa] of a point from its stored numbers.
template <HasModulus L>
Real p_wave_modulus(const L& law, const Real* numbers) noexcept {
  return law.p_wave_modulus(load_state<L, Real>(numbers));
}

/// Elastic shear modulus G [Pa] of a point from its stored numbers: `law.shear_modulus(state)` where L has
/// one, else 0.3 E_c, which lies within a factor of two of the stiffness of any Poisson's ratio from 0 to
/// 0.5: an implicit skeleton is stable with it.
template <HasModulus L>
Real shear_modulus(const L& law, const Real* numbers) noexcept {
  if constexpr (requires(const StateOf<L, Real>& s) {
                  { law.shear_modulus(s) } -> std::convertible_to<Real>;
                })
    return law.shear_modulus(load_state<L, Real>(numbers));
  else
    return 0.3 * p_wave_modulus(law, numbers);
}

/// The law with all numbers derived from its parameters: `law.prepared()` where L has one, else
/// a copy. Its update does the same; take it once, above the loop over points.
template <HasState L>
auto prepared(const L& law) noexcept {
  if constexpr (requires { law.prepared(); })
    return law.prepared();
  else
    return law;
}

/// Type of prepared(law).
template <HasState L>
using PreparedOf = decltype(prepared(std::declval<const L&>()));

namespace detail {

/// Lane-by-lane run of a law that knows plain doubles only.
template <class L, int N>
Status apply_each_lane(const L& law, const StrainStep<Lanes, N>& step, SymTensor<Lanes, N>& stress,
                       Lanes* state) noexcept {
  constexpr int size = state_size<L>;
  Status status = Status::ok;
  for (int lane = 0; lane < lane_count; ++lane) {
    StrainStep<Real, N> one_step;
    SymTensor<Real, N> one_stress;
    Real numbers[size + 1] = {};
    one_step.dt = step.dt;
    for (int i = 0; i < N; ++i) one_step.increment[i] = step.increment[i][lane];
    for (int i = 0; i < N; ++i) one_stress[i] = stress[i][lane];
    for (int i = 0; i < size; ++i) numbers[i] = state[i][lane];
    StateOf<L, Real> one_state = load_state<L, Real>(numbers);
    status = status | law.update(one_step, one_stress, one_state);
    store_state<L, Real>(one_state, numbers);
    for (int i = 0; i < N; ++i) stress[i].set(lane, one_stress[i]);
    for (int i = 0; i < size; ++i) state[i].set(lane, numbers[i]);
  }
  return status;
}

}  // namespace detail

/// Runs a law on eight points. `state` holds state_size<L> lanes (may be null when that is 0).
/// A law that knows plain doubles only is run lane by lane.
template <class L, int N>
requires HasUpdate<L, N> VADOSE_INLINE Status apply(const L& law, const StrainStep<Lanes, N>& step,
                                                    SymTensor<Lanes, N>& stress, Lanes* state)
noexcept {
  if constexpr (LaneLaw<L, N>) {
    StateOf<L, Lanes> lanes = load_state<L, Lanes>(state);
    const Status status = law.update(step, stress, lanes);
    store_state<L, Lanes>(lanes, state);
    return status;
  } else {
    return detail::apply_each_lane(law, step, stress, state);
  }
}

/// Runs a law on one point. `state` holds state_size<L> numbers (may be null when that is 0).
template <class L, int N>
requires HasUpdate<L, N> VADOSE_INLINE Status apply(const L& law, const StrainStep<Real, N>& step,
                                                    SymTensor<Real, N>& stress, Real* state)
noexcept {
  StateOf<L, Real> one = load_state<L, Real>(state);
  const Status status = law.update(step, stress, one);
  store_state<L, Real>(one, state);
  return status;
}

}  // namespace vadose::law
