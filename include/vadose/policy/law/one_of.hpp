// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <utility>
#include <variant>

#include <vadose/policy/law/law_concept.hpp>

namespace vadose::law {

namespace detail {

/// State of a law chosen at run time: room for the largest.
template <class T, int Size>
struct Numbers {
  T number[Size] = {};
  VADOSE_INLINE T* data() noexcept { return number; }
  VADOSE_INLINE const T* data() const noexcept { return number; }
};
template <class T>
struct Numbers<T, 0> {
  VADOSE_INLINE T* data() const noexcept { return nullptr; }
};

/// Equal texts, in constant expressions.
constexpr bool same_text(const char* a, const char* b) noexcept {
  while (*a != 0 && *a == *b) ++a, ++b;
  return *a == *b;
}

/// True when law L has no state at all or offers this very output.
template <class L>
constexpr bool agrees_on(const StateOutput& output) noexcept {
  if (state_size<L> == 0) return true;
  for (const StateOutput& other : outputs<L>())
    if (other.index == output.index && same_text(other.name, output.name) &&
        same_text(other.unit, output.unit))
      return true;
  return false;
}

}  // namespace detail

/// A law chosen at run time, material by material: `OneOf<LinearElastic, DruckerPrager>`. The
/// choice is made once per call, above the loop over lanes. Rigid is a choice of the model, not
/// of a material, and is refused here.
template <class... Laws>
class OneOf {
  static_assert(sizeof...(Laws) > 0, "vadose: law::OneOf needs at least one law");
  static_assert((HasState<Laws> && ...), "vadose: every law of law::OneOf needs a State");
  static_assert(!(RigidLaw<Laws> || ...),
                "vadose: law::Rigid is chosen by the model and cannot be one of several laws");
  using First = std::variant_alternative_t<0, std::variant<Laws...>>;

 public:
  /// Any of them takes its openings back.
  static constexpr bool remembers_opening = (RemembersOpening<Laws> || ...);

  /// Numbers of the largest state.
  static constexpr int numbers = std::max({state_size<Laws>...});

  /// Room for the state of any of the laws; smaller states use the first numbers.
  template <class T>
  using State = detail::Numbers<T, numbers>;

  /// The first law with its defaults.
  OneOf() = default;

  /// Chooses one of the laws; converts silently so that `skeleton = DruckerPrager{...}` reads well.
  template <class L>
  requires(std::same_as<std::remove_cvref_t<L>, Laws> || ...) OneOf(L&& law)
      : law_(std::forward<L>(law)) {}  // NOLINT(google-explicit-constructor)

  /// Position of the chosen law in the list, from 0.
  int index() const noexcept { return static_cast<int>(law_.index()); }
  /// The chosen law if it is an L, else null.
  template <class L>
  const L* get_if() const noexcept {
    return std::get_if<L>(&law_);
  }

  /// Checks the chosen law.
  void validate() const {
    std::visit([](const auto& law) { law.validate(); }, law_);
  }

  /// Oedometric modulus of the chosen law [Pa].
  Real p_wave_modulus(const State<Real>& state) const noexcept {
    return std::visit(
        [&](const auto& law) { return vadose::law::p_wave_modulus(law, state.data()); }, law_);
  }

  /// Shear modulus of the chosen law [Pa].
  Real shear_modulus(const State<Real>& state) const noexcept {
    return std::visit(
        [&](const auto& law) { return vadose::law::shear_modulus(law, state.data()); }, law_);
  }

  /// Numbers a new point of the chosen law starts with.
  State<Real> initial_state() const noexcept {
    State<Real> state;
    std::visit(
        [&](const auto& law) {
          const auto numbers_of_law = vadose::law::initial_state(law);
          for (std::size_t i = 0; i < numbers_of_law.size(); ++i)
            state.data()[i] = numbers_of_law[i];
        },
        law_);
    return state;
  }

  /// Runs the chosen law.
  template <class T, int N>
  Status update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                State<T>& state) const noexcept {
    return std::visit([&](const auto& law) { return apply(law, step, stress, state.data()); },
                      law_);
  }

  /// The same choice among prepared laws.
  auto prepared() const noexcept {
    using Result = OneOf<PreparedOf<Laws>...>;
    return std::visit([](const auto& law) { return Result(vadose::law::prepared(law)); }, law_);
  }

  /// The outputs that all laws with a state have in common.
  static constexpr auto outputs() noexcept {
    std::array<StateOutput, output_count()> list{};
    std::size_t count = 0;
    for_each_common([&](const StateOutput& output) { list[count++] = output; });
    return list;
  }

 private:
  /// Outputs of the first law that has a state.
  template <class F>
  static constexpr void for_each_common(F&& f) {
    bool found = false;
    const auto visit_law = [&]<class L>() {
      if (found || state_size<L> == 0) return;
      found = true;
      for (const StateOutput& output : vadose::law::outputs<L>())
        if ((detail::agrees_on<Laws>(output) && ...)) f(output);
    };
    (visit_law.template operator()<Laws>(), ...);
  }
  static constexpr std::size_t output_count() noexcept {
    std::size_t count = 0;
    for_each_common([&](const StateOutput&) { ++count; });
    return count;
  }

  std::variant<Laws...> law_;
};

}  // namespace vadose::law
