// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Names of what points carry. A point set holds exactly the fields its model needs.

#include <type_traits>

namespace vadose {

/// Field tags: `points.load(field::velocity, batch, axis)`. Each has a name and a unit for files.
namespace field {

/// Number given at creation, kept for life; -1 in padding lanes.
struct Id {
  static constexpr const char* name = "id";
  static constexpr const char* unit = "-";
};
/// Position of a point.
struct Position {
  static constexpr const char* name = "position";
  static constexpr const char* unit = "m";
};
/// Velocity of a point: of grains or of water.
struct Velocity {
  static constexpr const char* name = "velocity";
  static constexpr const char* unit = "m/s";
};
/// Solid or liquid mass; per metre of thickness in plane strain, per radian when axisymmetric.
struct Mass {
  static constexpr const char* name = "mass";
  static constexpr const char* unit = "kg";
};
/// Bulk volume (grains and pores) of a solid or pore-water point; water volume of a free point.
struct Volume {
  static constexpr const char* name = "volume";
  static constexpr const char* unit = "m3";
};
/// Porosity of a pore-water point (1 for free water).
struct Porosity {
  static constexpr const char* name = "porosity";
  static constexpr const char* unit = "-";
};
/// Bishop stress, tension positive; normals first, then tensorial shears.
struct BishopStress {
  static constexpr const char* name = "bishop_stress";
  static constexpr const char* unit = "Pa";
};
/// Half the edge of a GIMP domain along each axis.
struct HalfSize {
  static constexpr const char* name = "half_size";
  static constexpr const char* unit = "m";
};
/// Affine velocity data of APIC (B, m2/s) or TPIC (velocity gradient, 1/s), row-major.
struct Affine {
  static constexpr const char* name = "affine";
  static constexpr const char* unit = "m2/s|1/s";
};
/// Internal variables of the constitutive law.
struct LawState {
  static constexpr const char* name = "law_state";
  static constexpr const char* unit = "-";
};
/// Liquid pressure, compression positive. Free water: the state. Pore water: output and start
/// value of the cell's pressure; the state is the mass.
struct LiquidPressure {
  static constexpr const char* name = "liquid_pressure";
  static constexpr const char* unit = "Pa";
};
/// Storage of a pore-water point, d(theta)/dp.
struct Storage {
  static constexpr const char* name = "storage";
  static constexpr const char* unit = "1/Pa";
};
/// Deviatoric viscous stress of free water.
struct ViscousStress {
  static constexpr const char* name = "viscous_stress";
  static constexpr const char* unit = "Pa";
};

// What functions take, as in `at(field::mass, batch)`.
inline constexpr Id id{};
inline constexpr Position position{};
inline constexpr Velocity velocity{};
inline constexpr Mass mass{};
inline constexpr Volume volume{};
inline constexpr Porosity porosity{};
inline constexpr BishopStress bishop_stress{};
inline constexpr HalfSize half_size{};
inline constexpr Affine affine{};
inline constexpr LawState law_state{};
inline constexpr LiquidPressure liquid_pressure{};
inline constexpr Storage storage{};
inline constexpr ViscousStress viscous_stress{};

}  // namespace field

/// A field with its number of components; 0 components: not stored.
template <class Tag, int Components>
struct Sized {
  using tag = Tag;                               ///< the field
  static constexpr int components = Components;  ///< per point
};

/// The fields of a point set, in storage order. A host's own fields ride along with the points of
/// a model that names them (see DryModel): a tag with name and unit, and its number of components.
template <class... Fields>
struct FieldSet {
  /// Doubles per point.
  static constexpr int total = (0 + ... + Fields::components);

  /// Number of components of Tag, 0 if the set has no such field.
  template <class Tag>
  static constexpr int components() {
    return (0 + ... + (std::is_same_v<Tag, typename Fields::tag> ? Fields::components : 0));
  }
  /// Whether Tag is stored.
  template <class Tag>
  static constexpr bool has = components<Tag>() > 0;

  /// Position of the first component of Tag.
  template <class Tag>
  static constexpr int offset() {
    static_assert(has<Tag>, "vadose: this model does not store the field that is asked for");
    int at = 0;
    bool found = false;
    ((found = found || std::is_same_v<Tag, typename Fields::tag>,
      at += found ? 0 : Fields::components),
     ...);
    return at;
  }

  /// Calls f(tag, components) for every stored field, in order.
  template <class F>
  static void for_each(F&& f) {
    ((Fields::components > 0 ? f(typename Fields::tag{}, Fields::components) : void()), ...);
  }
};

namespace detail {

template <class A, class B>
struct JoinedFields;
template <class... A, class... B>
struct JoinedFields<FieldSet<A...>, FieldSet<B...>> {
  using type = FieldSet<A..., B...>;
};

}  // namespace detail

/// The fields of A, then those of B.
template <class A, class B>
using JoinFields = typename detail::JoinedFields<A, B>::type;

}  // namespace vadose
