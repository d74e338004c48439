// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/policy/law/law_concept.hpp>

namespace vadose::law {

namespace detail {

/// Adds the isotropic elastic stress of a strain increment; moduli in [Pa].
template <class T, int N>
VADOSE_INLINE void add_elastic_stress(const SymTensor<T, N>& strain, Real bulk_modulus,
                                      Real shear_modulus, SymTensor<T, N>& stress) noexcept {
  const T two_shear(2 * shear_modulus);
  const T isotropic = T(bulk_modulus - 2 * shear_modulus / 3) * strain.trace();
  for (int i = 0; i < N; ++i) stress[i] += two_shear * strain[i];
  stress.add_isotropic(isotropic);
}

}  // namespace detail

/// Isotropic linear elasticity, in rate form (the kernel rotates the stress).
struct LinearElastic {
  Real young_modulus = unset;  ///< E [Pa], > 0
  Real poisson_ratio = unset;  ///< nu [-], in (-1, 0.5)

  /// No history.
  template <class T>
  struct State {};

  /// G = E / (2 (1 + nu)) [Pa].
  Real shear_modulus() const noexcept { return young_modulus / (2 * (1 + poisson_ratio)); }
  /// K = E / (3 (1 - 2 nu)) [Pa].
  Real bulk_modulus() const noexcept { return young_modulus / (3 * (1 - 2 * poisson_ratio)); }
  /// E_c = K + 4 G / 3 = E (1 - nu) / ((1 + nu) (1 - 2 nu)) [Pa].
  Real p_wave_modulus() const noexcept { return bulk_modulus() + 4 * shear_modulus() / 3; }
  /// The same, as the contract of a law asks for it.
  Real p_wave_modulus(const State<Real>& /*state*/) const noexcept { return p_wave_modulus(); }

  /// The same, as an implicit skeleton asks for it.
  Real shear_modulus(const State<Real>& /*state*/) const noexcept { return shear_modulus(); }

  /// Refuses E <= 0 and nu outside (-1, 0.5); nu = 0.5 has no finite bulk modulus.
  void validate() const {
    check::positive("young_modulus", young_modulus, "Pa");
    check::inside("poisson_ratio", poisson_ratio, -1, 0.5, "-");
  }

  /// Adds 2 G e + (K - 2 G / 3) tr(e) I.
  template <class T, int N>
  VADOSE_INLINE Status update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                              State<T>& /*state*/) const noexcept {
    detail::add_elastic_stress(step.increment, bulk_modulus(), shear_modulus(), stress);
    return Status::ok;
  }
};

}  // namespace vadose::law
