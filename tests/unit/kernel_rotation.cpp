// SPDX-License-Identifier: MIT

// Rigid motion: the Jaumann rotation of the stress, and stressed blocks that turn and travel.

#include <doctest/doctest.h>

#include <Eigen/Dense>

#include "kernel_support.hpp"

namespace {

using namespace kernel_test;
using vadose::SymTensor;
namespace field = vadose::field;
using Matrix = Eigen::Matrix3d;

template <int N>
Matrix matrix(const std::array<Real, N>& s) {
  Matrix m = Matrix::Zero();
  for (int i = 0; i < 3; ++i) m(i, i) = s[static_cast<std::size_t>(i)];
  if constexpr (N >= 4) m(0, 1) = m(1, 0) = s[3];
  if constexpr (N == 6) {
    m(1, 2) = m(2, 1) = s[4];
    m(0, 2) = m(2, 0) = s[5];
  }
  return m;
}
template <int N>
Matrix lane(const SymTensor<Lanes, N>& s, int l) {
  std::array<Real, N> values;
  for (int i = 0; i < N; ++i) values[static_cast<std::size_t>(i)] = s[i][l];
  return matrix<N>(values);
}
template <int N>
SymTensor<Lanes, N> random_stress(Random& random) {
  SymTensor<Lanes, N> s;
  for (int i = 0; i < N; ++i)
    for (int l = 0; l < lane_count; ++l) s[i].set(l, random.in(-1e5, 1e5));
  return s;
}
Matrix skew(const Eigen::Vector3d& w) {
  Matrix m;
  m << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
  return m;
}
Matrix turn(const Eigen::Vector3d& axis, Real angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}
/// I1, J2 and the determinant of the deviator, each scaled to a stress.
std::array<Real, 3> invariants(const Matrix& s) {
  const Matrix d = s - s.trace() / 3 * Matrix::Identity();
  return {s.trace(), std::sqrt(0.5 * (d * d).trace()), std::cbrt(d.determinant())};
}

/// One step of a velocity gradient that spins about `omega` and stretches by `stretch`.
template <int Dim, int N>
SymTensor<Lanes, N> rotated(SymTensor<Lanes, N> s, const Eigen::Vector3d& omega, Real dt,
                            Real stretch = 0) {
  const Matrix w = skew(omega);
  Lanes gradient[Dim][Dim];
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b)
      gradient[a][b] = Lanes(w(a, b) + stretch * (a == b ? 1.0 + a : 0.3));
  vadose::kernel::rotate_stress(gradient, dt, s);
  return s;
}

template <int Dim, int N>
void check_one_step(unsigned seed) {
  Random random(seed);
  for (int k = 0; k < 50; ++k) {
    Eigen::Vector3d omega(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1));
    if (Dim == 2) omega[0] = omega[1] = 0;
    const Real dt = random.in(0, 0.2);
    const auto before = random_stress<N>(random);
    // The symmetric part of the gradient does not turn the stress.
    const auto after = rotated<Dim, N>(before, omega, dt, k % 2 == 0 ? 0.0 : 0.7);
    // Cayley's map turns by 2 atan(angle / 2): off by angle^3 / 12.
    const Real angle = omega.norm() * dt;
    const Matrix cayley = turn(omega, 2 * std::atan(0.5 * angle));
    const Matrix exact = turn(omega, angle);
    for (int l = 0; l < lane_count; ++l) {
      const Matrix s = lane<N>(before, l);
      CHECK((lane<N>(after, l) - cayley * s * cayley.transpose()).norm() < 1e-13 * s.norm());
      CHECK((lane<N>(after, l) - exact * s * exact.transpose()).norm() <
            (2.0 / 12 * angle * angle * angle + 1e-13) * std::numbers::sqrt2 * s.norm());
      const auto a = invariants(s), b = invariants(lane<N>(after, l));
      for (std::size_t i = 0; i < 3; ++i) CHECK(std::fabs(a[i] - b[i]) < 1e-12 * s.norm());
    }
  }
}

/// Error of the stress after a quarter turn in `steps` equal steps.
template <int Dim, int N>
Real quarter_turn_error(int steps) {
  Random random(73);
  const Eigen::Vector3d omega = Dim == 2 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(1, -2, 0.5);
  const Real angle = 0.5 * std::numbers::pi;
  const auto before = random_stress<N>(random);
  auto s = before;
  for (int i = 0; i < steps; ++i) s = rotated<Dim, N>(s, omega.normalized(), angle / steps);
  const Matrix r = turn(omega, angle);
  Real worst = 0;
  for (int l = 0; l < lane_count; ++l) {
    const Matrix m = lane<N>(before, l);
    worst = std::max(worst, (lane<N>(s, l) - r * m * r.transpose()).norm() / m.norm());
  }
  return worst;
}

