// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The contract of a model: one requirement, one sentence. Scene<M> and Solver<M> check it first.

#include <concepts>
#include <type_traits>

#include <vadose/core/kinematics.hpp>
#include <vadose/core/lanes.hpp>
#include <vadose/model/model.hpp>
#include <vadose/policy/hydraulic_concept.hpp>
#include <vadose/policy/law/law_concept.hpp>

namespace vadose {

namespace requirement {

/// The nine aliases of a model.
template <class M>
concept NamesKinematics = requires {
  typename M::Kinematics;
};
template <class M>
concept NamesShape = requires {
  typename M::Shape;
};
template <class M>
concept NamesTransfer = requires {
  typename M::Transfer;
};
template <class M>
concept NamesSkeleton = requires {
  typename M::Skeleton;
};
template <class M>
concept NamesLiquid = requires {
  typename M::Liquid;
};
template <class M>
concept NamesRetention = requires {
  typename M::Retention;
};
template <class M>
concept NamesConductivity = requires {
  typename M::Conductivity;
};
template <class M>
concept NamesDrag = requires {
  typename M::Drag;
};
template <class M>
concept NamesInterblock = requires {
  typename M::Interblock;
};

/// `support` nodes per axis and `weights(position, half_size, values, slopes)`.
template <class S>
concept ShapeFunctions = requires(Real u, Real* w) {
  requires S::support >= 2;
  { S::weights(u, u, w, w) } -> std::convertible_to<Real>;
};
/// Markers `affine`, `blends` and `validate()`.
template <class T>
concept VelocityTransfer = HasValidate<T> && requires {
  { T::affine } -> std::convertible_to<bool>;
  { T::blends } -> std::convertible_to<bool>;
};

/// All eight.
template <class M>
concept NamesAll =
    NamesKinematics<M> && NamesShape<M> && NamesTransfer<M> && NamesSkeleton<M> && NamesLiquid<M> &&
    NamesRetention<M> && NamesConductivity<M> && NamesDrag<M> && NamesInterblock<M>;
/// Kinematics, if named, is one.
template <class M>
concept NoWrongKinematics = !NamesKinematics<M> || KinematicsPolicy<typename M::Kinematics>;

}  // namespace requirement

/// All eight aliases exist, the sentences name those that do not, and Kinematics is one.
template <class M>
struct CheckAliases {
  static_assert(requirement::NamesKinematics<M>,
                "vadose: the model has no alias Kinematics; derive it from a preset such as "
                "UnsaturatedModel<PlaneStrain>");
  static_assert(requirement::NamesShape<M>,
                "vadose: the model has no alias Shape, its shape functions such as shape::Gimp");
  static_assert(requirement::NamesTransfer<M>,
                "vadose: the model has no alias Transfer, such as transfer::Flip");
  static_assert(requirement::NamesSkeleton<M>,
                "vadose: the model has no alias Skeleton, its law such as law::LinearElastic, or "
                "NoSkeleton");
  static_assert(requirement::NamesLiquid<M>,
                "vadose: the model has no alias Liquid, such as law::InviscidWater, or NoLiquid");
  static_assert(requirement::NamesRetention<M>,
                "vadose: the model has no alias Retention, its retention curve such as "
                "swrc::AlwaysSaturated");
  static_assert(requirement::NamesConductivity<M>,
                "vadose: the model has no alias Conductivity, such as conductivity::KozenyCarman");
  static_assert(requirement::NamesDrag<M>,
                "vadose: the model has no alias Drag, such as drag::Darcy");
  static_assert(requirement::NamesInterblock<M>,
                "vadose: the model has no alias Interblock, such as interblock::KirchhoffBlend");
  static_assert(requirement::NoWrongKinematics<M>,
                "vadose: Kinematics must be Uniaxial, PlaneStrain, Axisymmetric, "
                "ThreeDimensional or offer the same members");
};

/// Skeleton L is a constitutive law for stresses of N components.
template <class L, int N>
struct CheckSkeleton {
  static_assert(law::HasState<L>,
                "vadose: Skeleton needs a State: `struct State {...};` of Reals, or empty");
  static_assert(!law::HasState<L> || law::HasUpdate<L, N>,
                "vadose: Skeleton needs `Status update(const StrainStep<Real, N>&, "
                "SymTensor<Real, N>& stress, State&) const`");
  static_assert(!law::HasState<L> || law::HasModulus<L>,
                "vadose: Skeleton needs `Real p_wave_modulus(const State&) const` [Pa]");
  static_assert(HasValidate<L>, "vadose: Skeleton needs `void validate() const`");
};
template <int N>
struct CheckSkeleton<NoSkeleton, N> {};

/// Retention R, conductivity C and drag D can be evaluated with plain numbers.
template <class R, class C, class D>
struct CheckHydraulics {
  static_assert(HasSaturation<R>,
                "vadose: Retention needs `Real saturation(Real suction, Real porosity) const`");
  static_assert(HasSaturationSlope<R>,
                "vadose: Retention needs `Real saturation_slope(Real suction, Real porosity) const`"
                ", dS/ds [1/Pa]");
  static_assert(HasValidate<R>, "vadose: Retention needs `void validate() const`");
  static_assert(HasConductivity<C>,
                "vadose: Conductivity needs `Real conductivity(Real effective_saturation, "
                "Real porosity) const` [m/s]");
  static_assert(HasValidate<C>, "vadose: Conductivity needs `void validate() const`");
  static_assert(HasDragCoefficient<D>,
                "vadose: Drag needs `Real coefficient(Real porosity, Real saturation, "
                "Real conductivity, Real unit_weight) const` per unit liquid volume");
  static_assert(HasValidate<D>, "vadose: Drag needs `void validate() const`");
};

/// The chosen parts fit together.
template <class M>
struct CheckCombination {
  static constexpr int stress_size = M::Kinematics::stress_size;

