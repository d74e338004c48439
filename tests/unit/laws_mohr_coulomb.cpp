// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "laws_support.hpp"

using namespace laws_test;
using vadose::law::MohrCoulomb;

namespace {

constexpr vadose::law::LinearElastic silt{.young_modulus = 10e6, .poisson_ratio = 0.15};

/// Principal values, largest first, from the trigonometric closed form.
template <int N>
std::array<Real, 3> principal(const Tensor<N>& t) {
  if constexpr (N == 6) {
    const Tensor<6> s = t.deviator();
    const Real j2 = 0.5 * contract(s, s);
    const Real j3 = s[0] * (s[1] * s[2] - s[4] * s[4]) - s[3] * (s[3] * s[2] - s[4] * s[5]) +
                    s[5] * (s[3] * s[4] - s[1] * s[5]);
    const Real radius = 2 * std::sqrt(j2 / 3);
    const Real ratio = j2 > 0 ? std::clamp(4 * j3 / (radius * radius * radius), -1.0, 1.0) : 0;
    const Real angle = std::acos(ratio) / 3, third = 2 * std::numbers::pi / 3;
    return {t.mean() + radius * std::cos(angle), t.mean() + radius * std::cos(angle - third),
            t.mean() + radius * std::cos(angle + third)};
  } else {
    const Real shear = N == 4 ? t[N - 1] : 0;
    const Real centre = 0.5 * (t[0] + t[1]), radius = std::hypot(0.5 * (t[0] - t[1]), shear);
    std::array<Real, 3> s = {centre + radius, centre - radius, t[2]};
    std::sort(s.begin(), s.end(), [](Real a, Real b) { return a > b; });
    return s;
  }
}

template <int N>
Real yield(const MohrCoulomb& law, const Tensor<N>& stress) {
  const auto s = principal(stress);
  return 0.5 * (s[0] - s[2]) + 0.5 * (s[0] + s[2]) * std::sin(law.friction_angle) -
         law.cohesion * std::cos(law.friction_angle);
}

/// Stress at the end of a drained triaxial test at constant cell pressure, N = 6.
Tensor<6> triaxial(const MohrCoulomb& law, Real cell, Real axial_strain, int steps,
                   Real& volume_strain) {
  const Real d = axial_strain / steps;
  MohrCoulomb::State<Real> state;
  Tensor<6> stress;
  stress.add_isotropic(-cell);
  volume_strain = 0;
  for (int i = 0; i < steps; ++i) {
    Tensor<6> strain;
    const auto miss = [&](Real lateral) {
      strain[0] = strain[2] = lateral;
      strain[1] = d;
      return after<6>(law, strain, stress)[0] + cell;
    };
    Real a = 0, b = -d, fa = miss(a), fb = miss(b);
    for (int k = 0; k < 60 && std::abs(fb) > 1e-7 && fa != fb; ++k) {
      const Real c = b - fb * (b - a) / (fb - fa);
      a = b, fa = fb, b = c, fb = miss(c);
    }
    miss(b);
    stress = after<6>(law, strain, stress, state);
    volume_strain += strain.trace();
  }
  return stress;
}

std::vector<MohrCoulomb> all_kinds() {
  std::vector<MohrCoulomb> laws;
  for (const Real phi : {0.0, 20.0, 35.0, 47.0})
    for (const Real psi : {-5.0, 0.0, 14.0, 35.0})
      for (const Real cut_off : {vadose::law::no_cut_off, 2e3, 0.0})
        if (psi <= phi)
          laws.push_back({.elastic = silt,
                          .cohesion = 8e3,
                          .friction_angle = vadose::degrees(phi),
                          .dilation_angle = vadose::degrees(psi),
                          .tensile_strength = cut_off});
  return laws;
}

/// (trial - end) : C^-1 : (other - end) for plastic flow in principal directions.
Real work(const std::array<Real, 3>& flow, const std::array<Real, 3>& difference) {
  return flow[0] * difference[0] + flow[1] * difference[1] + flow[2] * difference[2];
}

}  // namespace

TEST_CASE("Mohr-Coulomb: drained triaxial tests of the Anura3D manual") {
  Real volume = 0;
  const MohrCoulomb loose{.elastic = silt, .cohesion = 5e3, .friction_angle = vadose::degrees(35)};
  Tensor<6> end = triaxial(loose, 50e3, -0.10, 100, volume);
  CHECK(end[1] == doctest::Approx(-203.718e3).epsilon(3e-6));
  CHECK(end[0] == doctest::Approx(-50e3).epsilon(1e-9));
  CHECK(end[2] == doctest::Approx(-50e3).epsilon(1e-9));
  const MohrCoulomb dense{.elastic = silt,
                          .cohesion = 3e3,
                          .friction_angle = vadose::degrees(47),
                          .dilation_angle = vadose::degrees(14)};
  end = triaxial(dense, 50e3, -0.10, 100, volume);
  CHECK(end[1] == doctest::Approx(-337.469e3).epsilon(3e-6));
  // Elastic volume change, then dilation 2 sin(psi) / (1 - sin(psi)) per axial compression.
  const Real yield_strain = 287.469e3 / 10e6, sine = std::sin(vadose::degrees(14));
  CHECK(volume == doctest::Approx(-(1 - 2 * 0.15) * yield_strain +
                                  (0.10 - yield_strain) * 2 * sine / (1 - sine))
                      .epsilon(1e-5));
}

