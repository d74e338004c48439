// SPDX-License-Identifier: MIT
// Models, materials, seeding and start values against closed forms.

#include <doctest/doctest.h>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <vadose/policy/drag/forchheimer.hpp>
#include <vadose/policy/law/drucker_prager.hpp>
#include <vadose/policy/shape/linear.hpp>
#include <vadose/policy/swrc/van_genuchten.hpp>
#include <vadose/scene/scene.hpp>

namespace {

using namespace vadose;

template <class K>
struct Sand : UnsaturatedModel<K> {};

/// [Zhan] Table 3.
template <class K>
Material<Sand<K>> sand() {
  return {.name = "sand",
          .solid_density = 2670,
          .porosity = 0.48,
          .lambda = 0.89,
          .skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.25},
          .retention = {.a = 1.2},
          .conductivity = {.saturated_conductivity = 2.77e-3}};
}

template <class K>
Material<DryModel<K>> grains(Real density = 2000, Real porosity = 0.5) {
  return {.solid_density = density,
          .porosity = porosity,
          .skeleton = {.young_modulus = 1e6, .poisson_ratio = 0.25}};
}

template <int Dim>
Real total_volume(const std::vector<SeedPoint<Dim>>& points) {
  Real sum = 0;
  for (const auto& p : points) sum += p.volume;
  return sum;
}

struct Bare {
  using Kinematics = PlaneStrain;
};

}  // namespace

// ---------------------------------------------------------------------------------------- models

static_assert(!has_liquid<DryModel<Uniaxial>> && has_skeleton<DryModel<Uniaxial>>);
static_assert(!is_unsaturated<DryModel<Uniaxial>> && !is_rigid<DryModel<Uniaxial>>);
static_assert(has_liquid<SaturatedModel<PlaneStrain>> &&
              !is_unsaturated<SaturatedModel<PlaneStrain>>);
static_assert(is_unsaturated<UnsaturatedModel<ThreeDimensional>>);
static_assert(has_liquid<FreeWaterModel<PlaneStrain>> &&
              !has_skeleton<FreeWaterModel<PlaneStrain>>);
static_assert(CheckModel<DryModel<Uniaxial>>::ok && CheckModel<SaturatedModel<Axisymmetric>>::ok &&
              CheckModel<UnsaturatedModel<ThreeDimensional>>::ok &&
              CheckModel<FreeWaterModel<PlaneStrain>>::ok);
static_assert(!requirement::NamesShape<Bare> && requirement::NamesKinematics<Bare>);

using Literal = PositionalModel<PlaneStrain, shape::Linear, law::DruckerPrager, swrc::VanGenuchten,
                                drag::Forchheimer>;
static_assert(CheckModel<Literal>::ok && is_unsaturated<Literal>);
static_assert(std::is_same_v<Literal::Shape, shape::Linear>);
static_assert(std::is_same_v<Literal::Drag, drag::Forchheimer>);
static_assert(std::is_same_v<Literal::Conductivity, conductivity::Mualem>);
static_assert(std::is_same_v<PositionalModel<PlaneStrain, shape::Linear, law::Rigid,
                                             swrc::AlwaysSaturated, drag::Darcy>::Conductivity,
                             conductivity::KozenyCarman>);

// Parts that a model has not take no room.
static_assert(sizeof(Material<DryModel<Uniaxial>>) ==
              sizeof(std::string) + 4 * sizeof(Real) + sizeof(law::LinearElastic));
static_assert(sizeof(Material<FreeWaterModel<Uniaxial>>) <= sizeof(std::string) + 5 * sizeof(Real));

// ------------------------------------------------------------------------------------- materials

