// SPDX-License-Identifier: MIT
// Gauges, balance histories, summaries and long advances: files and texts read back and compared
// with the solver.

#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <vadose/io/advance.hpp>
#include <vadose/io/balance_history.hpp>
#include <vadose/io/gauges.hpp>
#include <vadose/io/run_summary.hpp>
#include <vadose/solver/solver.hpp>

#include "../error_message.hpp"
#include "../seepage.hpp"
#include "../slope.hpp"
#include "../temporary_directory.hpp"

namespace {

using namespace vadose;
using io::Measure;
using io::SceneMeasure;
using vadose_test::error_message;
using vadose_test::TemporaryDirectory;

/// Columns of a CSV file by their heads.
std::map<std::string, std::vector<Real>> read_csv(const std::string& path) {
  std::ifstream in(path);
  REQUIRE(in.good());
  std::string line, cell;
  std::vector<std::string> heads;
  std::getline(in, line);
  for (std::istringstream row(line); std::getline(row, cell, ',');) heads.push_back(cell);
  std::map<std::string, std::vector<Real>> columns;
  while (std::getline(in, line)) {
    std::istringstream row(line);
    std::size_t i = 0;
    for (; std::getline(row, cell, ','); ++i)
      columns[heads.at(i)].push_back(std::strtod(cell.c_str(), nullptr));
    REQUIRE(i == heads.size());
  }
  REQUIRE(columns.size() == heads.size());  // no head twice
  return columns;
}

using GaugedSoil = vadose_test::Slope;

/// A block of soil over a water table, 0.4 m wide and 0.3 m high; its bottom is held at 0 Pa.
Solver<GaugedSoil> gauged_solver() {
  const Material<GaugedSoil> silt{
      .solid_density = 2650,
      .porosity = 0.4,
      .skeleton = {.elastic = {.young_modulus = 5e6, .poisson_ratio = 0.3},
                   .friction_angle = degrees(30)},
      .retention = {.a = 1.2, .lambda = 0.6},
      .conductivity = {.saturated_conductivity = 1e-3, .lambda = 0.6}};
  Scene<GaugedSoil> scene{{.box = {{0.0, 0.0}, {1.0, 0.5}}, .cell_size = 0.1}};
  scene.gravity = {0.0, -9.81};
  scene.liquid = {.density = 1000, .bulk_modulus = 2e6};
  scene.add_soil(box({0.0, 0.0}, {0.4, 0.3}), silt, {.water_table = 0.1});
  scene.add(bc::Drained{.face = Face::bottom});
  return Solver<GaugedSoil>{scene, {.courant = 0.3}};
}

/// Batch and lane of a solid point.
std::pair<std::size_t, int> place_of(const Solver<GaugedSoil>& solver, std::int64_t id) {
  std::pair<std::size_t, int> place{0, -1};
  solver.solid().for_each([&](std::size_t b, int l) {
    if (solver.solid().at(field::id, b)[l] == static_cast<Real>(id)) place = {b, l};
  });
  REQUIRE(place.second >= 0);
  return place;
}

/// What f(FILE*) prints.
template <class F>
std::string printed(F&& f) {
  std::FILE* file = std::tmpfile();
  REQUIRE(file != nullptr);
  f(file);
  std::rewind(file);
  std::string text;
  for (int c; (c = std::fgetc(file)) != EOF;) text += static_cast<char>(c);
  std::fclose(file);
  return text;
}

/// The number that follows `key` in `text`.
Real number_after(const std::string& text, const std::string& key) {
  const std::size_t at = text.find(key);
  REQUIRE(at != std::string::npos);
  return std::strtod(text.c_str() + at + key.size(), nullptr);
}

}  // namespace

