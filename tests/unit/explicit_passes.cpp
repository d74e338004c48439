// SPDX-License-Identifier: MIT

// What passes of an explicit step leave behind, against the same done the slow way: nodes one by one, the
// water of every cell at its pressure.

#include <doctest/doctest.h>

#include <bit>
#include <functional>
#include <optional>

#include <vadose/policy/drag/forchheimer.hpp>

#include "kernel_support.hpp"

namespace {

using namespace kernel_test;
namespace kernel = vadose::kernel;
using vadose::Block;
using vadose::BlockGrid;
using vadose::scheme::Pass;

/// Unsaturated soil with a drag that is not linear.
template <class K>
struct Coarse : vadose::UnsaturatedModel<K> {
  using Drag = vadose::drag::Forchheimer;
};

/// The explicit scheme; shows its state after each pass.
struct Shown {
  template <class M>
  static inline std::function<void(vadose::State<M>&, Pass)> watch;

  template <class M>
  static kernel::StableStep step(vadose::State<M>& state, Real dt_limit) {
    return vadose::scheme::Explicit::watched(state, dt_limit,
                                             [&](Pass pass) { watch<M>(state, pass); });
  }
};

/// A block of two soils with a wall on its left and a free surface, under its own weight.
template <class M>
vadose::Scene<M> two_soils() {
  constexpr int dim = M::Kinematics::dim;
  const Real h = 0.1, size = dim == 2 ? 1.5 : 0.9;
  Vec<dim> high, middle, low = Vec<dim>::Zero(), top;
  for (int d = 0; d < dim; ++d) {
    high[d] = size;
    top[d] = size + (d == 0 || d == dim - 1 ? 4 * h : 0);
  }
  middle = high;
  middle[dim - 1] = 0.6;
  vadose::Scene<M> scene({.box = {low, top}, .cell_size = h});
  scene.gravity[dim - 1] = -9.81;
  vadose::SoilOptions<dim> options{.jitter = 0.2 * h, .suction = 8e3};
  auto below = soil<M>(), above = soil<M>();
  above.porosity = 0.45;
  scene.add_soil(vadose::box<dim>(low, middle), below, options);
  low[dim - 1] = 0.6;
  options.suction = 6e3;
  scene.add_soil(vadose::box<dim>(low, high), above, options);
  scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
  return scene;
}

/// Largest difference of two arrays of records over the largest number in the same lane.
Real largest_difference(const vadose::AlignedVector<vadose::Record>& a,
                        const vadose::AlignedVector<vadose::Record>& b) {
  Real size[lane_count] = {}, difference[lane_count] = {}, most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int l = 0; l < lane_count; ++l) {
      size[l] = std::max(size[l], std::fabs(b[i][l]));
      difference[l] = std::max(difference[l], std::fabs(a[i][l] - b[i][l]));
    }
  for (int l = 0; l < lane_count; ++l)
    if (size[l] > 0) most = std::max(most, difference[l] / size[l]);
  return most;
}

/// Advances all nodes one by one; returns how many could have been advanced together with others.
template <class M>
int advance_one_by_one(vadose::State<M>& state) {
  constexpr int dim = vadose::State<M>::dim;
  int together = 0;
  state.nodes.open_impulse.assign(static_cast<std::size_t>(state.grid.slots() * dim), 0);
  for (int slot = 0; slot < state.grid.slots(); ++slot) {
    const kernel::CellParts<M> parts(state, slot, 0);
    for (int first = 0; first < Block<dim>::cells; first += lane_count) {
      kernel::SumsAround<dim> around[lane_count];
      for (int l = 0; l < lane_count; ++l) {
        const int at = BlockGrid<dim>::tile_index(BlockGrid<dim>::local_at(first + l));
        around[l] = kernel::SumsAround<dim>(parts, at, 1 / state.grid.cell_size());
      }
      together += std::popcount(kernel::advance_inner_nodes(state, slot, first, around));
    }
  }
  state.nodes.open_impulse.assign(static_cast<std::size_t>(state.grid.slots() * dim), 0);
  for (int slot = 0; slot < state.grid.slots(); ++slot) {
    const kernel::CellParts<M> parts(state, slot, 0);
    for (int i = 0; i < Block<dim>::cells; ++i) {
      const auto local = BlockGrid<dim>::local_at(i);
      const kernel::SumsAround<dim> around(parts, BlockGrid<dim>::tile_index(local),
                                           1 / state.grid.cell_size());
      kernel::advance_node<false>(state, kernel::CellView<M>(state, local, slot), around);
    }
  }
  return together;
}

template <class M>
void check_nodes(Real damping) {
  Real worst = 0;
  int together = 0;
  std::optional<vadose::State<M>> one_by_one;
  Shown::watch<M> = [&](vadose::State<M>& state, Pass pass) {
    if (pass == Pass::solid_to_nodes) {
      one_by_one.emplace(state);
      together = advance_one_by_one(*one_by_one);
    }
    if (pass != Pass::nodes) return;
    const auto &a = state.nodes, &b = one_by_one->nodes;
    for (const auto records : {&vadose::GridState<vadose::State<M>::dim>::solid_out,
                               &vadose::GridState<vadose::State<M>::dim>::liquid_out,
                               &vadose::GridState<vadose::State<M>::dim>::mixture,
                               &vadose::GridState<vadose::State<M>::dim>::relative})
      worst = std::max(worst, largest_difference(a.*records, b.*records));
  };
  vadose::Solver<M, Shown> solver(two_soils<M>(), {.damping = damping});
  for (int i = 0; i < 12; ++i) REQUIRE(solver.step().status == vadose::Status::ok);
  CHECK(together > 60);
  CHECK(worst < 1e-11);
  Shown::watch<M> = nullptr;
}

}  // namespace

TEST_CASE("nodes inside the soil, eight together, move as they do one by one") {
  check_nodes<Coarse<vadose::PlaneStrain>>(0);
  check_nodes<Coarse<vadose::PlaneStrain>>(0.3);
  check_nodes<Coarse<vadose::ThreeDimensional>>(0.3);
}

TEST_CASE("at the pressure that is found a cell holds its water") {
  using M = Coarse<vadose::PlaneStrain>;
  Real worst = 0;
  int cells = 0;
  Shown::watch<M> = [&](vadose::State<M>& state, Pass pass) {
    if (pass != Pass::pressures) return;
    vadose::State<M> check = state;
    kernel::clear(check.nodes.content, 1);
    std::fill(check.nodes.retry.begin(), check.nodes.retry.end(), char{1});
    kernel::find_heads(check, check.nodes.retry);
    kernel::sum_content(check);
    kernel::for_pressure_cells(check, [&](auto& cell, std::int32_t e, int) {
      const auto sums = kernel::member_sums(kernel::view_of(check, e), check.nodes.content);
      const Real excess = sums[vadose::lane::content] - cell.water / check.water.density;
      worst = std::max(worst, std::fabs(excess) / cell.pore_volume);
      ++cells;
    });
  };
  vadose::Solver<M, Shown> solver(two_soils<M>(), {.damping = 0});
  for (int i = 0; i < 200; ++i) REQUIRE(solver.step().status == vadose::Status::ok);
  CHECK(cells > 200 * 200);
  CHECK(worst < 1e-12);
  Shown::watch<M> = nullptr;
}
