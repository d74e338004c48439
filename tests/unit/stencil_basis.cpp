// SPDX-License-Identifier: MIT

// The shape functions as the kernels see them: kernel::Stencil in tiles, with walls.

#include <doctest/doctest.h>

#include "kernel_support.hpp"

namespace {

using namespace kernel_test;
using vadose::Block;
using vadose::BlockGrid;

/// Largest errors over many points.
struct Errors {
  Real unity = 0;      ///< sum N - 1
  Real gradients = 0;  ///< h sum dN/dx
  Real linear = 0;     ///< sum N x_I - x, in cells
  Real slopes = 0;     ///< sum dN/dx x_I - I
  Real value = 0;      ///< against the scalar basis
  Real slope = 0;      ///< against the scalar basis, times h
};

template <int Dim>
Index<Dim> cell_at(const BlockGrid<Dim>& grid, const Vec<Dim>& x) {
  Index<Dim> c;
  for (int d = 0; d < Dim; ++d) c[d] = grid.cell_of(x[d], d);
  return c;
}

/// A coordinate [cells] that is often special: on a node, a face centre, at or near a wall.
Real coordinate(Random& random, int cells, bool upper_wall) {
  const Real top = upper_wall ? cells : cells - 1e-9;
  switch (random.below(7)) {
    case 0:
      return std::min<Real>(random.below(cells + 1), top);
    case 1:
      return random.below(cells) + 0.5;
    case 2:
      return random.in(0, 0.6);
    case 3:
      return cells - random.in(1e-9, 0.6);
    case 4:
      return 0;
    default:
      return random.in(0, top);
  }
}

/// Checks eight points that lie in one block.
template <class Basis, int Dim>
void check_batch(const BlockGrid<Dim>& grid, const std::array<Vec<Dim>, 8>& points,
                 const std::array<Vec<Dim>, 8>& half, Errors& errors) {
  using Shape = typename Basis::policy;
  const int slot = grid.slot(grid.block_number(cell_at(grid, points[0])));
  Lanes x[Dim], l[Dim];
  for (int d = 0; d < Dim; ++d) {
    alignas(64) double place[lane_count], size[lane_count];
    for (int p = 0; p < lane_count; ++p) {
      place[p] = points[static_cast<std::size_t>(p)][d];
      size[p] = half[static_cast<std::size_t>(p)][d];
    }
    x[d] = Lanes::load(place);
    l[d] = Lanes::load(size);
  }
  vadose::kernel::Stencil<Shape, Dim> stencil;
  stencil.evaluate(vadose::kernel::tile_frame(grid, slot), x, l);
  const Real h = grid.cell_size();
  for (int p = 0; p < lane_count; ++p) {
    const auto q = static_cast<std::size_t>(p);
    Real unity = 0, reference_sum = 0;
    Vec<Dim> gradient = Vec<Dim>::Zero(), position = Vec<Dim>::Zero();
    Real jacobian[Dim][Dim] = {};
    int offset = 0;
    vadose::for_cube<Dim>(0, Shape::support, [&](const Index<Dim>& i) {
      Index<Dim> node;
      int at = 0;
      for (int d = Dim - 1; d >= 0; --d) {
        const int first = static_cast<int>(stencil.first[d][p]);
        node[d] = grid.first_cell(slot)[d] - 1 + first + i[d];
        at = at * Block<Dim>::tile_edge + first;
      }
      offset = at;
      const Real w = stencil.product(i, p);
      const auto reference = node_value<Basis, Dim>(grid, node, points[q], half[q]);
      bool beyond = false, kink = false;
      for (int d = 0; d < Dim; ++d) {
        beyond = beyond || node[d] < 0 || node[d] > grid.cells()[d];
        const Real u = (points[q][d] - grid.origin()[d]) / h;
        kink = kink || (!Basis::folds && std::fabs(u - std::round(u)) < 1e-8);
      }
      if (beyond)
        errors.value = std::max(errors.value, std::fabs(w));
      else
        errors.value = std::max(errors.value, std::fabs(w - reference.value));
      reference_sum += beyond ? 0 : reference.value;
      unity += w;
      for (int d = 0; d < Dim; ++d) {
        Real g = stencil.slope[d][i[d]][p];
        for (int e = 0; e < Dim; ++e)
          if (e != d) g *= stencil.weight[e][i[e]][p];
        if (!beyond && !kink)
          errors.slope = std::max(
              errors.slope, h * std::fabs(g - reference.gradient[static_cast<std::size_t>(d)]));
        gradient[d] += g;
        for (int e = 0; e < Dim; ++e) jacobian[e][d] += g * (grid.origin()[e] + node[e] * h);
      }
      for (int d = 0; d < Dim; ++d) position[d] += w * (grid.origin()[d] + node[d] * h);
    });
    CHECK(stencil.offset[p] == offset);
    // Nothing of the function lies outside the stencil.
    errors.unity = std::max(errors.unity, std::fabs(reference_sum - 1));
    errors.unity = std::max(errors.unity, std::fabs(unity - 1));
    for (int d = 0; d < Dim; ++d) {
      errors.gradients = std::max(errors.gradients, h * std::fabs(gradient[d]));
      errors.linear = std::max(errors.linear, std::fabs(position[d] - points[q][d]) / h);
      for (int e = 0; e < Dim; ++e)
        errors.slopes = std::max(errors.slopes, std::fabs(jacobian[e][d] - (d == e ? 1 : 0)));
    }
  }
}

template <class Basis, int Dim>
Errors check_basis(const Index<Dim>& cells, unsigned seed, int batches) {
  Random random(seed);
  Vec<Dim> origin;
  for (int d = 0; d < Dim; ++d) origin[d] = 0.7 - 1.3 * d;
  const Real h = 0.125;  // a power of two: nodes are hit exactly
  const BlockGrid<Dim> grid = full_grid<Dim>(origin, h, cells);
  Errors errors;
  for (int b = 0; b < batches; ++b) {
    std::array<Vec<Dim>, 8> points, half;
    Index<Dim> low, high;  // the block of the first point
    for (std::size_t p = 0; p < 8; ++p) {
      for (int d = 0; d < Dim; ++d) {
        Real u = coordinate(random, cells[d], Basis::folds);
        if (p == 0) {
          const int block =
              grid.cell_of(origin[d] + u * h, d) / Block<Dim>::edge * Block<Dim>::edge;
          low[d] = block;
          high[d] = std::min(block + Block<Dim>::edge, cells[d]);
        } else if (u < low[d] - 0.49 || u > high[d] + 0.49) {
          // Points may stray almost half a cell from the block they were sorted into.
          u = random.in(std::max(0.0, low[d] - 0.49), std::min<Real>(cells[d], high[d] + 0.49));
        }
        points[p][d] = origin[d] + u * h;
        const int kind = random.below(4);
        half[p][d] = h * (kind == 0   ? 0.5
                          : kind == 1 ? 0.25
                          : kind == 2 ? 1e-3
                                      : random.in(.01, .5));
      }
    }
    check_batch<Basis, Dim>(grid, points, half, errors);
  }
  return errors;
}

template <class Basis>
Errors check_all_dimensions() {
  Errors all;
  const auto join = [&](const Errors& e) {
    all.unity = std::max(all.unity, e.unity);
    all.gradients = std::max(all.gradients, e.gradients);
    all.linear = std::max(all.linear, e.linear);
    all.slopes = std::max(all.slopes, e.slopes);
    all.value = std::max(all.value, e.value);
    all.slope = std::max(all.slope, e.slope);
  };
  for (const int n : {1, 2, 3, 70}) join(check_basis<Basis, 1>({{n}}, 11, 300));
  join(check_basis<Basis, 2>({{13, 9}}, 12, 500));
  join(check_basis<Basis, 2>({{1, 3}}, 13, 100));
  join(check_basis<Basis, 3>({{6, 5, 9}}, 14, 400));
  return all;
}

template <class Basis>
void check_twins(unsigned seed) {
  using Shape = typename Basis::policy;
  Random random(seed);
  for (int k = 0; k < 2000; ++k) {
    Lanes u, half;
    for (int p = 0; p < lane_count; ++p) {
      u.set(p, random.below(3) == 0 ? 0.5 * random.below(20) : random.in(0, 10));
      half.set(p, random.below(3) == 0 ? 0.5 : random.in(1e-3, 0.5));
    }
    Lanes w[Shape::support], g[Shape::support];
    const Lanes first = Shape::weights(u, half, w, g);
    for (int p = 0; p < lane_count; ++p) {
      Real ws[Shape::support], gs[Shape::support];
      const Real one = Shape::template weights<Real>(u[p], half[p], ws, gs);
      REQUIRE(first[p] == one);
      for (int i = 0; i < Shape::support; ++i) {
        CHECK(w[i][p] == doctest::Approx(ws[i]).epsilon(1e-14).scale(1));
        CHECK(g[i][p] == doctest::Approx(gs[i]).epsilon(1e-14).scale(1));
      }
    }
  }
}

}  // namespace

