// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// What an implicit solution for the motion of the skeleton works on. Empty in other runs.

#include <cstdint>
#include <vector>

#include <vadose/core/sparse_cholesky.hpp>
#include <vadose/core/sparse_rows.hpp>

namespace vadose {

/// A node in the implicit balance of the skeleton. The liquid's velocity is eliminated:
/// v^l = (r_l - P r_l) / m_l + P v^s with P = (m_l I + D)^-1 D and the drag D of a step.
template <int Dim>
struct SkeletonNode {
  static constexpr int corners = 1 << Dim;

  std::int32_t row = -1;        ///< of its velocity in the system, in nodes; -1: no grains
  std::int32_t carried = -1;    ///< first of its entries in GridState::carried; -1: not carried
  std::int32_t carriers = 0;    ///< how many cells carry it
  std::uint8_t held = 0;        ///< bit per axis: velocity is given
  Real inertia[Dim][Dim] = {};  ///< m_s I + m_l P [kg]
  Real impulse[Dim] = {};       ///< r_s + P r_l: momentum before the step and by known forces [N s]
  Real given[Dim] = {};         ///< velocity along held axes [m/s]
  Real unbalanced = 0;          ///< force out of balance before the step [N]
  Real coupling[Dim][Dim] = {};         ///< P [-]
  Real liquid_velocity[Dim] = {};       ///< (r_l - P r_l) / m_l [m/s]
  Real liquid_mobility[Dim][Dim] = {};  ///< dt (I - P) / m_l [m/(s N)]
  /// Impulse per pressure of the cells around [m2 s], and of their balances per velocity [m2 s].
  Real force[corners][Dim] = {}, rate[corners][Dim] = {};
};

/// Everything an implicit solution for the skeleton keeps within a step.
template <int Dim>
struct SkeletonSystem {
  /// Coupling of a row with a lower or equal one.
  struct Entry {
    std::int32_t column;
    Real block[Dim][Dim];
  };

  bool on = false;                       ///< this step solves for the skeleton
  std::vector<SkeletonNode<Dim>> node;   ///< per entry
  std::vector<std::int32_t> entry;       ///< of every row
  std::vector<std::vector<Entry>> rows;  ///< stiffness [N/m], lower triangle, columns ascending
  /// Coefficients of m + dt^2 K in the lower triangle, held rows apart [kg].
  std::vector<Eigen::Triplet<Real>> values;
  bool factored = true;                 ///< wholly; else the system is solved by iteration
  bool solved = true;                   ///< every solution of this step converged
  SparseCholesky solver;                ///< in the plane, and of small systems
  SparseRows matrix;                    ///< the whole matrix of others
  SparseSolver iteration;               ///< and their solution
  std::vector<Real> impulse, velocity;  ///< Dim per row
};

}  // namespace vadose