TEST_CASE("gauges: a material point is followed by id, with everything that it carries") {
  const TemporaryDirectory directory("gauges_point");
  Solver<GaugedSoil> solver = gauged_solver();
  io::Gauges gauges{directory / "run.csv"};
  gauges.point("crest", {0.38, 0.29},
               {Measure::displacement, Measure::velocity, Measure::bishop_stress,
                Measure::mean_stress, Measure::deviatoric_stress, Measure::law_outputs,
                Measure::porosity, Measure::liquid_pressure, Measure::saturation});
  CHECK(gauges.followed("crest") == -1);
  const Vec<2> start{0.375, 0.275};  // the nearest lattice point
  gauges.record(solver);
  for (int i = 1; i <= 3; ++i) {
    for (int k = 0; k < 30; ++k) REQUIRE(solver.step().status == Status::ok);
    gauges.record(solver);
    const auto file = read_csv(directory / "run.csv");
    const auto row = static_cast<std::size_t>(i);
    const auto value = [&](const std::string& head) { return file.at(head).at(row); };
    const auto [b, l] = place_of(solver, gauges.followed("crest"));
    const auto& points = solver.solid();
    const Real x[2] = {points.at(field::position, b, 0)[l], points.at(field::position, b, 1)[l]};
    CHECK(value("time [s]") == solver.time());
    CHECK(value("crest.displacement_x [m]") == doctest::Approx(x[0] - start[0]).epsilon(1e-9));
    CHECK(value("crest.displacement_y [m]") == doctest::Approx(x[1] - start[1]).epsilon(1e-9));
    CHECK(value("crest.displacement_y [m]") < 0);  // it settles under its weight
    CHECK(value("crest.velocity_y [m/s]") == points.at(field::velocity, b, 1)[l]);
    const char* names[] = {"xx", "yy", "zz", "xy"};
    for (int c = 0; c < 4; ++c)
      CHECK(value(std::string("crest.bishop_stress_") + names[c] + " [Pa]") ==
            points.at(field::bishop_stress, b, c)[l]);
    CHECK(value("crest.mean_stress [Pa]") ==
          doctest::Approx((value("crest.bishop_stress_xx [Pa]") +
                           value("crest.bishop_stress_yy [Pa]") +
                           value("crest.bishop_stress_zz [Pa]")) /
                          3));
    CHECK(value("crest.deviatoric_stress [Pa]") > 0);
    for (const auto& output : law::outputs<law::DruckerPrager>())
      CHECK(value(std::string("crest.") + output.name + " [" + output.unit + "]") ==
            points.at(field::law_state, b, output.index)[l]);
    CHECK(value("crest.porosity [-]") ==
          doctest::Approx(1 -
                          points.at(field::mass, b)[l] / (2650 * points.at(field::volume, b)[l])));
    CHECK(value("crest.saturation [-]") > 0);
    CHECK(value("crest.saturation [-]") < 1);
    CHECK(value("crest.liquid_pressure [Pa]") < 0);
  }
}

