// SPDX-License-Identifier: MIT

// Scatter and gather of records, and the cells of points, against plain loops.

#include <doctest/doctest.h>

#include "kernel_support.hpp"

namespace {

using namespace kernel_test;
using vadose::Block;
using vadose::BlockGrid;
using vadose::Record;
using vadose::kernel::Tile;

/// Eight random points of one block of a small box, some at its walls; or close together.
template <class Basis, int Dim>
struct Batch {
  BlockGrid<Dim> grid;
  int slot = 0;
  std::array<Vec<Dim>, 8> x, half;
  vadose::kernel::Stencil<typename Basis::policy, Dim> stencil;

  explicit Batch(Random& random, bool together = false) {
    Vec<Dim> origin;
    Index<Dim> cells;
    for (int d = 0; d < Dim; ++d) {
      origin[d] = 0.5 - d;
      cells[d] = 2 * Block<Dim>::edge - 1;
    }
    const Real h = 0.25;  // a power of two: both sides see the same position in cells
    grid = full_grid<Dim>(origin, h, cells);
    slot = random.below(grid.slots());
    Lanes lanes[Dim], half_lanes[Dim];
    for (int d = 0; d < Dim; ++d)
      for (std::size_t p = 0; p < 8; ++p) {
        const int low = grid.first_cell(slot)[d];
        const int high = std::min(low + Block<Dim>::edge, cells[d]);
        const Real u = random.in(std::max(0.0, low - 0.4), std::min<Real>(high + 0.4, cells[d]));
        x[p][d] = together && p > 0 ? x[0][d] + random.in(-1e-3, 1e-3) * h : origin[d] + u * h;
        half[p][d] = h * random.in(0.1, 0.5);
        lanes[d].set(static_cast<int>(p), x[p][d]);
        half_lanes[d].set(static_cast<int>(p), half[p][d]);
      }
    stencil.evaluate(vadose::kernel::tile_frame(grid, slot), lanes, half_lanes);
  }
  /// Node of a position in the tile.
  Index<Dim> node(const Index<Dim>& i) const {
    Index<Dim> n;
    for (int d = 0; d < Dim; ++d) n[d] = grid.first_cell(slot)[d] + i[d];
    return n;
  }
  bool exists(const Index<Dim>& n) const {
    for (int d = 0; d < Dim; ++d)
      if (n[d] < 0 || n[d] > grid.cells()[d]) return false;
    return true;
  }
  /// Distance of a node from the first node of a point, in cells.
  Real steps(const Index<Dim>& n, std::size_t p, int axis) const {
    return n[axis] - (grid.first_cell(slot)[axis] - 1 + stencil.first[axis][static_cast<int>(p)]);
  }
};

template <bool Slopes, bool Moments, class Basis, int Dim>
Real scatter_error(unsigned seed) {
  Random random(seed);
  Real worst = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Batch<Basis, Dim> batch(random);
    Real value[8][8], slope[Dim][8][8] = {}, moment[Dim][8][8] = {};
    vadose::kernel::Scatter<Slopes, Moments, typename Basis::policy, Dim> scatter;
    for (int p = 0; p < 8; ++p)
      for (int r = 0; r < 8; ++r) {
        value[p][r] = random.in(-1, 1);
        scatter.value[p].set(r, value[p][r]);
        for (int e = 0; e < Dim; ++e) {
          // Slope parts go to lanes 4 .. 7, moments to lanes 0 .. 3.
          slope[e][p][r] = r >= 4 ? random.in(-1, 1) : 0;
          moment[e][p][r] = r < 4 ? random.in(-1, 1) : 0;
          if constexpr (Slopes) scatter.slope[e][p].set(r, slope[e][p][r]);
          if constexpr (Moments) scatter.moment[e][p].set(r, moment[e][p][r]);
        }
      }
    std::vector<Tile<Dim>> tile(1);
    scatter.add(batch.stencil, tile[0].record);
    vadose::for_cube<Dim>(-1, Block<Dim>::edge + 2, [&](const Index<Dim>& i) {
      const Index<Dim> node = batch.node(i);
      if (!batch.exists(node)) return;
      Real expected[8] = {};
      Real scale = 1;
      for (std::size_t p = 0; p < 8; ++p) {
        const auto f = node_value<Basis, Dim>(batch.grid, node, batch.x[p], batch.half[p]);
        for (int r = 0; r < 8; ++r) {
          Real v = value[p][r];
          for (int e = 0; Moments && e < Dim; ++e) v += moment[e][p][r] * batch.steps(node, p, e);
          expected[r] += v * f.value;
          for (int e = 0; Slopes && e < Dim; ++e) {
            const Real g = f.gradient[static_cast<std::size_t>(e)];
            expected[r] += slope[e][p][r] * g;
            scale = std::max(scale, std::fabs(g));
          }
        }
      }
      const Record& got = tile[0].record[BlockGrid<Dim>::tile_index(i)];
      for (int r = 0; r < 8; ++r) worst = std::max(worst, std::fabs(got[r] - expected[r]) / scale);
    });
  }
  return worst;
}