TEST_CASE("scene: a material hands its shared numbers to the policies that state none") {
  Material<Sand<PlaneStrain>> m = sand<PlaneStrain>();
  const auto all = m.resolved(9810);
  CHECK(all.unit_weight == 9810);
  CHECK(all.retention.lambda == 0.89);
  CHECK(all.retention.unit_weight == 9810);
  CHECK(all.conductivity.lambda == 0.89);
  CHECK(all.conductivity.reference_porosity == 0.48);
  CHECK(m.retention.lambda != m.retention.lambda);  // the original is as written

  m.unit_weight = 9000;
  m.retention.lambda = 0.5;
  m.conductivity.reference_porosity = 0.3;
  const auto own = m.resolved(9810);
  CHECK(own.unit_weight == 9000);
  CHECK(own.retention.unit_weight == 9000);
  CHECK(own.retention.lambda == 0.5);
  CHECK(own.conductivity.lambda == 0.89);
  CHECK(own.conductivity.reference_porosity == 0.3);

  // the scene's default follows its liquid, not its gravity
  Scene<Sand<PlaneStrain>> scene{{.box = {{0, 0}, {1, 1}}, .cell_size = 0.5}};
  scene.gravity = {0, -30 * 9.81};
  scene.add_soil(box({0, 0}, {1, 1}), sand<PlaneStrain>(), {.suction = 9.2e3});
  scene.liquid.density = 1100;
  CHECK(scene.material(0).retention.unit_weight == doctest::Approx(9.81 * 1100));
  CHECK(scene.materials()[0].name == "sand");
}

TEST_CASE("scene: faces by dimension") {
  CHECK(axis(Face::bottom, 1) == 0);
  CHECK(axis(Face::left, 1) == -1);
  CHECK(axis(Face::left, 2) == 0);
  CHECK(axis(Face::top, 2) == 1);
  CHECK(axis(Face::front, 2) == -1);
  CHECK(axis(Face::back, 3) == 1);
  CHECK(axis(Face::top, 3) == 2);
  CHECK(axis(unset_face, 3) == -1);
  CHECK(side(Face::left) + side(Face::front) + side(Face::bottom) == 0);
  CHECK(side(Face::right) + side(Face::back) + side(Face::top) == 3);
  CHECK(std::string(name(Face::back)) == "back");
}

// --------------------------------------------------------------------------------------- seeding

TEST_CASE("scene: the lattice fills boxes exactly, in one to three dimensions") {
  const auto line = seed(box({0.2}, {0.8}), Vec<1>(0.0), 0.1, 3);
  REQUIRE(line.size() == 18);
  CHECK(line[0].position[0] == doctest::Approx(0.2 + 0.1 / 6));
  CHECK(line[0].volume == doctest::Approx(0.1 / 3));

  const auto square = seed(box({1, 1}, {2, 3}), Vec<2>(1, 1), 0.25, 2);
  REQUIRE(square.size() == 4 * 8 * 4);
  CHECK(square[1].position[0] > square[0].position[0]);  // x runs first
  CHECK(square[1].position[1] == square[0].position[1]);
  CHECK(total_volume(square) == doctest::Approx(2.0));

  const auto cube = seed(box({0, 0, 0}, {1, 1, 0.5}), Vec<3>(0, 0, 0), 0.5, 3);
  CHECK(cube.size() == 2 * 2 * 27);
  CHECK(total_volume(cube) == doctest::Approx(0.5));

  // far from the origin of the grid nothing is lost
  const auto far = seed(box({1000.0}, {1000.5}), Vec<1>(-7.0), 0.1, 2);
  CHECK(far.size() == 10);
  CHECK_THROWS_AS(seed(half_space({0.0}, {1.0}), Vec<1>(0.0), 0.1, 2), SetupError);
  CHECK_THROWS_AS(seed(box({0.0}, {1.0}), Vec<1>(0.0), 0.1, 0), SetupError);
}

TEST_CASE("scene: the volume of a disc converges with the cell size") {
  const auto disc =
      level_set([](const Vec<2>& x) { return x.norm() - 1; }, Box<2>{{-1.0, -1.0}, {1.0, 1.0}});
  for (const Real h : {0.2, 0.1, 0.05}) {
    const Real volume = total_volume(seed(disc, Vec<2>(-1, -1), h, 2));
    CHECK(std::abs(volume - std::numbers::pi) < 0.5 * h);
  }
}

