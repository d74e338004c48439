// SPDX-License-Identifier: MIT

// Point sets: sorting, padding, groups, adding and removing, and sums that do not depend on the
// number of threads.

#include <doctest/doctest.h>

#include <set>

#include "kernel_support.hpp"

namespace {

using namespace kernel_test;
using vadose::BlockGrid;
namespace field = vadose::field;

template <int Dim>
using Fields = vadose::FieldSet<vadose::Sized<field::Id, 1>, vadose::Sized<field::Position, Dim>,
                                vadose::Sized<field::Velocity, Dim>, vadose::Sized<field::Mass, 1>,
                                vadose::Sized<field::Volume, 1>, vadose::Sized<field::Affine, 0>>;
template <int Dim>
using Points = vadose::PointSet<Dim, Fields<Dim>>;

/// A grid, a point set in it and what every point must hold, by id.
template <int Dim>
struct Filled {
  BlockGrid<Dim> grid;
  Points<Dim> points;
  std::map<std::int64_t, std::vector<double>> expected;
  std::map<std::int64_t, int> group;
  std::int64_t next_id = 0;
  Random random;
  static constexpr int groups = 3;

  Filled(const Index<Dim>& cells, int count, unsigned seed)
      : grid(Vec<Dim>::Zero(), 1.0, cells), random(seed) {
    for (int i = 0; i < count; ++i) add();
  }
  void add() {
    std::vector<double> values;
    values.push_back(static_cast<double>(next_id));
    for (int d = 0; d < Dim; ++d) values.push_back(random.in(0, grid.cells()[d]));
    while (values.size() < static_cast<std::size_t>(Fields<Dim>::total))
      values.push_back(random.in(0.5, 2));
    group[next_id] = random.below(groups);
    points.append(values, group[next_id]);
    expected[next_id++] = values;
  }
  void sort() {
    std::vector<char> occupied(grid.block_count(), 0);
    points.mark_blocks(grid, occupied);
    grid.rebuild(occupied);
    points.sort(grid, groups);
  }
  Index<Dim> cell(std::size_t b, int l) const {
    Index<Dim> c;
    for (int d = 0; d < Dim; ++d) c[d] = grid.cell_of(points.at(field::position, b, d)[l], d);
    return c;
  }
  /// Everything that must hold after a sort.
  void check() const {
    const auto all = by_id(points);
    REQUIRE(all.size() == expected.size());
    CHECK(points.size() == expected.size());
    CHECK_FALSE(points.has_new());
    for (const auto& [id, values] : expected) {
      const auto found = all.find(id);
      REQUIRE(found != all.end());
      REQUIRE(same_bits(found->second, values));
    }
    std::size_t covered = 0;
    for (const auto& range : points.blocks()) {
      REQUIRE(range.begin == covered);
      covered = range.end;
      for (std::size_t b = range.begin; b < range.end; ++b)
        for (int l = 0; l < lane_count; ++l) {
          // Padding too lies in the block, so that kernels can treat it like a point.
          CHECK(grid.slot(grid.block_number(cell(b, l))) == range.slot);
          if (points.at(field::id, b)[l] < 0) {
            CHECK(points.at(field::mass, b)[l] == 0);
            CHECK(points.at(field::volume, b)[l] == 0);
            CHECK(vadose::is_finite(points.at(field::velocity, b)[l]));
          } else {
            const auto id = static_cast<std::int64_t>(points.at(field::id, b)[l]);
            CHECK(points.group(b) == group.at(id));
          }
        }
    }
    CHECK(covered == points.batches());
    check_spans();
    check_order();
  }
  /// Every block is in one span; spans of one colour can be worked on together.
  void check_spans() const {
    std::vector<int> spans_of_block(points.blocks().size(), 0);
    for (int colour = 0; colour < points.colours; ++colour) {
      const auto& spans = points.spans(colour);
      for (std::size_t s = 0; s < spans.size(); ++s) {
        REQUIRE(spans[s].begin < spans[s].end);
        REQUIRE(spans[s].end <= points.blocks().size());
        for (std::size_t i = spans[s].begin; i < spans[s].end; ++i) {
          ++spans_of_block[i];
          for (std::size_t other = 0; other < s; ++other)
            for (std::size_t k = spans[other].begin; k < spans[other].end; ++k)
              CHECK(!are_neighbours(points.blocks()[i].slot, points.blocks()[k].slot));
        }
      }
    }
    for (const int count : spans_of_block) CHECK(count == 1);
  }
  bool are_neighbours(int slot, int other) const {
    for (int d = 0; d < Dim; ++d)
      if (std::abs(grid.block(slot)[d] - grid.block(other)[d]) > 1) return false;
    return true;
  }
  /// Inside a group of a block the points are ordered by cell.
  void check_order() const {
    for (const auto& range : points.blocks()) {
      int last_group = -1, last_cell = -1;
      for (std::size_t b = range.begin; b < range.end; ++b) {
        if (points.group(b) != last_group) last_cell = -1;
        CHECK(points.group(b) >= last_group);
        last_group = points.group(b);
        for (int l = 0; l < lane_count; ++l) {
          if (points.at(field::id, b)[l] < 0) continue;
          Index<Dim> local = cell(b, l);
          for (int d = 0; d < Dim; ++d) local[d] %= vadose::Block<Dim>::edge;
          const int at = BlockGrid<Dim>::local_index(local);
          CHECK(at >= last_cell);
          last_cell = at;
        }
      }
    }
  }
  /// Ids in storage order.
  std::vector<std::int64_t> order() const {
    std::vector<std::int64_t> ids;
    points.for_each([&](std::size_t b, int l) {
      ids.push_back(static_cast<std::int64_t>(points.at(field::id, b)[l]));
    });
    return ids;
  }
};

template <int Dim>
void check_life(const Index<Dim>& cells, int count, unsigned seed) {
  Filled<Dim> f(cells, count, seed);
  CHECK(f.points.has_new());
  f.sort();
  f.check();
  // A second sort of unmoved points changes no place.
  const auto order = f.order();
  f.sort();
  f.check();
  CHECK(f.order() == order);
  // Points move.
  for (int round = 0; round < 3; ++round) {
    f.points.for_each([&](std::size_t b, int l) {
      const auto id = static_cast<std::int64_t>(f.points.at(field::id, b)[l]);
      for (int d = 0; d < Dim; ++d) {
        double& x = f.points.at(field::position, b, d)[l];
        x = std::clamp(x + f.random.in(-2, 2), 0.0, static_cast<double>(f.grid.cells()[d]));
        f.expected[id][static_cast<std::size_t>(1 + d)] = x;
      }
    });
    // Some vanish, some are born.
    std::vector<std::pair<std::size_t, int>> doomed;
    f.points.for_each([&](std::size_t b, int l) {
      if (f.random.below(5) == 0) doomed.emplace_back(b, l);
    });
    for (const auto& [b, l] : doomed) {
      const auto id = static_cast<std::int64_t>(f.points.at(field::id, b)[l]);
      f.expected.erase(id);
      f.points.remove(b, l);
      CHECK(f.points.at(field::mass, b)[l] == 0);
    }
    CHECK(f.points.size() == f.expected.size());
    for (int k = 0; k < 37; ++k) f.add();
    f.sort();
    f.check();
  }
}

/// Nodal sums of a set with a given number of threads.
template <int Dim>
vadose::AlignedVector<vadose::Record> nodal_sums(const Filled<Dim>& f, int threads) {
  using vadose::kernel::Tile;
  vadose::AlignedVector<vadose::Record> nodes(f.grid.size());
  std::vector<Tile<Dim>> tiles(static_cast<std::size_t>(threads));
  vadose::kernel::for_blocks_adding(
      f.points, threads, [&](const vadose::BatchRange& range, int thread) {
        Tile<Dim>& tile = tiles[static_cast<std::size_t>(thread)];
        const auto frame = vadose::kernel::tile_frame(f.grid, range.slot);
        for (std::size_t b = range.begin; b < range.end; ++b) {
          Lanes x[Dim], half[Dim];
          for (int d = 0; d < Dim; ++d) {
            x[d] = f.points.load(field::position, b, d);
            half[d] = Lanes(0.3);
          }
          vadose::kernel::Stencil<vadose::shape::Gimp, Dim> stencil;
          stencil.evaluate(frame, x, half);
          vadose::kernel::Scatter<false, false, vadose::shape::Gimp, Dim> scatter;
          for (auto& v : scatter.value) v = Lanes(0.0);
          scatter.value[0] = f.points.load(field::mass, b);
          scatter.value[1] = f.points.load(field::mass, b) * f.points.load(field::velocity, b);
          vadose::transpose(scatter.value);
          scatter.add(stencil, tile.record);
        }
        tile.add_to(f.grid, range.slot, nodes);
      });
  return nodes;
}

template <int Dim>
void check_threads(const Index<Dim>& cells, int count, unsigned seed) {
  Filled<Dim> f(cells, count, seed);
  f.sort();
  const auto one = nodal_sums(f, 1);
  double mass = 0;
  for (const auto& r : one) mass += r[0];
  double expected = 0;
  f.points.for_each([&](std::size_t b, int l) { expected += f.points.at(field::mass, b)[l]; });
  CHECK(mass == doctest::Approx(expected).epsilon(1e-12));
  for (const int threads : {2, 3}) {
    const auto many = nodal_sums(f, threads);
    CHECK(std::memcmp(one.data(), many.data(), one.size() * sizeof(vadose::Record)) == 0);
  }
}

}  // namespace