TEST_CASE("Mohr-Coulomb: triaxial extension, closed form") {
  Real volume = 0;
  for (const Real psi : {-5.0, 0.0, 14.0}) {
    const MohrCoulomb law{.elastic = silt,
                          .cohesion = 5e3,
                          .friction_angle = vadose::degrees(35),
                          .dilation_angle = vadose::degrees(psi)};
    const Tensor<6> end = triaxial(law, 100e3, 0.03, 60, volume);
    const Real passive = (1 + std::sin(vadose::degrees(35))) / (1 - std::sin(vadose::degrees(35)));
    CHECK(end[1] ==
          doctest::Approx(-(100e3 - 2 * 5e3 * std::sqrt(passive)) / passive).epsilon(1e-8));
  }
}

TEST_CASE_TEMPLATE("Mohr-Coulomb: admissible after every return, flow normal to the potential",
                   Size, std::integral_constant<int, 3>, std::integral_constant<int, 4>,
                   std::integral_constant<int, 6>) {
  constexpr int N = Size::value;
  Random random(21);
  int plastic = 0;
  for (const MohrCoulomb& law : all_kinds()) {
    const Real sin_phi = std::sin(law.friction_angle), sin_psi = std::sin(law.dilation_angle);
    const Real apex = law.cohesion * std::cos(law.friction_angle) / std::max(sin_phi, 1e-30);
    const Real limit = std::min(apex, law.tensile_strength);
    for (int i = 0; i < 200; ++i) {
      Tensor<N> trial = random.tensor<N>(60e3);
      trial.add_isotropic(random(-90e3, 30e3));
      if (i % 10 == 0) trial[0] = trial[1];  // equal principal values
      MohrCoulomb::State<Real> state;
      const Tensor<N> end = after<N>(law, Tensor<N>{}, trial, state);
      const Real scale = largest(trial);
      REQUIRE(vadose::is_finite(end[0]));
      CHECK(yield(law, end) <= 1e-10 * scale + (N == 6 ? 1e-7 * scale : 0));
      CHECK(end.mean() <= limit + 1e-10 * scale);
      if (yield(law, trial) < -1e-6 * scale && trial.mean() < limit)
        CHECK(distance(end, trial) == 0);
      const Tensor<N> flow = elastic_strain(silt, trial - end);
      const Real shear = std::sqrt(2.0) * flow.deviator().norm();
      CHECK(std::abs(shear - state.plastic_shear_strain) <= 1e-12);
      plastic += shear > 1e-9;
      if (law.dilation_angle >= 0) CHECK(contract(end, flow) >= -1e-9 * scale * (shear + 1e-9));
      // Every neighbour at which no active potential is larger: flow : (other - end) <= 0. Stress
      // and flow share their directions, so principal values in the same order will do.
      const auto e = principal(end), t = principal(trial);
      std::array<Real, 3> f{};
      const Real mean_change = (t[0] + t[1] + t[2] - e[0] - e[1] - e[2]) / 3;
      for (std::size_t k = 0; k < 3; ++k)
        f[k] = (t[k] - e[k] - mean_change) / (2 * silt.shear_modulus()) +
               mean_change / (3 * silt.bulk_modulus());
      for (int k = 0; k < 40; ++k) {
        const std::array<Real, 3> d = {random(-1, 1), random(-1, 1), random(-1, 1)};
        bool inside = true;
        for (std::size_t a = 0; a < 3; ++a)
          for (std::size_t b = 0; b < 3; ++b) {
            if (a == b) continue;
            const Real value = (1 + sin_phi) * e[a] - (1 - sin_phi) * e[b] -
                               2 * law.cohesion * std::cos(law.friction_angle);
            if (value > -1e-6 * scale)
              inside = inside && (1 + sin_psi) * d[a] - (1 - sin_psi) * d[b] <= 0;
          }
        if (end.mean() > limit - 1e-9 * scale) inside = inside && d[0] + d[1] + d[2] <= 0;
        const Real flow_size = std::abs(f[0]) + std::abs(f[1]) + std::abs(f[2]);
        if (inside) CHECK(work(f, d) <= 1e-5 * flow_size + 1e-12);
      }
    }
  }
  CHECK(plastic > 2000);
}