template <class Basis, int Dim>
Real gather_error(unsigned seed) {
  Random random(seed);
  Real worst = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Batch<Basis, Dim> batch(random);
    std::vector<Tile<Dim>> tile(1);
    for (auto& r : tile[0].record)
      for (double& v : r.value) v = random.in(-1, 1);
    vadose::kernel::Gather<true, typename Basis::policy, Dim> gather;
    gather.sum(batch.stencil, tile[0].record);
    vadose::kernel::Gather<false, typename Basis::policy, Dim> plain;
    plain.sum(batch.stencil, tile[0].record);
    plain.by_field();
    for (std::size_t p = 0; p < 8; ++p) {
      Real value[8] = {}, slope[Dim][8] = {}, scale = 1;
      vadose::for_cube<Dim>(-1, Block<Dim>::edge + 2, [&](const Index<Dim>& i) {
        const Index<Dim> node = batch.node(i);
        if (!batch.exists(node)) return;
        const auto f = node_value<Basis, Dim>(batch.grid, node, batch.x[p], batch.half[p]);
        const Record& r = tile[0].record[BlockGrid<Dim>::tile_index(i)];
        for (int lane = 0; lane < 8; ++lane) {
          value[lane] += f.value * r[lane];
          for (int e = 0; e < Dim; ++e) {
            slope[e][lane] += f.gradient[static_cast<std::size_t>(e)] * r[lane];
            scale = std::max(scale, std::fabs(f.gradient[static_cast<std::size_t>(e)]));
          }
        }
      });
      for (int lane = 0; lane < 8; ++lane) {
        const int at = static_cast<int>(p);
        worst = std::max(worst, std::fabs(gather.value[at][lane] - value[lane]));
        worst = std::max(worst, std::fabs(plain.value[lane][at] - value[lane]));
        for (int e = 0; lane < 4 && e < Dim; ++e)
          worst = std::max(worst, std::fabs(gather.slope[e][at][lane] - slope[e][lane]) / scale);
      }
    }
  }
  return worst;
}

/// Against the general scatter, of the largest number.
template <class Basis, int Dim>
Real force_scatter_error(unsigned seed) {
  Random random(seed);
  Real worst = 0, most = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const Batch<Basis, Dim> batch(random);
    vadose::kernel::Scatter<true, false, typename Basis::policy, Dim> general;
    vadose::kernel::ForceScatter<typename Basis::policy, Dim> scatter;
    const auto draw = [&] {
      Lanes v;
      for (int p = 0; p < lane_count; ++p) v.set(p, random.in(-1, 1));
      return v;
    };
    Lanes value[5], force[Dim][Dim];
    for (auto& v : value) v = draw();
    for (auto& v : general.value) v = Lanes(0.0);
    for (int i = 0; i < 5; ++i) general.value[i < 4 ? i : vadose::lane::volume] = value[i];
    vadose::transpose(general.value);
    for (int e = 0; e < Dim; ++e) {
      for (auto& v : general.slope[e]) v = Lanes(0.0);
      for (int d = 0; d < Dim; ++d)
        general.slope[e][vadose::lane::force + d] = force[e][d] = draw();
      vadose::transpose(general.slope[e]);
    }
    scatter.set(value, force);
    std::vector<Tile<Dim>> tile(2);
    general.add(batch.stencil, tile[0].record);
    scatter.add(batch.stencil, tile[1].record);
    for (std::size_t i = 0; i < std::size_t{Block<Dim>::tile_size}; ++i)
      for (int r = 0; r < 8; ++r) {
        most = std::max(most, std::fabs(tile[0].record[i][r]));
        worst = std::max(worst, std::fabs(tile[0].record[i][r] - tile[1].record[i][r]));
      }
  }
  return worst / most;
}