TEST_CASE("sorting keeps every value of every point, through moves, births and deaths") {
  check_life<1>({{150}}, 90, 61);
  check_life<2>({{30, 21}}, 500, 62);    // few layers: spans are rows
  check_life<2>({{140, 21}}, 2000, 62);  // many: spans are layers
  check_life<3>({{9, 6, 13}}, 700, 63);
}

TEST_CASE("points of one cell and group keep the order in which they were added") {
  Filled<2> f({{20, 20}}, 0, 64);
  for (int i = 0; i < 60; ++i) {
    const double id = i;
    const std::array<double, 7> values{id, i % 2 == 0 ? 3.5 : 11.5, 4.5, 0, 0, 1, 1};
    static_assert(Fields<2>::total == 7);
    f.points.append(values, i % 3);
  }
  for (int round = 0; round < 3; ++round) {
    f.sort();
    std::map<std::pair<int, int>, std::int64_t> last;
    f.points.for_each([&](std::size_t b, int l) {
      const auto id = static_cast<std::int64_t>(f.points.at(field::id, b)[l]);
      const std::pair<int, int> place{f.cell(b, l)[0], f.points.group(b)};
      const auto found = last.find(place);
      if (found != last.end()) CHECK(found->second < id);
      last[place] = id;
    });
    CHECK(last.size() == 6);
  }
}