/// A block of stressed points in the middle of one block of the grid, turned by nodes that move
/// as a rigid body. Returns the solver after a quarter turn.
template <class M>
vadose::Solver<M> turned_block(const std::array<Real, 6>& stress, int steps) {
  constexpr int dim = M::Kinematics::dim;
  constexpr int edge = vadose::Block<dim>::edge;
  const Real h = 0.1, centre = 1.5 * edge * h;
  vadose::Scene<M> scene(
      {.box = {Vec<dim>::Zero(), Vec<dim>::Constant(3 * edge * h)}, .cell_size = h});
  const Real half = dim == 2 ? 2 * h : 1 * h;
  scene.add_soil(
      vadose::box<dim>(Vec<dim>::Constant(centre - half), Vec<dim>::Constant(centre + half)),
      soil<M>());
  vadose::Solver<M> solver(scene);
  auto& state = solver.mutable_state();
  for (std::size_t b = 0; b < state.solid.batches(); ++b)
    for (int i = 0; i < state.stress_size; ++i)
      state.solid.store(field::bishop_stress, b, i, Lanes(stress[static_cast<std::size_t>(i)]));
  // The skeleton turns about z (2D) or about the diagonal (3D) by pi / 2 in one second.
  Eigen::Vector3d omega = dim == 2 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(1, 1, 1);
  omega *= 0.5 * std::numbers::pi / omega.norm();
  const Matrix w = skew(omega);
  for (int s = 0; s < state.grid.slots(); ++s) {
    std::int32_t e = s * vadose::Block<dim>::cells;
    vadose::for_cube<dim>(0, edge, [&](const Index<dim>& i) {
      Eigen::Vector3d x = Eigen::Vector3d::Zero();
      for (int d = 0; d < dim; ++d) x[d] = (state.grid.first_cell(s)[d] + i[d]) * h - centre;
      const Eigen::Vector3d v = w * x;
      auto& r = state.nodes.solid_out[static_cast<std::size_t>(e++)];
      r = {};
      for (int d = 0; d < dim; ++d) r[vadose::lane::velocity + d] = v[d];
    });
  }
  state.dt = 1.0 / steps;
  for (int i = 0; i < steps; ++i) vadose::kernel::update_solid(state);
  CHECK_FALSE(state.sums[0].failed);
  return solver;
}

/// Largest distance of the stress of any point from a tensor, over its norm.
template <class M>
Real stress_distance(const vadose::Solver<M>& solver, const Matrix& expected) {
  constexpr int n = vadose::State<M>::stress_size;
  Real worst = 0;
  solver.solid().for_each([&](std::size_t b, int l) {
    std::array<Real, n> s;
    for (int i = 0; i < n; ++i)
      s[static_cast<std::size_t>(i)] = solver.solid().at(field::bishop_stress, b, i)[l];
    worst = std::max(worst, (matrix<n>(s) - expected).norm() / expected.norm());
  });
  return worst;
}
/// Largest change of an invariant of the stress of any point, over its norm.
template <class M>
Real invariant_drift(const vadose::Solver<M>& solver, const Matrix& start) {
  constexpr int n = vadose::State<M>::stress_size;
  const auto a = invariants(start);
  Real worst = 0;
  solver.solid().for_each([&](std::size_t b, int l) {
    std::array<Real, n> s;
    for (int i = 0; i < n; ++i)
      s[static_cast<std::size_t>(i)] = solver.solid().at(field::bishop_stress, b, i)[l];
    const auto c = invariants(matrix<n>(s));
    for (std::size_t i = 0; i < 3; ++i)
      worst = std::max(worst, std::fabs(a[i] - c[i]) / start.norm());
  });
  return worst;
}

constexpr std::array<Real, 6> stress_2d{-3e4, -1e4, -1.2e4, 7e3, 0, 0};
constexpr std::array<Real, 6> stress_3d{-3e4, -1e4, -1.2e4, 7e3, -2e3, 5e3};

