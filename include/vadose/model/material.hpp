// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The numbers of one soil.

#include <string>
#include <type_traits>

#include <vadose/core/error.hpp>
#include <vadose/model/check_model.hpp>
#include <vadose/policy/hydraulic_concept.hpp>

namespace vadose {

/// Stands for a parameter set that the model has no use for; empty.
template <int Which>
struct Absent {};

namespace detail {

/// T in a model with water in soil, else an empty type.
template <class M, class T, int Which>
using IfWet = std::conditional_t<has_skeleton<M> && has_liquid<M>, T, Absent<Which>>;

/// Checks a parameter set, naming it in the message.
template <class Policy>
void validate_part(const std::string& part, const std::string& material, const Policy& policy) {
  if constexpr (requires { policy.validate(); })
    check::in_context(part + " of " + material, [&] { policy.validate(); });
}

}  // namespace detail

/// Parameters of one soil of model M. Porosity, unit weight and lambda are stated once and handed
/// to the policies that use them and do not state their own. Parts that M has not are empty:
///
///     const Material<SandSlope> sand{.name = "sand",
///                                    .solid_density = 2670,
///                                    .porosity = 0.48,
///                                    .skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.33}};
template <class M>
struct Material {
  static_assert(CheckModel<M>::ok);

  std::string name = "soil";   ///< for messages and files
  Real solid_density = unset;  ///< rho_s, intrinsic [kg/m3], > 0; not needed if rigid
  Real porosity = unset;       ///< n at the start, also the reference porosity [-], in (0, 1)
  Real lambda = unset;  ///< [-], in (0, 1); for the retention and conductivity curves that have it
  /// gamma_l = 9.81 rho_l [N/m3], > 0, unless given; a reference, never the scene's gravity.
  Real unit_weight = unset;
  [[no_unique_address]] typename M::Skeleton skeleton = {};  ///< constitutive law
  [[no_unique_address]] detail::IfWet<M, typename M::Retention, 0> retention = {};  ///< S(s, n)
  [[no_unique_address]] detail::IfWet<M, typename M::Conductivity, 1> conductivity = {};  ///< k
  [[no_unique_address]] detail::IfWet<M, typename M::Drag, 2> drag = {};  ///< liquid on skeleton

  /// "material 'name'".
  std::string label() const { return "material '" + name + "'"; }

  /// A copy whose unit weight is set and whose policies have taken the shared numbers.
  Material resolved(Real default_unit_weight) const {
    Material copy = *this;
    if (copy.unit_weight != copy.unit_weight) copy.unit_weight = default_unit_weight;
    const SharedParameters shared{.liquid_unit_weight = copy.unit_weight,
                                  .reference_porosity = copy.porosity,
                                  .lambda = copy.lambda};
    adopt_shared(copy.retention, shared);
    adopt_shared(copy.conductivity, shared);
    adopt_shared(copy.drag, shared);
    return copy;
  }

  /// Raises SetupError unless all parameters are in range.
  void validate(Real default_unit_weight = 1000 * reference_gravity) const {
    const Material all = resolved(default_unit_weight);
    check::in_context(label(), [&] {
      if (!is_rigid<M> || solid_density == solid_density)
        check::positive("solid_density", solid_density, "kg/m3");
      check::inside("porosity", porosity, 0, 1, "-");
      if (lambda == lambda) check::inside("lambda", lambda, 0, 1, "-");
      check::positive("unit_weight", all.unit_weight, "N/m3");
    });
    detail::validate_part("skeleton", label(), all.skeleton);
    detail::validate_part("retention", label(), all.retention);
    detail::validate_part("conductivity", label(), all.conductivity);
    detail::validate_part("drag", label(), all.drag);
  }
};

}  // namespace vadose
