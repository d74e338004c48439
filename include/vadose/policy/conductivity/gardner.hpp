// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/core/error.hpp>
#include <vadose/policy/conductivity/kozeny_carman.hpp>
#include <vadose/policy/hydraulic_concept.hpp>

namespace vadose::conductivity {

/// Gardner's exponential conductivity k = k_sat(n) exp(-alpha s / gamma_l), written k_r = S_e with
/// the same alpha as in swrc::Gardner.
struct Gardner {
  Real saturated_conductivity = unset;  ///< k_sat at reference_porosity [m/s], > 0
  Real reference_porosity = unset;      ///< [-], (0, 1)
  bool porosity_dependent = true;       ///< true: Kozeny-Carman; false: k_sat at any porosity
  Real relative_floor = 1e-12;          ///< smallest k_r [-], [0, 1)

  /// Takes the reference porosity from the material where unset.
  void adopt(const SharedParameters& shared) noexcept {
    detail::fill(reference_porosity, shared.reference_porosity);
  }

  void validate() const {
    detail::check_saturated_conductivity(porosity_dependent, saturated_conductivity,
                                         reference_porosity);
    if (!(relative_floor >= 0 && relative_floor < 1))
      check::fail("relative_floor", relative_floor, "[0, 1)", "-");
  }

  /// k_sat(n) [m/s].
  template <class T>
  T saturated(T porosity) const noexcept {
    return detail::saturated_conductivity<T>(porosity_dependent, saturated_conductivity,
                                             reference_porosity, porosity);
  }
  /// k_r = S_e [-], limited to [relative_floor, 1].
  template <class T>
  T relative(T effective_saturation) const noexcept {
    return min(max(effective_saturation, T(relative_floor)), T(1.0));
  }
  /// k(S_e, n) [m/s].
  template <class T>
  T conductivity(T effective_saturation, T porosity) const noexcept {
    return saturated<T>(porosity) * relative<T>(effective_saturation);
  }
};

static_assert(FactorisingConductivity<Gardner>);

}  // namespace vadose::conductivity