TEST_CASE("gauges: positions and lines read the water at rest, and NaN where there is nothing") {
  const TemporaryDirectory directory("gauges_place");
  Solver<GaugedSoil> solver = gauged_solver();
  io::Gauges gauges{directory / "rest.csv"};
  gauges.position("deep", {0.15, 0.03}, {Measure::liquid_pressure, Measure::suction});
  gauges.position("high", Vec<2>{0.2, 0.3},
                  {Measure::suction, Measure::saturation, Measure::porosity});
  gauges.position("air", {0.9, 0.4},
                  {Measure::liquid_pressure, Measure::suction, Measure::displacement});
  gauges.line("axis", {0.2, 0.0}, {0.2, 0.3}, 7,
              {Measure::liquid_pressure, Measure::saturation, Measure::bishop_stress});
  gauges.record(solver);
  const auto file = read_csv(directory / "rest.csv");
  CHECK(file.at("deep.liquid_pressure [Pa]")[0] == doctest::Approx(9810 * 0.07));
  CHECK(file.at("deep.suction [Pa]")[0] == 0);
  CHECK(file.at("high.suction [Pa]")[0] == doctest::Approx(9810 * 0.2));
  CHECK(file.at("high.saturation [-]")[0] < 1);
  CHECK(file.at("high.porosity [-]")[0] == doctest::Approx(0.4));
  CHECK(std::isnan(file.at("air.liquid_pressure [Pa]")[0]));
  CHECK(std::isnan(file.at("air.suction [Pa]")[0]));
  CHECK(std::isnan(file.at("air.displacement_y [m]")[0]));

  const auto profile = read_csv(directory / "rest_axis_000000.csv");
  REQUIRE(profile.at("distance [m]").size() == 7);
  for (std::size_t i = 0; i < 7; ++i) {
    const Real y = 0.05 * static_cast<Real>(i);
    CHECK(profile.at("time [s]")[i] == 0);
    CHECK(profile.at("distance [m]")[i] == doctest::Approx(y));
    CHECK(profile.at("x [m]")[i] == 0.2);
    CHECK(profile.at("y [m]")[i] == doctest::Approx(y));
    CHECK(profile.at("liquid_pressure [Pa]")[i] == doctest::Approx(9810 * (0.1 - y)));
    CHECK(profile.at("bishop_stress_yy [Pa]")[i] == 0);
  }
  REQUIRE(solver.step().status == Status::ok);  // the pressure cells now say the same
  gauges.record(solver);
  const auto later = read_csv(directory / "rest_axis_000001.csv");
  for (std::size_t i = 0; i < 7; ++i)
    CHECK(later.at("liquid_pressure [Pa]")[i] ==
          doctest::Approx(profile.at("liquid_pressure [Pa]")[i]).epsilon(1e-6));
  CHECK(read_csv(directory / "rest.csv").at("time [s]")[1] == solver.time());
}

TEST_CASE("gauges: numbers of the scene are sums over its points") {
  const TemporaryDirectory directory("gauges_scene");
  Solver<GaugedSoil> solver = gauged_solver();
  io::Gauges gauges{directory / "scene.csv"};
  gauges.scene({SceneMeasure::step, SceneMeasure::time_step, SceneMeasure::kinetic_energy});
  gauges.scene({SceneMeasure::max_displacement, SceneMeasure::run_out, SceneMeasure::height,
                SceneMeasure::pore_water, SceneMeasure::free_water, SceneMeasure::water_inflow,
                SceneMeasure::water_outflow, SceneMeasure::water_closure,
                SceneMeasure::solid_closure});
  io::WaterBalanceHistory balance(directory / "balance.csv");
  for (int k = 0; k < 50; ++k) REQUIRE(solver.step().status == Status::ok);
  gauges.record(solver);
  balance.record(solver);
  const auto file = read_csv(directory / "scene.csv");
  const auto ledger = read_csv(directory / "balance.csv");
  Real energy = 0, most = 0, run_out = -1, height = -1;
  const auto add_energy = [&](const auto& points) {
    points.for_each([&](std::size_t b, int l) {
      energy += 0.5 * points.at(field::mass, b)[l] *
                (std::pow(points.at(field::velocity, b, 0)[l], 2) +
                 std::pow(points.at(field::velocity, b, 1)[l], 2));
    });
  };
  add_energy(solver.solid());
  add_energy(solver.liquid());
  solver.solid().for_each([&](std::size_t b, int l) {
    most = std::fmax(most, solver.displacement(b, l).norm());
    run_out = std::fmax(run_out, solver.solid().at(field::position, b, 0)[l]);
    height = std::fmax(height, solver.solid().at(field::position, b, 1)[l]);
  });
  CHECK(file.at("step [-]")[0] == 50);
  CHECK(file.at("time_step [s]")[0] == solver.last_step().dt);
  CHECK(energy > 0);
  CHECK(file.at("kinetic_energy [J]")[0] == doctest::Approx(energy).epsilon(1e-12));
  CHECK(most > 0);
  CHECK(file.at("max_displacement [m]")[0] == most);
  CHECK(file.at("run_out [m]")[0] == run_out);
  CHECK(run_out == doctest::Approx(0.375).epsilon(1e-3));
  CHECK(file.at("height [m]")[0] == height);
  const WaterBalance w = solver.water_balance();
  const SolidBalance s = solver.solid_balance();
  CHECK(w.outflow > 0);
  CHECK(file.at("water_outflow [kg]")[0] == w.outflow);
  CHECK(file.at("pore_water [kg]")[0] == w.pore);
  CHECK(file.at("free_water [kg]")[0] == 0);
  CHECK(file.at("water_closure [kg]")[0] == w.closure());
  CHECK(std::fabs(w.closure()) < 1e-12 * w.initial);
  CHECK(file.at("solid_closure [kg]")[0] == s.closure());

  CHECK(ledger.at("time [s]")[0] == solver.time());
  CHECK(ledger.at("water_initial [kg]")[0] == w.initial);
  CHECK(ledger.at("water_inflow [kg]")[0] == w.inflow);
  CHECK(ledger.at("water_outflow [kg]")[0] == w.outflow);
  CHECK(ledger.at("pore_water [kg]")[0] == w.pore);
  CHECK(ledger.at("water_closure [kg]")[0] ==
        doctest::Approx(w.pore + w.free - w.initial - w.inflow + w.outflow + w.lost)
            .epsilon(1e-12)
            .scale(w.initial));
  CHECK(ledger.at("solid_stored [kg]")[0] == doctest::Approx(2650 * 0.6 * 0.12).epsilon(1e-12));
  CHECK(ledger.at("solid_relative_closure [-]")[0] == s.relative_closure());
}

