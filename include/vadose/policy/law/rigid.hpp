// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/policy/law/law_concept.hpp>

namespace vadose::law {

/// Skeleton that does not deform: seepage only. The stress stays what it was and the solid sets
/// no limit to the time step. Models recognise it by `rigid`.
struct Rigid {
  static constexpr bool rigid = true;  ///< does not move

  /// No history.
  template <class T>
  struct State {};

  /// Nothing to check.
  void validate() const {}

  /// 0 [Pa]: no elastic wave.
  Real p_wave_modulus(const State<Real>& /*state*/) const noexcept { return 0; }

  /// Leaves the stress as it is.
  template <class T, int N>
  VADOSE_INLINE Status update(const StrainStep<T, N>& /*step*/, SymTensor<T, N>& /*stress*/,
                              State<T>& /*state*/) const noexcept {
    return Status::ok;
  }
};

}  // namespace vadose::law
