// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The background grid: square cells of one size in a box, kept in blocks of 64 cells. Only
/// blocks near points exist; data of all existing blocks lie one after the other.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <vadose/core/real.hpp>

namespace vadose {

/// Sizes of a block: 64 cells in one, 8 x 8 in two, 4 x 4 x 4 in three dimensions. A block of
/// node records of 64 bytes fills one 4 KiB page.
template <int Dim>
struct Block {
  static constexpr int edge = Dim == 1 ? 64 : Dim == 2 ? 8 : 4;  ///< cells per axis
  static constexpr int cells = 64;                               ///< in a block
  /// A tile reaches one node below the block and two above: enough for every basis while points
  /// stay within half a cell of the block they were sorted into.
  static constexpr int tile_edge = edge + 3;
  static constexpr int tile_size = power<Dim>(tile_edge);  ///< nodes of a tile
};

/// Cell or node coordinates.
template <int Dim>
struct Index {
  int at[Dim] = {};  ///< per axis
  constexpr int& operator[](int d) noexcept { return at[d]; }
  constexpr int operator[](int d) const noexcept { return at[d]; }
};

/// Calls f(index) for every index of the cube [low, high)^Dim, axis 0 fastest.
template <int Dim, class F>
constexpr void for_cube(int low, int high, F&& f) {
  Index<Dim> i;
  if constexpr (Dim == 1) {
    for (i[0] = low; i[0] < high; ++i[0]) f(i);
  } else if constexpr (Dim == 2) {
    for (i[1] = low; i[1] < high; ++i[1])
      for (i[0] = low; i[0] < high; ++i[0]) f(i);
  } else {
    for (i[2] = low; i[2] < high; ++i[2])
      for (i[1] = low; i[1] < high; ++i[1])
        for (i[0] = low; i[0] < high; ++i[0]) f(i);
  }
}

/// The block grid. Cell c of an axis spans [origin + c h, origin + (c + 1) h]; node c is at its
/// lower end; walls are at nodes 0 and cells.
template <int Dim>
class BlockGrid {
 public:
  using B = Block<Dim>;  ///< sizes

  BlockGrid() = default;

  /// Grid over [origin, origin + cells * cell_size]; nothing exists yet.
  BlockGrid(const Vec<Dim>& origin, Real cell_size, const Index<Dim>& cells)
      : origin_(origin), cell_size_(cell_size), cells_(cells) {
    int total = 1;
    for (int d = 0; d < Dim; ++d) {
      blocks_[d] = (cells[d] + 1 + B::edge - 1) / B::edge;  // node `cells` needs a place too
      total *= blocks_[d];
      if (blocks_[d] > blocks_[slab_axis_]) slab_axis_ = d;
    }
    slot_of_.assign(static_cast<std::size_t>(total), -1);
  }

  const Vec<Dim>& origin() const noexcept { return origin_; }    ///< lower corner [m]
  Real cell_size() const noexcept { return cell_size_; }         ///< h [m]
  const Index<Dim>& cells() const noexcept { return cells_; }    ///< cells per axis
  const Index<Dim>& blocks() const noexcept { return blocks_; }  ///< of 64 cells, per axis
  int slab_axis() const noexcept { return slab_axis_; }          ///< axis of layers
  int slots() const noexcept { return static_cast<int>(coordinates_.size()); }  ///< existing blocks
  /// Length of an array with one entry per cell (or node) of all existing blocks, plus one block
  /// that stands for everything outside.
  std::size_t size() const noexcept { return (coordinates_.size() + 1) * B::cells; }
  /// Entry that stands for a cell or node that does not exist; stays zero.
  std::int32_t outside() const noexcept { return static_cast<std::int32_t>(slots() * B::cells); }
  /// Block coordinates of a slot.
  const Index<Dim>& block(int slot) const noexcept {
    return coordinates_[static_cast<std::size_t>(slot)];
  }
  /// First cell of a slot.
  Index<Dim> first_cell(int slot) const noexcept {
    Index<Dim> c;
    for (int d = 0; d < Dim; ++d) c[d] = block(slot)[d] * B::edge;
    return c;
  }
  /// Array entries of the tile of a slot, tile index 0 being the node one below the block.
  const std::int32_t* tile(int slot) const noexcept {
    return tiles_.data() + static_cast<std::size_t>(slot) * B::tile_size;
  }
  /// Position of cell (i, j, k) - block coordinates, -1 .. edge + 1 - in a tile.
  static constexpr int tile_index(const Index<Dim>& i) noexcept {
    int t = 0;
    for (int d = Dim - 1; d >= 0; --d) t = t * B::tile_edge + i[d] + 1;
    return t;
  }
  /// Step in a tile along an axis.
  static constexpr int tile_stride(int axis) noexcept {
    int s = 1;
    for (int d = 0; d < axis; ++d) s *= B::tile_edge;
    return s;
  }
  /// Position of cell (i, j, k) of a block in the block's 64 entries.
  static constexpr int local_index(const Index<Dim>& i) noexcept {
    int t = 0;
    for (int d = Dim - 1; d >= 0; --d) t = t * B::edge + i[d];
    return t;
  }

