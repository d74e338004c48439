// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Cells whose air-filled pores close within a step: how stiff they will be.

#include <vadose/kernel/wave_frequency.hpp>

namespace vadose::kernel {

/// Part of the time until the air-filled pores of a cell have closed that one step may take [-].
inline constexpr Real closing_share = 0.5;

/// Highest frequency squared that a cell will have in a step: where little air is left, K* leaps to that of
/// water within it. `speed` bounds that of all points [m/s].
template <class M>
Real coming_frequency2(const State<M>& state, const Cell<State<M>::dim>& c, Real speed) noexcept {
  const Real now = cell_frequency2(state, c, c.modulus, c.saturation);
  if constexpr (is_unsaturated<M>) {
    const Real air = max(0.0, c.pore_volume - c.content);
    const Real bulk = c.pore_volume / c.porosity;
    const Real known = is_finite(c.closing)
                           ? c.closing
                           : 2 * State<M>::dim * speed / state.grid.cell_size() * bulk;
    // A step of closing_share air / closing has this 2/omega.
    const Real coming = 2 * max(0.0, known) / closing_share;
    if (coming * coming <= now * air * air) return now;
    const Real full = cell_frequency2(state, c, state.water.bulk_modulus, 1);
    return coming * coming < full * air * air ? coming * coming / (air * air) : max(now, full);
  } else {
    return now;
  }
}

}  // namespace vadose::kernel
