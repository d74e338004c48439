// SPDX-License-Identifier: MIT
// Sparse rows and their solution against dense elimination and closed forms.

#include <doctest/doctest.h>

#include <random>
#include <vadose/core/sparse_rows.hpp>

namespace {

using vadose::Real;

/// Five-point matrix of an n x n grid with upwinding, unsymmetric.
vadose::SparseRows five_points(int n, Real drift) {
  std::vector<std::vector<int>> columns;
  for (int i = 0; i < n * n; ++i) {
    std::vector<int> row;
    if (i >= n) row.push_back(i - n);
    if (i % n > 0) row.push_back(i - 1);
    row.push_back(i);
    if (i % n + 1 < n) row.push_back(i + 1);
    if (i + n < n * n) row.push_back(i + n);
    columns.push_back(row);
  }
  vadose::SparseRows a;
  a.set_pattern(columns);
  for (int i = 0; i < n * n; ++i)
    for (int at = a.begin(i); at < a.end(i); ++at)
      a.add(i, a.column(at),
            a.column(at) == i  ? 4.01 + 2 * drift
            : a.column(at) < i ? -1 - drift
                               : -1);
  return a;
}

Real largest_error(const vadose::SparseRows& a, int threads, int& iterations) {
  std::mt19937 random(3);
  std::uniform_real_distribution<Real> number(-1, 1);
  std::vector<Real> exact(static_cast<std::size_t>(a.rows())), b(exact.size(), 0), x;
  for (Real& e : exact) e = number(random);
  for (int row = 0; row < a.rows(); ++row)
    for (int at = a.begin(row); at < a.end(row); ++at)
      b[static_cast<std::size_t>(row)] +=
          a.value(at) * exact[static_cast<std::size_t>(a.column(at))];
  vadose::SparseSolver solver;
  const auto outcome = solver.solve(a, b, x, 1e-12, 1000, threads);
  iterations = outcome.iterations;
  Real worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Real error = std::fabs(x[i] - exact[i]);
    if (std::isnan(error)) return error;  // would vanish in max()
    worst = std::max(worst, error);
  }
  return worst;
}

}  // namespace

TEST_CASE("sparse solver: a tridiagonal matrix takes one iteration") {
  std::vector<std::vector<int>> columns;
  for (int i = 0; i < 100; ++i) {
    columns.push_back({});
    for (int j = std::max(0, i - 1); j <= std::min(99, i + 1); ++j) columns.back().push_back(j);
  }
  vadose::SparseRows a;
  a.set_pattern(columns);
  for (int i = 0; i < 100; ++i)
    for (int at = a.begin(i); at < a.end(i); ++at)
      a.add(i, a.column(at), a.column(at) == i ? 2.001 : a.column(at) < i ? -1.3 : -0.7);
  int iterations = 0;
  CHECK(largest_error(a, 1, iterations) <= 1e-10);
  CHECK(iterations == 1);
}

TEST_CASE("sparse solver: unsymmetric grids of one and of several chunks of rows") {
  for (const int n : {20, 80}) {
    int one = 0, three = 0;
    const auto a = five_points(n, 0.3);
    const Real error = largest_error(a, 1, one);
    CHECK(error <= 1e-9);
    CHECK(largest_error(a, 3, three) == error);
    CHECK(one == three);
    CHECK(one < 100);
  }
}
