// SPDX-License-Identifier: MIT
#include <doctest/doctest.h>

#include "../../examples/laws/von_mises.hpp"
#include "laws_support.hpp"

using namespace laws_test;
using namespace vadose::law;
using vadose::ConstitutiveLaw;
using vadose::Status;

namespace {

/// The user's VonMises written once for numbers and lanes.
struct LaneVonMises {
  LinearElastic elastic;
  Real undrained_strength = vadose::unset;
  template <class T>
  struct State {
    T plastic_shear_strain{0.0};
  };
  void validate() const {}
  Real p_wave_modulus(const State<Real>&) const noexcept { return elastic.p_wave_modulus(); }
  template <class T, int N>
  Status update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                State<T>& state) const noexcept {
    using vadose::max;  // for T = Real; lanes bring their own
    LinearElastic::State<T> none;
    elastic.update(step, stress, none);
    const auto s = stress.deviator();
    const T norm = s.norm(), limit(std::numbers::sqrt2 * undrained_strength);
    const T excess = max(norm - limit, T(0.0));
    state.plastic_shear_strain += excess * T(1 / (std::numbers::sqrt2 * elastic.shear_modulus()));
    stress -= (excess / max(norm, T(1e-300))) * s;
    return Status::ok;
  }
};

/// A template law with ordinary branches, two numbers of state and a state at the start; it
/// refuses large strains.
struct Branching {
  static constexpr bool scalar_only = true;
  template <class T>
  struct State {
    T largest_strain{0.0};
    T steps{0.0};
  };
  static constexpr std::array<StateOutput, 2> outputs() noexcept {
    return {{{"largest_strain", "-", 0}, {"steps", "-", 1}}};
  }
  State<Real> initial_state() const noexcept { return {0.25, 3}; }
  void validate() const {}
  Real p_wave_modulus(const State<Real>& state) const noexcept { return 1e6 * state.steps; }
  template <class T, int N>
  Status update(const StrainStep<T, N>& step, SymTensor<T, N>& stress,
                State<T>& state) const noexcept {
    state.steps += 1;
    if (step.increment[0] > state.largest_strain) state.largest_strain = step.increment[0];
    if (step.increment[0] > 0.5) return Status::failed;
    stress[0] += step.dt;
    return Status::ok;
  }
};

struct NoModulus {
  struct State {};
  void validate() const {}
  template <class T, int N>
  Status update(const StrainStep<T, N>&, SymTensor<T, N>&, State&) const noexcept {
    return Status::ok;
  }
};

struct TextState {
  struct State {
    std::string text;
  };
};

template <class L>
constexpr bool complete = ConstitutiveLaw<L, 3>&& ConstitutiveLaw<L, 4>&& ConstitutiveLaw<L, 6>;
template <class L>
constexpr bool on_lanes = LaneLaw<L, 3>&& LaneLaw<L, 4>&& LaneLaw<L, 6>;

static_assert(complete<Rigid> && on_lanes<Rigid> && state_size<Rigid> == 0 && RigidLaw<Rigid>);
static_assert(complete<LinearElastic> && on_lanes<LinearElastic> && state_size<LinearElastic> == 0);
static_assert(complete<DruckerPrager> && on_lanes<DruckerPrager> && state_size<DruckerPrager> == 1);
static_assert(complete<MohrCoulomb> && on_lanes<MohrCoulomb> && state_size<MohrCoulomb> == 1);
static_assert(on_lanes<DruckerPrager::Prepared> && on_lanes<MohrCoulomb::Prepared>);
static_assert(complete<VonMises> && !on_lanes<VonMises> && state_size<VonMises> == 1);
static_assert(complete<LaneVonMises> && on_lanes<LaneVonMises>);
static_assert(complete<Branching> && !on_lanes<Branching> && state_size<Branching> == 2);
static_assert(HasState<NoModulus> && HasUpdate<NoModulus, 4> && HasValidate<NoModulus>);
static_assert(!HasModulus<NoModulus> && !complete<NoModulus> && LaneLaw<NoModulus, 4>);
static_assert(!HasState<TextState> && !HasState<int> && !complete<int>);
static_assert(std::is_empty_v<StateOf<LinearElastic, Lanes>>);
static_assert(sizeof(StateOf<DruckerPrager, Lanes>) == sizeof(Lanes));
static_assert(vadose::LiquidLaw<InviscidWater, 4> && vadose::LiquidLaw<NewtonianFluid, 6>);
static_assert(!vadose::LiquidLaw<LinearElastic, 4>);
static_assert(std::is_trivially_copyable_v<DruckerPrager> && std::is_aggregate_v<DruckerPrager>);
static_assert(std::is_same_v<PreparedOf<LinearElastic>, LinearElastic>);
static_assert(std::is_same_v<PreparedOf<DruckerPrager>, DruckerPrager::Prepared>);

