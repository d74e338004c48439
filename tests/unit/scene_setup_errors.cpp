// SPDX-License-Identifier: MIT
// Wrong set-ups: one SetupError each, naming parameter, value, range, unit and where it is; the
// scene stays as it was.

#include <doctest/doctest.h>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include <vadose/policy/law/newtonian_fluid.hpp>
#include <vadose/scene/scene.hpp>

namespace {

using namespace vadose;

struct WetSoil : UnsaturatedModel<PlaneStrain> {};
struct FullSoil : SaturatedModel<PlaneStrain> {};
struct DrySoil : DryModel<PlaneStrain> {};
struct Seepage : UnsaturatedModel<PlaneStrain> {
  using Skeleton = law::Rigid;
};
/// A law without Poisson's ratio.
struct Spring {
  struct State {};
  template <int N>
  Status update(const StrainStep<Real, N>&, SymTensor<Real, N>&, State&) const {
    return Status::ok;
  }
  Real p_wave_modulus(const State&) const { return 1; }
  void validate() const {}
};
struct SpringSoil : DryModel<PlaneStrain> {
  using Skeleton = Spring;
};
struct Viscous : FreeWaterModel<PlaneStrain> {
  using Liquid = law::NewtonianFluid;
};

constexpr Real nan_value = unset;
constexpr Real infinity = std::numeric_limits<Real>::infinity();

/// [Zhan] Table 3.
Material<WetSoil> silty_sand() {
  return {.name = "silty_sand",
          .solid_density = 2670,
          .porosity = 0.48,
          .lambda = 0.89,
          .skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.33},
          .retention = {.residual_saturation = 0.1, .a = 1.2},
          .conductivity = {.saturated_conductivity = 2.77e-3}};
}
Material<FullSoil> clay() {
  return {.name = "clay",
          .solid_density = 2700,
          .porosity = 0.4,
          .skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.33},
          .conductivity = {.saturated_conductivity = 1e-8}};
}
Material<DrySoil> dry_sand() {
  return {.name = "dry_sand",
          .solid_density = 2650,
          .porosity = 0.4,
          .skeleton = {.young_modulus = 1e6, .poisson_ratio = 0.2}};
}

Region<2> left_half() {
  return box({0.0, 0.0}, {0.5, 0.5});
}

template <class M>
Scene<M> unit_scene() {
  Scene<M> scene{{.box = {{0.0, 0.0}, {1.0, 1.0}}, .cell_size = 0.1}};
  scene.gravity = {0.0, -9.81};
  return scene;
}

template <class M>
std::size_t count(const Scene<M>& s) {
  return s.soils().size() + 100 * s.materials().size() + 10000 * s.waters().size() +
         1000000 *
             (s.template conditions<bc::Fixed>().size() +
              s.template conditions<bc::Roller>().size() +
              s.template conditions<bc::Frictional>().size() +
              s.template conditions<bc::Traction<M::Kinematics::dim>>().size() +
              s.template conditions<bc::PrescribedVelocity<M::Kinematics::dim>>().size() +
              s.template conditions<bc::Impermeable>().size() +
              s.template conditions<bc::PrescribedPressure<M::Kinematics::dim>>().size() +
              s.template conditions<bc::ZeroSuction>().size() +
              s.template conditions<bc::PrescribedHead>().size() +
              s.template conditions<bc::Reservoir>().size() +
              s.template conditions<bc::Drain>().size() + s.template conditions<bc::Rain>().size());
}

/// A wrong set-up and what its message must contain.
struct Wrong {
  std::vector<std::string> parts;
  void (*build)();
};

/// Runs f on a unit scene; whatever f throws, f must not have changed what was added before.
template <class M, class F>
void attempt(F&& f) {
  Scene<M> scene = unit_scene<M>();
  const std::size_t before = count(scene);
  try {
    f(scene);
  } catch (const SetupError&) {
    CHECK(count(scene) == before);
    throw;
  }
}

/// The same for a material.
template <class M, class F>
void with_material(Material<M> material, F&& change) {
  change(material);
  attempt<M>([&](Scene<M>& s) {
    if constexpr (is_unsaturated<M>)
      s.add_soil(left_half(), material, {.suction = 1e3});
    else
      s.add_soil(left_half(), material);
  });
}

