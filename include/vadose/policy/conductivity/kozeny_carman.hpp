// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/core/error.hpp>
#include <vadose/policy/hydraulic_concept.hpp>

namespace vadose {
namespace detail {

/// k = C n^3 / (1-n)^2 with C such that k(reference) = saturated; [Zhan] Eq. (16).
template <class T>
T kozeny_carman(Real saturated, Real reference, T porosity) noexcept {
  const Real solid = 1 - reference;
  const Real factor = saturated * solid * solid / (reference * reference * reference);
  const T rest = T(1.0) - porosity;
  return T(factor) * porosity * porosity * porosity / (rest * rest);
}

/// k_sat(n) of laws with a porosity switch.
template <class T>
T saturated_conductivity(bool porosity_dependent, Real saturated, Real reference,
                         T porosity) noexcept {
  if (!porosity_dependent) return T(saturated);
  return kozeny_carman<T>(saturated, reference, porosity);
}

inline void check_saturated_conductivity(bool porosity_dependent, Real saturated, Real reference) {
  check::positive("saturated_conductivity", saturated, "m/s");
  if (porosity_dependent) check::inside("reference_porosity", reference, 0, 1, "-");
}

}  // namespace detail

namespace conductivity {

/// Saturated conductivity of Kozeny and Carman, k_sat = C n^3 / (1-n)^2, [Zhan] Eq. (16) after
/// Carrier (2003), given by its value at a reference porosity; not reduced by partial saturation.
struct KozenyCarman {
  Real saturated_conductivity = unset;  ///< k_sat at reference_porosity [m/s], > 0
  Real reference_porosity = unset;      ///< [-], (0, 1)
  bool porosity_dependent = true;       ///< false: k_sat at any porosity

  /// Takes the reference porosity from the material where unset.
  void adopt(const SharedParameters& shared) noexcept {
    detail::fill(reference_porosity, shared.reference_porosity);
  }

  void validate() const {
    detail::check_saturated_conductivity(porosity_dependent, saturated_conductivity,
                                         reference_porosity);
  }

  /// k_sat(n) [m/s].
  template <class T>
  T saturated(T porosity) const noexcept {
    return detail::saturated_conductivity<T>(porosity_dependent, saturated_conductivity,
                                             reference_porosity, porosity);
  }
  /// 1 [-].
  template <class T>
  T relative(T /*effective_saturation*/) const noexcept {
    return T(1.0);
  }
  /// k_sat(n) [m/s].
  template <class T>
  T conductivity(T /*effective_saturation*/, T porosity) const noexcept {
    return saturated<T>(porosity);
  }
};

static_assert(FactorisingConductivity<KozenyCarman>);

}  // namespace conductivity
}  // namespace vadose