TEST_CASE("an empty set has no batches and can be sorted") {
  Filled<2> f({{20, 20}}, 0, 65);
  f.sort();
  f.check();
  CHECK(f.points.batches() == 0);
  CHECK(f.points.blocks().empty());
  CHECK(f.grid.slots() == 0);
}

TEST_CASE("a set fills whole batches per block and group only") {
  Filled<2> f({{8, 7}}, 0, 66);
  const std::array<double, 7> values{0, 1, 1, 0, 0, 1, 1};
  for (int i = 0; i < 9; ++i) {
    auto v = values;
    v[0] = i;
    f.points.append(v, i == 8 ? 1 : 0);
  }
  f.sort();
  CHECK(f.points.batches() == 2);
  CHECK(f.points.group(0) == 0);
  CHECK(f.points.group(1) == 1);
  CHECK(f.points.at(field::id, 1)[0] == 8);
  for (int l = 1; l < lane_count; ++l) CHECK(f.points.at(field::id, 1)[l] == -1);
}

TEST_CASE("nodal sums have the same bits for one, two and three threads") {
  check_threads<1>({{2000}}, 3000, 67);
  check_threads<2>({{50, 33}}, 3000, 68);
  check_threads<2>({{33, 150}}, 3000, 68);
  check_threads<3>({{13, 14, 29}}, 4000, 69);
}

TEST_CASE("room made by threads is empty, large enough and stays where it is") {
  for (const int threads : {1, 2, 3}) {
    vadose::AlignedVector<vadose::Record> records(3);
    vadose::reserve_by_threads(records, 5000, threads);
    CHECK(records.empty());
    CHECK(records.capacity() >= 5000);
    const auto* place = records.data();
    records.assign(5000, vadose::Record{});
    vadose::reserve_by_threads(records, 4000, threads);
    CHECK(records.empty());
    CHECK(records.data() == place);
  }
}