/// add_soil of silty sand with these options.
void with_options(const SoilOptions<2>& options) {
  attempt<WetSoil>([&](Scene<WetSoil>& s) { s.add_soil(left_half(), silty_sand(), options); });
}

template <class Condition>
void with_condition(const Condition& condition) {
  attempt<WetSoil>([&](Scene<WetSoil>& s) { s.add(condition); });
}

void check_all(const std::vector<Wrong>& table) {
  for (const Wrong& wrong : table) {
    std::string message = "(no error)";
    try {
      wrong.build();
    } catch (const SetupError& error) {
      message = error.what();
    }
    CAPTURE(message);
    for (const std::string& part : wrong.parts) {
      CAPTURE(part);
      CHECK(message.find(part) != std::string::npos);
    }
  }
}

}  // namespace

TEST_CASE("scene: wrong domains") {
  check_all({
      {{"cell_size = nan", "(0, inf)", "[m]"},
       [] {
         Scene<WetSoil>{{.box = {{0, 0}, {1, 1}}}};
       }},
      {{"cell_size = -0.1", "(0, inf)", "[m]"},
       [] {
         Scene<WetSoil>{{.box = {{0, 0}, {1, 1}}, .cell_size = -0.1}};
       }},
      {{"cell_size = 0 ", "(0, inf)", "[m]"},
       [] {
         Scene<WetSoil>{{.box = {{0, 0}, {1, 1}}, .cell_size = 0}};
       }},
      {{"cell_size = 0.03", "{1 / integer}", "[m]", "edge x", "33.33"},
       [] {
         Scene<WetSoil>{{.box = {{0, 0}, {1, 0.3}}, .cell_size = 0.03}};
       }},
      {{"cell_size = 0.1", "{1.00001 / integer}", "[m]", "edge y"},
       [] {
         Scene<WetSoil>{{.box = {{0, 0}, {1, 1.00001}}, .cell_size = 0.1}};
       }},
      {{"cell_size = 2", "{1 / integer}", "[m]"},
       [] {
         Scene<WetSoil>{{.box = {{0, 0}, {1, 1}}, .cell_size = 2}};
       }},
      {{"box low x = nan", "(-inf, inf)", "[m]"}, [] { Scene<WetSoil>{{.cell_size = 0.1}}; }},
      {{"box high y = -1 ", "(0, inf)", "[m]"},
       [] {
         Scene<WetSoil>{{.box = {{0, 0}, {1, -1}}, .cell_size = 0.1}};
       }},
      {{"box low r = -1 ", "[0, inf)", "[m]"},
       [] {
         Scene<SaturatedModel<Axisymmetric>>{{.box = {{-1, 0}, {1, 1}}, .cell_size = 0.1}};
       }},
  });
}

