// SPDX-License-Identifier: MIT
#pragma once

// Helpers of the tests of constitutive laws.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <vadose/policy/law.hpp>

#include "../reference_table.hpp"

namespace laws_test {

using vadose::Lanes;
using vadose::Real;
using vadose::StrainStep;
using vadose::SymTensor;

template <int N>
using Tensor = SymTensor<Real, N>;

using vadose_test::Table;

/// Repeatable numbers in [low, high).
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  Real operator()(Real low, Real high) {
    return low + (high - low) * static_cast<Real>(engine_()) / 4294967296.0;
  }
  template <int N>
  Tensor<N> tensor(Real amplitude) {
    Tensor<N> t;
    for (int i = 0; i < N; ++i) t[i] = (*this)(-amplitude, amplitude);
    return t;
  }

 private:
  std::mt19937 engine_;
};

template <int N>
Real largest(const Tensor<N>& t) {
  Real m = 0;
  for (int i = 0; i < N; ++i) m = std::max(m, std::abs(t[i]));
  return m;
}

/// The first components of a tensor of six (yz = zx = 0, for N = 3 also xy = 0).
template <int N>
Tensor<N> reduced(const Tensor<6>& t) {
  Tensor<N> r;
  for (int i = 0; i < N; ++i) r[i] = t[i];
  return r;
}

/// Stress after one step; the state is updated.
template <int N, class L>
Tensor<N> after(const L& law, const Tensor<N>& strain, Tensor<N> stress,
                vadose::law::StateOf<L, Real>& state) {
  StrainStep<Real, N> step;
  step.increment = strain;
  step.dt = 1e-3;
  if (law.update(step, stress, state) != vadose::Status::ok) stress[0] = vadose::unset;
  return stress;
}

/// Stress after one step from the default state.
template <int N, class L>
Tensor<N> after(const L& law, const Tensor<N>& strain, const Tensor<N>& stress) {
  vadose::law::StateOf<L, Real> state{};
  return after<N>(law, strain, stress, state);
}

/// Largest difference, over stresses and states, of a run on lanes (through apply) against eight
/// runs on numbers, each relative to its own scale. Every lane starts with another state.
template <int N, class L>
Real lanes_against_numbers(const L& law, Random& random, Real stress_scale, Real strain_scale,
                           Real state_scale) {
  constexpr int size = vadose::law::state_size<L>;
  StrainStep<Lanes, N> step;
  SymTensor<Lanes, N> stress;
  Lanes state[size + 1];
  Real expected[vadose::lane_count][N];
  Real expected_state[vadose::lane_count][size + 1] = {};
  Real scale = 0, worst = 0;
  for (int lane = 0; lane < vadose::lane_count; ++lane) {
    StrainStep<Real, N> one_step;
    one_step.increment = random.tensor<N>(strain_scale);
    Tensor<N> one = random.tensor<N>(stress_scale);
    one.add_isotropic(random(-stress_scale, 0.5 * stress_scale));
    for (int i = 0; i < N; ++i) step.increment[i].set(lane, one_step.increment[i]);
    for (int i = 0; i < N; ++i) stress[i].set(lane, one[i]);
    for (int i = 0; i < size; ++i) {
      expected_state[lane][i] = random(0, state_scale);
      state[i].set(lane, expected_state[lane][i]);
    }
    vadose::law::apply(law, one_step, one, expected_state[lane]);
    scale = std::max(scale, largest(one));
    for (int i = 0; i < N; ++i) expected[lane][i] = one[i];
  }
  if (vadose::law::apply(law, step, stress, state) != vadose::Status::ok) return 1;
  for (int lane = 0; lane < vadose::lane_count; ++lane) {
    for (int i = 0; i < N; ++i)
      worst = std::max(
          worst, std::abs(stress[i][lane] - expected[lane][i]) / std::max(scale, stress_scale));
    for (int i = 0; i < size; ++i)
      worst = std::max(worst, std::abs(state[i][lane] - expected_state[lane][i]) /
                                  std::max(expected_state[lane][i], strain_scale));
  }
  return worst;
}

/// What validate() says, or "accepted".
template <class L>
std::string complaint(const L& law) {
  try {
    law.validate();
  } catch (const vadose::SetupError& error) {
    return error.what();
  }
  return "accepted";
}

inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// Elastic strain of a stress [-].
template <int N>
Tensor<N> elastic_strain(const vadose::law::LinearElastic& elastic, const Tensor<N>& stress) {
  Tensor<N> strain = (1 / (2 * elastic.shear_modulus())) * stress.deviator();
  strain.add_isotropic(stress.mean() / (3 * elastic.bulk_modulus()));
  return strain;
}

/// Columns of a random rotation matrix.
using Rotation = std::array<std::array<Real, 3>, 3>;
inline Rotation random_rotation(Random& random) {
  Real q[4], norm = 0;
  for (Real& x : q) {
    x = random(-1, 1);
    norm += x * x;
  }
  for (Real& x : q) x /= std::sqrt(norm);
  const Real w = q[0], x = q[1], y = q[2], z = q[3];
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
           {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
           {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
}

/// R t R^T.
inline Tensor<6> rotated(const Rotation& r, const Tensor<6>& t) {
  const Real full[3][3] = {{t[0], t[3], t[5]}, {t[3], t[1], t[4]}, {t[5], t[4], t[2]}};
  const auto entry = [&](std::size_t a, std::size_t b) {
    Real sum = 0;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) sum += r[a][i] * full[i][j] * r[b][j];
    return sum;
  };
  Tensor<6> u;
  u[0] = entry(0, 0), u[1] = entry(1, 1), u[2] = entry(2, 2);
  u[3] = entry(0, 1), u[4] = entry(1, 2), u[5] = entry(2, 0);
  return u;
}

/// Largest entry of the difference of two tensors.
template <int N>
Real distance(const Tensor<N>& a, const Tensor<N>& b) {
  return largest(a - b);
}

}  // namespace laws_test