  static_assert(requirement::ShapeFunctions<typename M::Shape>,
                "vadose: Shape needs `support` and `weights(position, half_size, values, slopes)`");
  static_assert(
      requirement::VelocityTransfer<typename M::Transfer>,
      "vadose: Transfer needs `affine`, `blends` and `validate()`, as transfer::Flip has");
  static_assert(has_skeleton<M> || has_liquid<M>,
                "vadose: the model has neither Skeleton nor Liquid");
  static_assert(has_liquid<M> || !is_rigid<M>,
                "vadose: Skeleton law::Rigid without Liquid leaves nothing to compute");
  static_assert(has_liquid<M> || is_always_saturated<typename M::Retention>,
                "vadose: a model with NoLiquid takes Retention swrc::AlwaysSaturated; a retention "
                "curve needs a Liquid");
  static_assert(has_skeleton<M> || is_always_saturated<typename M::Retention>,
                "vadose: a model with NoSkeleton takes Retention swrc::AlwaysSaturated; a "
                "retention curve needs a Skeleton");
  static_assert(
      InterblockMean<typename M::Interblock, KirchhoffMean<swrc::Tarantino, conductivity::Mualem>>,
      "vadose: Interblock needs `static T mean(const Integral&, const FaceState<T>&)`");
  static_assert(!has_liquid<M> || LiquidLaw<typename M::Liquid, stress_size>,
                "vadose: Liquid needs `inviscid`, `validate()` and, unless inviscid, "
                "`viscous_stress(rate)`");
};

namespace detail {

/// Checks of the parts, for models whose aliases exist and whose kinematics is one.
template <class M, bool Named>
struct CheckParts {};
template <class M>
struct CheckParts<M, true>
    : CheckCombination<M>,
      CheckSkeleton<typename M::Skeleton, M::Kinematics::stress_size>,
      std::conditional_t<
          has_liquid<M> && has_skeleton<M>,
          CheckHydraulics<typename M::Retention, typename M::Conductivity, typename M::Drag>,
          std::true_type> {};

}  // namespace detail

/// Instantiating it checks model M; `ok` is true where this compiles.
template <class M>
struct CheckModel
    : CheckAliases<M>,
      detail::CheckParts<M, requirement::NamesAll<M> && requirement::NoWrongKinematics<M>> {
  static constexpr bool ok = true;  ///< nothing is wrong with M
};

}  // namespace vadose
