// SPDX-License-Identifier: MIT
#pragma once

// Helpers of the tests of grid, points, kernels and solver: plain scalar versions of what the
// library does in lanes, totals of a run, and small scenes.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include <vadose/policy/law/drucker_prager.hpp>
#include <vadose/policy/law/newtonian_fluid.hpp>
#include <vadose/policy/shape/gimp.hpp>
#include <vadose/policy/shape/linear.hpp>
#include <vadose/policy/shape/quadratic_b_spline.hpp>
#include <vadose/solver/solver.hpp>

#include "../changed_model.hpp"

namespace kernel_test {

using vadose::Index;
using vadose::lane_count;
using vadose::Lanes;
using vadose::Real;
using vadose::Vec;

// ---------------------------------------------------------------------------------------------
// Shape functions, one point and one axis at a time, from their definitions.

/// Hat function of a node at distance 0, u in cells.
inline Real hat(Real u) {
  return std::max(0.0, 1 - std::fabs(u));
}

/// Integral of the hat function from -1 to u.
inline Real hat_integral(Real u) {
  if (u <= -1) return 0;
  if (u >= 1) return 1;
  return u < 0 ? 0.5 * (1 + u) * (1 + u) : 1 - 0.5 * (1 - u) * (1 - u);
}

/// Mean of the hat function over [u - l, u + l] by composite three-point Gauss integration, cut at
/// its kinks so that every piece is a polynomial.
inline Real mean_hat_by_quadrature(Real u, Real l) {
  std::vector<Real> cuts{u - l, u + l};
  for (const Real kink : {-1.0, 0.0, 1.0})
    if (kink > u - l && kink < u + l) cuts.push_back(kink);
  std::sort(cuts.begin(), cuts.end());
  const Real x3 = std::sqrt(0.6);
  Real sum = 0;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const Real m = 0.5 * (cuts[i] + cuts[i + 1]), r = 0.5 * (cuts[i + 1] - cuts[i]);
    sum += r * (5 * hat(m - x3 * r) + 8 * hat(m) + 5 * hat(m + x3 * r)) / 9;
  }
  return sum / (2 * l);
}

/// The linear basis of a node at distance 0.
struct ScalarLinear {
  using policy = vadose::shape::Linear;
  static constexpr bool folds = false;
  static Real value(Real u, Real) { return hat(u); }
  /// Slope per cell; at a node the side above it counts, as in the library.
  static Real slope(Real u, Real) { return u >= -1 && u < 0 ? 1 : u >= 0 && u < 1 ? -1 : 0; }
};
/// Hat functions averaged over the domain of a point, from their closed integral.
struct ScalarGimp {
  using policy = vadose::shape::Gimp;
  static constexpr bool folds = true;
  static Real value(Real u, Real l) {
    return (hat_integral(u + l) - hat_integral(u - l)) / (2 * l);
  }
  static Real slope(Real u, Real l) { return (hat(u + l) - hat(u - l)) / (2 * l); }
};
/// Quadratic B-spline of a node at distance 0: the hat function averaged over one cell.
struct ScalarSpline {
  using policy = vadose::shape::QuadraticBSpline;
  static constexpr bool folds = true;
  static Real value(Real u, Real) {
    const Real a = std::fabs(u);
    return a <= 0.5 ? 0.75 - a * a : a < 1.5 ? 0.5 * (1.5 - a) * (1.5 - a) : 0;
  }
  static Real slope(Real u, Real) {
    const Real a = std::fabs(u);
    return a <= 0.5 ? -2 * u : a < 1.5 ? (u > 0 ? a - 1.5 : 1.5 - a) : 0;
  }
};