/// Points that share their nodes against each by itself.
template <class Basis, int Dim>
Real shared_gather_error(unsigned seed) {
  Random random(seed);
  Real worst = 0, most = 0;
  int shared = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const Batch<Basis, Dim> batch(random, true);
    shared += batch.stencil.shared;
    std::vector<Tile<Dim>> tile(1);
    for (auto& r : tile[0].record)
      for (double& v : r.value) v = random.in(-1, 1);
    vadose::kernel::Gather<true, typename Basis::policy, Dim> each, together;
    each.sum(batch.stencil, tile[0].record);
    each.by_field();
    together.sum_vectors(batch.stencil, tile[0].record);
    for (int p = 0; p < lane_count; ++p)
      for (int d = 0; d < Dim; ++d) {
        const auto compare = [&](const Lanes& a, const Lanes& b) {
          most = std::max(most, std::fabs(a[p]));
          worst = std::max(worst, std::fabs(a[p] - b[p]));
        };
        compare(each.value[d], together.value[d]);
        compare(each.value[4 + d], together.value[4 + d]);
        for (int e = 0; e < Dim; ++e) compare(each.slope[e][d], together.slope[e][d]);
      }
  }
  CHECK(shared > 20);
  return worst / most;
}

template <class Basis, int Dim>
void check_transfers() {
  CHECK(force_scatter_error<Basis, Dim>(48) < 1e-14);
  CHECK(shared_gather_error<Basis, Dim>(49) < 1e-14);
  CHECK(scatter_error<false, false, Basis, Dim>(41) < 1e-13);
  CHECK(scatter_error<true, false, Basis, Dim>(42) < 1e-13);
  CHECK(scatter_error<false, true, Basis, Dim>(43) < 1e-13);
  CHECK(scatter_error<true, true, Basis, Dim>(44) < 1e-13);
  CHECK(gather_error<Basis, Dim>(45) < 1e-13);
}

template <int Dim>
void check_cells() {
  Random random(46);
  Index<Dim> cells;
  for (int d = 0; d < Dim; ++d) cells[d] = Block<Dim>::edge + 3;
  const BlockGrid<Dim> grid = full_grid<Dim>(Vec<Dim>::Constant(-0.4), 0.25, cells);
  for (int trial = 0; trial < 200; ++trial) {
    const int slot = random.below(grid.slots());
    const Index<Dim> first = grid.first_cell(slot);
    Lanes x[Dim];
    std::array<Index<Dim>, 8> cell;
    for (int d = 0; d < Dim; ++d)
      for (std::size_t p = 0; p < 8; ++p) {
        const Real top = std::min(first[d] + Block<Dim>::edge, cells[d]);
        const bool special = random.below(4) == 0;
        // Cell boundaries are exact in this grid; the upper wall belongs to the last cell.
        const Real u = special ? first[d] + random.below(static_cast<int>(top) - first[d] + 1)
                               : random.in(first[d], top);
        const Real at = special ? -0.4 + 0.25 * u : -0.4 + 0.25 * (u + 1e-12);
        x[d].set(static_cast<int>(p), at);
        cell[p][d] = std::min(static_cast<int>(std::floor((at + 0.4) / 0.25)), cells[d] - 1);
      }
    vadose::kernel::CellFinder<Dim> finder;
    finder.find(vadose::kernel::tile_frame(grid, slot), x);
    for (std::size_t p = 0; p < 8; ++p) {
      int near = 1;
      Index<Dim> local;
      for (int d = 0; d < Dim; ++d) {
        local[d] = cell[p][d] - first[d];
        const Real u = (x[d][static_cast<int>(p)] + 0.4) / 0.25;
        if (std::fabs(u - std::round(u)) < 1e-9) near = 0;
      }
      // On a boundary either neighbour may be found; off it the cell must be right.
      if (near)
        CHECK(finder.index[p] == BlockGrid<Dim>::tile_index(local));
      else {
        CHECK(finder.index[p] >= 0);
        CHECK(finder.index[p] < Block<Dim>::tile_size);
      }
    }
  }
}

}  // namespace

