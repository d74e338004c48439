// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Checks that every constitutive law must pass, for authors of laws:
///
///     const auto report = vadose::testing::check_law(MyLaw{...});
///     if (!report.ok()) std::fputs(report.text().c_str(), stderr);

#include <cmath>
#include <string>
#include <vector>

#include <vadose/policy/law/law_concept.hpp>
#include <vadose/testing/report.hpp>

namespace vadose::testing {

/// Sizes at which a law is tried.
struct LawCheckOptions {
  Real stress = 100e3;            ///< size of stresses [Pa]
  Real strain = 1e-3;             ///< size of strain increments [-]
  Real large_strain = 0.05;       ///< the largest increments of the paths [-]
  Real elastic_strain = 1e-7;     ///< size of increments for slopes and elastic cycles [-]
  int paths = 20;                 ///< random paths
  int steps = 40;                 ///< increments per path
  std::uint64_t seed = 1;         ///< of the random numbers
  Real tolerance = 1e-9;          ///< of comparisons, relative to stresses and moduli [-]
  bool elastic_potential = true;  ///< no energy comes from a closed elastic cycle
  Real plastic_stiffness = 1.25;  ///< allowed over E_c while the state changes [-]
};

namespace detail {

/// Stress and history of one point under a law.
template <class L, int N>
struct LawPoint {
  SymTensor<Real, N> stress;
  std::array<Real, static_cast<std::size_t>(law::state_size<L>) + 1> state{};

  explicit LawPoint(const L& law) {
    const auto start = law::initial_state(law);
    for (std::size_t i = 0; i < start.size(); ++i) state[i] = start[i];
  }
  Status step(const L& law, const SymTensor<Real, N>& increment) {
    StrainStep<Real, N> s;
    s.increment = increment;
    s.dt = 1e-3;
    return law::apply(law, s, stress, state.data());
  }
};

/// Largest component.
template <int N>
Real size_of(const SymTensor<Real, N>& t) noexcept {
  Real most = 0;
  for (int i = 0; i < N; ++i)
    if (most == most && !(std::fabs(t[i]) <= most)) most = std::fabs(t[i]);  // keeps NaN
  return most;
}
template <class State>
Real difference(const State& a, const State& b) noexcept {
  Real most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Real scale = std::fmax(1, std::fmax(std::fabs(a[i]), std::fabs(b[i])));
    const Real d = std::fabs(a[i] - b[i]) / scale;
    if (most == most && !(d <= most)) most = d;  // keeps NaN
  }
  return most;
}

template <int N>
SymTensor<Real, N> random_tensor(Random& random, Real size) noexcept {
  SymTensor<Real, N> t;
  for (int i = 0; i < N; ++i) t[i] = random(-size, size);
  return t;
}

/// Rotation about an axis through the origin (row-major), by an angle.
struct Rotation {
  Real r[3][3];

  Rotation(const Real (&axis)[3], Real angle) noexcept {
    const Real norm = std::sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    const Real a[3] = {axis[0] / norm, axis[1] / norm, axis[2] / norm};
    const Real c = std::cos(angle), s = std::sin(angle);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) r[i][j] = (i == j ? c : 0) + (1 - c) * a[i] * a[j];
    r[0][1] -= s * a[2], r[1][0] += s * a[2];
    r[0][2] += s * a[1], r[2][0] -= s * a[1];
    r[1][2] -= s * a[0], r[2][1] += s * a[0];
  }
  /// R t R^T; for N = 4 the axis must be z.
  template <int N>
  SymTensor<Real, N> operator()(const SymTensor<Real, N>& t) const noexcept {
    Real full[3][3] = {{t[0], 0, 0}, {0, t[1], 0}, {0, 0, t[2]}};
    if constexpr (N > 3) full[0][1] = full[1][0] = t[3];
    if constexpr (N == 6) {
      full[1][2] = full[2][1] = t[4];
      full[0][2] = full[2][0] = t[5];
    }
    const auto entry = [&](int a, int b) {
      Real sum = 0;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) sum += r[a][i] * full[i][j] * r[b][j];
      return sum;
    };
    SymTensor<Real, N> u;
    for (int i = 0; i < 3; ++i) u[i] = entry(i, i);
    if constexpr (N > 3) u[3] = entry(0, 1);
    if constexpr (N == 6) u[4] = entry(1, 2), u[5] = entry(2, 0);
    return u;
  }
};

/// The checks of one law for stresses of N components.
template <class L, int N>
class LawCheck {
 public:
  LawCheck(const L& law, const LawCheckOptions& options, Report& report)
      : law_(law), o_(options), report_(report), random_(options.seed) {}

