// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The nodes around one block in a contiguous buffer, and the loop over blocks that adds tiles
/// up in the same order for any number of threads.

#include <vadose/core/aligned.hpp>
#include <vadose/core/parallel.hpp>
#include <vadose/grid/point_set.hpp>
#include <vadose/kernel/stencil.hpp>

namespace vadose::kernel {

/// Records of the nodes (or cells) one below a block to two above.
template <int Dim>
struct Tile {
  Record record[Block<Dim>::tile_size];

  /// Reads the records of a slot.
  void read(const BlockGrid<Dim>& grid, int slot, const AlignedVector<Record>& from) noexcept {
    const std::int32_t* entry = grid.tile(slot);
    for (int i = 0; i < Block<Dim>::tile_size; ++i)
      record[i] = from[static_cast<std::size_t>(entry[i])];
  }
  /// The same with lanes 0 .. 3 in both halves, as FlowGather reads them.
  void read_twice(const BlockGrid<Dim>& grid, int slot,
                  const AlignedVector<Record>& from) noexcept {
    const std::int32_t* entry = grid.tile(slot);
    for (int i = 0; i < Block<Dim>::tile_size; ++i)
      low_twice(Lanes::load(from[static_cast<std::size_t>(entry[i])].value)).store(record[i].value);
  }
  /// Adds what the tile gathered to the records of a slot and clears it.
  void add_to(const BlockGrid<Dim>& grid, int slot, AlignedVector<Record>& to) noexcept {
    const std::int32_t* entry = grid.tile(slot);
    const std::int32_t outside = grid.outside();
    for (int i = 0; i < Block<Dim>::tile_size; ++i) {
      if (entry[i] != outside) {
        Record& r = to[static_cast<std::size_t>(entry[i])];
        (Lanes::load(r.value) + Lanes::load(record[i].value)).store(r.value);
      }
      Lanes(0.0).store(record[i].value);
    }
  }
};

/// Asks the cache, a few with every batch of points, for the records that a tile will be read from or added
/// to once these points are done. Else each of them waits for memory: they lie apart, and the points that
/// stream by drive them out of the cache.
template <int Dim>
class ComingRecords {
 public:
  ComingRecords(const BlockGrid<Dim>& grid, int slot, const AlignedVector<Record>& records) noexcept
      : entry_(grid.tile(slot)), records_(records.data()) {}

  VADOSE_INLINE void ask_for_some() noexcept {
    for (int i = 0; i < per_batch && next_ < Block<Dim>::tile_size; ++i)
      __builtin_prefetch(records_ + entry_[next_++], 0, 2);
  }

 private:
  static constexpr int per_batch = 8;
  const std::int32_t* entry_;
  const Record* records_;
  int next_ = 0;
};

/// Block whose points come after those of a range; the same where there is none.
template <class Points>
int next_slot(const Points& points, const BatchRange& range) noexcept {
  const BatchRange* next = &range + 1;
  return next == points.blocks().data() + points.blocks().size() ? range.slot : next->slot;
}

/// Calls f(block range, thread) for all blocks of points; blocks may be worked on together.
template <class Points, class F>
void for_blocks(const Points& points, int threads, F&& f) {
  parallel_for(points.blocks().size(), threads,
               [&](std::size_t i, int thread) { f(points.blocks()[i], thread); });
}

/// Calls f(block range, thread) for all blocks, so that two blocks whose tiles share a node are
/// never worked on together and always in the same order: that of their colours, see PointSet::spans().
template <class Points, class F>
void for_blocks_adding(const Points& points, int threads, F&& f) {
  for (int colour = 0; colour < Points::colours; ++colour) {
    const auto& spans = points.spans(colour);
    parallel_for(spans.size(), threads, [&](std::size_t s, int thread) {
      for (std::size_t i = spans[s].begin; i < spans[s].end; ++i) f(points.blocks()[i], thread);
    });
  }
}

/// Adds to a tile, for each of eight points, value * N + sum_e slope_part_e * dN/dx_e.
/// value: eight numbers per point; slope parts: numbers of record lanes 4 .. 7 that go with the
/// slope along each axis (lanes 0 .. 3 are ignored). With Moments, `moment[e]` (lanes 0 .. 3)
/// times the distance of the node from the point's first node, in cells, is added to value.
template <bool Slopes, bool Moments, class Shape, int Dim>
struct Scatter {
  Lanes value[lane_count];
  Lanes slope[Slopes ? Dim : 1][lane_count];
  Lanes moment[Moments ? Dim : 1][lane_count];

