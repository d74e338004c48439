// SPDX-License-Identifier: MIT
// Series of point files written from a solver, read back and compared with the solver's state.

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <vadose/io/vtk_series.hpp>
#include <vadose/solver/two_phase_solver.hpp>

#include "../error_message.hpp"
#include "../slope.hpp"
#include "../temporary_directory.hpp"

namespace {

using namespace vadose;
using vadose_test::error_message;
using vadose_test::TemporaryDirectory;

std::string file_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

struct SeriesColumn {
  std::size_t components = 0;
  std::vector<Real> values;
  Real at(std::size_t point, std::size_t component = 0) const {
    return values.at(point * components + component);
  }
};

/// Points (as "Points") and columns of an appended-raw .vtp file.
std::map<std::string, SeriesColumn> read_columns(const std::string& path) {
  const std::string text = file_text(path);
  const std::string marker = "<AppendedData encoding=\"raw\">\n_";
  const std::size_t data = text.find(marker) + marker.size();
  REQUIRE(data > marker.size());
  std::map<std::string, SeriesColumn> columns;
  for (std::size_t at = 0; (at = text.find("<DataArray type=\"Float64\"", at)) < data; ++at) {
    const auto attribute = [&](const std::string& key) {
      const std::size_t begin = text.find(key + "=\"", at) + key.size() + 2;
      return text.substr(begin, text.find('"', begin) - begin);
    };
    const std::size_t from = data + std::stoull(attribute("offset"));
    std::uint64_t bytes = 0;
    REQUIRE(from + 8 <= text.size());
    std::memcpy(&bytes, text.data() + from, 8);
    REQUIRE(from + 8 + bytes <= text.size());
    SeriesColumn& column = columns[attribute("Name")];
    column.components = std::stoull(attribute("NumberOfComponents"));
    column.values.resize(bytes / 8);
    std::memcpy(column.values.data(), text.data() + from + 8, bytes);
  }
  return columns;
}

using vadose_test::Salt;
using WetSoil = vadose_test::Slope;

/// Two soils of different suction, and a pool beside them; the widths leave unused lanes.
Solver<WetSoil> wet_solver() {
  Material<WetSoil> silt{.name = "silt",
                         .solid_density = 2650,
                         .porosity = 0.4,
                         .skeleton = {.elastic = {.young_modulus = 5e6, .poisson_ratio = 0.3},
                                      .friction_angle = degrees(30)},
                         .retention = {.a = 1.2, .lambda = 0.6},
                         .conductivity = {.saturated_conductivity = 1e-4, .lambda = 0.6}};
  Scene<WetSoil> scene{{.box = {{0.0, 0.0}, {1.0, 0.5}}, .cell_size = 0.1}};
  scene.gravity = {0.0, -9.81};
  scene.liquid = {.density = 1000, .bulk_modulus = 2e6};
  scene.add_soil(box({0.0, 0.0}, {0.3, 0.3}), silt, {.suction = 5e3});
  silt.name = "wetter";
  silt.porosity = 0.45;
  scene.add_soil(box({0.3, 0.0}, {0.6, 0.2}), silt, {.water_table = 0.4});
  scene.add_water(box({0.6, 0.0}, {1.0, 0.1}), {.surface_level = 0.1});
  return Solver<WetSoil>{scene, {.courant = 0.3}};
}

const auto suction = [](Real p) { return p < 0 ? -p : 0.0; };

void check_solid(const Solver<WetSoil>& solver, const std::map<std::string, SeriesColumn>& file) {
  const auto& points = solver.solid();
  const auto& ids = file.at("id [-]");
  REQUIRE(ids.values.size() == points.size());
  for (std::size_t i = 0; i < ids.values.size(); ++i)
    REQUIRE(ids.values[i] == static_cast<Real>(i));  // ordered, none twice, no padding
  points.for_each([&](std::size_t b, int l) {
    const auto i = static_cast<std::size_t>(points.at(field::id, b)[l]);
    const Vec<2> u = solver.displacement(b, l);
    for (int d = 0; d < 2; ++d) {
      const auto c = static_cast<std::size_t>(d);
      CHECK(file.at("Points").at(i, c) == points.at(field::position, b, d)[l]);
      CHECK(file.at("velocity [m/s]").at(i, c) == points.at(field::velocity, b, d)[l]);
      CHECK(file.at("displacement [m]").at(i, c) == u[d]);
    }
    CHECK(file.at("velocity [m/s]").at(i, 2) == 0);
    Real s[6] = {};
    for (int c = 0; c < 4; ++c) s[c] = points.at(field::bishop_stress, b, c)[l];
    for (std::size_t c = 0; c < 6; ++c) CHECK(file.at("bishop_stress [Pa]").at(i, c) == s[c]);
    CHECK(file.at("mean_stress [Pa]").at(i) == doctest::Approx((s[0] + s[1] + s[2]) / 3));
    const Real q = std::sqrt(0.5 * ((s[0] - s[1]) * (s[0] - s[1]) + (s[1] - s[2]) * (s[1] - s[2]) +
                                    (s[2] - s[0]) * (s[2] - s[0])) +
                             3 * s[3] * s[3]);
    CHECK(file.at("deviatoric_stress [Pa]").at(i) == doctest::Approx(q));
    CHECK(file.at("material [-]").at(i) == points.group(b));
    const Real n = 1 - points.at(field::mass, b)[l] / (2650 * points.at(field::volume, b)[l]);
    CHECK(file.at("porosity [-]").at(i) == doctest::Approx(n).epsilon(1e-14));
    for (const auto& output : law::outputs<law::DruckerPrager>())
      CHECK(file.at(std::string(output.name) + " [" + output.unit + "]").at(i) ==
            points.at(field::law_state, b, output.index)[l]);
    CHECK(file.at("suction [Pa]").at(i) == suction(file.at("liquid_pressure [Pa]").at(i)));
  });
}

void check_liquid(const Solver<WetSoil>& solver, const std::map<std::string, SeriesColumn>& file) {
  const auto& points = solver.liquid();
  const auto& ids = file.at("id [-]").values;
  REQUIRE(ids.size() == points.size());
  REQUIRE(std::is_sorted(ids.begin(), ids.end()));
  Real mass = 0;
  std::size_t free = 0;
  points.for_each([&](std::size_t b, int l) {
    const Real id = points.at(field::id, b)[l];
    const auto i =
        static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
    REQUIRE(ids[i] == id);
    const Real m = points.at(field::mass, b)[l], v = points.at(field::volume, b)[l];
    const Real n = points.at(field::porosity, b)[l], p = points.at(field::liquid_pressure, b)[l];
    CHECK(file.at("mass [kg]").at(i) == m);
    CHECK(file.at("liquid_pressure [Pa]").at(i) == p);
    CHECK(file.at("porosity [-]").at(i) == n);
    CHECK(file.at("velocity [m/s]").at(i, 1) == points.at(field::velocity, b, 1)[l]);
    CHECK(file.at("saturation [-]").at(i) * n * v * 1000 * std::exp(p / 2e6) ==
          doctest::Approx(m).epsilon(1e-13));
    const bool is_free = points.group(b) == solver.state().free_group();
    CHECK(file.at("kind [-]").at(i) == (is_free ? 1 : 0));
    mass += file.at("mass [kg]").at(i);
    free += is_free ? 1u : 0u;
  });
  CHECK(free == 16);
  const WaterBalance balance = solver.water_balance();
  CHECK(mass == doctest::Approx(balance.pore + balance.free).epsilon(1e-13));
}

}  // namespace