TEST_CASE("gauges: what the model has not, wrong dimensions and late gauges are refused") {
  const TemporaryDirectory directory("gauges_refused");
  using Dry = DryModel<Uniaxial>;
  Scene<Dry> scene{{.box = {{0.0}, {1.0}}, .cell_size = 0.1}};
  scene.add_soil(box({0.0}, {0.5}),
                 Material<Dry>{.solid_density = 2000,
                               .porosity = 0.5,
                               .skeleton = {.young_modulus = 1e6, .poisson_ratio = 0.25}},
                 {.points_per_cell = 2});
  const Solver<Dry> solver{scene};
  const auto refusal = [&](auto&& add) {
    io::Gauges gauges{directory / "never.csv"};
    return error_message<SetupError>([&] {
      add(gauges);
      gauges.record(solver);
    });
  };
  CHECK(refusal([](io::Gauges& g) { g.position("p", {0.1}, {Measure::suction}); }) ==
        "measure = suction outside {measures of what the model has} [-] in gauge 'p'");
  CHECK(refusal([](io::Gauges& g) {
          g.line("axis", {0.1}, {0.3}, 3, {Measure::saturation});
        }).find("in gauge 'axis'") != std::string::npos);
  CHECK(refusal([](io::Gauges& g) {
          g.position("flat", {0.1, 0.2}, {Measure::mean_stress});
        }) == "dimension = 2 outside {1} [-] in gauge 'flat'");
  CHECK(refusal([](io::Gauges& g) {
          g.point("nan", {unset}, {Measure::mean_stress});
        }).find("position") != std::string::npos);
  CHECK(refusal([](io::Gauges& g) { g.line("axis", {0.1}, {0.3}, 1, {Measure::mean_stress}); }) ==
        "count = 1 outside [2, inf) [-]");
  CHECK_FALSE(std::filesystem::exists(directory / "never.csv"));

  io::Gauges gauges{directory / "dry.csv"};
  gauges.point("top", {0.5}, {Measure::displacement, Measure::bishop_stress});
  gauges.record(solver);
  CHECK(gauges.followed("top") == 9);
  CHECK(error_message<SetupError>([&] {
          gauges.scene({SceneMeasure::step});
        }).find("before the first record") != std::string::npos);
  const auto file = read_csv(directory / "dry.csv");
  CHECK(file.size() == 5);
  CHECK(file.count("top.bishop_stress_zz [Pa]") == 1);
}

