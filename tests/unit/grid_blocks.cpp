// SPDX-License-Identifier: MIT

// The block grid: entries, tiles, blocks that exist, cells of positions.

#include <doctest/doctest.h>

#include <set>

#include "kernel_support.hpp"

namespace {

using namespace kernel_test;
using vadose::Block;
using vadose::BlockGrid;

template <int Dim>
Index<Dim> cells_of(int a, int b, int c) {
  const int all[3] = {a, b, c};
  Index<Dim> n;
  for (int d = 0; d < Dim; ++d) n[d] = all[d];
  return n;
}

/// Calls f(index) for all nodes 0 .. cells of a box.
template <int Dim, class F>
void for_nodes(const Index<Dim>& cells, F&& f) {
  int most = 0;
  for (int d = 0; d < Dim; ++d) most = std::max(most, cells[d]);
  vadose::for_cube<Dim>(0, most + 1, [&](const Index<Dim>& i) {
    for (int d = 0; d < Dim; ++d)
      if (i[d] > cells[d]) return;
    f(i);
  });
}

template <int Dim>
void check_entries(const Index<Dim>& cells) {
  const BlockGrid<Dim> grid = full_grid<Dim>(Vec<Dim>::Constant(1.5), 0.1, cells);
  std::set<std::int32_t> seen;
  std::size_t count = 0;
  for_nodes<Dim>(cells, [&](const Index<Dim>& node) {
    const std::int32_t e = grid.entry(node);
    REQUIRE(e >= 0);
    REQUIRE(e < grid.outside());
    seen.insert(e);
    ++count;
    // The entry's block holds the node.
    const Index<Dim> first = grid.first_cell(e / Block<Dim>::cells);
    Index<Dim> local;
    for (int d = 0; d < Dim; ++d) {
      local[d] = node[d] - first[d];
      REQUIRE(local[d] >= 0);
      REQUIRE(local[d] < Block<Dim>::edge);
    }
    REQUIRE(BlockGrid<Dim>::local_index(local) == e % Block<Dim>::cells);
  });
  CHECK(seen.size() == count);
  CHECK(grid.size() == static_cast<std::size_t>(grid.slots() + 1) * Block<Dim>::cells);
  for (int d = 0; d < Dim; ++d) {
    Index<Dim> below, above;
    below[d] = -1;
    above[d] = (cells[d] / Block<Dim>::edge + 1) * Block<Dim>::edge;
    CHECK(grid.entry(below) == grid.outside());
    CHECK(grid.entry(above) == grid.outside());
  }
}

template <int Dim>
void check_tiles(const BlockGrid<Dim>& grid) {
  for (int s = 0; s < grid.slots(); ++s) {
    std::set<int> positions;
    vadose::for_cube<Dim>(-1, Block<Dim>::edge + 2, [&](const Index<Dim>& i) {
      Index<Dim> node;
      for (int d = 0; d < Dim; ++d) node[d] = grid.first_cell(s)[d] + i[d];
      const int at = BlockGrid<Dim>::tile_index(i);
      positions.insert(at);
      REQUIRE(grid.tile(s)[at] == grid.entry(node));
      for (int d = 0; d < Dim && i[d] < Block<Dim>::edge + 1; ++d) {
        Index<Dim> next = i;
        ++next[d];
        REQUIRE(BlockGrid<Dim>::tile_index(next) == at + BlockGrid<Dim>::tile_stride(d));
      }
    });
    CHECK(positions.size() == static_cast<std::size_t>(Block<Dim>::tile_size));
    CHECK(*positions.begin() == 0);
  }
}

template <int Dim>
void check_rebuild(const Index<Dim>& cells, unsigned seed) {
  Random random(seed);
  BlockGrid<Dim> grid(Vec<Dim>::Zero(), 1.0, cells);
  Index<Dim> blocks;
  for (int d = 0; d < Dim; ++d) blocks[d] = cells[d] / Block<Dim>::edge + 1;
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<char> occupied(grid.block_count(), 0);
    std::set<std::size_t> wanted;
    for (int k = 0; k < 1 + trial % 3; ++k) {
      Index<Dim> cell;
      for (int d = 0; d < Dim; ++d) cell[d] = random.below(cells[d]);
      occupied[grid.block_number(cell)] = 1;
      vadose::for_cube<Dim>(-1, 2, [&](const Index<Dim>& step) {
        Index<Dim> other;
        for (int d = 0; d < Dim; ++d) {
          const int b = cell[d] / Block<Dim>::edge + step[d];
          if (b < 0 || b >= blocks[d]) return;
          other[d] = b * Block<Dim>::edge;
        }
        wanted.insert(grid.block_number(other));
      });
    }
    grid.rebuild(occupied);
    REQUIRE(static_cast<std::size_t>(grid.slots()) == wanted.size());
    int last = -1;
    for (int s = 0; s < grid.slots(); ++s) {
      const std::size_t number = grid.block_number(grid.first_cell(s));
      CHECK(wanted.count(number) == 1);
      CHECK(grid.slot(number) == s);
      const int layer = grid.block(s)[grid.slab_axis()];
      CHECK(layer >= last);  // in order of layers
      last = layer;
    }
    for (std::size_t n = 0; n < grid.block_count(); ++n)
      CHECK((grid.slot(n) >= 0) == (wanted.count(n) == 1));
    check_tiles(grid);
  }
}

}  // namespace