TEST_CASE("scene: wrong materials") {
  check_all({
      {{"solid_density = nan", "(0, inf)", "[kg/m3]", "material 'silty_sand'"},
       [] { with_material(silty_sand(), [](auto& m) { m.solid_density = unset; }); }},
      {{"solid_density = -1 ", "(0, inf)", "[kg/m3]", "material 'clay'"},
       [] { with_material(clay(), [](auto& m) { m.solid_density = -1; }); }},
      {{"porosity = 1.2 outside (0, 1) [-] in material 'silty_sand'"},
       [] { with_material(silty_sand(), [](auto& m) { m.porosity = 1.2; }); }},
      {{"porosity = 0 ", "(0, 1)", "[-]"},
       [] { with_material(dry_sand(), [](auto& m) { m.porosity = 0; }); }},
      {{"porosity = 1 ", "(0, 1)", "[-]"},
       [] { with_material(dry_sand(), [](auto& m) { m.porosity = 1; }); }},
      {{"porosity = nan", "(0, 1)", "[-]"},
       [] { with_material(clay(), [](auto& m) { m.porosity = unset; }); }},
      {{"lambda = 1.5", "(0, 1)", "[-]", "material 'silty_sand'"},
       [] { with_material(silty_sand(), [](auto& m) { m.lambda = 1.5; }); }},
      {{"lambda = nan", "(0, 1)", "[-]", "retention of material 'silty_sand'"},
       [] { with_material(silty_sand(), [](auto& m) { m.lambda = unset; }); }},
      {{"unit_weight = -9810", "(0, inf)", "[N/m3]", "material 'silty_sand'"},
       [] { with_material(silty_sand(), [](auto& m) { m.unit_weight = -9810; }); }},
      {{"young_modulus = -1 ", "(0, inf)", "[Pa]", "skeleton of material 'silty_sand'"},
       [] { with_material(silty_sand(), [](auto& m) { m.skeleton.young_modulus = -1; }); }},
      {{"poisson_ratio = 0.5", "(-1, 0.5)", "[-]", "skeleton of material 'dry_sand'"},
       [] { with_material(dry_sand(), [](auto& m) { m.skeleton.poisson_ratio = 0.5; }); }},
      {{"a = nan", "(0, inf)", "[1/m]", "retention of material 'silty_sand'"},
       [] { with_material(silty_sand(), [](auto& m) { m.retention.a = unset; }); }},
      {{"residual_saturation = 1 ", "[0, 1)", "[-]", "retention of"},
       [] { with_material(silty_sand(), [](auto& m) { m.retention.residual_saturation = 1; }); }},
      {{"saturated_conductivity = nan", "(0, inf)", "[m/s]", "conductivity of material"},
       [] {
         with_material(silty_sand(),
                       [](auto& m) { m.conductivity.saturated_conductivity = unset; });
       }},
      {{"saturated_conductivity = 0 ", "(0, inf)", "[m/s]", "conductivity of material 'clay'"},
       [] { with_material(clay(), [](auto& m) { m.conductivity.saturated_conductivity = 0; }); }},
  });
}

