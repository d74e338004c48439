// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Small helpers of kernels that work on a batch of points.

#include <vadose/kernel/state.hpp>

namespace vadose::kernel {

/// Positions of a batch.
template <int Dim, class Points>
VADOSE_INLINE void load_positions(const Points& points, std::size_t batch,
                                  Lanes (&x)[Dim]) noexcept {
  for (int d = 0; d < Dim; ++d) x[d] = points.load(field::position, batch, d);
}

/// GIMP half sizes of a batch; zero for a basis without.
template <int Dim, class Points>
VADOSE_INLINE void load_half_sizes(const Points& points, std::size_t batch,
                                   Lanes (&half)[Dim]) noexcept {
  for (int d = 0; d < Dim; ++d) {
    if constexpr (Points::fields::template has<field::HalfSize>)
      half[d] = points.load(field::half_size, batch, d);
    else
      half[d] = Lanes(0.0);
  }
}

/// Tile index of the cell of each of eight points; cells beyond a wall count as the last inside.
template <int Dim>
struct CellFinder {
  alignas(32) int index[lane_count];
  bool shared;  ///< all points are in the same cell

  VADOSE_INLINE void find(const TileFrame<Dim>& frame, const Lanes (&x)[Dim]) noexcept {
    Lanes at(0.0);
    double stride = 1;
    for (int d = 0; d < Dim; ++d) {
      const Lanes u = floor((x[d] - Lanes(frame.first[d])) * Lanes(frame.over_cell_size));
      const Lanes low(max(frame.low_wall[d], 0.0));
      const Lanes high(min(frame.high_wall[d] - 1, static_cast<double>(Block<Dim>::tile_edge - 1)));
      at += min(select(u > low, u, low), high) * Lanes(stride);
      stride *= Block<Dim>::tile_edge;
    }
    at.store_integers(index);
    shared = all(at == Lanes(at[0]));
  }
};

/// Component i of the coordinate shifts needed by axisymmetric terms: radius of eight points.
template <class K, int Dim>
VADOSE_INLINE Lanes over_radius(const Lanes (&x)[Dim], Real origin) noexcept {
  if constexpr (K::axisymmetric)
    return Lanes(1.0) / max(x[0] - Lanes(origin), Lanes(1e-300));
  else
    return Lanes(0.0);
}

}  // namespace vadose::kernel