TEST_CASE_TEMPLATE("bases add up to one and reproduce linear fields", Basis, ScalarLinear,
                   ScalarGimp, ScalarSpline) {
  const Errors e = check_all_dimensions<Basis>();
  CHECK(e.unity < 1e-12);
  CHECK(e.gradients < 1e-11);
  CHECK(e.linear < 1e-12);
  CHECK(e.slopes < 1e-10);
}

TEST_CASE_TEMPLATE("stencils equal the scalar basis at every node", Basis, ScalarLinear, ScalarGimp,
                   ScalarSpline) {
  const Errors e = check_all_dimensions<Basis>();
  CHECK(e.value < 1e-12);
  CHECK(e.slope < 1e-10);
}

TEST_CASE_TEMPLATE("lanes and single numbers give the same basis", Basis, ScalarLinear, ScalarGimp,
                   ScalarSpline) {
  check_twins<Basis>(21);
}

TEST_CASE("GIMP is the mean of the hat function over the point's domain") {
  Random random(31);
  Real worst = 0, worst_slope = 0;
  for (int k = 0; k < 5000; ++k) {
    const Real u = random.in(0, 4), half = k % 5 == 0 ? 0.5 : random.in(1e-3, 0.5);
    Real w[3], g[3];
    const Real first = vadose::shape::Gimp::weights<Real>(u, half, w, g);
    for (int i = -1; i < 6; ++i) {
      const int at = i - static_cast<int>(first);
      const Real value = at >= 0 && at < 3 ? w[at] : 0;
      const Real slope = at >= 0 && at < 3 ? g[at] : 0;
      worst = std::max(worst, std::fabs(value - mean_hat_by_quadrature(u - i, half)));
      // The slope is the difference of the hat function across the domain.
      const Real exact = (hat(u + half - i) - hat(u - half - i)) / (2 * half);
      worst_slope = std::max(worst_slope, std::fabs(slope - exact));
    }
  }
  CHECK(worst < 1e-10);
  CHECK(worst_slope < 1e-10);
}