TEST_CASE("scene: wrong bodies of soil") {
  check_all({
      {{"region high x = 1.5", "[0, 1]", "[m]", "material 'silty_sand'"},
       [] {
         attempt<WetSoil>([](auto& s) {
           s.add_soil(box({0.0, 0.0}, {1.5, 0.5}), silty_sand(), {.suction = 0});
         });
       }},
      {{"region low y = -0.5", "[0, 1]", "[m]"},
       [] {
         attempt<WetSoil>([](auto& s) {
           s.add_soil(box({0.0, -0.5}, {1.0, 0.5}), silty_sand(), {.suction = 0});
         });
       }},
      {{"region low x = -inf", "[0, 1]", "[m]"},
       [] {
         attempt<WetSoil>([](auto& s) {
           s.add_soil(half_space({0.0, 0.5}, {0.0, 1.0}), silty_sand(), {.suction = 0});
         });
       }},
      {{"number of points = 0", "[1, inf)", "[-]", "region of material 'silty_sand'", "0.1 [m]"},
       [] {
         attempt<WetSoil>([](auto& s) {
           s.add_soil(box({0.0, 0.0}, {0.01, 0.01}), silty_sand(), {.suction = 0});
         });
       }},
      {{"number of points = 0", "material 'silty_sand'"},
       [] {
         attempt<WetSoil>(
             [](auto& s) { s.add_soil(left_half() - left_half(), silty_sand(), {.suction = 0}); });
       }},
      {{"points_per_cell = 5 ", "{1, 4, 9, 16", "[-]", "material 'silty_sand'"},
       [] { with_options({.points_per_cell = 5, .suction = 0}); }},
      {{"points_per_cell = 0 ", "{1, 4, 9, 16", "[-]"},
       [] { with_options({.points_per_cell = 0, .suction = 0}); }},
      {{"jitter = 0.3 ", "[0, 0.25]", "[cell size]"},
       [] { with_options({.jitter = 0.3, .suction = 0}); }},
      {{"jitter = nan", "[0, 0.25]", "[cell size]"},
       [] { with_options({.jitter = nan_value, .suction = 0}); }},
      {{"velocity y = inf", "(-inf, inf)", "[m/s]"},
       [] {
         with_options({.suction = 0, .velocity = {0, infinity}});
       }},
      {{"number of given suction, saturation", "= 0 ", "{1}", "Pa", "material 'silty_sand'"},
       [] { with_options({}); }},
      {{"number of given suction, saturation", "= 2 ", "{1}"},
       [] { with_options({.suction = 10, .saturation = 0.5}); }},
      {{"number of given", "= 2 ", "{1}"}, [] { with_options({.water_table = 1, .dry = true}); }},
      {{"suction = -5 ", "[0, inf)", "[Pa]", "material 'silty_sand'"},
       [] { with_options({.suction = -5}); }},
      {{"suction = inf", "[0, inf)", "[Pa]"}, [] { with_options({.suction = infinity}); }},
      {{"saturation = 0.05 outside (0.1, 1] [-] in material 'silty_sand'"},
       [] { with_options({.saturation = 0.05}); }},
      {{"saturation = 0.1 ", "(0.1, 1]", "[-]"}, [] { with_options({.saturation = 0.1}); }},
      {{"saturation = 1.01", "(0.1, 1]", "[-]"}, [] { with_options({.saturation = 1.01}); }},
      {{"water_table = inf", "(-inf, inf)", "[m]"},
       [] { with_options({.water_table = infinity}); }},
      {{"lateral_stress_ratio = 11 ", "[0, 10]", "[-]", "material 'silty_sand'"},
       [] {
         with_options({.suction = 0,
                       .initial_stress = InitialStress::geostatic,
                       .lateral_stress_ratio = 11});
       }},
      {{"lateral_stress_ratio = -0.5", "[0, 10]", "[-]"},
       [] {
         with_options({.suction = 0,
                       .initial_stress = InitialStress::geostatic,
                       .lateral_stress_ratio = -0.5});
       }},
      {{"lateral_stress_ratio = 0.5 ", "geostatic", "[-]"},
       [] { with_options({.suction = 0, .lateral_stress_ratio = 0.5}); }},
      {{"lateral_stress_ratio = nan", "[0, 10]", "[-]", "material 'spring'"},
       [] {
         attempt<SpringSoil>([](auto& s) {
           s.add_soil(left_half(), {.name = "spring", .solid_density = 2700, .porosity = 0.4},
                      {.initial_stress = InitialStress::geostatic});
         });
       }},
      {{"initial_stress = geostatic", "{none}", "rigid", "[-]", "material 'rock'"},
       [] {
         attempt<Seepage>([](auto& s) {
           s.add_soil(left_half(),
                      {.name = "rock",
                       .porosity = 0.4,
                       .lambda = 0.5,
                       .retention = {.a = 1},
                       .conductivity = {.saturated_conductivity = 1e-5}},
                      {.suction = 0, .initial_stress = InitialStress::geostatic});
         });
       }},
      {{"suction = 5 ", "{} of this model", "[Pa]", "material 'clay'"},
       [] { attempt<FullSoil>([](auto& s) { s.add_soil(left_half(), clay(), {.suction = 5}); }); }},
      {{"saturation = 0.5 ", "{} of this model", "[-]", "material 'clay'"},
       [] {
         attempt<FullSoil>([](auto& s) { s.add_soil(left_half(), clay(), {.saturation = 0.5}); });
       }},
      {{"dry = 1 ", "{0} of this model", "[-]"},
       [] { attempt<FullSoil>([](auto& s) { s.add_soil(left_half(), clay(), {.dry = true}); }); }},
      {{"water_table [m], liquid_pressure [Pa] = 2 ", "{0, 1}"},
       [] {
         attempt<FullSoil>([](auto& s) {
           s.add_soil(left_half(), clay(),
                      {.water_table = 1, .liquid_pressure = [](const Vec<2>&) { return 0.0; }});
         });
       }},
      {{"water_table [m], liquid_pressure [Pa] = 1 ", "{0}", "NoLiquid", "material 'dry_sand'"},
       [] {
         attempt<DrySoil>([](auto& s) { s.add_soil(left_half(), dry_sand(), {.water_table = 1}); });
       }},
      {{"density = 0 ", "(0, inf)", "[kg/m3]", "liquid"},
       [] {
         attempt<FullSoil>([](auto& s) {
           s.liquid.density = 0;
           s.add_soil(left_half(), clay());
         });
       }},
  });
}