/// A stressed block carried along by its nodes at one velocity; returns the drift of the stress.
template <class M>
Real carried_block_drift(const std::array<Real, 6>& stress) {
  constexpr int dim = M::Kinematics::dim;
  constexpr int n = M::Kinematics::stress_size;
  const Real h = 0.1;
  const Vec<dim> high = Vec<dim>::Constant(1.6);
  vadose::Scene<M> scene({.box = {Vec<dim>::Zero(), high}, .cell_size = h});
  Vec<dim> velocity;
  for (int d = 0; d < dim; ++d) velocity[d] = 1.7 - 0.6 * d;
  scene.add_soil(vadose::box<dim>(Vec<dim>::Constant(0.23), Vec<dim>::Constant(0.61)), soil<M>(),
                 {.jitter = 0.1, .seed = 5, .velocity = velocity});
  scene.add(vadose::bc::PrescribedVelocity<dim>{.region = vadose::box<dim>(Vec<dim>::Zero(), high),
                                                .velocity = velocity});
  vadose::Solver<M> solver(scene);
  auto& state = solver.mutable_state();
  std::array<Real, n> start;
  for (int i = 0; i < n; ++i) {
    start[static_cast<std::size_t>(i)] = stress[static_cast<std::size_t>(i)];
    for (std::size_t b = 0; b < state.solid.batches(); ++b)
      state.solid.store(field::bishop_stress, b, i, Lanes(stress[static_cast<std::size_t>(i)]));
  }
  solver.advance_to(0.4);  // nearly seven cells
  Real worst_place = 0;
  solver.solid().for_each([&](std::size_t b, int l) {
    worst_place = std::max(worst_place, (solver.displacement(b, l) - 0.4 * velocity).norm());
  });
  CHECK(worst_place < 1e-12);
  return stress_distance(solver, matrix<n>(start));
}

using Plane = Dry<vadose::PlaneStrain>;
using Space = Dry<vadose::ThreeDimensional>;
using PlaneSpline = Dry<vadose::PlaneStrain, vadose::law::LinearElastic, vadose::transfer::Apic,
                        vadose::shape::QuadraticBSpline>;

}  // namespace

TEST_CASE("one step turns the stress as a rotation, in two and three dimensions") {
  check_one_step<2, 4>(71);
  check_one_step<3, 6>(72);
}

TEST_CASE("a quarter turn of the stress converges at second order") {
  const Real plane[2] = {quarter_turn_error<2, 4>(50), quarter_turn_error<2, 4>(100)};
  CHECK(plane[0] < 3e-4);
  CHECK(plane[0] / plane[1] == doctest::Approx(4).epsilon(0.02));
  const Real space[2] = {quarter_turn_error<3, 6>(50), quarter_turn_error<3, 6>(100)};
  CHECK(space[0] < 3e-4);
  CHECK(space[0] / space[1] == doctest::Approx(4).epsilon(0.02));
}

TEST_CASE("a uniaxial state has no spin") {
  Random random(74);
  const auto before = random_stress<3>(random);
  auto after = before;
  const Lanes gradient[1][1] = {{Lanes(3.0)}};
  vadose::kernel::rotate_stress(gradient, 0.1, after);
  for (int i = 0; i < 3; ++i) CHECK(all(after[i] == before[i]));
}

TEST_CASE("a block that turns by 90 degrees keeps its stress invariants: plane strain") {
  const Matrix start = matrix<4>({stress_2d[0], stress_2d[1], stress_2d[2], stress_2d[3]});
  const Matrix r = turn({0, 0, 1}, 0.5 * std::numbers::pi);
  const auto coarse = turned_block<Plane>(stress_2d, 100);
  const auto fine = turned_block<Plane>(stress_2d, 200);
  CHECK(invariant_drift(coarse, start) < 1e-10);
  CHECK(invariant_drift(fine, start) < 1e-10);
  const Real e = stress_distance(coarse, r * start * r.transpose());
  CHECK(e < 1e-4);
  CHECK(e / stress_distance(fine, r * start * r.transpose()) == doctest::Approx(4).epsilon(0.05));
}

TEST_CASE("a block that turns by 90 degrees keeps its stress invariants: three dimensions") {
  const Matrix start = matrix<6>(stress_3d);
  const Matrix r = turn({1, 1, 1}, 0.5 * std::numbers::pi);
  const auto coarse = turned_block<Space>(stress_3d, 100);
  CHECK(invariant_drift(coarse, start) < 1e-10);
  CHECK(stress_distance(coarse, r * start * r.transpose()) < 1e-4);
}

TEST_CASE("a stressed block that is carried along keeps its stress") {
  CHECK(carried_block_drift<Plane>(stress_2d) < 1e-10);
  CHECK(carried_block_drift<PlaneSpline>(stress_2d) < 1e-10);
  CHECK(carried_block_drift<Space>(stress_3d) < 1e-10);
}
