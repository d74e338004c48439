// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Sparse matrix in compressed rows with a pattern that is kept while values change, and its solution
/// by BiCGSTAB with an incomplete LU factorisation. Sums run over fixed chunks of rows, so that
/// results are bitwise equal for any number of threads.

#include <algorithm>
#include <cmath>
#include <vector>

#include <vadose/core/parallel.hpp>
#include <vadose/core/real.hpp>

namespace vadose {

/// Square sparse matrix.
class SparseRows {
 public:
  /// Takes the sorted columns of every row as its pattern; every row holds its diagonal.
  void set_pattern(const std::vector<std::vector<int>>& columns) {
    start_.assign(1, 0);
    column_.clear();
    diagonal_.clear();
    for (std::size_t row = 0; row < columns.size(); ++row) {
      for (const int c : columns[row]) {
        if (c == static_cast<int>(row)) diagonal_.push_back(static_cast<int>(column_.size()));
        column_.push_back(c);
      }
      start_.push_back(static_cast<int>(column_.size()));
    }
    value_.assign(column_.size(), 0);
  }
  int rows() const noexcept { return static_cast<int>(diagonal_.size()); }  ///< number of rows
  /// Number of the first entry of a row, and of the one behind its last.
  int begin(int row) const noexcept { return start_[static_cast<std::size_t>(row)]; }
  /// See begin().
  int end(int row) const noexcept { return start_[static_cast<std::size_t>(row) + 1]; }
  /// Number of the entry on the diagonal.
  int diagonal(int row) const noexcept { return diagonal_[static_cast<std::size_t>(row)]; }
  /// Column of an entry.
  int column(int at) const noexcept { return column_[static_cast<std::size_t>(at)]; }
  /// Value of an entry.
  Real value(int at) const noexcept { return value_[static_cast<std::size_t>(at)]; }
  /// Sets a row to zero.
  void clear(int row) noexcept {
    for (int at = begin(row); at < end(row); ++at) value_[static_cast<std::size_t>(at)] = 0;
  }
  /// Adds to an entry of the pattern.
  void add(int row, int column, Real value) noexcept {
    for (int at = begin(row); at < end(row); ++at)
      if (this->column(at) == column) {
        value_[static_cast<std::size_t>(at)] += value;
        return;
      }
  }

 private:
  std::vector<int> start_, column_, diagonal_;
  std::vector<Real> value_;
};

/// Incomplete LU factorisation without fill, chunk by chunk of rows: exact for a tridiagonal matrix
/// of one chunk.
class IncompleteLu {
 public:
  static constexpr int chunk = 2048;  ///< rows factored together

  /// Number of chunks.
  static std::size_t chunks(int rows) noexcept {
    return static_cast<std::size_t>((rows + chunk - 1) / chunk);
  }

  /// Factors a matrix.
  void factor(const SparseRows& a, int threads) {
    value_.resize(static_cast<std::size_t>(a.rows() > 0 ? a.end(a.rows() - 1) : 0));
    place_.assign(static_cast<std::size_t>(a.rows()), -1);
    parallel_for(chunks(a.rows()), threads, [&](std::size_t c, int) {
      const int first = static_cast<int>(c) * chunk;
      const int last = std::min(a.rows(), first + chunk);
      for (int row = first; row < last; ++row) factor_row(a, row, first, last);
    });
  }
  /// z = (LU)^-1 r.
  void solve(const SparseRows& a, const std::vector<Real>& r, std::vector<Real>& z,
             int threads) const {
    parallel_for(chunks(a.rows()), threads, [&](std::size_t c, int) {
      const int first = static_cast<int>(c) * chunk;
      const int last = std::min(a.rows(), first + chunk);
      for (int row = first; row < last; ++row) {
        Real sum = r[static_cast<std::size_t>(row)];
        for (int at = a.begin(row); at < a.diagonal(row); ++at)
          if (a.column(at) >= first) sum -= u(at) * z[static_cast<std::size_t>(a.column(at))];
        z[static_cast<std::size_t>(row)] = sum;
      }
      for (int row = last - 1; row >= first; --row) {
        Real sum = z[static_cast<std::size_t>(row)];
        for (int at = a.diagonal(row) + 1; at < a.end(row); ++at)
          if (a.column(at) < last) sum -= u(at) * z[static_cast<std::size_t>(a.column(at))];
        z[static_cast<std::size_t>(row)] = sum / u(a.diagonal(row));
      }
    });
  }

 private:
  Real u(int at) const noexcept { return value_[static_cast<std::size_t>(at)]; }

  void factor_row(const SparseRows& a, int row, int first, int last) {
    const auto inside = [&](int at) { return a.column(at) >= first && a.column(at) < last; };
    for (int at = a.begin(row); at < a.end(row); ++at) {
      value_[static_cast<std::size_t>(at)] = a.value(at);
      if (inside(at)) place_[static_cast<std::size_t>(a.column(at))] = at;
    }
    for (int at = a.begin(row); at < a.diagonal(row); ++at) {
      if (!inside(at)) continue;
      const int k = a.column(at);
      const Real factor = u(at) / u(a.diagonal(k));
      value_[static_cast<std::size_t>(at)] = factor;
      for (int from = a.diagonal(k) + 1; from < a.end(k); ++from) {
        if (!inside(from)) continue;
        const int to = place_[static_cast<std::size_t>(a.column(from))];
        if (to >= 0) value_[static_cast<std::size_t>(to)] -= factor * u(from);
      }
    }
    for (int at = a.begin(row); at < a.end(row); ++at)
      if (inside(at)) place_[static_cast<std::size_t>(a.column(at))] = -1;
    // A pivot that all but cancelled would spoil everything after it.
    const Real own = a.value(a.diagonal(row));
    Real& pivot = value_[static_cast<std::size_t>(a.diagonal(row))];
    if (!(std::fabs(pivot) > 1e-10 * std::fabs(own))) pivot = own != 0 ? own : 1;
  }