TEST_CASE("vtk series: both phases before and after steps hold the solver's state") {
  const TemporaryDirectory directory("series_wet");
  Solver<WetSoil> solver = wet_solver();
  io::VtkSeries series{directory / "slope"};
  series.write(solver);
  const auto start = read_columns(directory / "slope_solid_000000.vtp");
  check_solid(solver, start);
  check_liquid(solver, read_columns(directory / "slope_liquid_000000.vtp"));
  // before any step: water where the scene put it
  for (std::size_t i = 0; i < 36; ++i)
    CHECK(start.at("suction [Pa]").at(i) == doctest::Approx(5e3).epsilon(1e-12));
  for (std::size_t i = 36; i < 60; ++i) {
    const Real y = start.at("Points").at(i, 1);
    CHECK(start.at("liquid_pressure [Pa]").at(i) == doctest::Approx(9810 * (0.4 - y)));
    CHECK(start.at("saturation [-]").at(i) == doctest::Approx(1).epsilon(1e-12));
  }
  CHECK(start.at("saturation [-]").at(0) < 0.99);

  for (int i = 0; i < 40; ++i) REQUIRE(solver.step().status == Status::ok);
  series.write(solver);
  const auto later = read_columns(directory / "slope_solid_000001.vtp");
  check_solid(solver, later);
  check_liquid(solver, read_columns(directory / "slope_liquid_000001.vtp"));
  // after steps: the pressure cell of the point, hydrostatic inside it
  const auto& state = solver.state();
  state.solid.for_each([&](std::size_t b, int l) {
    const auto i = static_cast<std::size_t>(state.solid.at(field::id, b)[l]);
    const Real x = state.solid.at(field::position, b, 0)[l];
    const Real y = state.solid.at(field::position, b, 1)[l];
    const Index<2> index{{static_cast<int>(x / 0.1), static_cast<int>(y / 0.1)}};
    const auto owner = state.nodes.dof[static_cast<std::size_t>(state.grid.entry(index))];
    REQUIRE(owner >= 0);
    const auto& cell = state.nodes.cell[static_cast<std::size_t>(owner)];
    CHECK(later.at("liquid_pressure [Pa]").at(i) ==
          doctest::Approx(cell.pressure - 9810 * (y - cell.centroid[1])).epsilon(1e-12));
    CHECK(later.at("saturation [-]").at(i) == cell.saturation);
  });

  for (const std::string phase : {"solid", "liquid"}) {
    const std::string list = file_text(directory / ("slope_" + phase + ".pvd"));
    CHECK(list.find("timestep=\"0\" part=\"0\" file=\"slope_" + phase + "_000000.vtp\"") !=
          std::string::npos);
    CHECK(list.find("file=\"slope_" + phase + "_000001.vtp\"") != std::string::npos);
    CHECK(file_text(directory / ("slope_" + phase + "_000001.vtp")).find("tension positive") !=
          std::string::npos);
  }
  CHECK(series.solid().size() == 2);
}