  /// Cell (i, j, k) of a block at one of the block's 64 entries.
  static constexpr Index<Dim> local_at(int entry) noexcept {
    Index<Dim> i;
    for (int d = 0; d < Dim; ++d, entry /= B::edge) i[d] = entry % B::edge;
    return i;
  }

  /// Cell of a position along an axis, clamped into the box.
  int cell_of(Real x, int axis) const noexcept {
    const Real u = (x - origin_[axis]) / cell_size_;
    if (!(u > 0)) return 0;  // NaN too
    return u < cells_[axis] ? static_cast<int>(u) : cells_[axis] - 1;
  }
  /// Whether a position lies in the box (its walls included).
  bool contains(const Vec<Dim>& x) const noexcept {
    for (int d = 0; d < Dim; ++d)
      if (!(x[d] >= origin_[d] && x[d] <= origin_[d] + cells_[d] * cell_size_)) return false;
    return true;
  }
  /// Number of a cell's block among all possible ones.
  std::size_t block_number(const Index<Dim>& cell) const noexcept {
    std::size_t n = 0;
    for (int d = Dim - 1; d >= 0; --d)
      n = n * static_cast<std::size_t>(blocks_[d]) + static_cast<std::size_t>(cell[d] / B::edge);
    return n;
  }
  /// Slot of a block number, -1 if the block does not exist.
  int slot(std::size_t block_number) const noexcept { return slot_of_[block_number]; }
  /// Array entry of a cell or node; outside() if its block does not exist.
  std::int32_t entry(const Index<Dim>& cell) const noexcept {
    Index<Dim> local;
    for (int d = 0; d < Dim; ++d) {
      if (cell[d] < 0 || cell[d] >= blocks_[d] * B::edge) return outside();
      local[d] = cell[d] % B::edge;
    }
    const int s = slot(block_number(cell));
    return s < 0 ? outside() : static_cast<std::int32_t>(s * B::cells + local_index(local));
  }

  /// Makes exactly the blocks exist that hold points (marked in `occupied`, one entry per block
  /// number) or touch one that does. Array contents are lost.
  void rebuild(const std::vector<char>& occupied) {
    for (const Index<Dim>& b : coordinates_) slot_of_[number(b)] = -1;
    coordinates_.clear();
    collect(occupied);
    for (std::size_t s = 0; s < coordinates_.size(); ++s)
      slot_of_[number(coordinates_[s])] = static_cast<std::int32_t>(s);
    map_tiles();
  }
  /// Number of possible blocks.
  std::size_t block_count() const noexcept { return slot_of_.size(); }

 private:
  std::size_t number(const Index<Dim>& b) const noexcept {
    std::size_t n = 0;
    for (int d = Dim - 1; d >= 0; --d)
      n = n * static_cast<std::size_t>(blocks_[d]) + static_cast<std::size_t>(b[d]);
    return n;
  }
  bool exists(const Index<Dim>& b) const noexcept {
    for (int d = 0; d < Dim; ++d)
      if (b[d] < 0 || b[d] >= blocks_[d]) return false;
    return true;
  }

  /// Occupied blocks and their neighbours, ordered by slab, then by number.
  void collect(const std::vector<char>& occupied) {
    std::vector<char> wanted(slot_of_.size(), 0);
    for_blocks([&](const Index<Dim>& b, std::size_t n) {
      if (!occupied[n]) return;
      for_cube<Dim>(-1, 2, [&](const Index<Dim>& o) {
        Index<Dim> c = b;
        for (int d = 0; d < Dim; ++d) c[d] += o[d];
        if (exists(c)) wanted[number(c)] = 1;
      });
    });
    for_blocks([&](const Index<Dim>& b, std::size_t n) {
      if (wanted[n]) coordinates_.push_back(b);
    });
    const int axis = slab_axis_;
    std::stable_sort(
        coordinates_.begin(), coordinates_.end(),
        [axis](const Index<Dim>& a, const Index<Dim>& b) { return a[axis] < b[axis]; });
  }

  template <class F>
  void for_blocks(F&& f) const {
    Index<Dim> b;
    for (std::size_t n = 0; n < slot_of_.size(); ++n) {
      f(b, n);
      for (int d = 0; d < Dim; ++d) {
        if (++b[d] < blocks_[d]) break;
        b[d] = 0;
      }
    }
  }

  void map_tiles() {
    tiles_.resize(coordinates_.size() * B::tile_size);
    for (int s = 0; s < slots(); ++s) {
      const Index<Dim> first = first_cell(s);
      std::int32_t* tile = tiles_.data() + static_cast<std::size_t>(s) * B::tile_size;
      for_cube<Dim>(-1, B::edge + 2, [&](const Index<Dim>& i) {
        Index<Dim> c;
        for (int d = 0; d < Dim; ++d) c[d] = first[d] + i[d];
        tile[tile_index(i)] = entry(c);
      });
    }
  }

  Vec<Dim> origin_ = Vec<Dim>::Zero();
  Real cell_size_ = 1;
  Index<Dim> cells_;
  Index<Dim> blocks_;
  int slab_axis_ = 0;
  std::vector<std::int32_t> slot_of_;
  std::vector<Index<Dim>> coordinates_;
  std::vector<std::int32_t> tiles_;
};

}  // namespace vadose
