// SPDX-License-Identifier: MIT
#pragma once

// Helpers of the verification and stability tests: reference tables, norms over cells, closed forms.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <vadose/solver/solver.hpp>

#include "../reference_table.hpp"

namespace verify {

using vadose::Real;
using vadose::Vec;

using vadose_test::Table;

/// Root mean square, largest absolute value and mean of what is added.
struct Norm {
  Real squares = 0, sum = 0, max = 0;
  int count = 0;

  void add(Real error) {
    squares += error * error;
    sum += error;
    // A NaN must not vanish in max().
    max = std::isnan(error) || std::isnan(max) ? vadose::unset : std::max(max, std::fabs(error));
    ++count;
  }
  Real rms() const { return count > 0 ? std::sqrt(squares / count) : vadose::unset; }
  Real mean() const { return count > 0 ? sum / count : vadose::unset; }
};

/// |value / reference - 1| <= tolerance, purely relative (doctest::Approx adds an absolute part).
inline bool close(Real value, Real reference, Real tolerance) {
  return std::fabs(value - reference) <= tolerance * std::fabs(reference);
}

/// Value at x of a curve of (x, y) sorted by x, linear between its points and beyond them.
inline Real linear(const std::vector<std::pair<Real, Real>>& curve, Real x) {
  std::size_t i = 1;
  while (i + 1 < curve.size() && curve[i].first < x) ++i;
  const auto [xa, ya] = curve.at(i - 1);
  const auto [xb, yb] = curve.at(i);
  return ya + (x - xa) / (xb - xa) * (yb - ya);
}

/// Calls f(cell) for every cell of a kind that owns its pressure, as of the start of the last step.
template <class Solver, class F>
void for_cells(const Solver& solver, vadose::CellKind kind, F&& f) {
  const auto& nodes = solver.state().nodes;
  for (std::size_t i = 0; i < nodes.cell.size(); ++i)
    if (nodes.dof[i] == static_cast<std::int32_t>(i) && nodes.cell[i].kind == kind)
      f(nodes.cell[i]);
}

/// Largest speed of a set of points [m/s].
template <class Points>
Real largest_speed(const Points& points) {
  constexpr int dim = Points::fields::template components<vadose::field::Velocity>();
  Norm norm;
  points.for_each([&](std::size_t b, int l) {
    Real v2 = 0;
    for (int d = 0; d < dim; ++d) {
      const Real v = points.at(vadose::field::velocity, b, d)[l];
      v2 += v * v;
    }
    norm.add(std::sqrt(v2));
  });
  return norm.max;
}

/// Gives the skeleton of a solver a uniform vertical Bishop stress, the horizontal ones by a ratio [Pa].
template <class Solver>
void set_vertical_stress(Solver& solver, Real stress, Real lateral_ratio) {
  constexpr int up = Solver::dim - 1;
  constexpr int normal_components = 3;
  auto& solid = solver.mutable_state().solid;
  solid.for_each([&](std::size_t b, int l) {
    for (int i = 0; i < normal_components; ++i)
      solid.at(vadose::field::bishop_stress, b, i)[l] = i == up ? stress : lateral_ratio * stress;
  });
}

/// E (1 - nu) / ((1 + nu) (1 - 2 nu)) [Pa].
inline Real oedometric_modulus(Real young_modulus, Real poisson_ratio) {
  return young_modulus * (1 - poisson_ratio) / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
}

/// Terzaghi's p / p0, mean over depth / H in [a, b] (0: drained top, 1: closed base):
/// sum 2/M sin(M Z) exp(-M^2 T), M = (2 k + 1) pi / 2.
inline Real terzaghi_mean(Real a, Real b, Real time_factor) {
  Real sum = 0;
  for (int k = 0; k < 400; ++k) {
    const Real m = (2 * k + 1) * std::numbers::pi / 2;
    sum += 2 / (m * m) * (std::cos(m * a) - std::cos(m * b)) * std::exp(-m * m * time_factor);
  }
  return sum / (b - a);
}

/// [Zhan] Table 1.
namespace table1 {
inline constexpr Real young_modulus = 10e6, poisson_ratio = 0.33, porosity = 0.4;
inline constexpr Real solid_density = 2600, liquid_density = 1000, bulk_modulus = 2.2e9;
inline constexpr Real conductivity = 9.8e-4, a = 12, lambda = 0.09;
}  // namespace table1

/// Table 1 soil of a saturated model with linear elasticity.
template <class M>
vadose::Material<M> saturated_soil(Real conductivity = table1::conductivity) {
  return {
      .solid_density = table1::solid_density,
      .porosity = table1::porosity,
      .skeleton = {.young_modulus = table1::young_modulus, .poisson_ratio = table1::poisson_ratio},
      .conductivity = {.saturated_conductivity = conductivity}};
}

/// Table 1 clay of an unsaturated model with linear elasticity.
template <class M>
vadose::Material<M> clay(Real young_modulus = table1::young_modulus, bool porosity_dependent = true,
                         Real conductivity = table1::conductivity) {
  return {.name = "clay",
          .solid_density = table1::solid_density,
          .porosity = table1::porosity,
          .lambda = table1::lambda,
          .skeleton = {.young_modulus = young_modulus, .poisson_ratio = table1::poisson_ratio},
          .retention = {.a = table1::a, .porosity_dependent = porosity_dependent},
          .conductivity = {.saturated_conductivity = conductivity,
                           .porosity_dependent = porosity_dependent}};
}

}  // namespace verify