using Soil = OneOf<LinearElastic, DruckerPrager, MohrCoulomb>;
using Mixed = OneOf<DruckerPrager, Branching, VonMises, LinearElastic>;
static_assert(complete<Soil> && on_lanes<Soil> && state_size<Soil> == 1);
static_assert(complete<Mixed> && on_lanes<Mixed> && state_size<Mixed> == 2);
static_assert(state_size<OneOf<LinearElastic>> == 0 && complete<OneOf<LinearElastic>>);
static_assert(outputs<Soil>().size() == 1 && outputs<Soil>()[0].index == 0);
static_assert(outputs<Mixed>().empty() && outputs<LinearElastic>().empty());
static_assert(outputs<Branching>().size() == 2);

constexpr LinearElastic ground{.young_modulus = 20e6, .poisson_ratio = 0.3};

}  // namespace

TEST_CASE_TEMPLATE("Linear elasticity: the tangent is the elastic stiffness", Size,
                   std::integral_constant<int, 3>, std::integral_constant<int, 4>,
                   std::integral_constant<int, 6>) {
  constexpr int N = Size::value;
  const Real lame = ground.bulk_modulus() - 2 * ground.shear_modulus() / 3;
  Random random(1);
  const Tensor<N> stress = random.tensor<N>(100e3), strain = random.tensor<N>(1e-3);
  for (int j = 0; j < N; ++j) {
    const Real h = 1e-4;
    Tensor<N> forward = strain, backward = strain;
    forward[j] += h, backward[j] -= h;
    const Tensor<N> slope =
        (1 / (2 * h)) * (after<N>(ground, forward, stress) - after<N>(ground, backward, stress));
    for (int i = 0; i < N; ++i) {
      const Real exact = (i == j ? 2 * ground.shear_modulus() : 0) + (i < 3 && j < 3 ? lame : 0);
      CHECK(std::abs(slope[i] - exact) < 1e-9 * ground.young_modulus);
    }
  }
}

TEST_CASE("Linear elasticity: moduli and closed forms") {
  CHECK(ground.p_wave_modulus({}) == doctest::Approx(20e6 * 0.7 / (1.3 * 0.4)).epsilon(1e-14));
  CHECK(ground.p_wave_modulus() == ground.p_wave_modulus({}));
  Tensor<3> oedometer;
  oedometer[1] = -0.01;
  const Tensor<3> confined = after<3>(ground, oedometer, {});
  CHECK(confined[1] == doctest::Approx(-0.01 * ground.p_wave_modulus()).epsilon(1e-14));
  CHECK(confined[0] == doctest::Approx(confined[1] * 0.3 / 0.7).epsilon(1e-14));
  Tensor<6> free;  // drained triaxial, LITERATURE 2.7: E = 10 MPa, cell 50 kPa, 10 % axial
  const LinearElastic manual{.young_modulus = 10e6, .poisson_ratio = 0.25};
  free[1] = -0.1, free[0] = free[2] = 0.025;
  Tensor<6> start;
  start.add_isotropic(-50e3);
  const Tensor<6> end = after<6>(manual, free, start);
  CHECK(end[1] == doctest::Approx(-1050e3).epsilon(1e-13));
  CHECK(end[0] == doctest::Approx(-50e3).epsilon(1e-9));
}