TEST_CASE("a quadratic B-spline is the hat function averaged over one cell") {
  Random random(32);
  Real worst = 0;
  for (int k = 0; k < 2000; ++k) {
    const Real u = random.in(0, 4);
    Real w[3], g[3];
    const Real first = vadose::shape::QuadraticBSpline::weights<Real>(u, 0.0, w, g);
    for (int i = 0; i < 3; ++i) {
      worst = std::max(worst, std::fabs(w[i] - mean_hat_by_quadrature(u - first - i, 0.5)));
      const Real d = 1e-6;
      Real low[3], high[3], unused[3];
      const Real a = vadose::shape::QuadraticBSpline::weights<Real>(u - d, 0.0, low, unused);
      const Real b = vadose::shape::QuadraticBSpline::weights<Real>(u + d, 0.0, high, unused);
      if (a == first && b == first)
        CHECK(g[i] == doctest::Approx((high[i] - low[i]) / (2 * d)).epsilon(1e-7).scale(1));
    }
  }
  CHECK(worst < 1e-14);
}

TEST_CASE("a node on a wall interpolates: its basis is one there and no other reaches it") {
  const BlockGrid<2> grid = full_grid<2>({0, 0}, 0.5, {{5, 5}});
  const Vec<2> corner{0, 0}, top{1.25, 2.5};
  const Vec<2> half{0.1, 0.2};
  CHECK(node_value<ScalarSpline, 2>(grid, {{0, 0}}, corner, half).value ==
        doctest::Approx(1).epsilon(1e-14));
  Errors errors;
  std::array<Vec<2>, 8> points, sizes;
  points.fill(top);
  sizes.fill(half);
  check_batch<ScalarSpline, 2>(grid, points, sizes, errors);
  check_batch<ScalarGimp, 2>(grid, points, sizes, errors);
  CHECK(errors.value < 1e-13);
  CHECK(errors.slopes < 1e-12);
}

TEST_CASE("a wild or NaN position never leaves the tile") {
  const BlockGrid<3> grid = full_grid<3>({0, 0, 0}, 1.0, {{8, 8, 8}});
  const auto frame = vadose::kernel::tile_frame(grid, 0);
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  for (const Real wild : {-1e30, 1e30, nan, -5.0, 17.0}) {
    const Lanes x[3] = {Lanes(wild), Lanes(1.0), Lanes(wild)};
    const Lanes half[3] = {Lanes(0.25), Lanes(0.25), Lanes(0.25)};
    vadose::kernel::Stencil<vadose::shape::Gimp, 3> stencil;
    stencil.evaluate(frame, x, half);
    vadose::kernel::Stencil<vadose::shape::Linear, 3> linear;
    linear.evaluate(frame, x, half);
    const int last = Block<3>::tile_size - 1;
    const int reach = 1 + Block<3>::tile_edge + Block<3>::tile_edge * Block<3>::tile_edge;
    for (int p = 0; p < lane_count; ++p) {
      CHECK(stencil.offset[p] >= 0);
      CHECK(stencil.offset[p] + 2 * reach <= last);
      CHECK(linear.offset[p] >= 0);
      CHECK(linear.offset[p] + reach <= last);
    }
  }
}