  void run() {
    LawPoint<L, N> start(law_);
    modulus_ = law::p_wave_modulus(law_, start.state.data());
    report_.expect("modulus is positive", at("start, -E_c [Pa]"), -modulus_, -1e-300);
    elastic_cycle(start);
    for (int p = 0; p < o_.paths; ++p) {
      LawPoint<L, N> point(law_);
      for (int s = 0; s < o_.steps; ++s) {
        one_step(point, random_tensor<N>(random_, p % 4 == 0 ? o_.large_strain : o_.strain));
        if (!is_finite(size_of(point.stress))) break;
      }
    }
  }

 private:
  /// Everything that is checked at one point of a path, then the step itself.
  void one_step(LawPoint<L, N>& point, const SymTensor<Real, N>& increment) {
    if constexpr (N > 3) indifference(point, increment);
    if (++count_ % 5 == 0) stiffness(point);
    lanes(point, increment);
    const Status status = point.step(law_, increment);
    report_.expect("step is accepted", at("status after an increment"),
                   static_cast<Real>(status != Status::ok), 0);
    report_.expect("stress is finite", at("after an increment [Pa]"), size_of(point.stress), 1e300);
    LawPoint<L, N> again = point;
    again.step(law_, {});
    report_.expect("stress is admissible", at("changed by an increment of 0 [Pa]"),
                   size_of(again.stress - point.stress), tolerance(point));
    report_.expect("state stays", at("changed by an increment of 0"),
                   difference(again.state, point.state), 1e3 * o_.tolerance);
  }

  /// Rotated stress and increment give the rotated stress and the same state.
  void indifference(const LawPoint<L, N>& point, const SymTensor<Real, N>& increment) {
    const Real axis[3] = {N == 6 ? random_(-1, 1) : 0, N == 6 ? random_(-1, 1) : 0, 1};
    const Rotation rotation(axis, random_(0.1, 3));
    LawPoint<L, N> plain = point, turned = point;
    turned.stress = rotation(point.stress);
    plain.step(law_, increment);
    turned.step(law_, rotation(increment));
    report_.expect("frame indifference", at("stress in a rotated frame [Pa]"),
                   size_of(turned.stress - rotation(plain.stress)), 10 * tolerance(plain));
    report_.expect("frame indifference", at("state in a rotated frame"),
                   difference(turned.state, plain.state), 1e3 * o_.tolerance);
  }

  /// Stiffness n . d(sigma) . n along any normal n, by a difference, against the modulus of the state.
  void stiffness(const LawPoint<L, N>& point) {
    const Real modulus = law::p_wave_modulus(law_, point.state.data());
    LawPoint<L, N> rest = point;
    rest.step(law_, {});
    for (int k = 0; k < 4; ++k) {
      Real n[3] = {random_(-1, 1), random_(-1, 1), random_(-1, 1)};
      if (N == 4) n[2] = 0;
      if (N == 3) n[1] = n[2] = 0;
      const Real norm = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      for (Real& x : n) x /= norm;
      SymTensor<Real, N> direction;
      for (int i = 0; i < 3; ++i) direction[i] = n[i] * n[i];
      if constexpr (N > 3) direction[3] = n[0] * n[1];
      if constexpr (N == 6) direction[4] = n[1] * n[2], direction[5] = n[2] * n[0];
      const Real h = (k % 2 == 0 ? 1 : -1) * 1e2 * o_.elastic_strain;
      LawPoint<L, N> moved = point;
      moved.step(law_, h * direction);
      // While the state stays the law is elastic. Flow that is not associated may be a little stiffer
      // than that in some directions (1.11 for Drucker-Prager at 30 and 5 degrees); the Courant number
      // has room for it.
      const bool flows = difference(moved.state, rest.state) > 0;
      report_.expect("modulus bounds the stiffness", at("stiffness over E_c of the state"),
                     contract(moved.stress - rest.stress, direction) / h / modulus,
                     (flows ? o_.plastic_stiffness : 1) + 1e-6 +
                         10 * tolerance(point) / (modulus * std::fabs(h)));
    }
  }

  /// Work of closed cycles of small strain about a stress, run both ways round; and the stress at the end
  /// where the state has not changed.
  void elastic_cycle(const LawPoint<L, N>& start) {
    if (!o_.elastic_potential) return;
    for (int k = 0; k < 20; ++k) {
      const auto a = random_tensor<N>(random_, o_.elastic_strain);
      const auto b = random_tensor<N>(random_, o_.elastic_strain);
      for (const Real sense : {1.0, -1.0}) {
        LawPoint<L, N> point = start;
        for (int i = 0; i < 3; ++i) point.stress[i] = -o_.stress;
        point.step(law_, {});
        const LawPoint<L, N> before = point;
        Real work = 0;
        const auto go = [&](const SymTensor<Real, N>& step) {
          const auto old = point.stress;
          point.step(law_, step);
          work += 0.5 * contract(point.stress + old - 2 * before.stress, step);
        };
        go(sense > 0 ? a : b);
        go(sense > 0 ? b : a);
        go(sense > 0 ? -1.0 * a : -1.0 * b);
        go(sense > 0 ? -1.0 * b : -1.0 * a);
        const Real unit = modulus_ * o_.elastic_strain * o_.elastic_strain;
        const Real noise = 1e-14 * o_.stress / (modulus_ * o_.elastic_strain);
        report_.expect("no energy from an elastic cycle", at("energy gained over E_c strain^2"),
                       -work / unit, 1e-6 + 10 * noise);
        if (difference(point.state, before.state) == 0)
          report_.expect("elastic cycle closes", at("stress after it over E_c strain"),
                         size_of(point.stress - before.stress) / (modulus_ * o_.elastic_strain),
                         1e-6 + 10 * noise);
      }
    }
  }

