// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Storage of one set of points: batches of eight, sorted by grid block.

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <vadose/core/aligned.hpp>
#include <vadose/core/field.hpp>
#include <vadose/core/first_touch.hpp>
#include <vadose/core/lanes.hpp>
#include <vadose/grid/block_grid.hpp>

namespace vadose {

/// Batches of one block: [begin, end).
struct BatchRange {
  int slot = 0;           ///< the block
  std::size_t begin = 0;  ///< first batch
  std::size_t end = 0;    ///< one past the last batch
};

/// What points of a block and group are sorted by.
enum class SortBy : unsigned char {
  cell,  ///< the cell they are in
  node,  ///< the node nearest to them
};

/// Consecutive entries of PointSet::blocks(), [begin, end).
struct BlockSpan {
  std::size_t begin = 0;  ///< first
  std::size_t end = 0;    ///< one beyond the last
};

/// One set of points (solid or liquid). A batch holds eight points, one cache line per field
/// component; all points of a batch lie in one block (within half a cell) and belong to one
/// group (material, or kind of water). Unused lanes have id -1 and no mass or volume.
template <int Dim, class Fields>
class PointSet {
 public:
  using fields = Fields;                                     ///< what a point carries
  static constexpr int stride = Fields::total * lane_count;  ///< doubles per batch
  static constexpr int bytes_per_point = Fields::total * 8;  ///< of all fields

  std::size_t batches() const noexcept { return group_.size(); }         ///< number of batches
  std::size_t size() const noexcept { return size_; }                    ///< points that exist
  int group(std::size_t batch) const noexcept { return group_[batch]; }  ///< group of a batch
  /// Ranges of batches by block, in the order of layers.
  const std::vector<BatchRange>& blocks() const noexcept { return blocks_; }
  /// Spans of blocks of one colour: no two of them have neighbouring blocks.
  const std::vector<BlockSpan>& spans(int colour) const noexcept {
    return spans_[static_cast<std::size_t>(colour)];
  }
  static constexpr int colours = 4;  ///< of spans; each block is in one of them

  /// The eight values of a component of a field.
  template <class Tag>
  double* at(Tag, std::size_t batch, int component = 0) noexcept {
    return data_.data() + batch * stride +
           static_cast<std::size_t>(Fields::template offset<Tag>() + component) * lane_count;
  }
  /// The same, to read.
  template <class Tag>
  const double* at(Tag, std::size_t batch, int component = 0) const noexcept {
    return data_.data() + batch * stride +
           static_cast<std::size_t>(Fields::template offset<Tag>() + component) * lane_count;
  }
  /// The same as lanes.
  template <class Tag>
  VADOSE_INLINE Lanes load(Tag tag, std::size_t batch, int component = 0) const noexcept {
    return Lanes::load(at(tag, batch, component));
  }
  /// Writes the eight values of a component of a field.
  template <class Tag>
  VADOSE_INLINE void store(Tag tag, std::size_t batch, int component, const Lanes& v) noexcept {
    v.store(at(tag, batch, component));
  }
  /// Writes the eight values of a field of one component.
  template <class Tag>
  VADOSE_INLINE void store(Tag tag, std::size_t batch, const Lanes& v) noexcept {
    v.store(at(tag, batch, 0));
  }
  /// Asks the cache for a batch that will be needed soon.
  void prefetch(std::size_t batch) const noexcept {
    if (batch >= batches()) return;
    const double* p = data_.data() + batch * stride;
    for (int f = 0; f < Fields::total; ++f) __builtin_prefetch(p + f * lane_count, 0, 3);
  }

  /// Calls f(batch, lane) for every point that exists.
  template <class F>
  void for_each(F&& f) const {
    for (std::size_t b = 0; b < batches(); ++b)
      for (int l = 0; l < lane_count; ++l)
        if (at(field::id, b)[l] >= 0) f(b, l);
  }

  /// All components of a point in field order.
  void read(std::size_t batch, int lane, std::span<double> values) const noexcept {
    const double* p = data_.data() + batch * stride + static_cast<std::size_t>(lane);
    for (std::size_t c = 0; c < static_cast<std::size_t>(Fields::total); ++c)
      values[c] = p[c * lane_count];
  }

  /// Adds a point; it takes part from the next sort on. values: all components in field order.
  void append(std::span<const double> values, int group) {
    new_values_.insert(new_values_.end(), values.begin(), values.end());
    new_groups_.push_back(static_cast<std::uint8_t>(group));
  }
  /// Calls f(components in field order, group) for every point that waits for the next sort.
  template <class F>
  void for_each_new(F&& f) const {
    for (std::size_t i = 0; i < new_groups_.size(); ++i)
      f(new_values_.data() + i * Fields::total, int{new_groups_[i]});
  }
  /// Whether points wait for the next sort.
  bool has_new() const noexcept { return !new_groups_.empty(); }
  /// Removes a point; its lane is free until the next sort.
  void remove(std::size_t batch, int lane) noexcept {
    at(field::id, batch)[lane] = -1;
    at(field::mass, batch)[lane] = 0;
    at(field::volume, batch)[lane] = 0;
    --size_;
  }

