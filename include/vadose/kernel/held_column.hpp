// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Columns whose skeleton the pore water holds.

#include <vadose/kernel/wave_frequency.hpp>

namespace vadose::kernel {

/// Part of the time in which a cell consolidates, gamma h^2 / (k E_c), that a step may take [-].
inline constexpr Real drainage_share = 0.05;

/// Step of a cell of a column that its pore water holds; 0 if it does not. In one dimension all motion
/// changes volume: water that cannot flow away within the step resists it by S K* / n, implicitly, in
/// series with its drainage. Where that is more than E_c, waves in the skeleton do not grow; with a margin
/// 1 / (n / (S (K* + p)) + 4 k dt / (gamma h^2)) >= 2 E_c: S p, the stress it takes, grows by
/// S + p dS/dp.
template <class M>
Real held_step(const State<M>& state, const Cell<State<M>::dim>& c) noexcept {
  const auto& soil = state.soils[c.material];
  const Real h = state.grid.cell_size(), stiffness = soil.p_wave_modulus;
  if (!(c.saturation > 0)) return 0;
  const Real held = c.saturation * (c.modulus + min(0.0, c.pressure)) / c.porosity;
  if (!(held > 2 * stiffness)) return 0;
  const Real room = 0.5 / stiffness - 1 / held;
  if (!(c.conductivity > 0)) return 1e30;
  const Real drainage = soil.material.unit_weight * h * h / c.conductivity;
  const Real near = c.at_air ? 0.25 : 1;  // an open surface is nearer than the next cell
  return near * min(0.25 * room * drainage, drainage_share * drainage / stiffness);
}

}  // namespace vadose::kernel