TEST_CASE("scene: bodies that overlap are refused, whatever their lattices") {
  Scene<WetSoil> scene = unit_scene<WetSoil>();
  Material<WetSoil> other = silty_sand();
  other.name = "other";
  scene.add_soil(left_half(), silty_sand(), {.points_per_cell = 1, .suction = 0});
  const std::size_t before = count(scene);
  const auto refused = [&](const Region<2>& region, int points_per_cell) {
    try {
      scene.add_soil(region, other, {.points_per_cell = points_per_cell, .suction = 0});
    } catch (const SetupError& error) {
      CHECK(std::string(error.what())
                .find("region of material 'other' overlaps region of "
                      "material 'silty_sand' at (") == 0);
      CHECK(count(scene) == before);
      return true;
    }
    return false;
  };
  CHECK(refused(box({0.4, 0.0}, {1.0, 0.5}), 4));
  CHECK(refused(box({0.2, 0.2}, {0.3, 0.3}), 4));  // a small one inside
  CHECK(refused(box({0.0, 0.0}, {1.0, 1.0}), 9));  // a large one around
  // around a point of the old lattice without a point of its own there
  CHECK(refused(box({0.6, 0.0}, {0.7, 0.1}) | box({0.045, 0.045}, {0.055, 0.055}), 4));
  CHECK_THROWS_AS(scene.add_water(box({0.0, 0.4}, {0.5, 0.8})), SetupError);
  CHECK(count(scene) == before);
  // side by side is fine
  scene.add_soil(box({0.5, 0.0}, {1.0, 0.5}), other, {.suction = 0});
  scene.add_water(box({0.0, 0.5}, {1.0, 0.8}), {.surface_level = 0.8});
  CHECK_THROWS_AS(scene.add_water(box({0.0, 0.7}, {1.0, 0.9})), SetupError);
  CHECK_NOTHROW(scene.validate());
  CHECK(scene.soils().size() == 2);
  CHECK(scene.waters().size() == 1);
}

TEST_CASE("scene: wrong bodies of water") {
  check_all({
      {{"points_per_cell = 3 ", "{1, 4, 9", "[-]", "free water 0"},
       [] {
         attempt<FullSoil>([](auto& s) { s.add_water(left_half(), {.points_per_cell = 3}); });
       }},
      {{"surface_level [m], liquid_pressure [Pa] = 2 ", "{0, 1}", "free water 0"},
       [] {
         attempt<FullSoil>([](auto& s) {
           s.add_water(left_half(),
                       {.surface_level = 1, .liquid_pressure = [](const Vec<2>&) { return 0.0; }});
         });
       }},
      {{"surface_level = inf", "(-inf, inf)", "[m]", "free water 0"},
       [] {
         attempt<FullSoil>([](auto& s) { s.add_water(left_half(), {.surface_level = infinity}); });
       }},
      {{"region high y = 2 ", "[0, 1]", "[m]", "free water 0"},
       [] { attempt<FullSoil>([](auto& s) {
              s.add_water(box({0.0, 0.0}, {1.0, 2.0}));
            }); }},
      {{"number of points = 0", "region of free water 0"},
       [] { attempt<FullSoil>([](auto& s) {
              s.add_water(box({0.0, 0.0}, {0.01, 1.0}));
            }); }},
      {{"jitter = -0.1 ", "[0, 0.25]", "[cell size]", "free water 0"},
       [] { attempt<FullSoil>([](auto& s) { s.add_water(left_half(), {.jitter = -0.1}); }); }},
  });
}