  /// A set as it is stored, for files: batches with their unused lanes, blocks, waiting points.
  struct Storage {
    AlignedVector<double> values;          ///< stride per batch
    std::vector<std::uint8_t> groups;      ///< one per batch
    std::vector<BatchRange> blocks;        ///< one after the other, all batches
    std::vector<double> new_values;        ///< Fields::total per waiting point
    std::vector<std::uint8_t> new_groups;  ///< one per waiting point
  };
  /// The values of all batches and of the waiting points, and the groups of both.
  const AlignedVector<double>& values() const noexcept { return data_; }
  const std::vector<std::uint8_t>& groups() const noexcept { return group_; }     ///< see values()
  const std::vector<double>& new_values() const noexcept { return new_values_; }  ///< see values()
  /// See values().
  const std::vector<std::uint8_t>& new_groups() const noexcept { return new_groups_; }

  /// Puts a stored set back; the grid must have the blocks it was stored with.
  void restore(const BlockGrid<Dim>& grid, Storage&& stored) {
    data_ = std::move(stored.values);
    group_ = std::move(stored.groups);
    blocks_ = std::move(stored.blocks);
    new_values_ = std::move(stored.new_values);
    new_groups_ = std::move(stored.new_groups);
    size_ = 0;
    for_each([&](std::size_t, int) { ++size_; });
    list_spans(grid);
  }

  /// Marks in `occupied` (one entry per block number) the blocks that hold points.
  void mark_blocks(const BlockGrid<Dim>& grid, std::vector<char>& occupied) const {
    for_each_value([&](const double* p, int step, int) {
      occupied[grid.block_number(cell_of(grid, p, step))] = 1;
    });
  }

  /// Sorts by block and group, then by cell or, for bases of three nodes per axis, by the middle node,
  /// so that many batches share their nodes; new points join, removed ones vanish.
  void sort(const BlockGrid<Dim>& grid, int groups, SortBy by = SortBy::cell, int threads = 1) {
    by_ = by;
    const std::vector<std::size_t> start = count(grid, groups);
    const std::size_t size =
        batch_total(start, groups, grid.slots()) * static_cast<std::size_t>(stride);
    AlignedVector<double> sorted;
    reserve_by_threads(sorted, size, threads);
    sorted.resize(size);
    place(grid, groups, start, sorted);
    data_.swap(sorted);
    new_values_.clear();
    new_groups_.clear();
    list_spans(grid);
  }

 private:
  using B = Block<Dim>;

  /// Calls f(first component of the point, distance between components, group) for all points.
  template <class F>
  void for_each_value(F&& f) const {
    for_each([&](std::size_t b, int l) {
      f(data_.data() + b * stride + static_cast<std::size_t>(l), lane_count, group_[b]);
    });
    for (std::size_t i = 0; i < new_groups_.size(); ++i)
      f(new_values_.data() + i * Fields::total, 1, new_groups_[i]);
  }
  static Index<Dim> cell_of(const BlockGrid<Dim>& grid, const double* p, int step) noexcept {
    constexpr int x = Fields::template offset<field::Position>();
    Index<Dim> c;
    for (int d = 0; d < Dim; ++d) c[d] = grid.cell_of(p[(x + d) * step], d);
    return c;
  }
  /// Number of keys of one block and group.
  std::size_t keys() const noexcept {
    return by_ == SortBy::cell ? std::size_t{B::cells} : ranks_.size();
  }
  std::size_t key(const BlockGrid<Dim>& grid, const double* p, int step, int group,
                  int groups) const noexcept {
    constexpr int x = Fields::template offset<field::Position>();
    const Index<Dim> c = cell_of(grid, p, step);
    const int slot = grid.slot(grid.block_number(c));
    const std::size_t range = static_cast<std::size_t>(slot * groups + group);
    Index<Dim> local;
    for (int d = 0; d < Dim; ++d) local[d] = c[d] % B::edge;
    if (by_ == SortBy::cell)
      return range * B::cells + static_cast<std::size_t>(BlockGrid<Dim>::local_index(local));
    std::size_t node = 0;
    for (int d = Dim - 1; d >= 0; --d) {
      const Real u = (p[(x + d) * step] - grid.origin()[d]) / grid.cell_size() - c[d];
      node = node * (B::edge + 1) + static_cast<std::size_t>(local[d] + (u >= 0.5 ? 1 : 0));
    }
    return range * ranks_.size() + ranks_[node];
  }
  /// Ranks of the nodes of a block: those inside come first, since all points near them are in the
  /// block; where these fill whole batches, they stay so.
  static constexpr auto rank_nodes() {
    constexpr int edge = B::edge + 1;
    std::array<std::uint8_t, power<Dim>(static_cast<std::size_t>(edge))> rank{};
    std::uint8_t next = 0;
    for (int sides = 0; sides <= Dim; ++sides)
      for (std::size_t n = 0; n < rank.size(); ++n) {
        int rest = static_cast<int>(n), on = 0;
        for (int d = 0; d < Dim; ++d, rest /= edge)
          on += rest % edge == 0 || rest % edge == edge - 1 ? 1 : 0;
        if (on == sides) rank[n] = next++;
      }
    return rank;
  }
  static constexpr auto ranks_ = rank_nodes();