TEST_CASE("every cell and node of a full grid has an entry of its own") {
  check_entries<1>({{130}});
  check_entries<2>({{16, 25}});
  check_entries<3>({{8, 3, 13}});
}

TEST_CASE("tiles list the nodes from one below a block to two above") {
  check_tiles(full_grid<1>(Vec<1>(0.0), 1.0, {{200}}));
  check_tiles(full_grid<2>({0, 0}, 1.0, {{24, 9}}));
  check_tiles(full_grid<3>({0, 0, 0}, 1.0, {{9, 8, 4}}));
}

TEST_CASE("only occupied blocks and their neighbours exist, in order of layers") {
  check_rebuild<1>(cells_of<1>(700, 0, 0), 51);
  check_rebuild<2>(cells_of<2>(40, 64, 0), 52);
  check_rebuild<3>(cells_of<3>(13, 21, 17), 53);
}

TEST_CASE("a node that does not exist is the entry outside") {
  BlockGrid<2> grid({0, 0}, 1.0, {{64, 64}});
  std::vector<char> occupied(grid.block_count(), 0);
  occupied[grid.block_number({{4, 4}})] = 1;
  grid.rebuild(occupied);
  CHECK(grid.slots() == 4);
  CHECK(grid.entry({{15, 15}}) < grid.outside());
  CHECK(grid.entry({{16, 15}}) == grid.outside());
  CHECK(grid.entry({{-1, 0}}) == grid.outside());
  CHECK(grid.entry({{100000, 0}}) == grid.outside());
}

TEST_CASE("a grid in use can be rebuilt and forgets its old blocks") {
  BlockGrid<2> grid({0, 0}, 1.0, {{64, 64}});
  std::vector<char> occupied(grid.block_count(), 0);
  occupied[grid.block_number({{4, 4}})] = 1;
  grid.rebuild(occupied);
  std::vector<char> other(grid.block_count(), 0);
  other[grid.block_number({{40, 40}})] = 1;
  grid.rebuild(other);
  CHECK(grid.slots() == 9);
  CHECK(grid.slot(grid.block_number({{4, 4}})) == -1);
  CHECK(grid.entry({{4, 4}}) == grid.outside());
  CHECK(grid.entry({{40, 40}}) < grid.outside());
}

TEST_CASE("positions are clamped into the box") {
  const BlockGrid<2> grid({-1, 2}, 0.5, {{6, 4}});
  CHECK(grid.cell_of(-5, 0) == 0);
  CHECK(grid.cell_of(-1, 0) == 0);
  CHECK(grid.cell_of(-0.51, 0) == 0);
  CHECK(grid.cell_of(-0.5, 0) == 1);
  CHECK(grid.cell_of(1.99, 0) == 5);
  CHECK(grid.cell_of(2, 0) == 5);
  CHECK(grid.cell_of(40, 0) == 5);
  CHECK(grid.cell_of(std::numeric_limits<Real>::quiet_NaN(), 0) == 0);
  CHECK(grid.contains({-1, 2}));
  CHECK(grid.contains({2, 4}));
  CHECK_FALSE(grid.contains({2.0001, 3}));
  CHECK_FALSE(grid.contains({0, 1.9999}));
  CHECK_FALSE(grid.contains({std::numeric_limits<Real>::quiet_NaN(), 3}));
}

TEST_CASE("layers run along the axis with most blocks") {
  CHECK(BlockGrid<2>({0, 0}, 1.0, {{100, 20}}).slab_axis() == 0);
  CHECK(BlockGrid<2>({0, 0}, 1.0, {{20, 100}}).slab_axis() == 1);
  CHECK(BlockGrid<3>({0, 0, 0}, 1.0, {{8, 8, 30}}).slab_axis() == 2);
}