TEST_CASE("scene: wrong boundary conditions") {
  check_all({
      {{"face = (missing)", "{left, right, bottom, top}", "[-]", "bc::Fixed"},
       [] { with_condition(bc::Fixed{}); }},
      {{"face = front", "{left, right, bottom, top}", "[-]", "bc::Roller"},
       [] { with_condition(bc::Roller{.face = Face::front}); }},
      {{"face = left", "{bottom, top}", "[-]"},
       [] {
         Scene<DryModel<Uniaxial>> s{{.box = {{0.0}, {1.0}}, .cell_size = 0.1}};
         s.add(bc::Fixed{.face = Face::left});
       }},
      {{"region dimension = 3 ", "{2}", "[-]", "bc::Fixed"},
       [] {
         with_condition(bc::Fixed{.face = Face::left, .region = box({0, 0, 0}, {1, 1, 1})});
       }},
      {{"region low x = 2 ", "(-inf, 1]", "[m]", "bc::Fixed"},
       [] {
         with_condition(bc::Fixed{.face = Face::left, .region = box({2, 0}, {3, 1})});
       }},
      {{"region high y = -1 ", "[0, inf)", "[m]", "bc::ZeroSuction"},
       [] {
         with_condition(bc::ZeroSuction{.region = box({0, -2}, {1, -1})});
       }},
      {{"friction_coefficient = nan", "[0, inf)", "[-]", "bc::Frictional"},
       [] { with_condition(bc::Frictional{.face = Face::bottom}); }},
      {{"friction_coefficient = -0.1", "[0, inf)", "[-]"},
       [] { with_condition(bc::Frictional{.face = Face::bottom, .friction_coefficient = -0.1}); }},
      {{"region = (missing)", "[m]", "bc::Traction"},
       [] { with_condition(bc::Traction<2>{.normal_pressure = 1e3}); }},
      {{"number of given traction, normal_pressure", "= 0 ", "{1}", "Pa", "bc::Traction"},
       [] { with_condition(bc::Traction<2>{.region = left_half()}); }},
      {{"number of given traction, normal_pressure", "= 2 ", "{1}"},
       [] {
         with_condition(
             bc::Traction<2>{.region = left_half(), .traction = {0, 1}, .normal_pressure = 1e3});
       }},
      {{"traction y = nan", "(-inf, inf)", "[Pa]"},
       [] {
         with_condition(bc::Traction<2>{.region = left_half(), .traction = {0, nan_value}});
       }},
      {{"normal_pressure = inf", "(-inf, inf)", "[Pa]"},
       [] { with_condition(bc::Traction<2>{.region = left_half(), .normal_pressure = infinity}); }},
      {{"time_factor(0 s) = nan", "(-inf, inf)", "[-]", "bc::Traction"},
       [] {
         with_condition(bc::Traction<2>{.region = left_half(),
                                        .normal_pressure = 1,
                                        .time_factor = [](Real) { return nan_value; }});
       }},
      {{"velocity = nan", "one component or more", "[m/s]", "bc::PrescribedVelocity"},
       [] { with_condition(bc::PrescribedVelocity<2>{.region = left_half()}); }},
      {{"velocity x = -inf", "(-inf, inf)", "[m/s]"},
       [] {
         with_condition(
             bc::PrescribedVelocity<2>{.region = left_half(), .velocity = {-infinity, unset}});
       }},
      {{"face = (missing)", "{left, right, bottom, top}", "[-]", "bc::Impermeable"},
       [] { with_condition(bc::Impermeable{.face = static_cast<Face>(77)}); }},
      {{"face = (missing)", "region = (missing)", "[m]", "bc::PrescribedPressure"},
       [] { with_condition(bc::PrescribedPressure<2>{.pressure = 0}); }},
      {{"face = (missing)", "region = (missing)", "bc::Drained"},
       [] { with_condition(bc::Drained{}); }},
      {{"number of given pressure, function", "= 0 ", "{1}", "Pa"},
       [] { with_condition(bc::PrescribedPressure<2>{.face = Face::left}); }},
      {{"pressure = inf", "(-inf, inf)", "[Pa]", "bc::PrescribedPressure"},
       [] { with_condition(bc::PrescribedPressure<2>{.face = Face::left, .pressure = infinity}); }},
  });
}

