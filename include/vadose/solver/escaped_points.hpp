// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Points that left the box: taken out, or put back.

#include <vadose/kernel/state.hpp>

namespace vadose::detail {

/// Applies the policy to one set of points; adds the mass taken out to `lost`.
template <class M, class Points>
void handle_escaped(const State<M>& state, Points& points, CompensatedSum& lost) {
  constexpr int dim = State<M>::dim;
  const Real h = state.grid.cell_size();
  points.for_each([&](std::size_t b, int l) {
    for (int d = 0; d < dim; ++d) {
      Real& x = points.at(field::position, b, d)[l];
      const Real low = state.grid.origin()[d], high = low + state.grid.cells()[d] * h;
      if (x >= low && x <= high) continue;
      if (state.options.escaped == Escape::outflow) {
        lost += points.at(field::mass, b)[l];
        points.remove(b, l);
        return;
      }
      Real& v = points.at(field::velocity, b, d)[l];
      v = x < low ? max(v, 0.0) : min(v, 0.0);
      x = x < low ? low : high;
    }
  });
}

/// Points of both phases that left the box in this step.
template <class M>
void handle_escaped(State<M>& state) {
  bool any = false;
  for (const StepSums& s : state.sums) any = any || (s.escaped && !s.failed);
  if (!any || state.options.escaped == Escape::error) return;
  if constexpr (is_deformable<M>) handle_escaped(state, state.solid, state.lost_solid);
  if constexpr (has_liquid<M>) handle_escaped(state, state.liquid, state.lost_water);
}

}  // namespace vadose::detail