  std::vector<Real> value_;
  std::vector<int> place_;
};

/// Solves A x = b by BiCGSTAB; keeps its vectors.
class SparseSolver {
 public:
  /// What a solution took.
  struct Outcome {
    int iterations = 0;  ///< taken
    Real residual = 0;   ///< |b - A x| / |b| as the iteration has it [-]; NaN: it broke down
  };

  /// x = A^-1 b to |b - A x| <= tolerance |b|.
  Outcome solve(const SparseRows& a, const std::vector<Real>& b, std::vector<Real>& x,
                Real tolerance, int max_iterations, int threads) {
    factor(a, threads);
    return solve_factored(a, b, x, tolerance, max_iterations, threads);
  }
  /// The same for another matrix, given by `multiply(y, product)`, close enough to `a` that its
  /// factorisation serves.
  template <class Multiply>
  Outcome solve(const SparseRows& a, const std::vector<Real>& b, std::vector<Real>& x,
                Real tolerance, int max_iterations, int threads, Multiply&& product_of) {
    factor(a, threads);
    return iterate(a, b, x, tolerance, max_iterations, threads, product_of);
  }
  /// Factors a matrix for solve_factored().
  void factor(const SparseRows& a, int threads) { lu_.factor(a, threads); }
  /// solve() of the matrix that was factored last.
  Outcome solve_factored(const SparseRows& a, const std::vector<Real>& b, std::vector<Real>& x,
                         Real tolerance, int max_iterations, int threads) {
    return iterate(a, b, x, tolerance, max_iterations, threads,
                   [&](const std::vector<Real>& y, std::vector<Real>& product) {
                     multiply(a, y, product, threads);
                   });
  }

  /// y = A x.
  static void multiply(const SparseRows& a, const std::vector<Real>& x, std::vector<Real>& y,
                       int threads) {
    each(static_cast<std::size_t>(a.rows()), threads, [&](std::size_t i) {
      const int row = static_cast<int>(i);
      Real sum = 0;
      for (int at = a.begin(row); at < a.end(row); ++at)
        sum += a.value(at) * x[static_cast<std::size_t>(a.column(at))];
      y[i] = sum;
    });
  }

 private:
  template <class Multiply>
  Outcome iterate(const SparseRows& a, const std::vector<Real>& b, std::vector<Real>& x,
                  Real tolerance, int max_iterations, int threads, Multiply&& product_of) {
    const auto n = static_cast<std::size_t>(a.rows());
    for (auto* v : {&p_, &v_, &y_, &z_, &t_}) v->assign(n, 0);
    x.assign(n, 0);
    r_ = b;
    shadow_ = b;
    const Real scale = std::sqrt(dot(b, b, threads));
    if (!(scale > 0)) return {};
    Real rho = 1, alpha = 1, omega = 1, shadow = scale;
    Outcome out{0, 1};
    while (out.iterations < max_iterations) {
      ++out.iterations;
      Real next = dot(shadow_, r_, threads);
      const Real left = out.residual * scale;
      if (std::fabs(next) < 1e-12 * shadow * left) {  // all but orthogonal: start anew from here
        shadow_ = r_;
        shadow = left;
        next = left * left;
        rho = alpha = omega = 1;
        for (auto* v : {&p_, &v_}) v->assign(n, 0);
      }
      const Real beta = next / rho * (alpha / omega);
      rho = next;
      each(n, threads, [&](std::size_t i) { p_[i] = r_[i] + beta * (p_[i] - omega * v_[i]); });
      lu_.solve(a, p_, y_, threads);
      product_of(y_, v_);
      alpha = rho / dot(shadow_, v_, threads);
      each(n, threads, [&](std::size_t i) {
        r_[i] -= alpha * v_[i];
        x[i] += alpha * y_[i];
      });
      out.residual = std::sqrt(dot(r_, r_, threads)) / scale;
      if (!(out.residual > tolerance)) break;
      lu_.solve(a, r_, z_, threads);
      product_of(z_, t_);
      omega = dot(t_, r_, threads) / dot(t_, t_, threads);
      each(n, threads, [&](std::size_t i) {
        x[i] += omega * z_[i];
        r_[i] -= omega * t_[i];
      });
      out.residual = std::sqrt(dot(r_, r_, threads)) / scale;
      if (!(out.residual > tolerance)) break;
    }
    return out;
  }

  template <class F>
  static void each(std::size_t n, int threads, F&& f) {
    constexpr std::size_t chunk = IncompleteLu::chunk;
    parallel_for((n + chunk - 1) / chunk, threads, [&](std::size_t c, int) {
      for (std::size_t i = c * chunk; i < std::min(n, (c + 1) * chunk); ++i) f(i);
    });
  }
  Real dot(const std::vector<Real>& a, const std::vector<Real>& b, int threads) {
    constexpr std::size_t chunk = IncompleteLu::chunk;
    const std::size_t n = a.size();
    parts_.assign((n + chunk - 1) / chunk, 0);
    parallel_for(parts_.size(), threads, [&](std::size_t c, int) {
      Real sum = 0;
      for (std::size_t i = c * chunk; i < std::min(n, (c + 1) * chunk); ++i) sum += a[i] * b[i];
      parts_[c] = sum;
    });
    Real sum = 0;
    for (const Real part : parts_) sum += part;
    return sum;
  }
  IncompleteLu lu_;
  std::vector<Real> r_, shadow_, p_, v_, y_, z_, t_, parts_;
};

}  // namespace vadose
