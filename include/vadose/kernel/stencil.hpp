// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Shape function values of a batch of points in a tile of nodes.

#include <vadose/core/lanes.hpp>
#include <vadose/core/lanes_transpose.hpp>
#include <vadose/grid/block_grid.hpp>

namespace vadose::kernel {

/// Where a tile lies: what turns positions into tile coordinates.
template <int Dim>
struct TileFrame {
  Real over_cell_size = 1;   ///< 1/h [1/m]
  Real first[Dim] = {};      ///< position of tile node 0 along each axis [m]
  Real low_wall[Dim] = {};   ///< tile coordinate of the lower wall node
  Real high_wall[Dim] = {};  ///< tile coordinate of the upper wall node
  bool at_wall[Dim] = {};    ///< a node of the tile is a wall or beyond one
};

/// Frame of the tile of a slot.
template <int Dim>
TileFrame<Dim> tile_frame(const BlockGrid<Dim>& grid, int slot) noexcept {
  TileFrame<Dim> f;
  f.over_cell_size = 1 / grid.cell_size();
  const Index<Dim> cell = grid.first_cell(slot);
  for (int d = 0; d < Dim; ++d) {
    const int node = cell[d] - 1;
    f.first[d] = grid.origin()[d] + node * grid.cell_size();
    f.low_wall[d] = -node;
    f.high_wall[d] = grid.cells()[d] - node;
    f.at_wall[d] = f.low_wall[d] > 0 || f.high_wall[d] < Block<Dim>::tile_edge - 1;
  }
  return f;
}

/// Weights and slopes of eight points along each axis, and the first node of each.
template <class Shape, int Dim>
struct Stencil {
  static constexpr int support = Shape::support;

  alignas(64) double weight[Dim][support][lane_count];  ///< [axis][node][point]
  alignas(64) double slope[Dim][support][lane_count];   ///< dN/dx [1/m]
  alignas(64) double first[Dim][lane_count];            ///< first node, tile coordinates
  alignas(32) int offset[lane_count];                   ///< first node in the tile
  bool shared;                                          ///< all points have the same nodes

  /// Evaluates the basis at positions x [m] with GIMP half sizes half [m] (unused otherwise).
  VADOSE_INLINE void evaluate(const TileFrame<Dim>& frame, const Lanes (&x)[Dim],
                              const Lanes (&half)[Dim]) noexcept {
    Lanes at(0.0);
    double stride = 1;
    for (int d = 0; d < Dim; ++d) {
      Lanes w[support], g[support];
      const Lanes u = (x[d] - Lanes(frame.first[d])) * Lanes(frame.over_cell_size);
      Lanes base = Shape::weights(u, half[d] * Lanes(frame.over_cell_size), w, g);
      if constexpr (support == 3) {
        if (frame.at_wall[d]) fold(base, Lanes(frame.low_wall[d]), Lanes(frame.high_wall[d]), w, g);
      }
      base = into_tile(base);
      for (int i = 0; i < support; ++i) {
        w[i].store(weight[d][i]);
        (g[i] * Lanes(frame.over_cell_size)).store(slope[d][i]);
      }
      base.store(first[d]);
      at += base * Lanes(stride);
      stride *= Block<Dim>::tile_edge;
    }
    at.store_integers(offset);
    shared = all(at == Lanes(at[0]));
  }

  /// Weight of node (i, j, k) of a point.
  VADOSE_INLINE double product(const Index<Dim>& i, int lane) const noexcept {
    double w = 1;
    for (int d = 0; d < Dim; ++d) w *= weight[d][i[d]][lane];
    return w;
  }

 private:
  /// A node outside a wall hands its function to the two nodes inside: v_out = 2 v_wall - v_next.
  VADOSE_INLINE static void fold(const Lanes& base, const Lanes& low, const Lanes& high,
                                 Lanes (&w)[support], Lanes (&g)[support]) noexcept {
    const Lanes zero(0.0), two(2.0);
    const auto below = base < low;
    const Lanes w0 = select(below, w[0], zero), g0 = select(below, g[0], zero);
    w[0] -= w0;
    w[1] += two * w0;
    w[2] -= w0;
    g[0] -= g0;
    g[1] += two * g0;
    g[2] -= g0;
    const auto above = base + two > high;
    const Lanes w2 = select(above, w[2], zero), g2 = select(above, g[2], zero);
    w[2] -= w2;
    w[1] += two * w2;
    w[0] -= w2;
    g[2] -= g2;
    g[1] += two * g2;
    g[0] -= g2;
  }
  /// Keeps a wild position (the guard reports it) from touching memory outside the tile.
  VADOSE_INLINE static Lanes into_tile(const Lanes& base) noexcept {
    const Lanes last(static_cast<double>(Block<Dim>::tile_edge - support));
    const Lanes low = select(base > Lanes(0.0), base, Lanes(0.0));  // also catches NaN
    return min(low, last);
  }
};

}  // namespace vadose::kernel