/// Value and slope [per cell] of node `node` of an axis with nodes 0 .. cells, at u [cells]: the
/// function of a node beyond a wall counts twice for the wall node and minus once for the next.
template <class Basis>
std::array<Real, 2> node_function(int node, int cells, Real u, Real l) {
  const auto bare = [&](int i, Real& value, Real& slope, Real factor) {
    value += factor * Basis::value(u - i, l);
    slope += factor * Basis::slope(u - i, l);
  };
  Real value = 0, slope = 0;
  bare(node, value, slope, 1);
  if (Basis::folds) {
    if (node == 0) bare(-1, value, slope, 2);
    if (node == 1) bare(-1, value, slope, -1);
    if (node == cells) bare(cells + 1, value, slope, 2);
    if (node == cells - 1) bare(cells + 1, value, slope, -1);
  }
  return {value, slope};
}

/// Value and gradient [1/m] of a node at a position.
template <int Dim>
struct NodeValue {
  Real value = 1;
  std::array<Real, Dim> gradient{};
};
template <class Basis, int Dim>
NodeValue<Dim> node_value(const vadose::BlockGrid<Dim>& grid, const Index<Dim>& node,
                          const Vec<Dim>& x, const Vec<Dim>& half) {
  NodeValue<Dim> result;
  const Real h = grid.cell_size();
  std::array<std::array<Real, 2>, Dim> axis;
  for (int d = 0; d < Dim; ++d)
    axis[static_cast<std::size_t>(d)] =
        node_function<Basis>(node[d], grid.cells()[d], (x[d] - grid.origin()[d]) / h, half[d] / h);
  for (std::size_t d = 0; d < Dim; ++d) {
    result.value *= axis[d][0];
    result.gradient[d] = axis[d][1] / h;
    for (std::size_t e = 0; e < Dim; ++e)
      if (e != d) result.gradient[d] *= axis[e][0];
  }
  return result;
}

// ---------------------------------------------------------------------------------------------
// Random numbers and points.

/// Reproducible numbers.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  Real in(Real low, Real high) {
    return low + (high - low) * (static_cast<Real>(engine_() >> 11) * 0x1p-53);
  }
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }

 private:
  std::mt19937_64 engine_;
};

/// Grid with all of its blocks.
template <int Dim>
vadose::BlockGrid<Dim> full_grid(const Vec<Dim>& origin, Real h, const Index<Dim>& cells) {
  vadose::BlockGrid<Dim> grid(origin, h, cells);
  grid.rebuild(std::vector<char>(grid.block_count(), 1));
  return grid;
}

// ---------------------------------------------------------------------------------------------
// Totals of a run. Long double: the tests look at the last digits.

using Wide = long double;

/// Sum and size of a vector quantity.
struct Total {
  std::array<Wide, 3> sum{};
  Wide size = 0;  ///< sum of norms
  /// Largest difference of a component to another total, over the larger size.
  Real relative_to(const Total& other) const {
    Wide worst = 0;
    for (std::size_t i = 0; i < 3; ++i) worst = std::max(worst, std::fabs(sum[i] - other.sum[i]));
    return static_cast<Real>(worst / std::max(size, other.size));
  }
};

template <class Points>
Wide total_mass(const Points& points) {
  Wide sum = 0;
  points.for_each([&](std::size_t b, int l) { sum += points.at(vadose::field::mass, b)[l]; });
  return sum;
}

/// Linear momentum of a point set, none if it does not move.
template <int Dim, class Points>
void add_momentum(const Points& points, Total& total) {
  if constexpr (Points::fields::template has<vadose::field::Velocity>) {
    points.for_each([&](std::size_t b, int l) {
      const Wide m = points.at(vadose::field::mass, b)[l];
      Wide v2 = 0;
      for (int d = 0; d < Dim; ++d) {
        const Wide v = points.at(vadose::field::velocity, b, d)[l];
        total.sum[static_cast<std::size_t>(d)] += m * v;
        v2 += v * v;
      }
      total.size += m * std::sqrt(v2);
    });
  }
}