TEST_CASE_TEMPLATE("scatter and gather equal plain loops in one dimension", Basis, ScalarLinear,
                   ScalarGimp, ScalarSpline) {
  check_transfers<Basis, 1>();
}

TEST_CASE_TEMPLATE("scatter and gather equal plain loops in two dimensions", Basis, ScalarLinear,
                   ScalarGimp, ScalarSpline) {
  check_transfers<Basis, 2>();
}

TEST_CASE_TEMPLATE("scatter and gather equal plain loops in three dimensions", Basis, ScalarLinear,
                   ScalarGimp, ScalarSpline) {
  check_transfers<Basis, 3>();
}

TEST_CASE("points find their cells") {
  check_cells<1>();
  check_cells<2>();
  check_cells<3>();
}

TEST_CASE("points beyond a wall count as in the last cell inside") {
  const BlockGrid<2> grid = full_grid<2>({0, 0}, 1.0, {{8, 8}});
  const auto frame = vadose::kernel::tile_frame(grid, 0);
  vadose::kernel::CellFinder<2> finder;
  finder.find(frame, {Lanes(-0.3), Lanes(8.2)});
  CHECK(finder.index[0] == BlockGrid<2>::tile_index({{0, 7}}));
  finder.find(frame, {Lanes(8.0), Lanes(0.0)});
  CHECK(finder.index[7] == BlockGrid<2>::tile_index({{7, 0}}));
}

TEST_CASE("a tile reads records and adds them back") {
  Random random(47);
  BlockGrid<3> grid({0, 0, 0}, 1.0, {{12, 9, 6}});
  std::vector<char> occupied(grid.block_count(), 0);
  occupied[0] = 1;
  grid.rebuild(occupied);
  vadose::AlignedVector<Record> records(grid.size());
  for (std::size_t i = 0; i + Block<3>::cells < records.size(); ++i)
    for (double& v : records[i].value) v = random.in(-1, 1);
  const auto before = records;
  std::vector<Tile<3>> tile(1);
  for (int s = 0; s < grid.slots(); ++s) {
    tile[0].read(grid, s, records);
    vadose::for_cube<3>(-1, Block<3>::edge + 2, [&](const Index<3>& i) {
      Index<3> n;
      for (int d = 0; d < 3; ++d) n[d] = grid.first_cell(s)[d] + i[d];
      const std::int32_t e = grid.entry(n);
      for (int r = 0; r < 8; ++r)
        REQUIRE(tile[0].record[BlockGrid<3>::tile_index(i)][r] ==
                before[static_cast<std::size_t>(e)][r]);
    });
    tile[0].add_to(grid, s, records);
    for (const auto& r : tile[0].record)
      for (const double v : r.value) REQUIRE(v == 0);
    // Every record of the tile has doubled, all others and the one outside are as they were.
    std::vector<char> in_tile(records.size(), 0);
    for (int i = 0; i < Block<3>::tile_size; ++i)
      in_tile[static_cast<std::size_t>(grid.tile(s)[i])] = 1;
    for (std::size_t i = 0; i < records.size(); ++i)
      for (int r = 0; r < 8; ++r) {
        const bool doubles = in_tile[i] && i + Block<3>::cells < records.size();
        REQUIRE(records[i][r] == (doubles ? 2 : 1) * before[i][r]);
      }
    records = before;
  }
}