TEST_CASE("scene: random offsets keep number, sub-cell and seed, whatever the region") {
  const Vec<2> origin(0, 0);
  const Real h = 0.1;
  const auto region = box({0.0, 0.0}, {1.0, 1.0});
  const auto plain = seed(region, origin, h, 2);
  const auto moved = seed(region, origin, h, 2, 0.2, 7);
  const auto again = seed(region, origin, h, 2, 0.2, 7);
  const auto other = seed(region, origin, h, 2, 0.2, 8);
  REQUIRE(moved.size() == plain.size());
  Real sum = 0, squares = 0, largest = 0, product = 0;
  int equal = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const Vec<2> d = (moved[i].position - plain[i].position) / h;
    sum += d.sum();
    squares += d.squaredNorm();
    product += d[0] * d[1];
    largest = std::max(largest, d.cwiseAbs().maxCoeff());
    CHECK(moved[i].position == again[i].position);
    equal += moved[i].position == other[i].position;
    CHECK(moved[i].volume == plain[i].volume);
  }
  const Real n = 2 * Real(plain.size());
  CHECK(largest <= 0.2 * (1 + 1e-12));
  CHECK(largest > 0.19);
  CHECK(std::abs(sum / n) < 0.02);                                    // mean 0
  CHECK(squares / n == doctest::Approx(0.2 * 0.2 / 3).epsilon(0.1));  // evenly distributed
  CHECK(std::abs(product / Real(plain.size())) < 0.1 * 0.2 * 0.2);    // axes independent
  CHECK(equal == 0);

  // a part of the region gives the same points
  std::map<std::pair<Real, Real>, int> seen;
  for (const auto& p : moved) seen[{p.position[0], p.position[1]}] = 1;
  int missing = 0;
  const auto part = seed(box({0.3, 0.2}, {0.6, 0.9}), origin, h, 2, 0.2, 7);
  CHECK(part.size() == 3 * 7 * 4);
  for (const auto& p : part) missing += !seen.count({p.position[0], p.position[1]});
  CHECK(missing == 0);
}

// ----------------------------------------------------------------------------------- start values

TEST_CASE("scene: start pressures and saturations of soil") {
  using M = Sand<PlaneStrain>;
  Scene<M> scene{{.box = {{0, 0}, {5, 2}}, .cell_size = 0.5}};
  scene.gravity = {0, -9.81};
  const auto strip = [](Real x) { return box(Vec<2>(x, 0), Vec<2>(x + 1, 2)); };
  scene.add_soil(strip(0), sand<PlaneStrain>(), {.suction = 9.2e3});
  scene.add_soil(strip(1), sand<PlaneStrain>(), {.saturation = 0.7});
  scene.add_soil(strip(2), sand<PlaneStrain>(), {.water_table = 0.5});
  scene.add_soil(strip(3), sand<PlaneStrain>(),
                 {.liquid_pressure = [](const Vec<2>& x) { return -1000 * x[1]; }});
  scene.add_soil(strip(4), sand<PlaneStrain>(), {.dry = true});
  scene.validate();
  const auto state = scene.initial_state();
  const Vec<2> x(0.3, 1.2);
  CHECK(state.liquid_pressure(0, x) == -9.2e3);
  // Eq. (12), (13) written out
  const Real e = 0.48 / 0.52, b = (1 - 0.89) / 0.89;
  const Real expected =
      std::pow(1 + std::pow(1.2 * 9.2e3 * std::pow(e, b) / 9810, 1 / (1 - 0.89)), -0.89);
  CHECK(state.saturation(0, x) == doctest::Approx(expected).epsilon(1e-12));
  CHECK(state.saturation(1, x) == doctest::Approx(0.7).epsilon(1e-12));
  CHECK(state.liquid_pressure(1, x) < 0);
  CHECK(state.liquid_pressure(2, x) == doctest::Approx(9810 * (0.5 - 1.2)));
  CHECK(state.liquid_pressure(2, Vec<2>(2.5, 0.1)) == doctest::Approx(9810 * 0.4));
  CHECK(state.saturation(2, Vec<2>(2.5, 0.1)) == 1);
  CHECK(state.liquid_pressure(3, x) == -1200);
  CHECK(state.liquid_pressure(4, x) == 0);
  CHECK(state.saturation(4, x) == 0);
  // saturation 1 is no suction
  Scene<M> full{{.box = {{0, 0}, {1, 1}}, .cell_size = 0.5}};
  full.add_soil(box({0, 0}, {1, 1}), sand<PlaneStrain>(), {.saturation = 1});
  CHECK(full.initial_state().liquid_pressure(0, x) == 0);
  CHECK(full.seed_soil(0).size() == 16);
}