  VADOSE_INLINE void add(const Stencil<Shape, Dim>& s, Record* tile) const noexcept {
    for (int l = 0; l < lane_count; ++l) add_point(s, l, tile + s.offset[l]);
  }

 private:
  static constexpr int n = Shape::support;

  VADOSE_INLINE void add_point(const Stencil<Shape, Dim>& s, int l, Record* first) const noexcept {
    Lanes split[n], plain[n];
    for (int i = 0; i < n; ++i) {
      const double w = s.weight[0][i][l];
      plain[i] = Lanes(w);
      if constexpr (Slopes) split[i] = halves(w, s.slope[0][i][l]);
    }
    if constexpr (Dim == 1) {
      add_row(value[l], Lanes(1.0), Lanes(0.0), l, split, plain, first);
    } else if constexpr (Dim == 2) {
      for (int j = 0; j < n; ++j) {
        const Lanes wy(s.weight[1][j][l]);
        Lanes across(0.0);
        if constexpr (Slopes) across = slope[1][l] * Lanes(s.slope[1][j][l]);
        Lanes v = value[l];
        if constexpr (Moments) v += moment[1][l] * Lanes(static_cast<double>(j));
        add_row(v, wy, across, l, split, plain, first + j * BlockGrid<Dim>::tile_stride(1));
      }
    } else {
      for (int k = 0; k < n; ++k) {
        const double wz = s.weight[2][k][l];
        for (int j = 0; j < n; ++j) {
          const double wy = s.weight[1][j][l];
          Lanes across(0.0);
          if constexpr (Slopes)
            across = slope[1][l] * Lanes(s.slope[1][j][l] * wz) +
                     slope[2][l] * Lanes(wy * s.slope[2][k][l]);
          Lanes v = value[l];
          if constexpr (Moments)
            v += moment[1][l] * Lanes(static_cast<double>(j)) +
                 moment[2][l] * Lanes(static_cast<double>(k));
          add_row(v, Lanes(wy * wz), across, l, split, plain,
                  first + j * BlockGrid<Dim>::tile_stride(1) + k * BlockGrid<Dim>::tile_stride(2));
        }
      }
    }
  }

  /// One row of nodes along axis 0: two multiply-adds per node. Lanes 0 .. 3 take value * N from
  /// `a`; lanes 4 .. 7 take slope_0 dN/dx_0 from `a` and everything else from `b`.
  VADOSE_INLINE void add_row(const Lanes& v, const Lanes& w, const Lanes& across, int l,
                             const Lanes (&split)[n], const Lanes (&plain)[n],
                             Record* row) const noexcept {
    const Lanes vw = v * w;
    Lanes a = vw, b(0.0);
    if constexpr (Slopes) {
      a = low_high(vw, slope[0][l] * w);
      b = low_high(Lanes(0.0), vw + across);
    }
    for (int i = 0; i < n; ++i) {
      Lanes r = Lanes::load(row[i].value);
      if constexpr (Slopes) {
        r += a * split[i];
        r += b * plain[i];
      } else {
        r += a * plain[i];
      }
      if constexpr (Moments) r += moment[0][l] * w * (plain[i] * Lanes(static_cast<double>(i)));
      r.store(row[i].value);
    }
  }
  /// Lanes 0 .. 3 of the first, 4 .. 7 of the second.
  VADOSE_INLINE static Lanes low_high(const Lanes& low, const Lanes& high) noexcept {
    return select(halves(0.0, 1.0) < Lanes(0.5), low, high);
  }
};

/// The same for what the skeleton brings, in fewer operations: lanes 0 .. 3 and 7 times N, and lanes
/// 4 .. 6 the sum over the axes of force_e dN/dx_e.
template <class Shape, int Dim>
class ForceScatter {
 public:
  /// By field: value[0 .. 3] and value[7] of eight points, force[e][d] along axis d that goes with the
  /// slope along axis e.
  VADOSE_INLINE void set(const Lanes (&value)[5], const Lanes (&force)[Dim][Dim]) noexcept {
    for (int i = 0; i < lane_count; ++i) main_[i] = side_[i] = Lanes(0.0);
    for (int i = 0; i < 4; ++i) main_[i] = value[i];
    main_[7] = value[4];
    for (int d = 0; d < Dim; ++d) {
      main_[4 + d] = force[0][d];
      if constexpr (Dim >= 2) side_[4 + d] = force[1][d];
      if constexpr (Dim == 3) side_[d] = force[2][d];
    }
    transpose(main_);
    if constexpr (Dim >= 2) transpose(side_);
  }