  /// Eight points at once, each with another increment, against one by one.
  void lanes(const LawPoint<L, N>& point, const SymTensor<Real, N>& increment) {
    constexpr int size = law::state_size<L>;
    StrainStep<Lanes, N> step;
    step.dt = 1e-3;
    SymTensor<Lanes, N> stress;
    Lanes state[size + 1];
    for (int l = 0; l < lane_count; ++l)
      for (int i = 0; i < N; ++i) step.increment[i].set(l, increment[i] * (1 - 0.3 * l));
    for (int i = 0; i < N; ++i) stress[i] = Lanes(point.stress[i]);
    for (int i = 0; i < size; ++i) state[i] = Lanes(point.state[static_cast<std::size_t>(i)]);
    law::apply(law_, step, stress, state);
    for (int l = 0; l < lane_count; ++l) {
      LawPoint<L, N> one = point;
      one.step(law_, (1 - 0.3 * l) * increment);
      SymTensor<Real, N> got;
      for (int i = 0; i < N; ++i) got[i] = stress[i][l];
      report_.expect("lanes agree with numbers", at("stress of a lane [Pa]"),
                     size_of(got - one.stress), 10 * tolerance(one));
      for (int i = 0; i < size; ++i) {
        const Real expected = one.state[static_cast<std::size_t>(i)];
        report_.expect("lanes agree with numbers", at("state of a lane"),
                       std::fabs(state[i][l] - expected) / std::fmax(1, std::fabs(expected)),
                       1e3 * o_.tolerance);
      }
    }
  }

  /// Round-off of stresses [Pa].
  Real tolerance(const LawPoint<L, N>& point) const noexcept {
    return o_.tolerance * std::fmax(std::fmax(o_.stress, size_of(point.stress)),
                                    1e-3 * o_.large_strain * modulus_);
  }
  static std::string at(const std::string& what) {
    return std::to_string(N) + " components, " + what;
  }

  const L& law_;
  const LawCheckOptions& o_;
  Report& report_;
  Random random_;
  Real modulus_ = 1;
  int count_ = 0;
};

/// In plane strain the three-dimensional law gives the same as that of four components.
template <class L>
void check_dimensions(const L& law, const LawCheckOptions& o, Report& report) {
  Random random(o.seed + 1);
  LawPoint<L, 4> plane(law);
  LawPoint<L, 6> space(law);
  for (int s = 0; s < o.steps; ++s) {
    const auto increment = random_tensor<4>(random, o.strain);
    SymTensor<Real, 6> same;
    for (int i = 0; i < 4; ++i) same[i] = increment[i];
    plane.step(law, increment);
    space.step(law, same);
    SymTensor<Real, 6> difference = space.stress;
    for (int i = 0; i < 4; ++i) difference[i] -= plane.stress[i];
    report.expect("dimensions agree", "stress of six components less that of four [Pa]",
                  size_of(difference),
                  1e3 * o.tolerance * std::fmax(o.stress, size_of(plane.stress)));
  }
}

}  // namespace detail

/// Checks a law with its parameters, for every number of stress components that it accepts: frame
/// indifference; E_c an upper bound of the stiffness; no energy from a closed elastic cycle; stress and
/// state finite, accepted and admissible (an increment of zero changes nothing) on random paths; eight
/// points at once as one by one; plane strain as in space.
template <law::HasModulus L>
Report check_law(const L& law, const LawCheckOptions& options = {}) {
  Report report;
  if constexpr (law::HasUpdate<L, 3>) detail::LawCheck<L, 3>(law, options, report).run();
  if constexpr (law::HasUpdate<L, 4>) detail::LawCheck<L, 4>(law, options, report).run();
  if constexpr (law::HasUpdate<L, 6>) detail::LawCheck<L, 6>(law, options, report).run();
  if constexpr (law::HasUpdate<L, 4> && law::HasUpdate<L, 6>)
    detail::check_dimensions(law, options, report);
  return report;
}

}  // namespace vadose::testing