TEST_CASE("scene: hydrostatic pressure follows the direction of gravity") {
  const Vec<2> tilted(9.81 * std::sin(0.3), -9.81 * std::cos(0.3));
  const Vec<2> along(std::cos(0.3), std::sin(0.3));  // level line
  const Vec<2> x(0.4, 0.2);
  const Real p = hydrostatic_pressure(x, 2.0, 1000, tilted);
  CHECK(hydrostatic_pressure<2>(x + 5 * along, 2.0, 1000, tilted) == doctest::Approx(p));
  CHECK(hydrostatic_pressure<2>(x + 0.1 * tilted / 9.81, 2.0, 1000, tilted) ==
        doctest::Approx(p + 981));
  Scene<FreeWaterModel<PlaneStrain>> scene{{.box = {{0, 0}, {1, 1}}, .cell_size = 0.5}};
  scene.gravity = {0, -10};
  scene.add_water(box({0, 0}, {1, 1}), {.surface_level = 1});
  scene.validate();
  CHECK(scene.initial_state().water_pressure(0, Vec<2>(0.5, 0.25)) == doctest::Approx(7500));
}

TEST_CASE_TEMPLATE("scene: geostatic stress of a dry column in every kinematics", K, Uniaxial,
                   PlaneStrain, Axisymmetric, ThreeDimensional) {
  constexpr int dim = K::dim;
  using M = DryModel<K>;
  Vec<dim> low = Vec<dim>::Zero(), high = Vec<dim>::Ones();
  high[dim - 1] = 4;
  Scene<M> scene{{.box = {low, high}, .cell_size = 0.5}};
  scene.gravity[dim - 1] = -10;
  Vec<dim> top = high;
  top[dim - 1] = 3.3;  // the surface need not be a grid line
  scene.add_soil(box<dim>(low, top), grains<K>(), {.initial_stress = InitialStress::geostatic});
  scene.validate();
  Vec<dim> x = Vec<dim>::Constant(0.5);
  x[dim - 1] = 1.2;
  const auto stress = scene.initial_state().bishop_stress(0, x);
  const Real vertical = -0.5 * 2000 * 10 * 2.1;
  const int up = dim - 1;
  for (int i = 0; i < K::stress_size; ++i) {
    const Real expected = i == up ? vertical : i < 3 ? vertical / 3 : 0;  // nu = 0.25: K_0 = 1/3
    CHECK(stress[i] == doctest::Approx(expected).epsilon(1e-10));
  }
}

TEST_CASE("scene: geostatic stress of layers under a pond, with a water table") {
  using M = SaturatedModel<PlaneStrain>;
  const auto layer = [](Real density, Real porosity) {
    return Material<M>{.solid_density = density,
                       .porosity = porosity,
                       .skeleton = {.young_modulus = 1e6, .poisson_ratio = 0.25},
                       .conductivity = {.saturated_conductivity = 1e-5}};
  };
  Scene<M> scene{{.box = {{0, 0}, {1, 4}}, .cell_size = 0.5}};
  scene.gravity = {0, -10};
  const SoilOptions<2> options{
      .water_table = 3, .initial_stress = InitialStress::geostatic, .lateral_stress_ratio = 0.6};
  scene.add_soil(box({0.0, 0.0}, {1.0, 1.1}), layer(2700, 0.4), options);
  scene.add_soil(box({0.0, 1.1}, {1.0, 2.0}), layer(2500, 0.5), options);
  scene.add_water(box({0.0, 2.0}, {1.0, 3.0}), {.surface_level = 3});
  scene.validate();
  const auto state = scene.initial_state();
  const Vec<2> x(0.3, 0.4);
  const Real total =
      10 * (0.7 * (0.6 * 2700 + 0.4 * 1000) + 0.9 * (0.5 * 2500 + 0.5 * 1000) + 1000);
  CHECK(state.overburden(x) == doctest::Approx(total).epsilon(1e-10));
  const Real vertical = -total + 10000 * 2.6;
  CHECK(state.bishop_stress(0, x)[1] == doctest::Approx(vertical).epsilon(1e-10));
  CHECK(state.bishop_stress(0, x)[0] == doctest::Approx(0.6 * vertical).epsilon(1e-10));
  CHECK(state.bishop_stress(0, x)[2] == doctest::Approx(0.6 * vertical).epsilon(1e-10));
  CHECK(state.bishop_stress(0, x)[3] == doctest::Approx(0));
  // buoyant weight, the textbook form: does not depend on the pond
  const Real buoyant = -10 * (0.7 * 0.6 * 1700 + 0.9 * 0.5 * 1500);
  CHECK(vertical == doctest::Approx(buoyant));
}

