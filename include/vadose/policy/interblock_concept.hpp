// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Conductivity of unsaturated soil between two cells, from what both sides say of it.

#include <concepts>

#include <vadose/core/real.hpp>

namespace vadose {

/// What a face between two pressures knows, for numbers or lanes T.
template <class T>
struct FaceState {
  T pressure_a;    ///< liquid pressure on one side [Pa]
  T pressure_b;    ///< and on the other [Pa]
  T porosity;      ///< [-]
  T upstream;      ///< conductivity of the upstream side [m/s]
  T gravity_head;  ///< G = rho_l |g . dx| between the sides [Pa], >= 0
};

/// A mean of conductivities: `mean(integral, face)` [m/s] for faces with suction on a side at least.
/// `integral.mean(p_a, p_b, n)` is the mean of k over the pressures between, k(p) for p_a = p_b.
template <class I, class Integral>
concept InterblockMean = requires(const Integral& integral, const FaceState<Real>& face) {
  { I::mean(integral, face) } -> std::convertible_to<Real>;
};

}  // namespace vadose
