// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Symmetric positive definite sparse systems by Eigen's Cholesky factorisation.

#include <utility>
#include <vector>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include <vadose/core/real.hpp>

namespace vadose {

/// Factors a symmetric matrix given by its lower triangle. The order of elimination is kept while the
/// pattern stays. A copy starts anew: nothing but time depends on what is kept.
class SparseCholesky {
 public:
  using Matrix = Eigen::SparseMatrix<Real>;  ///< compressed columns

  SparseCholesky() = default;
  /// Has factored nothing yet.
  SparseCholesky(const SparseCholesky&) noexcept {}
  /// The same.
  SparseCholesky& operator=(const SparseCholesky&) noexcept {
    columns_.clear();
    return *this;
  }
  ~SparseCholesky() = default;

  /// Takes a matrix into work; false: it is not positive definite.
  bool factor(const Matrix& lower) {
    if (!keeps_pattern(lower)) cholesky_.analyzePattern(lower);
    cholesky_.factorize(lower);
    return cholesky_.info() == Eigen::Success;
  }
  /// x = A^-1 b.
  void solve(const std::vector<Real>& b, std::vector<Real>& x) const {
    using Vector = Eigen::Matrix<Real, -1, 1>;
    const auto rows = static_cast<Eigen::Index>(b.size());
    x.resize(b.size());
    Eigen::Map<Vector>(x.data(), rows) = cholesky_.solve(Eigen::Map<const Vector>(b.data(), rows));
  }

 private:
  bool keeps_pattern(const Matrix& a) {
    std::vector<int> columns(a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1);
    std::vector<int> rows(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros());
    const bool same = columns == columns_ && rows == rows_;
    columns_ = std::move(columns);
    rows_ = std::move(rows);
    return same;
  }

  Eigen::SimplicialLDLT<Matrix> cholesky_;
  std::vector<int> columns_, rows_;
};

}  // namespace vadose