TEST_CASE("samples: before the first step water is as the scene gives it, after equilibrium too") {
  const Material<GaugedSoil> silt{
      .solid_density = 2650,
      .porosity = 0.4,
      .skeleton = {.elastic = {.young_modulus = 5e7, .poisson_ratio = 0.3},
                   .friction_angle = degrees(30)},
      .retention = {.a = 1.2, .lambda = 0.6},
      .conductivity = {.saturated_conductivity = 1e-3, .lambda = 0.6}};
  Scene<GaugedSoil> scene{{.box = {{0.0, 0.0}, {4.0, 4.0}}, .cell_size = 1.0}};
  scene.gravity = {0.0, -9.81};
  scene.liquid = {.density = 1000, .bulk_modulus = 2e6};
  const Real suction = 9e3;
  scene.add_soil(box({0.0, 0.0}, {4.0, 3.0}), silt, {.suction = suction});
  scene.add(bc::Fixed{.face = Face::bottom});
  Solver<GaugedSoil> solver{scene};
  const Vec<2> place{0.25, 1.25};  // a point of the lattice
  const auto check = [&] {
    const auto water = io::WaterSampler(solver.state()).at(place);
    const auto nearest = io::nearest_of_all(solver.liquid(), place, 1.0);
    REQUIRE(nearest);
    const Real above = place[1] - io::position_of<2>(solver.liquid(), *nearest)[1];
    CHECK(water.pressure == doctest::Approx(-suction - 9810 * above).epsilon(1e-9));
    const auto& curve = solver.state().soils[0].material.retention;
    const Real porosity = solver.liquid().at(field::porosity, nearest->batch)[nearest->lane];
    CHECK(water.saturation == doctest::Approx(curve.saturation(suction, porosity)).epsilon(1e-9));
  };
  check();
  solver.equilibrate();
  check();
}

TEST_CASE("run summary: the numbers printed are those of the solver") {
  Solver<GaugedSoil> solver = gauged_solver();
  const std::string before =
      printed([&](std::FILE* out) { io::print_preflight(out, solver, 1000.0); });
  CHECK(solver.steps() == 0);
  CHECK(number_after(before, "points   ") == 48);
  CHECK(number_after(before, "solid, ") == 48);
  const Real dt = number_after(before, "step     ");
  CHECK(dt > 0);
  // A trend that the trial may show takes the step from that printed towards that of wet soil.
  const Real shortest = std::min(dt, solver.estimate(1000.0).shortest_dt);
  CHECK(number_after(before, "steps    ") >= 0.99 * 1000 / dt);
  CHECK(number_after(before, "steps    ") <= 1.01 * 1000 / shortest);
  CHECK(before.find("limited by two-phase wave") != std::string::npos);

  const io::RunClock clock(solver);
  for (int k = 0; k < 20; ++k) REQUIRE(solver.step().status == Status::ok);
  CHECK(clock.steps(solver) == 20);
  const std::string after = printed([&](std::FILE* out) { io::print_summary(out, solver, clock); });
  CHECK(number_after(after, "t = ") == doctest::Approx(solver.time()).epsilon(1e-5));
  CHECK(number_after(after, "after ") == 20);
  CHECK(number_after(after, "water ") ==
        doctest::Approx(solver.water_balance().initial).epsilon(1e-5));
  CHECK(number_after(after, "start, ") >= 0);
  CHECK(number_after(after, "grains ") == doctest::Approx(2650 * 0.6 * 0.12).epsilon(1e-5));
  CHECK(number_after(after, "wall ") > 0);
  CHECK(number_after(after, "s, ") > 0);
  CHECK(after.find("ns per point and step") != std::string::npos);
  CHECK(printed([&](std::FILE* out) { io::print_summary(out, solver); }).find("wall") ==
        std::string::npos);
}