  VADOSE_INLINE void add(const Stencil<Shape, Dim>& s, Record* tile) const noexcept {
    for (int l = 0; l < lane_count; ++l) add_point(s, l, tile + s.offset[l]);
  }

 private:
  static constexpr int n = Shape::support;

  VADOSE_INLINE void add_point(const Stencil<Shape, Dim>& s, int l, Record* first) const noexcept {
    Lanes along[n], across[n];  // weights along axis 0 of main_ and side_
    for (int i = 0; i < n; ++i) {
      across[i] = Lanes(s.weight[0][i][l]);
      along[i] = in_force(Lanes(s.slope[0][i][l]), across[i]);
    }
    const Lanes zero(0.0), main = main_[l];
    const Lanes second = in_force(side_[l], zero);
    Lanes third = zero;
    if constexpr (Dim == 3) third = in_force(swap_halves(side_[l]), zero);
    for (int k = 0; k < (Dim == 3 ? n : 1); ++k)
      for (int j = 0; j < (Dim >= 2 ? n : 1); ++j) {
        Record* row = first;
        Lanes a = main, b = zero;
        if constexpr (Dim == 2) {
          row += j * BlockGrid<Dim>::tile_stride(1);
          a = main * Lanes(s.weight[1][j][l]);
          b = second * Lanes(s.slope[1][j][l]);
        }
        if constexpr (Dim == 3) {
          row += j * BlockGrid<Dim>::tile_stride(1) + k * BlockGrid<Dim>::tile_stride(2);
          const double wy = s.weight[1][j][l], wz = s.weight[2][k][l];
          a = main * Lanes(wy * wz);
          b = second * Lanes(s.slope[1][j][l] * wz) + third * Lanes(wy * s.slope[2][k][l]);
        }
        for (int i = 0; i < n; ++i) {
          Lanes r = Lanes::load(row[i].value);
          r += a * along[i];
          if constexpr (Dim >= 2) r += b * across[i];
          r.store(row[i].value);
        }
      }
  }
  /// Lanes 4 .. 6 of the first, the others of the second.
  VADOSE_INLINE static Lanes in_force(const Lanes& force, const Lanes& other) noexcept {
    alignas(64) static constexpr double force_lanes[lane_count] = {0, 0, 0, 0, 1, 1, 1, 0};
    return select(Lanes::load(force_lanes) > Lanes(0.5), force, other);
  }

  Lanes main_[lane_count];  ///< by point: values, and the forces of axis 0 in lanes 4 .. 6
  Lanes side_[lane_count];  ///< by point: forces of axis 1 in lanes 4 .. 6, of axis 2 in 0 .. 2
};

/// Products of the weights and slopes of eight points along axes 1 and 2, one for each row of nodes along
/// axis 0; in three dimensions. Read from memory they reach all lanes at no cost.
template <class Shape, int Dim>
struct RowWeights {
  static constexpr int n = Shape::support;

  alignas(64) double weight[n][n][lane_count];   ///< w_1 w_2, [node along axis 2][axis 1][point]
  alignas(64) double slope_1[n][n][lane_count];  ///< g_1 w_2
  alignas(64) double slope_2[n][n][lane_count];  ///< w_1 g_2

  VADOSE_INLINE explicit RowWeights(const Stencil<Shape, Dim>& s) noexcept {
    for (int k = 0; k < n; ++k) {
      const Lanes w2 = Lanes::load(s.weight[2][k]), g2 = Lanes::load(s.slope[2][k]);
      for (int j = 0; j < n; ++j) {
        const Lanes w1 = Lanes::load(s.weight[1][j]);
        (w1 * w2).store(weight[k][j]);
        (Lanes::load(s.slope[1][j]) * w2).store(slope_1[k][j]);
        (w1 * g2).store(slope_2[k][j]);
      }
    }
  }
};

/// Where rows need no products.
template <class Shape, int Dim>
requires(Dim < 3) struct RowWeights<Shape, Dim> {
  VADOSE_INLINE explicit RowWeights(const Stencil<Shape, Dim>&) noexcept {}
};

/// Sums over the nodes of eight points: sum N r (all lanes) and sum dN/dx_e r (lanes 0 .. 3).
template <bool Slopes, class Shape, int Dim>
struct Gather {
  Lanes value[lane_count];
  Lanes slope[Slopes ? Dim : 1][lane_count];

