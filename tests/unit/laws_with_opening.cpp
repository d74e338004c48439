// SPDX-License-Identifier: MIT

// Soil that is pulled apart and pressed together again.

#include <doctest/doctest.h>

#include <vadose/testing/check_law.hpp>

#include "laws_support.hpp"

namespace {

using namespace laws_test;
using vadose::law::DruckerPrager;
using vadose::law::LinearElastic;
using vadose::law::MohrCoulomb;
using vadose::law::WithOpening;

constexpr LinearElastic ground{.young_modulus = 10e6, .poisson_ratio = 0.3};

/// Sand without cohesion; with both laws.
template <class L>
L sand(Real cohesion = 0, Real dilation = 0) {
  return {.elastic = ground,
          .cohesion = cohesion,
          .friction_angle = vadose::degrees(30),
          .dilation_angle = vadose::degrees(dilation)};
}
template <class L>
WithOpening<L> remembering(const L& law) {
  return {law};
}

template <int N>
Tensor<N> volume_strain(Real strain) {
  Tensor<N> t;
  for (int i = 0; i < 3; ++i) t[i] = strain / 3;
  return t;
}

template <int N, class L>
void check_pulled_apart(const L& plain) {
  const auto law = remembering(plain);
  Tensor<N> stress, torn;
  stress.add_isotropic(-20e3);
  const Tensor<N> start = stress;
  typename WithOpening<L>::template State<Real> state;
  typename L::template State<Real> forgetful;
  for (int cycle = 0; cycle < 5; ++cycle) {
    for (int i = 0; i < 10; ++i) stress = after<N>(law, volume_strain<N>(0.03), stress, state);
    CHECK(std::abs(stress.mean()) < 1e-9);
    CHECK(state.opening == doctest::Approx(0.3 - 20e3 / ground.bulk_modulus()));
    Tensor<N> shear;  // of grains that do not touch
    shear[0] = 0.01, shear[1] = -0.01;
    const Tensor<N> sheared = after<N>(law, shear, stress, state);
    CHECK(largest(sheared) < 1e-9);
    CHECK(state.opening == doctest::Approx(0.3 - 20e3 / ground.bulk_modulus()));
    stress = sheared;
    for (int i = 0; i < 10; ++i) {
      CHECK(std::abs(stress.mean()) < 1e-9);
      stress = after<N>(law, volume_strain<N>(-0.03), stress, state);
    }
    CHECK(largest(Tensor<N>(stress - start)) < 1e-6);
    CHECK(state.opening == 0);
    // Without memory the first strain back is carried already.
    torn = after<N>(plain, volume_strain<N>(0.3), torn, forgetful);
    torn = after<N>(plain, volume_strain<N>(-0.3), torn, forgetful);
    CHECK(torn.mean() == doctest::Approx(-0.3 * ground.bulk_modulus()));
  }
}

/// A law of one's own: its history does not start at 0, it has no shear_modulus, and nothing is prepared.
struct Crumbling {
  template <class T>
  struct State {
    T age{0.0};
  };
  void validate() const { ground.validate(); }
  Real p_wave_modulus(const State<Real>&) const noexcept { return ground.p_wave_modulus(); }
  State<Real> initial_state() const noexcept { return {7}; }
  template <class T, int N>
  vadose::Status update(const StrainStep<T, N>& step, Tensor<N>& stress, State<T>& state,
                        T& opening) const noexcept {
    LinearElastic::State<T> none;
    ground.update(step, stress, none);
    opening = std::max(stress.mean(), 0.0) / ground.bulk_modulus();
    stress.add_isotropic(-opening * ground.bulk_modulus());
    state.age += 1;
    return vadose::Status::ok;
  }
};

/// Where the cut-off does not act the law is the law.
template <int N, class L>
void check_in_contact(const L& plain) {
  const auto law = remembering(plain);
  Random random(7);
  Tensor<N> a, b;
  a.add_isotropic(-200e3);
  b = a;
  typename WithOpening<L>::template State<Real> state;
  typename L::template State<Real> own;
  int yielded = 0;
  for (int i = 0; i < 200; ++i) {
    Tensor<N> strain = random.tensor<N>(4e-3);
    strain.add_isotropic(-strain.trace() / 3 - 1e-6);
    a = after<N>(law, strain, a, state);
    b = after<N>(plain, strain, b, own);
    CHECK(largest(Tensor<N>(a - b)) == 0);
    CHECK(state.opening == 0);
    yielded += own.plastic_shear_strain > 0;
  }
  CHECK(state.base.plastic_shear_strain == own.plastic_shear_strain);
  CHECK(yielded > 100);
}

}  // namespace

TEST_CASE("WithOpening: torn soil carries nothing until its grains are back") {
  check_pulled_apart<6>(sand<DruckerPrager>());
  check_pulled_apart<4>(sand<DruckerPrager>());
  check_pulled_apart<3>(sand<MohrCoulomb>());
  check_pulled_apart<6>(sand<MohrCoulomb>());
  check_pulled_apart<6>(sand<DruckerPrager>(0, 10));
  check_pulled_apart<4>(sand<MohrCoulomb>(0, 10));
}