TEST_CASE("vtk series: columns by name, and a phase that is not there gets no file") {
  const TemporaryDirectory directory("series_chosen");
  Solver<WetSoil> solver = wet_solver();
  io::VtkSeries chosen{directory / "some", {"mean_stress", "kind"}};
  chosen.write(solver);
  const auto solid = read_columns(directory / "some_solid_000000.vtp");
  CHECK(solid.size() == 2);  // Points and one column
  CHECK(solid.count("mean_stress [Pa]") == 1);
  CHECK(read_columns(directory / "some_liquid_000000.vtp").count("kind [-]") == 1);
  io::VtkSeries wrong{directory / "wrong", {"pressure"}};
  const std::string message = error_message<io::OutputError>([&] { wrong.write(solver); });
  CHECK(message.find("no column 'pressure', only id, material") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(directory / "wrong_solid_000000.vtp"));

  using Dry = DryModel<Uniaxial>;
  Scene<Dry> scene{{.box = {{0.0}, {1.0}}, .cell_size = 0.1}};
  scene.add_soil(box({0.0}, {0.5}),
                 Material<Dry>{.solid_density = 2000,
                               .porosity = 0.5,
                               .skeleton = {.young_modulus = 1e6, .poisson_ratio = 0.25}},
                 {.points_per_cell = 2});
  io::VtkSeries dry{directory / "dry"};
  dry.write(Solver<Dry>{scene});
  const auto columns = read_columns(directory / "dry_solid_000000.vtp");
  CHECK(columns.at("id [-]").values.size() == 10);
  CHECK(columns.at("bishop_stress [Pa]").components == 6);
  CHECK(columns.count("liquid_pressure [Pa]") == 0);
  CHECK_FALSE(std::filesystem::exists(directory / "dry_liquid.pvd"));

  using Water = FreeWaterModel<PlaneStrain>;
  Scene<Water> pool{{.box = {{0.0, 0.0}, {0.4, 0.4}}, .cell_size = 0.1}};
  pool.gravity = {0.0, -9.81};
  pool.add_water(box({0.0, 0.0}, {0.4, 0.2}), {.surface_level = 0.2});
  io::VtkSeries water{directory / "water"};
  water.write(Solver<Water>{pool});
  const auto liquid = read_columns(directory / "water_liquid_000000.vtp");
  for (std::size_t i = 0; i < 32; ++i) {
    CHECK(liquid.at("saturation [-]").at(i) == doctest::Approx(1).epsilon(1e-12));
    CHECK(liquid.at("porosity [-]").at(i) == 1);
    CHECK(liquid.at("kind [-]").at(i) == 1);
  }
  CHECK_FALSE(std::filesystem::exists(directory / "water_solid.pvd"));
}