  VADOSE_INLINE void sum(const Stencil<Shape, Dim>& s, const Record* tile) noexcept {
    const RowWeights<Shape, Dim> rows(s);
    for (int l = 0; l < lane_count; ++l) sum_point(s, rows, l, tile + s.offset[l]);
  }

  /// Turns the results into one Lanes per record lane: value[i] holds lane i of the eight points.
  VADOSE_INLINE void by_field() noexcept {
    transpose(value);
    if constexpr (Slopes)
      for (int e = 0; e < Dim; ++e) transpose(slope[e]);
  }

  /// Both, of the first Dim lanes of each half only, which hold vectors.
  VADOSE_INLINE void sum_vectors(const Stencil<Shape, Dim>& s, const Record* tile) noexcept {
    if (s.shared) {
      sum_shared(s, tile + s.offset[0]);
    } else {
      sum(s, tile);
      by_field();
    }
  }

 private:
  static constexpr int n = Shape::support;

  /// Eight points with the same nodes: each number of a node meets the weights of all points.
  VADOSE_INLINE void sum_shared(const Stencil<Shape, Dim>& s, const Record* first) noexcept {
    for (int c = 0; c < Dim; ++c) {
      value[c] = value[4 + c] = Lanes(0.0);
      if constexpr (Slopes)
        for (int e = 0; e < Dim; ++e) slope[e][c] = Lanes(0.0);
    }
    for (int k = 0; k < (Dim == 3 ? n : 1); ++k)
      for (int j = 0; j < (Dim >= 2 ? n : 1); ++j) add_shared_row(s, first, j, k);
  }
  /// One row of nodes along axis 0.
  VADOSE_INLINE void add_shared_row(const Stencil<Shape, Dim>& s, const Record* first, int j,
                                    int k) noexcept {
    const Record* row = first;
    Lanes w(1.0), g1(0.0), g2(0.0);
    if constexpr (Dim >= 2) {
      row += j * BlockGrid<Dim>::tile_stride(1);
      w = Lanes::load(s.weight[1][j]);
      g1 = Lanes::load(s.slope[1][j]);
    }
    if constexpr (Dim == 3) {
      row += k * BlockGrid<Dim>::tile_stride(2);
      g2 = w * Lanes::load(s.slope[2][k]);
      w *= Lanes::load(s.weight[2][k]);
      g1 *= Lanes::load(s.weight[2][k]);
    }
    Lanes low[Dim], high[Dim], along[Dim];
    for (int c = 0; c < Dim; ++c) low[c] = high[c] = along[c] = Lanes(0.0);
    for (int i = 0; i < n; ++i) {
      const Lanes wi = Lanes::load(s.weight[0][i]);
      for (int c = 0; c < Dim; ++c) {
        low[c] += Lanes(row[i][c]) * wi;
        high[c] += Lanes(row[i][4 + c]) * wi;
        if constexpr (Slopes) along[c] += Lanes(row[i][c]) * Lanes::load(s.slope[0][i]);
      }
    }
    for (int c = 0; c < Dim; ++c) {
      value[c] += low[c] * w;
      value[4 + c] += high[c] * w;
      if constexpr (Slopes) {
        slope[0][c] += along[c] * w;
        if constexpr (Dim >= 2) slope[1][c] += low[c] * g1;
        if constexpr (Dim == 3) slope[2][c] += low[c] * g2;
      }
    }
  }

  VADOSE_INLINE void sum_point(const Stencil<Shape, Dim>& s,
                               [[maybe_unused]] const RowWeights<Shape, Dim>& rows, int l,
                               const Record* first) noexcept {
    Lanes total(0.0), along[Slopes ? Dim : 1];
    for (auto& a : along) a = Lanes(0.0);
    for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
      for (int j = 0; j < (Dim >= 2 ? n : 1); ++j) {
        const Record* row = first;
        double w = 1, g1 = 0, g2 = 0;
        if constexpr (Dim >= 2) {
          row += j * BlockGrid<Dim>::tile_stride(1);
          w = s.weight[1][j][l];
          g1 = s.slope[1][j][l];
        }
        if constexpr (Dim == 3) {
          row += k * BlockGrid<Dim>::tile_stride(2);
          w = rows.weight[k][j][l];
          g1 = rows.slope_1[k][j][l];
          g2 = rows.slope_2[k][j][l];
        }
        Lanes r(0.0), d(0.0);
        for (int i = 0; i < n; ++i) {
          const Lanes node = Lanes::load(row[i].value);
          r += node * Lanes(s.weight[0][i][l]);
          if constexpr (Slopes) d += node * Lanes(s.slope[0][i][l]);
        }
        total += r * Lanes(w);
        if constexpr (Slopes) {
          along[0] += d * Lanes(w);
          if constexpr (Dim >= 2) along[1] += r * Lanes(g1);
          if constexpr (Dim == 3) along[2] += r * Lanes(g2);
        }
      }
    }
    value[l] = total;
    if constexpr (Slopes)
      for (int e = 0; e < Dim; ++e) slope[e][l] = along[e];
  }
};