TEST_CASE("Mohr-Coulomb: apex and cut-off") {
  MohrCoulomb law{.elastic = silt, .cohesion = 5e3, .friction_angle = vadose::degrees(30)};
  Tensor<6> trial;
  trial[0] = 40e3, trial[1] = 25e3, trial[2] = 30e3, trial[4] = 6e3;
  Tensor<6> end = after<6>(law, Tensor<6>{}, trial);
  CHECK(end.mean() == doctest::Approx(5e3 / std::tan(vadose::degrees(30))).epsilon(1e-12));
  CHECK(end.deviator().norm() < 1e-6);
  law.cohesion = 0;
  end = after<6>(law, Tensor<6>{}, trial);
  CHECK(largest(end) < 1e-6);
  law.cohesion = 5e3;
  law.tensile_strength = 1e3;
  end = after<6>(law, Tensor<6>{}, trial);
  CHECK(end.mean() == doctest::Approx(1e3).epsilon(1e-10));
  CHECK(std::abs(yield(law, end)) < 1e-3);
}

TEST_CASE("Mohr-Coulomb: orientation does not matter, 3, 4 and 6 components agree") {
  Random random(23);
  for (const MohrCoulomb& law : all_kinds())
    for (int i = 0; i < 20; ++i) {
      Tensor<6> stress, strain;
      for (int k = 0; k < 3; ++k) stress[k] = random(-90e3, 20e3), strain[k] = random(-0.01, 0.01);
      if (i % 4 == 0) stress[1] = stress[0], strain[1] = strain[0];
      const Tensor<6> end = after<6>(law, strain, stress);
      CHECK(distance(after<3>(law, reduced<3>(strain), reduced<3>(stress)), reduced<3>(end)) <
            1e-9);
      const Rotation r = random_rotation(random);
      CHECK(distance(after<6>(law, rotated(r, strain), rotated(r, stress)), rotated(r, end)) <
            1e-6);
      stress[3] = 7e3, strain[3] = 3e-3;
      CHECK(distance(after<4>(law, reduced<4>(strain), reduced<4>(stress)),
                     reduced<4>(after<6>(law, strain, stress))) < 1e-6);
    }
}

TEST_CASE_TEMPLATE("Mohr-Coulomb: lanes equal numbers", Size, std::integral_constant<int, 3>,
                   std::integral_constant<int, 4>, std::integral_constant<int, 6>) {
  Random random(25);
  for (const MohrCoulomb& law : all_kinds())
    for (int i = 0; i < 20; ++i) {
      CHECK(lanes_against_numbers<Size::value>(law, random, 60e3, 0.01, 1) < 1e-12);
      CHECK(lanes_against_numbers<Size::value>(law.prepared(), random, 60e3, 1e-3, 1) < 1e-12);
    }
}

TEST_CASE("Principal stresses: values and directions, also when they coincide") {
  Random random(27);
  for (int i = 0; i < 500; ++i) {
    const Real gap = i % 3 == 0 ? 0 : i % 3 == 1 ? 1e-9 : 1;
    Tensor<6> diagonal;
    diagonal[0] = 1e5, diagonal[1] = 1e5 * (1 + gap), diagonal[2] = i % 2 == 0 ? 1e5 : -3e4;
    const Tensor<6> t = rotated(random_rotation(random), diagonal);
    const vadose::law::detail::PrincipalStress<Real, 6> p(t);
    std::array<Real, 3> found = {p[0], p[1], p[2]};
    std::array<Real, 3> exact = {diagonal[0], diagonal[1], diagonal[2]};
    std::sort(found.begin(), found.end());
    std::sort(exact.begin(), exact.end());
    for (std::size_t k = 0; k < 3; ++k) CHECK(std::abs(found[k] - exact[k]) < 1e-9);
    Tensor<6> again;
    const Real values[3] = {p[0], p[1], p[2]};
    p.add(values, again);
    CHECK(distance(again, t) < 1e-9);
  }
  const vadose::law::detail::PrincipalStress<Real, 6> none(Tensor<6>{});
  CHECK(none[0] == 0);
}

TEST_CASE("Mohr-Coulomb: set-up errors name the parameter") {
  const MohrCoulomb good{.elastic = silt, .friction_angle = vadose::degrees(30)};
  CHECK(complaint(good) == "accepted");
  const auto changed = [&](auto change) {
    MohrCoulomb law = good;
    change(law);
    return complaint(law);
  };
  CHECK(contains(complaint(MohrCoulomb{.elastic = silt}), "friction_angle = nan"));
  CHECK(contains(changed([](auto& l) { l.friction_angle = vadose::degrees(90); }),
                 "friction_angle = 1.57079633 outside [0, pi/2) [rad]"));
  CHECK(contains(changed([](auto& l) { l.friction_angle = 0; }), "cohesion is 0"));
  CHECK(contains(changed([](auto& l) { l.cohesion = vadose::unset; }), "cohesion = nan"));
  CHECK(contains(changed([](auto& l) { l.dilation_angle = 0.6; }), "dilation_angle = 0.6"));
  CHECK(contains(changed([](auto& l) { l.tensile_strength = -1; }), "tensile_strength = -1"));
  CHECK(contains(changed([](auto& l) { l.elastic.young_modulus = -1; }), "young_modulus = -1"));
  CHECK(contains(changed([](auto& l) {
                   l.elastic.poisson_ratio = 0.499;
                   l.dilation_angle = vadose::degrees(-10);
                 }),
                 "dilation_angle = -0.174532925"));
}