TEST_CASE("vtk series: cells and nodes of the grid, and the host's own fields") {
  const TemporaryDirectory directory("series_grid");
  Solver<WetSoil> solver = wet_solver();
  solver.mutable_state().liquid.at(Salt{}, 0)[0] = 35;
  for (int i = 0; i < 5; ++i) REQUIRE(solver.step().status == Status::ok);
  io::VtkSeries series{directory / "wet", {}, io::VtkSeries::Grid::yes};
  series.write(solver);
  const auto liquid = read_columns(directory / "wet_liquid_000000.vtp");
  const auto& salt = liquid.at("salt [g/kg]").values;
  CHECK(std::count(salt.begin(), salt.end(), 35.0) == 1);
  CHECK(std::count(salt.begin(), salt.end(), 0.0) == static_cast<long>(salt.size()) - 1);
  // 10 x 5 cells in two blocks: the box
  const auto grid = read_columns(directory / "wet_grid_000000.vti");
  const auto& state = solver.state();
  const auto& pressure = grid.at("cell_pressure [Pa]").values;
  const auto& velocity = grid.at("solid_velocity [m/s]").values;
  REQUIRE(pressure.size() == 50);
  REQUIRE(velocity.size() == 3 * 66);
  int wrong = 0, filled = 0;
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 10; ++x) {
      const auto entry = static_cast<std::size_t>(state.grid.entry({{x, y}}));
      const Real value = pressure[static_cast<std::size_t>(y * 10 + x)];
      wrong += (state.nodes.dof[entry] < 0) != std::isnan(value);
      filled += !std::isnan(value);
      const auto node = static_cast<std::size_t>(3 * (y * 11 + x));
      wrong += velocity[node + 1] != state.nodes.solid_out[entry][lane::velocity + 1];
    }
  CHECK(wrong == 0);
  CHECK(filled == 3 * 3 + 3 * 2 + 4);
  CHECK(grid.at("cell_kind [-]").values[9] == 1);
  CHECK(grid.at("cell_kind [-]").values[0] == 0);
  CHECK(file_text(directory / "wet_grid.pvd").find("wet_grid_000000.vti") != std::string::npos);

  // VTK's own reader, where there is one.
  const std::string script = std::filesystem::path(__FILE__).replace_filename("read_with_vtk.py");
  int result = 77;
  for (const std::string python : {"python3", "/usr/bin/python3"})
    if (result == 77 || result == 127)
      result = WEXITSTATUS(
          std::system((python + " '" + script + "' '" + directory.path.string() + "'").c_str()));
  if (result == 77 || result == 127)
    MESSAGE("VTK's reader (package python3-vtk9) is not installed: skipped");
  else
    CHECK(result == 0);
}

TEST_CASE("vtk series: the solver named by its policies is that of its positional model") {
  using Named =
      TwoPhaseSolver<PlaneStrain, shape::Gimp, law::LinearElastic, swrc::Tarantino, drag::Darcy>;
  using Model =
      PositionalModel<PlaneStrain, shape::Gimp, law::LinearElastic, swrc::Tarantino, drag::Darcy>;
  CHECK(std::is_same_v<Named, Solver<Model>>);
  CHECK(is_unsaturated<Model>);
  CHECK(Named::dim == 2);
}