TEST_CASE("Elasticity, liquids: set-up errors name the parameter") {
  CHECK(complaint(ground) == "accepted");
  CHECK(contains(complaint(LinearElastic{}), "young_modulus = nan (missing or not finite)"));
  CHECK(contains(complaint(LinearElastic{.young_modulus = 1e6}), "poisson_ratio = nan"));
  CHECK(contains(complaint(LinearElastic{0, 0.3}), "young_modulus = 0 outside (0, inf) [Pa]"));
  CHECK(contains(complaint(LinearElastic{1e6, 0.5}), "poisson_ratio = 0.5 outside (-1, 0.5) [-]"));
  CHECK(contains(complaint(LinearElastic{1e6, -1}), "poisson_ratio = -1"));
  CHECK(contains(complaint(LinearElastic{std::numeric_limits<Real>::infinity(), 0.3}),
                 "young_modulus = inf"));
  CHECK(contains(complaint(NewtonianFluid{}), "dynamic_viscosity = nan"));
  CHECK(contains(complaint(NewtonianFluid{0}), "dynamic_viscosity = 0 outside (0, inf) [Pa s]"));
  CHECK(complaint(NewtonianFluid{1e-3}) == "accepted");
  CHECK(complaint(InviscidWater{}) == "accepted");
  CHECK(complaint(Rigid{}) == "accepted");
}

TEST_CASE("Rigid: the stress stays") {
  Random random(2);
  const Tensor<4> stress = random.tensor<4>(1e5);
  CHECK(distance(after<4>(Rigid{}, random.tensor<4>(0.1), stress), stress) == 0);
  CHECK(Rigid{}.p_wave_modulus({}) == 0);
}

TEST_CASE("Newtonian fluid: deviatoric stress of the rate") {
  const NewtonianFluid fluid{.dynamic_viscosity = 2.5};
  Tensor<4> rate;
  rate[0] = 3, rate[1] = 1, rate[2] = -1, rate[3] = 0.7;
  const Tensor<4> stress = fluid.viscous_stress(rate);
  CHECK(std::abs(stress.trace()) < 1e-14);
  CHECK(stress[0] == doctest::Approx(10.0));
  CHECK(stress[1] == doctest::Approx(0.0));
  CHECK(stress[3] == doctest::Approx(3.5));  // mu times the engineering rate 1.4
  SymTensor<Lanes, 4> lanes;
  for (int i = 0; i < 4; ++i) lanes[i] = Lanes(rate[i]);
  CHECK(fluid.viscous_stress(lanes)[3][5] == doctest::Approx(3.5));
}

TEST_CASE_TEMPLATE("Adapter: a plain-double law runs like its twin on lanes", Size,
                   std::integral_constant<int, 3>, std::integral_constant<int, 4>,
                   std::integral_constant<int, 6>) {
  constexpr int N = Size::value;
  const VonMises plain{.elastic = ground, .undrained_strength = 30e3};
  const LaneVonMises twin{.elastic = ground, .undrained_strength = 30e3};
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    CHECK(lanes_against_numbers<N>(plain, random, 60e3, 0.004, 0.1) < 1e-14);
    CHECK(lanes_against_numbers<N>(twin, random, 60e3, 0.004, 0.1) < 1e-13);
    const Tensor<N> strain = random.tensor<N>(0.004), stress = random.tensor<N>(50e3);
    VonMises::State a;
    LaneVonMises::State<Real> b;
    const Tensor<N> end = after<N>(plain, strain, stress, a);
    CHECK(distance(end, after<N>(twin, strain, stress, b)) < 1e-9);
    CHECK(std::abs(a.plastic_shear_strain - b.plastic_shear_strain) < 1e-15);
    CHECK(end.deviator().norm() <= std::sqrt(2.0) * 30e3 * (1 + 1e-14));
  }
}

