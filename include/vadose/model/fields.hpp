// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Which fields the points of a model carry: exactly those its physics needs.

#include <vadose/core/field.hpp>
#include <vadose/model/model.hpp>
#include <vadose/policy/law/law_concept.hpp>

namespace vadose {

namespace detail {

template <class M>
constexpr int law_state_size() {
  if constexpr (has_skeleton<M>)
    return law::state_size<typename M::Skeleton>;
  else
    return 0;
}

template <class M>
constexpr bool is_viscous() {
  if constexpr (has_liquid<M>)
    return !M::Liquid::inviscid;
  else
    return false;
}

/// The host's own fields of solid points; none in a model that does not name them.
template <class M>
struct SolidUserFieldsOf {
  using type = FieldSet<>;
};
template <class M>
requires requires {
  typename M::SolidUserFields;
}
struct SolidUserFieldsOf<M> {
  using type = typename M::SolidUserFields;
};
/// The same of liquid points.
template <class M>
struct LiquidUserFieldsOf {
  using type = FieldSet<>;
};
template <class M>
requires requires {
  typename M::LiquidUserFields;
}
struct LiquidUserFieldsOf<M> {
  using type = typename M::LiquidUserFields;
};

/// c if the condition holds, else no component.
constexpr int if_stored(bool condition, int c) {
  return condition ? c : 0;
}

}  // namespace detail

/// The liquid of M has viscosity.
template <class M>
inline constexpr bool is_viscous = detail::is_viscous<M>();

/// The skeleton of M exists and moves.
template <class M>
inline constexpr bool is_deformable = has_skeleton<M> && !is_rigid<M>;

/// Fields of solid points.
template <class M>
using SolidFields = JoinFields<
    FieldSet<
        Sized<field::Id, 1>, Sized<field::Position, M::Kinematics::dim>,
        Sized<field::Velocity, detail::if_stored(is_deformable<M>, M::Kinematics::dim)>,
        Sized<field::Mass, 1>, Sized<field::Volume, 1>,
        Sized<field::BishopStress, detail::if_stored(is_deformable<M>, M::Kinematics::stress_size)>,
        Sized<field::HalfSize,
              detail::if_stored(is_deformable<M>&& M::Shape::uses_half_size, M::Kinematics::dim)>,
        Sized<field::Affine, detail::if_stored(is_deformable<M>&& M::Transfer::affine,
                                               power<2>(M::Kinematics::dim))>,
        Sized<field::LawState, detail::law_state_size<M>()>>,
    typename detail::SolidUserFieldsOf<M>::type>;

/// Fields of liquid points.
template <class M>
using LiquidFields = JoinFields<
    FieldSet<
        Sized<field::Id, 1>, Sized<field::Position, M::Kinematics::dim>,
        Sized<field::Velocity, M::Kinematics::dim>, Sized<field::Mass, 1>, Sized<field::Volume, 1>,
        Sized<field::LiquidPressure, 1>,
        Sized<field::Porosity, detail::if_stored(has_skeleton<M>, 1)>,
        Sized<field::HalfSize,
              detail::if_stored(is_deformable<M>&& M::Shape::uses_half_size, M::Kinematics::dim)>,
        Sized<field::Affine, detail::if_stored(M::Transfer::affine, power<2>(M::Kinematics::dim))>,
        Sized<field::ViscousStress, detail::if_stored(is_viscous<M>, M::Kinematics::stress_size)>>,
    typename detail::LiquidUserFieldsOf<M>::type>;

}  // namespace vadose