TEST_CASE("WithOpening: in contact the law is the law, to the last bit") {
  check_in_contact<4>(sand<DruckerPrager>(1e3));
  check_in_contact<6>(sand<DruckerPrager>(1e3, 5));
  check_in_contact<6>(sand<MohrCoulomb>(1e3));
}

TEST_CASE("WithOpening: soil with cohesion opens at its cut-off and carries it while open") {
  DruckerPrager clay = sand<DruckerPrager>(10e3);
  clay.tensile_strength = 4e3;
  const auto law = remembering(clay);
  WithOpening<DruckerPrager>::State<Real> state;
  Tensor<4> stress = after<4>(law, volume_strain<4>(0.01), Tensor<4>{}, state);
  CHECK(stress.mean() == doctest::Approx(4e3));
  CHECK(state.opening == doctest::Approx(0.01 - 4e3 / ground.bulk_modulus()));
  stress = after<4>(law, volume_strain<4>(-0.005), stress, state);
  CHECK(stress.mean() == doctest::Approx(4e3));
  stress = after<4>(law, volume_strain<4>(-0.006), stress, state);
  CHECK(stress.mean() == doctest::Approx(-0.001 * ground.bulk_modulus()));
  CHECK(state.opening == 0);
}

TEST_CASE("WithOpening: a law of one's own starts with its own state, closed") {
  const WithOpening<Crumbling> law;
  const auto start = vadose::law::initial_state(law);
  REQUIRE(start.size() == 2);
  CHECK(start[0] == 7);
  CHECK(start[1] == 0);
  CHECK(vadose::law::shear_modulus(law, start.data()) == 0.3 * ground.p_wave_modulus());
  auto state = law.initial_state();
  Tensor<3> stress = after<3>(law, volume_strain<3>(0.01), Tensor<3>{}, state);
  CHECK(stress.mean() == doctest::Approx(0).epsilon(1e-9));
  CHECK(state.opening == doctest::Approx(0.01));
  stress = after<3>(law, volume_strain<3>(-0.011), stress, state);
  CHECK(stress.mean() == doctest::Approx(-0.001 * ground.bulk_modulus()));
  CHECK(state.base.age == 9);
}

TEST_CASE("WithOpening: strength that shear mobilises") {
  DruckerPrager soil = sand<DruckerPrager>();
  soil.dilation_angle = vadose::degrees(5);
  soil.mobilisation = {.peak_shear_strain = 0.02,
                       .critical_shear_strain = 0.1,
                       .onset = {.friction_angle = vadose::degrees(20)},
                       .critical = {.friction_angle = vadose::degrees(25)}};
  soil.validate();
  check_pulled_apart<4>(soil);
}

TEST_CASE("WithOpening: lanes, outputs, contract") {
  const auto law = remembering(sand<DruckerPrager>(2e3));
  const auto rock = remembering(sand<MohrCoulomb>(2e3));
  Random random(8);
  for (int i = 0; i < 50; ++i) {
    CHECK(lanes_against_numbers<4>(law, random, 60e3, 0.004, 0.01) < 1e-12);
    CHECK(lanes_against_numbers<6>(law.prepared(), random, 60e3, 0.004, 0.01) < 1e-12);
    CHECK(lanes_against_numbers<6>(rock, random, 60e3, 0.004, 0.01) < 1e-12);
  }
  constexpr auto outputs = vadose::law::outputs<WithOpening<DruckerPrager>>();
  static_assert(outputs.size() == 2);
  CHECK(std::string(outputs[0].name) == "plastic_shear_strain");
  CHECK(outputs[0].index == 0);
  CHECK(std::string(outputs[1].name) == "opening");
  CHECK(outputs[1].index == 1);
  static_assert(vadose::law::state_size<WithOpening<DruckerPrager>> == 2);
  static_assert(vadose::ConstitutiveLaw<WithOpening<MohrCoulomb>, 3>);
  static_assert(vadose::law::RemembersOpening<WithOpening<DruckerPrager>>);
  static_assert(!vadose::law::RemembersOpening<DruckerPrager>);
  static_assert(
      vadose::law::RemembersOpening<vadose::law::OneOf<LinearElastic, WithOpening<MohrCoulomb>>>);
  WithOpening<DruckerPrager>::State<Real> state;
  CHECK(law.p_wave_modulus(state) == ground.p_wave_modulus());
  CHECK(law.shear_modulus(state) == ground.shear_modulus());
  CHECK(complaint(remembering(DruckerPrager{.elastic = ground})).find("friction_angle") !=
        std::string::npos);
  const auto report = vadose::testing::check_law(law);
  INFO(report.text());
  CHECK(report.ok());
}