TEST_CASE("Adapter: scalar_only, two numbers of state, failure of one lane") {
  const Branching law;
  const auto start = initial_state(law);
  CHECK(start[0] == 0.25);
  CHECK(start[1] == 3);
  CHECK(p_wave_modulus(law, start.data()) == 3e6);
  CHECK(initial_state(DruckerPrager{})[0] == 0);
  StrainStep<Lanes, 4> step;
  step.dt = 2;
  for (int lane = 0; lane < vadose::lane_count; ++lane)
    step.increment[0].set(lane, 0.05 * (lane + 1));
  SymTensor<Lanes, 4> stress;
  Lanes state[2] = {Lanes(start[0]), Lanes(start[1])};
  CHECK(apply(law, step, stress, state) == Status::ok);
  for (int lane = 0; lane < vadose::lane_count; ++lane) {
    CHECK(stress[0][lane] == 2);
    CHECK(state[0][lane] == std::max(0.25, 0.05 * (lane + 1)));
    CHECK(state[1][lane] == 4);
  }
  step.increment[0].set(6, 0.9);
  CHECK(apply(law, step, stress, state) == Status::failed);
}

TEST_CASE("OneOf: the chosen law, number by number and lane by lane") {
  const DruckerPrager sand{.elastic = ground, .friction_angle = vadose::degrees(30)};
  const MohrCoulomb rock{.elastic = ground, .cohesion = 5e3, .friction_angle = vadose::degrees(40)};
  const Soil soils[3] = {ground, sand, rock};
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Tensor<6> strain = random.tensor<6>(0.004), stress = random.tensor<6>(50e3);
    CHECK(distance(after<6>(soils[0], strain, stress), after<6>(ground, strain, stress)) < 1e-9);
    Soil::State<Real> state;
    DruckerPrager::State<Real> own;
    CHECK(distance(after<6>(soils[1], strain, stress, state), after<6>(sand, strain, stress, own)) <
          1e-9);
    CHECK(std::abs(state.number[0] - own.plastic_shear_strain) < 1e-15);
    CHECK(distance(after<6>(soils[2], strain, stress), after<6>(rock, strain, stress)) < 1e-9);
    for (const Soil& soil : soils) {
      CHECK(lanes_against_numbers<4>(soil, random, 60e3, 0.004, 0.1) < 1e-12);
      CHECK(lanes_against_numbers<4>(soil.prepared(), random, 60e3, 0.004, 0.1) < 1e-12);
    }
    const Mixed user = VonMises{.elastic = ground, .undrained_strength = 30e3};
    CHECK(lanes_against_numbers<6>(user, random, 60e3, 0.004, 0.1) < 1e-12);
  }
  CHECK(soils[1].index() == 1);
  CHECK(soils[1].get_if<DruckerPrager>()->friction_angle == sand.friction_angle);
  CHECK(soils[1].get_if<MohrCoulomb>() == nullptr);
}

TEST_CASE("OneOf: modulus, start and checks are those of the chosen law") {
  const Mixed branching = Branching{};
  const auto start = initial_state(branching);
  CHECK(start[0] == 0.25);
  CHECK(start[1] == 3);
  CHECK(p_wave_modulus(branching, start.data()) == 3e6);
  CHECK(contains(complaint(Mixed{}), "young_modulus = nan"));
  const Mixed elastic = ground;
  CHECK(complaint(elastic) == "accepted");
  CHECK(initial_state(elastic)[1] == 0);
  CHECK(elastic.p_wave_modulus({}) == ground.p_wave_modulus());
  CHECK(contains(complaint(Mixed(VonMises{.elastic = ground})), "undrained_strength = nan"));
}