TEST_CASE("scene: conditions that contradict each other on a face") {
  Scene<WetSoil> scene = unit_scene<WetSoil>();
  scene.add(bc::Fixed{.face = Face::bottom});
  scene.add(bc::Drained{.face = Face::left});
  const auto message = [&](const auto& condition) -> std::string {
    const std::size_t before = count(scene);
    try {
      scene.add(condition);
    } catch (const SetupError& error) {
      CHECK(count(scene) == before);
      return error.what();
    }
    return "(no error)";
  };
  CHECK(message(bc::Roller{.face = Face::bottom}) ==
        "face = bottom outside {free faces} [-]: bc::Roller contradicts bc::Fixed there; give one "
        "a region");
  CHECK(message(bc::Fixed{.face = Face::bottom}).find("contradicts bc::Fixed") !=
        std::string::npos);
  CHECK(message(bc::Frictional{.face = Face::bottom, .friction_coefficient = 0.3})
            .find("bc::Frictional contradicts bc::Fixed") != std::string::npos);
  CHECK(message(bc::Impermeable{.face = Face::left}).find("contradicts bc::PrescribedPressure") !=
        std::string::npos);
  // other faces, parts of a face, and another kind on the same face
  CHECK(message(bc::Roller{.face = Face::left}) == "(no error)");
  CHECK(message(bc::Roller{.face = Face::bottom, .region = left_half()}) == "(no error)");
  CHECK(message(bc::Impermeable{.face = Face::bottom}) == "(no error)");
  CHECK(message(bc::ZeroSuction{}) == "(no error)");
  REQUIRE(scene.conditions<bc::PrescribedPressure<2>>().size() == 1);
  CHECK(scene.conditions<bc::PrescribedPressure<2>>()[0].at(Vec<2>(0, 0), 3.0) == 0);
  CHECK(scene.conditions<bc::Roller>().size() == 2);
}

TEST_CASE("scene: validate sees what was assigned or fits not together") {
  const auto message = [](auto&& build) -> std::string {
    try {
      build();
    } catch (const SetupError& error) {
      return error.what();
    }
    return "(no error)";
  };
  const auto wet = [](const SoilOptions<2>& options, auto&& change) {
    return [=] {
      Scene<WetSoil> s = unit_scene<WetSoil>();
      s.add_soil(left_half(), silty_sand(), options);
      change(s);
      s.validate();
    };
  };
  const auto has = [](const std::string& text, const std::string& part) {
    CAPTURE(text);
    CHECK(text.find(part) != std::string::npos);
  };
  CHECK(message(wet({.suction = 1}, [](auto&) {})) == "(no error)");
  has(message([] { unit_scene<WetSoil>().validate(); }), "number of bodies = 0 outside [1, inf)");
  has(message(wet({.suction = 1}, [](auto& s) { s.gravity[1] = nan_value; })),
      "gravity y = nan (missing or not finite), allowed (-inf, inf) [m/s2]");
  has(message(wet({.suction = 1}, [](auto& s) { s.liquid.bulk_modulus = 0; })),
      "bulk_modulus = 0 outside (0, inf) [Pa] in liquid");
  has(message(wet({.suction = 1}, [](auto& s) { s.liquid.density = -1; })),
      "density = -1 outside (0, inf) [kg/m3] in liquid");
  const auto no_gravity = [](auto& s) { s.gravity.setZero(); };
  has(message(wet({.water_table = 1}, no_gravity)),
      "gravity = 0 outside (0, inf), needed by water_table [m/s2] in material 'silty_sand'");
  has(message(wet({.suction = 1, .initial_stress = InitialStress::geostatic}, no_gravity)),
      "needed by geostatic stress [m/s2] in material 'silty_sand'");
  const auto broken = [](const Vec<2>& x) { return x[0] > 0.4 ? nan_value : 0.0; };
  has(message(wet({.liquid_pressure = broken}, [](auto&) {})),
      "liquid_pressure = nan (missing or not finite), allowed (-inf, inf) [Pa] in material "
      "'silty_sand'");
  const auto water = [](const WaterOptions<2>& options, bool gravity) {
    return [=] {
      Scene<WetSoil> s = unit_scene<WetSoil>();
      if (!gravity) s.gravity.setZero();
      s.add_water(left_half(), options);
      s.validate();
    };
  };
  CHECK(message(water({.surface_level = 0.5}, true)) == "(no error)");
  CHECK(message(water({}, false)) == "(no error)");
  has(message(water({.surface_level = 0.4}, true)), "surface_level = 0.4 outside [0.425, inf)");
  has(message(water({.surface_level = 0.5}, false)), "needed by surface_level [m/s2]");
  has(message(water({.liquid_pressure = broken}, true)), "liquid_pressure = nan");
  has(message([] {
        Scene<Viscous> s = unit_scene<Viscous>();
        s.add_water(left_half());
        s.validate();
      }),
      "dynamic_viscosity = nan (missing or not finite), allowed (0, inf) [Pa s] in liquid");
}
