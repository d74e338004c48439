// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// A model says by types what physics a scene has. Inherit from a preset and override aliases:
///
///     struct SandSlope : vadose::UnsaturatedModel<vadose::PlaneStrain> {
///       using Skeleton = vadose::law::DruckerPrager;
///     };

#include <type_traits>

#include <vadose/core/field.hpp>
#include <vadose/core/kinematics.hpp>
#include <vadose/policy/conductivity/constant.hpp>
#include <vadose/policy/conductivity/kozeny_carman.hpp>
#include <vadose/policy/conductivity/mualem.hpp>
#include <vadose/policy/drag/darcy.hpp>
#include <vadose/policy/hydraulic_concept.hpp>
#include <vadose/policy/interblock/kirchhoff_blend.hpp>
#include <vadose/policy/law/inviscid_water.hpp>
#include <vadose/policy/law/linear_elastic.hpp>
#include <vadose/policy/law/rigid.hpp>
#include <vadose/policy/shape/gimp.hpp>
#include <vadose/policy/swrc/always_saturated.hpp>
#include <vadose/policy/swrc/tarantino.hpp>
#include <vadose/policy/transfer/transfer.hpp>

namespace vadose {

/// Skeleton of a model without soil: free water only.
struct NoSkeleton {};

/// Liquid of a model without water: dry soil.
struct NoLiquid {};

/// Dry soil.
template <class K>
struct DryModel {
  using Kinematics = K;                           ///< dimension and strains
  using Shape = shape::Gimp;                      ///< shape functions of solid points
  using Transfer = transfer::Flip;                ///< velocities from nodes to points
  using Skeleton = law::LinearElastic;            ///< constitutive law of the soil skeleton
  using Liquid = NoLiquid;                        ///< viscous law of free water
  using Retention = swrc::AlwaysSaturated;        ///< soil-water retention curve
  using Conductivity = conductivity::Constant;    ///< hydraulic conductivity
  using Drag = drag::Darcy;                       ///< force between liquid and skeleton
  using Interblock = interblock::KirchhoffBlend;  ///< unsaturated conductivity between cells
  using SolidUserFields = FieldSet<>;   ///< the host's own fields of solid points, 0 at first
  using LiquidUserFields = FieldSet<>;  ///< the same of liquid points
};

/// Soil whose pores are full, and free water.
template <class K>
struct SaturatedModel : DryModel<K> {
  using Liquid = law::InviscidWater;                ///< water without shear stress
  using Conductivity = conductivity::KozenyCarman;  ///< by porosity
};

/// Soil whose pores are partly filled, and free water: [Zhan] Eqs. (12) to (16).
template <class K>
struct UnsaturatedModel : SaturatedModel<K> {
  using Retention = swrc::Tarantino;          ///< [Zhan] Eq. (12)
  using Conductivity = conductivity::Mualem;  ///< [Zhan] Eqs. (13) to (16)
};

/// Free water only.
template <class K>
struct FreeWaterModel : SaturatedModel<K> {
  using Skeleton = NoSkeleton;  ///< no soil
};

/// M has soil.
template <class M>
inline constexpr bool has_skeleton = !std::is_same_v<typename M::Skeleton, NoSkeleton>;

/// M has water.
template <class M>
inline constexpr bool has_liquid = !std::is_same_v<typename M::Liquid, NoLiquid>;

/// The soil of M can be partly saturated: a retention curve other than AlwaysSaturated.
template <class M>
inline constexpr bool is_unsaturated =
    has_skeleton<M>&& has_liquid<M> && !is_always_saturated<typename M::Retention>;

/// The skeleton of M neither moves nor carries stress: seepage only.
template <class M>
inline constexpr bool is_rigid = law::RigidLaw<typename M::Skeleton>;

/// Model from its policies in the order of TwoPhaseSolver. The conductivity is that of the
/// matching preset: KozenyCarman for AlwaysSaturated, else Mualem.
template <class K, class S, class Law, class R, class D>
struct PositionalModel : UnsaturatedModel<K> {
  using Shape = S;       ///< second parameter
  using Skeleton = Law;  ///< third
  using Retention = R;   ///< fourth
  /// By the retention curve.
  using Conductivity = std::conditional_t<std::is_same_v<R, swrc::AlwaysSaturated>,
                                          typename SaturatedModel<K>::Conductivity,
                                          typename UnsaturatedModel<K>::Conductivity>;
  using Drag = D;  ///< last
};

}  // namespace vadose