  /// Number of points before each key (block, group, place in the block), and in all.
  std::vector<std::size_t> count(const BlockGrid<Dim>& grid, int groups) const {
    std::vector<std::size_t> start(static_cast<std::size_t>(grid.slots() * groups) * keys() + 1, 0);
    for_each_value([&](const double* p, int step, int group) {
      ++start[key(grid, p, step, group, groups) + 1];
    });
    for (std::size_t k = 1; k < start.size(); ++k) start[k] += start[k - 1];
    return start;
  }
  std::size_t batches_of(const std::vector<std::size_t>& start, std::size_t range) const {
    return (start[(range + 1) * keys()] - start[range * keys()] + lane_count - 1) / lane_count;
  }
  std::size_t batch_total(const std::vector<std::size_t>& start, int groups, int slots) const {
    std::size_t total = 0;
    for (std::size_t r = 0; r < static_cast<std::size_t>(slots * groups); ++r)
      total += batches_of(start, r);
    return total;
  }

  void place(const BlockGrid<Dim>& grid, int groups, const std::vector<std::size_t>& start,
             AlignedVector<double>& sorted) {
    const std::size_t ranges = static_cast<std::size_t>(grid.slots() * groups);
    std::vector<std::size_t> first_batch(ranges + 1, 0);
    for (std::size_t r = 0; r < ranges; ++r)
      first_batch[r + 1] = first_batch[r] + batches_of(start, r);
    std::vector<std::size_t> next = start;
    for_each_value([&](const double* p, int step, int group) {
      const std::size_t k = key(grid, p, step, group, groups);
      const std::size_t range = k / keys();
      const std::size_t n = next[k]++ - start[range * keys()];
      double* to = sorted.data() + (first_batch[range] + n / lane_count) * stride + n % lane_count;
      for (int c = 0; c < Fields::total; ++c) to[c * lane_count] = p[c * step];
    });
    size_ = start.back();
    group_.assign(first_batch[ranges], 0);
    blocks_.clear();
    for (int s = 0; s < grid.slots(); ++s) {
      const std::size_t r0 = static_cast<std::size_t>(s * groups);
      const std::size_t r1 = r0 + static_cast<std::size_t>(groups);
      for (std::size_t r = r0; r < r1; ++r) {
        const std::size_t n = start[(r + 1) * keys()] - start[r * keys()];
        for (std::size_t b = first_batch[r]; b < first_batch[r + 1]; ++b)
          group_[b] = static_cast<std::uint8_t>(r - r0);
        if (n > 0) pad(sorted, first_batch[r + 1] - 1, static_cast<int>((n - 1) % lane_count) + 1);
      }
      if (first_batch[r1] > first_batch[r0])
        blocks_.push_back({s, first_batch[r0], first_batch[r1]});
    }
  }
  /// Fills the lanes from `used` on: copies of the first point without id, mass and volume.
  static void pad(AlignedVector<double>& data, std::size_t batch, int used) noexcept {
    double* p = data.data() + batch * stride;
    for (int l = used; l < lane_count; ++l) {
      for (int c = 0; c < Fields::total; ++c) p[c * lane_count + l] = p[c * lane_count];
      p[Fields::template offset<field::Id>() * lane_count + l] = -1;
      p[Fields::template offset<field::Mass>() * lane_count + l] = 0;
      p[Fields::template offset<field::Volume>() * lane_count + l] = 0;
    }
  }
  /// Spans are layers across the slab axis; where there are few of those, the rows in them, or threads
  /// would wait for each other.
  void list_spans(const BlockGrid<Dim>& grid) {
    constexpr int few = 16;
    const int slab = grid.slab_axis(), across = slab == Dim - 1 ? Dim - 2 : Dim - 1;
    const bool rows = Dim > 1 && grid.blocks()[slab] < few;
    for (auto& spans : spans_) spans.clear();
    int last_layer = -1, last_row = -1;
    std::vector<BlockSpan>* spans = nullptr;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const Index<Dim>& block = grid.block(blocks_[i].slot);
      const int layer = block[slab], row = rows ? block[across] : 0;
      if (layer != last_layer || row != last_row) {
        spans = &spans_[static_cast<std::size_t>(2 * (layer & 1) + (row & 1))];
        spans->push_back({i, i});
      }
      spans->back().end = i + 1;
      last_layer = layer, last_row = row;
    }
  }

  AlignedVector<double> data_;
  std::vector<std::uint8_t> group_;
  std::vector<BatchRange> blocks_;
  std::array<std::vector<BlockSpan>, colours> spans_;
  std::size_t size_ = 0;
  SortBy by_ = SortBy::cell;
  std::vector<double> new_values_;
  std::vector<std::uint8_t> new_groups_;
};

}  // namespace vadose