/// Angular momentum of a point set about the origin, that inside the points (APIC's B) included.
template <int Dim, class Points>
Total angular_momentum(const Points& points) {
  static_assert(Dim >= 2);
  Total total;
  points.for_each([&](std::size_t b, int l) {
    const Wide m = points.at(vadose::field::mass, b)[l];
    std::array<Wide, 3> x{}, v{}, spin{};
    std::array<std::array<Wide, 3>, 3> affine{};
    for (int d = 0; d < Dim; ++d) {
      const auto i = static_cast<std::size_t>(d);
      x[i] = points.at(vadose::field::position, b, d)[l];
      v[i] = points.at(vadose::field::velocity, b, d)[l];
      for (int e = 0; e < Dim; ++e)
        affine[i][static_cast<std::size_t>(e)] =
            points.at(vadose::field::affine, b, d * Dim + e)[l];
    }
    Wide size = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      // eps_ijk (x_j v_k + B_kj): B = sum w v (x_I - x_p)^T.
      spin[i] = x[j] * v[k] - x[k] * v[j] + affine[k][j] - affine[j][k];
      total.sum[i] += m * spin[i];
      size += spin[i] * spin[i];
    }
    total.size += m * std::sqrt(size);
  });
  return total;
}

/// Every number of every point, by id.
template <class Points>
std::map<std::int64_t, std::vector<double>> by_id(const Points& points) {
  std::map<std::int64_t, std::vector<double>> all;
  points.for_each([&](std::size_t b, int l) {
    std::vector<double> values;
    Points::fields::for_each([&](auto tag, [[maybe_unused]] int components) {
      if constexpr (Points::fields::template has<decltype(tag)>)
        for (int c = 0; c < components; ++c) values.push_back(points.at(tag, b, c)[l]);
    });
    all[static_cast<std::int64_t>(points.at(vadose::field::id, b)[l])] = values;
  });
  return all;
}

/// Whether two lists of numbers have the same bits.
inline bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

// ---------------------------------------------------------------------------------------------
// Models and materials.

template <class K, class Law = vadose::law::LinearElastic, class Tr = vadose::transfer::Flip,
          class Sh = vadose::shape::Gimp>
using Dry = vadose_test::With<vadose::DryModel<K>, Law, Tr, Sh>;
template <class K, class Law = vadose::law::LinearElastic, class Tr = vadose::transfer::Flip,
          class Sh = vadose::shape::Gimp>
using Saturated = vadose_test::With<vadose::SaturatedModel<K>, Law, Tr, Sh>;
template <class K, class Law = vadose::law::LinearElastic, class Tr = vadose::transfer::Flip,
          class Sh = vadose::shape::Gimp>
using Unsaturated = vadose_test::With<vadose::UnsaturatedModel<K>, Law, Tr, Sh>;

/// A soft soil; a Drucker-Prager one slides and yields in these tests.
template <class M>
vadose::Material<M> soil() {
  vadose::Material<M> m;
  m.solid_density = 2600;
  m.porosity = 0.4;
  if constexpr (requires { m.skeleton.elastic; }) {
    m.skeleton.elastic = {.young_modulus = 2e6, .poisson_ratio = 0.3};
    m.skeleton.friction_angle = vadose::degrees(30);
    m.skeleton.cohesion = 500;
  } else if constexpr (requires { m.skeleton.young_modulus; }) {
    m.skeleton.young_modulus = 2e6;
    m.skeleton.poisson_ratio = 0.3;
  }
  if constexpr (vadose::is_unsaturated<M>) {
    m.lambda = 0.6;
    m.retention.a = 1.5;
  }
  if constexpr (vadose::has_liquid<M> && vadose::has_skeleton<M>)
    m.conductivity.saturated_conductivity = 1e-3;
  return m;
}

/// Runs n steps; false at the first failed one.
template <class Solver>
bool run(Solver& solver, int n) {
  for (int i = 0; i < n; ++i)
    if (solver.step().status != vadose::Status::ok) return false;
  return true;
}

}  // namespace kernel_test