TEST_CASE("advance: the same run as advance_to, with lines about its progress") {
  Solver<GaugedSoil> quiet = gauged_solver(), watched = gauged_solver();
  const Real end = 40.5 * quiet.step().dt;
  quiet = gauged_solver();
  quiet.advance_to(end);
  const std::string text = printed([&](std::FILE* out) {
    io::Progress progress(end, 0, out);  // a line at every step
    io::advance(watched, end, progress);
  });
  CHECK(watched.time() == end);
  CHECK(watched.steps() == quiet.steps());
  std::int64_t lines = 0;
  for (const char c : text) lines += c == '\n' ? 1 : 0;
  CHECK(lines == watched.steps());
  CHECK(text.find("(100.0 %)") != std::string::npos);
  quiet.solid().for_each([&](std::size_t b, int l) {
    for (int d = 0; d < 2; ++d) {
      CHECK(watched.solid().at(field::position, b, d)[l] ==
            quiet.solid().at(field::position, b, d)[l]);
      CHECK(watched.solid().at(field::bishop_stress, b, d)[l] ==
            quiet.solid().at(field::bishop_stress, b, d)[l]);
    }
  });
}

TEST_CASE("suction is read in a cell as that of water at rest with the water that the cell has") {
  using Soil = vadose_test::Seepage<Uniaxial>;
  const Real uniform = 9.2e3, weight = 9810;  // [Pa], [Pa/m]
  Real error[2];
  for (int k = 0; k < 2; ++k) {
    const Real h = k == 0 ? 1 : 0.5;
    Scene<Soil> scene{{.box = {{0.0}, {4 * h}}, .cell_size = h}};
    scene.gravity[0] = -9.81;
    scene.add_soil(box({0.0}, {4 * h}),
                   {.porosity = 0.48,
                    .lambda = 0.89,
                    .retention = {.a = 1.2},
                    .conductivity = {.saturated_conductivity = 1e-9}},
                   {.suction = uniform});
    Solver<Soil> solver{scene};
    REQUIRE(solver.step().status == Status::ok);
    const io::WaterSample water = io::WaterSampler<Soil>(solver.state()).at(Vec<1>(1.5 * h));

    const auto& curve = solver.state().soils[0].material.retention;
    // Uniform suction is not at rest: its saturation is the mean over the points of S at rest.
    std::vector<Real> heights;
    solver.liquid().for_each([&](std::size_t b, int l) {
      const Real x = solver.liquid().at(field::position, b, 0)[l];
      if (x > h && x < 2 * h) heights.push_back(x - 1.5 * h);
    });
    REQUIRE(heights.size() > 1);
    const auto mean_saturation = [&](Real suction) {
      Real sum = 0;
      for (const Real z : heights) sum += curve.saturation(suction + weight * z, 0.48);
      return sum / static_cast<Real>(heights.size());
    };
    const Real saturation = curve.saturation(uniform, 0.48);
    Real low = uniform, high = 2 * uniform;
    for (int i = 0; i < 60; ++i)
      (mean_saturation((low + high) / 2) > saturation ? low : high) = (low + high) / 2;
    CHECK(water.saturation == doctest::Approx(saturation).epsilon(1e-5));
    CHECK(-water.pressure == doctest::Approx(low).epsilon(1e-5));
    error[k] = -water.pressure - uniform;
    MESSAGE("cells of ", h, " m: suction ", -water.pressure, " Pa, uniform ", uniform, " Pa");
  }
  // Second order in the cell size.
  CHECK(error[0] > 0);
  CHECK(error[1] < 0.35 * error[0]);
}