TEST_CASE("scene: geostatic stress of moist soil counts the water by its saturation") {
  using M = Sand<Uniaxial>;
  Scene<M> scene{{.box = {{0.0}, {2.0}}, .cell_size = 0.1}};
  scene.gravity[0] = -9.81;
  scene.add_soil(box({0.0}, {2.0}), sand<Uniaxial>(),
                 {.water_table = 0.5, .initial_stress = InitialStress::geostatic});
  scene.validate();
  const auto state = scene.initial_state();
  // reference: fine trapezoidal rule
  const int n = 200000;
  Real weight = 0;
  for (int i = 0; i < n; ++i) {
    const Vec<1> at(0.3 + 1.7 * (i + 0.5) / n);
    weight += (0.52 * 2670 + 0.48 * 1000 * state.saturation(0, at)) * 9.81 * 1.7 / n;
  }
  CHECK(state.overburden(Vec<1>(0.3)) == doctest::Approx(weight).epsilon(1e-4));
  const Vec<1> above(1.3);
  CHECK(state.bishop_stress(0, above)[0] ==
        doctest::Approx(-state.overburden(above) +
                        state.saturation(0, above) * state.liquid_pressure(0, above)));
}

TEST_CASE("scene: geostatic stress under tilted gravity has the principal axes of gravity") {
  using M = DryModel<ThreeDimensional>;
  Scene<M> scene{{.box = {{0, 0, 0}, {2, 2, 2}}, .cell_size = 0.5}};
  const Vec<3> g(1, -2, -9);
  scene.gravity = g;
  scene.add_soil(box({0, 0, 0}, {2, 2, 2}), grains<ThreeDimensional>(),
                 {.initial_stress = InitialStress::geostatic});
  const Vec<3> x(1, 1, 1);
  const auto s = scene.initial_state().bishop_stress(0, x);
  Eigen::Matrix3d full;
  full << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  const Eigen::Vector3d e = g.normalized();
  const Real along = -scene.initial_state().overburden(x);
  CHECK(along < 0);
  CHECK((full * e - along * e).norm() < 1e-10 * std::abs(along));
  const Eigen::Vector3d across = Eigen::Vector3d(2, 1, 0).normalized();
  CHECK((full * across - along / 3 * across).norm() < 1e-10 * std::abs(along));
  // up is -g: the ray leaves through the top, 9/|g| per unit length
  CHECK(along == doctest::Approx(-0.5 * 2000 * g.squaredNorm() / 9));
}

TEST_CASE("scene: prescribed values are kept as given") {
  Scene<Sand<PlaneStrain>> scene{{.box = {{0, 0}, {1, 2}}, .cell_size = 0.25}};
  CHECK(scene.cells() == std::array<int, 2>{4, 8});
  CHECK(scene.cell_size() == 0.25);
  scene.add(bc::PrescribedPressure<2>{.face = Face::right, .function = [](const Vec<2>& x, Real t) {
                                        return 9810 * (1 - x[1]) * t;
                                      }});
  CHECK(scene.conditions<bc::PrescribedPressure<2>>()[0].at(Vec<2>(1, 0.5), 2) == 9810);
  scene.add(bc::Traction<2>{.region = box({0.0, 1.9}, {1.0, 2.0}),
                            .normal_pressure = 1e3,
                            .time_factor = [](Real t) { return t < 1 ? t : 1; }});
  const auto& load = scene.conditions<bc::Traction<2>>()[0];
  CHECK(load.has_pressure());
  CHECK_FALSE(load.has_vector());
  CHECK(load.factor(0.25) == 0.25);
  CHECK(load.region.contains(Vec<2>(0.5, 1.95)));
  CHECK_FALSE(load.region.contains(Vec<2>(0.5, 1.5)));
  scene.add(bc::PrescribedVelocity<2>{.region = box({0, 0}, {1, 1}), .velocity = {unset, -1}});
  const auto& motion = scene.conditions<bc::PrescribedVelocity<2>>()[0];
  CHECK_FALSE(motion.prescribes(0));
  CHECK(motion.prescribes(1));
  CHECK(motion.factor(3) == 1);
  // no region means everywhere; one of another dimension means nowhere
  CHECK(AnyRegion{}.contains(Vec<3>(1, 2, 3)));
  CHECK_FALSE(AnyRegion{box({0.0}, {1.0})}.contains(Vec<2>(0.5, 0.5)));
  // a copy of a scene shares nothing that can change
  Scene<Sand<PlaneStrain>> copy = scene;
  copy.add(bc::ZeroSuction{});
  CHECK(scene.conditions<bc::ZeroSuction>().empty());
}