/// Sums over the nodes of eight points for what only moves with them: velocity and the stretching dv_e/dx_e
/// along each axis, of a tile that was read twice.
template <class Shape, int Dim>
struct FlowGather {
  Lanes velocity[Dim];
  Lanes stretching[Dim];

  VADOSE_INLINE void sum(const Stencil<Shape, Dim>& s, const Record* tile) noexcept {
    if (s.shared)
      sum_shared(s, tile + s.offset[0]);
    else
      sum_points(s, tile);
  }

 private:
  static constexpr int n = Shape::support;
  static constexpr int rows = Dim >= 2 ? n : 1, layers = Dim == 3 ? n : 1;

  /// Eight points with the same nodes: each number of a node meets the weights of all points.
  VADOSE_INLINE void sum_shared(const Stencil<Shape, Dim>& s, const Record* first) noexcept {
    for (int c = 0; c < Dim; ++c) velocity[c] = stretching[c] = Lanes(0.0);
    for (int k = 0; k < layers; ++k)
      for (int j = 0; j < rows; ++j) {
        const Record* row = first;
        Lanes w(1.0), g[3] = {Lanes(0.0), Lanes(0.0), Lanes(0.0)};
        if constexpr (Dim >= 2) {
          row += j * BlockGrid<Dim>::tile_stride(1);
          w = Lanes::load(s.weight[1][j]);
          g[1] = Lanes::load(s.slope[1][j]);
        }
        if constexpr (Dim == 3) {
          row += k * BlockGrid<Dim>::tile_stride(2);
          g[2] = w * Lanes::load(s.slope[2][k]);
          w *= Lanes::load(s.weight[2][k]);
          g[1] *= Lanes::load(s.weight[2][k]);
        }
        Lanes sums[Dim], along(0.0);
        for (auto& v : sums) v = Lanes(0.0);
        for (int i = 0; i < n; ++i) {
          const Lanes wi = Lanes::load(s.weight[0][i]);
          for (int c = 0; c < Dim; ++c) sums[c] += Lanes(row[i][c]) * wi;
          along += Lanes(row[i][0]) * Lanes::load(s.slope[0][i]);
        }
        for (int c = 0; c < Dim; ++c) velocity[c] += sums[c] * w;
        stretching[0] += along * w;
        for (int c = 1; c < Dim; ++c) stretching[c] += sums[c] * g[c];
      }
  }

  /// Point by point: lanes 0 .. 3 take the velocity by the weights along every axis, lane 4 + e takes
  /// component e by the slope along axis e and the weights along the others, so that both are one product
  /// of sums along the axes.
  VADOSE_INLINE void sum_points(const Stencil<Shape, Dim>& s, const Record* tile) noexcept {
    Lanes total[lane_count];
    for (int l = 0; l < lane_count; ++l) {
      const Record* first = tile + s.offset[l];
      Lanes factor[Dim][n];
      for (int e = 0; e < Dim; ++e)
        for (int i = 0; i < n; ++i) {
          factor[e][i] = Lanes(s.weight[e][i][l]);
          factor[e][i].set(4 + e, s.slope[e][i][l]);
        }
      total[l] = Lanes(0.0);
      for (int k = 0; k < layers; ++k) {
        Lanes layer(0.0);
        for (int j = 0; j < rows; ++j) {
          const Record* row = first;
          if constexpr (Dim >= 2) row += j * BlockGrid<Dim>::tile_stride(1);
          if constexpr (Dim == 3) row += k * BlockGrid<Dim>::tile_stride(2);
          Lanes along(0.0);
          for (int i = 0; i < n; ++i) along += Lanes::load(row[i].value) * factor[0][i];
          if constexpr (Dim >= 2)
            layer += along * factor[1][j];
          else
            layer = along;
        }
        if constexpr (Dim == 3)
          total[l] += layer * factor[2][k];
        else
          total[l] = layer;
      }
    }
    transpose(total);
    for (int c = 0; c < Dim; ++c) {
      velocity[c] = total[c];
      stretching[c] = total[4 + c];
    }
  }
};

}  // namespace vadose::kernel
