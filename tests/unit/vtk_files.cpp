// SPDX-License-Identifier: MIT
// .vtp and .pvd files are read back by a parser of their own and compared bit for bit.

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include <vadose/io/pvd_series.hpp>
#include <vadose/io/vtk_grid.hpp>
#include <vadose/io/vtk_points.hpp>

#include "../error_message.hpp"
#include "../temporary_directory.hpp"

namespace {

namespace io = vadose::io;
using vadose::Real;
using vadose_test::error_message;
using vadose_test::TemporaryDirectory;

std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Value of attribute `key` in the element that starts at `at`.
std::string attribute(const std::string& text, std::size_t at, const std::string& key) {
  const std::size_t end = text.find('>', at);
  const std::size_t begin = text.find(" " + key + "=\"", at) + key.size() + 3;
  REQUIRE(begin < end);
  return text.substr(begin, text.find('"', begin) - begin);
}

struct ReadArray {
  std::string type;
  std::string name;
  int components;
  std::string bytes;
};

/// All arrays of an appended-raw VTK file, by what its head says.
std::vector<ReadArray> read_arrays(const std::string& text) {
  const std::string marker = "<AppendedData encoding=\"raw\">\n_";
  const std::size_t data = text.find(marker) + marker.size();
  REQUIRE(data > marker.size());
  std::vector<ReadArray> arrays;
  for (std::size_t at = 0; (at = text.find("<DataArray", at)) < data; ++at) {
    ReadArray a;
    a.type = attribute(text, at, "type");
    a.name = attribute(text, at, "Name");
    a.components = std::stoi(attribute(text, at, "NumberOfComponents"));
    CHECK(attribute(text, at, "format") == "appended");
    const std::size_t offset = std::stoull(attribute(text, at, "offset"));
    std::uint64_t bytes = 0;
    REQUIRE(data + offset + 8 <= text.size());
    std::memcpy(&bytes, text.data() + data + offset, 8);
    REQUIRE(data + offset + 8 + bytes <= text.size());
    a.bytes = text.substr(data + offset + 8, bytes);
    arrays.push_back(a);
  }
  return arrays;
}

template <class T>
std::vector<T> values(const ReadArray& a) {
  std::vector<T> v(a.bytes.size() / sizeof(T));
  if (!v.empty()) std::memcpy(v.data(), a.bytes.data(), a.bytes.size());
  return v;
}

bool same_bits(const std::vector<Real>& a, const std::vector<Real>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Real)) == 0);
}

const std::vector<Real> awkward = {0.1,
                                   -0.0,
                                   5e-324,
                                   std::numeric_limits<Real>::max(),
                                   1.0 / 3,
                                   -1e5,
                                   std::numeric_limits<Real>::quiet_NaN(),
                                   2.0 / 7};

}  // namespace

TEST_CASE("vtk: points and columns read back bit for bit in one to three dimensions") {
  const TemporaryDirectory directory("vtk_points", true);
  for (int dim = 1; dim <= 3; ++dim) {
    const std::size_t points = 2;
    std::vector<Real> positions;
    for (std::size_t i = 0; i < points * std::size_t(dim); ++i) positions.push_back(awkward[i]);
    const std::vector<io::Column> columns = {
        {"liquid_pressure [Pa]", 1, {awkward[3], awkward[6]}},
        {"bishop_stress [Pa]", 4, awkward},
    };
    const std::string path = directory / "sub/points_" + std::to_string(dim) + ".vtp";
    io::write_vtp(path, dim, positions, columns, "stress: tension + -- <a&b>-");
    const std::string text = content(path);
    CHECK(text.rfind("<?xml", 0) == 0);
    CHECK(text.find("byte_order=\"LittleEndian\"") != std::string::npos);
    CHECK(text.find("header_type=\"UInt64\"") != std::string::npos);
    const std::size_t comment = text.find("<!--");
    CHECK(text.find("--", comment + 4) == text.find("-->", comment));  // no "--" inside
    const std::size_t piece = text.find("<Piece");
    CHECK(attribute(text, piece, "NumberOfPoints") == "2");
    CHECK(attribute(text, piece, "NumberOfVerts") == "2");
    CHECK(text.size() > 30);
    CHECK(text.substr(text.size() - 28) == "\n</AppendedData>\n</VTKFile>\n");

    const auto arrays = read_arrays(text);
    REQUIRE(arrays.size() == 5);
    CHECK(arrays[0].components == 3);
    std::vector<Real> padded(3 * points, 0.0);
    for (std::size_t i = 0; i < points; ++i)
      for (std::size_t d = 0; d < std::size_t(dim); ++d)
        padded[3 * i + d] = positions[std::size_t(dim) * i + d];
    CHECK(same_bits(values<Real>(arrays[0]), padded));
    CHECK(arrays[1].type == "Int64");
    CHECK(values<std::int64_t>(arrays[1]) == std::vector<std::int64_t>{0, 1});
    CHECK(values<std::int64_t>(arrays[2]) == std::vector<std::int64_t>{1, 2});
    CHECK(arrays[3].name == "liquid_pressure [Pa]");
    CHECK(same_bits(values<Real>(arrays[3]), columns[0].values));
    CHECK(arrays[4].components == 4);
    CHECK(same_bits(values<Real>(arrays[4]), columns[1].values));
    // the arrays follow each other without gap up to the end of the data
    std::size_t total = 0;
    for (const auto& a : arrays) total += 8 + a.bytes.size();
    const std::string marker = "<AppendedData encoding=\"raw\">\n_";
    CHECK(text.find(marker) + marker.size() + total + 28 == text.size());
    CHECK_FALSE(std::filesystem::exists(path + ".part"));
  }
}

TEST_CASE("vtk: a file without points is valid, names are escaped") {
  const TemporaryDirectory directory("vtk_empty", true);
  const std::vector<io::Column> columns = {{"a<b & \"c\"", 3, {}}};
  io::write_vtp(directory / "none.vtp", 2, {}, columns);
  const std::string text = content(directory / "none.vtp");
  const auto arrays = read_arrays(text);
  REQUIRE(arrays.size() == 4);
  for (const auto& a : arrays) CHECK(a.bytes.empty());
  CHECK(arrays[3].name == "a&lt;b &amp; &quot;c&quot;");
}

TEST_CASE("vtk: columns of a wrong length are refused and leave no file") {
  const TemporaryDirectory directory("vtk_wrong", true);
  const std::vector<Real> positions = {0, 0, 1, 1};
  const std::vector<io::Column> columns = {{"velocity [m/s]", 2, {1, 2, 3}}};
  const std::string path = directory / "wrong.vtp";
  const std::string message =
      error_message<io::OutputError>([&] { io::write_vtp(path, 2, positions, columns); });
  CHECK(message.find("velocity [m/s]") != std::string::npos);
  CHECK(message.find("3 values, expected 2 x 2") != std::string::npos);
  CHECK(error_message<io::OutputError>([&] {
          io::write_vtp(path, 3, positions, {});
        }).find("4 coordinates") != std::string::npos);
  CHECK(error_message<io::OutputError>([&] {
          io::write_vtp(path, 0, positions, {});
        }).find("0 dimensions") != std::string::npos);
  CHECK(std::filesystem::is_empty(directory.path));
}

TEST_CASE("vtk: unwritable paths are told with path and reason") {
  const TemporaryDirectory directory("vtk_unwritable", true);
  io::write_vtp(directory / "file.vtp", 1, std::vector<Real>{1.0}, {});
  // a file where a directory is needed
  const std::string below = directory / "file.vtp/points.vtp";
  CHECK(error_message<io::OutputError>([&] { io::write_vtp(below, 1, {}, {}); }).find("file.vtp") !=
        std::string::npos);
  // a directory where the file should be: the part file is taken away again
  std::filesystem::create_directories(directory / "taken.vtp/inside");
  const std::string message =
      error_message<io::OutputError>([&] { io::write_vtp(directory / "taken.vtp", 1, {}, {}); });
  CHECK(message.find("cannot write file '" + (directory / "taken.vtp")) != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(directory / "taken.vtp.part"));
  // a full device
  if (std::filesystem::exists("/dev/full")) {
    io::File full("/dev/full");
    const std::string bytes(1 << 20, 'x');
    const std::string text = error_message<io::OutputError>([&] {
      full.write(bytes);
      full.close();
    });
    CHECK(text.find("'/dev/full': No space left on device") != std::string::npos);
  }
}

TEST_CASE("vtk: the series is listed and valid after every write") {
  const TemporaryDirectory directory("pvd", true);
  io::PvdSeries series(directory / "out/slope & co");
  CHECK_FALSE(std::filesystem::exists(series.path()));
  const std::vector<Real> times = {0.0, 0.1, 1.0 / 3};
  for (std::size_t i = 0; i < times.size(); ++i) {
    const std::vector<Real> positions = {times[i], 2.0};
    series.write(times[i], 2, positions, {});
    const std::string text = content(series.path());
    CHECK(text.substr(text.size() - 25) == "</Collection>\n</VTKFile>\n");
    std::size_t listed = 0;
    for (std::size_t at = 0; (at = text.find("<DataSet", at)) != std::string::npos; ++at) {
      REQUIRE(listed <= i);
      CHECK(std::stod(attribute(text, at, "timestep")) == times[listed]);
      const std::string file = attribute(text, at, "file");
      CHECK(file == "slope &amp; co_00000" + std::to_string(listed) + ".vtp");
      const auto arrays = read_arrays(
          content(directory / "out/slope & co_00000" + std::to_string(listed) + ".vtp"));
      CHECK(values<Real>(arrays[0])[0] == times[listed]);
      ++listed;
    }
    CHECK(listed == i + 1);
    CHECK(series.size() == i + 1);
  }
  // time runs forward and is a number
  CHECK(error_message<io::OutputError>([&] { series.write(0.2, 2, {}, {}); }).find("time = 0.2") !=
        std::string::npos);
  CHECK(error_message<io::OutputError>([&] {
          series.write(vadose::unset, 2, {}, {});
        }).find("nan") != std::string::npos);
  // a failed write leaves the list as it was, and the series goes on
  const std::vector<io::Column> wrong = {{"x [m]", 1, {1.0}}};
  const std::string before = content(series.path());
  CHECK(error_message<io::OutputError>([&] { series.write(1.0, 2, {}, wrong); }) != "(no error)");
  CHECK(content(series.path()) == before);
  series.write(1.0, 2, {}, {});
  CHECK(series.size() == 4);
  CHECK(error_message<io::OutputError>([] {
          io::PvdSeries{"some/directory/"};
        }).find("no file name") != std::string::npos);
}

namespace {

/// Every file that a .pvd file lists is there and whole; returns how many.
std::size_t check_series(const std::string& pvd) {
  const std::string text = content(pvd);
  if (text.empty()) return 0;  // killed before the first write
  REQUIRE(text.size() > 24);
  CHECK(text.substr(text.size() - 25) == "</Collection>\n</VTKFile>\n");
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find("<DataSet", at)) != std::string::npos; ++at, ++count) {
    const std::string file =
        content((std::filesystem::path(pvd).parent_path() / attribute(text, at, "file")).string());
    REQUIRE(file.size() > 28);
    CHECK(file.substr(file.size() - 28) == "\n</AppendedData>\n</VTKFile>\n");
    CHECK(read_arrays(file).size() == 4);
  }
  return count;
}

}  // namespace

TEST_CASE("vtk: a series is valid whenever the run is killed, and a later run goes on with it") {
  const std::vector<Real> x(3000, 0.5);
  const std::vector<io::Column> columns = {{"mass [kg]", 1, x}};
  std::size_t written = 0;
  for (unsigned kill_after = 4; kill_after <= 40; kill_after += 6) {  // [ms]
    const TemporaryDirectory directory("vtk_killed", true);
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
      io::PvdSeries series(directory / "run");
      for (int i = 0; i < 100000; ++i) series.write(i, 1, x, columns);
      _exit(0);
    }
    usleep(1000 * kill_after);
    REQUIRE(kill(child, SIGKILL) == 0);
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    const std::size_t before = check_series(directory / "run.pvd");
    written += before;
    io::PvdSeries series(directory / "run");
    series.resume(2.5);
    CHECK(series.size() == std::min<std::size_t>(before, 3));
    series.write(3, 1, x, columns);
    CHECK(check_series(directory / "run.pvd") == std::min<std::size_t>(before, 3) + 1);
  }
  MESSAGE("files written by the runs that were killed: ", written);
  CHECK(written > 0);
}

TEST_CASE("vtk: after a write that fails the series is as it was and can go on") {
  const TemporaryDirectory directory("vtk_full", true);
  const std::vector<Real> x = {0.5};
  io::PvdSeries series(directory / "run");
  series.write(0, 1, x, {});
  const std::string listed = content(directory / "run.pvd");
  const auto failure = [&] {
    return error_message<io::OutputError>([&] { series.write(1, 1, x, {}); });
  };
  // A full disk, first for the points, then for the list.
  std::filesystem::create_symlink("/dev/full", directory / "run_000001.vtp.part");
  CHECK(failure() ==
        "cannot write file '" + (directory / "run_000001.vtp.part") + "': No space left on device");
  std::filesystem::create_symlink("/dev/full", directory / "run.pvd.part");
  CHECK(failure() ==
        "cannot write file '" + (directory / "run.pvd.part") + "': No space left on device");
  CHECK(content(directory / "run.pvd") == listed);
  CHECK(series.size() == 1);
  // A path that cannot be written.
  std::filesystem::create_directory(directory / "run_000001.vtp.part");
  CHECK(failure().find("cannot open file '") == 0);
  std::filesystem::remove(directory / "run_000001.vtp.part");
  series.write(1, 1, x, {});
  CHECK(series.size() == 2);
  const io::PvdSeries none("/dev/null/run");
  CHECK(error_message<io::OutputError>([&] {
          io::PvdSeries(none).write(0, 1, x, {});
        }).find("cannot create directory '/dev/null'") == 0);
}

TEST_CASE("vtk: cells and nodes of a part of a grid read back bit for bit") {
  const TemporaryDirectory directory("vtk_grid", true);
  const io::GridPart part{
      .origin = {1, 2, 0}, .cell_size = 0.5, .low = {2, 1, 0}, .high = {4, 2, 1}, .dim = 2};
  CHECK(part.count(false) == 2);
  CHECK(part.count(true) == 6);
  const std::vector<io::Column> cells = {{"cell_pressure [Pa]", 1, {awkward[0], awkward[6]}}};
  const std::vector<io::Column> nodes = {
      {"velocity [m/s]", 1, {awkward.begin(), awkward.begin() + 6}}};
  io::write_vti(directory / "grid.vti", part, cells, nodes, "cells");
  const std::string text = content(directory / "grid.vti");
  const std::size_t image = text.find("<ImageData");
  CHECK(attribute(text, image, "WholeExtent") == "2 4 1 2 0 0");
  CHECK(attribute(text, image, "Origin") == "1 2 0");
  CHECK(attribute(text, image, "Spacing") == "0.5 0.5 0.5");
  CHECK(attribute(text, text.find("<Piece"), "Extent") == "2 4 1 2 0 0");
  const auto arrays = read_arrays(text);
  REQUIRE(arrays.size() == 2);
  // The nodes come first in the head; their bytes lie behind those of the cells.
  CHECK(arrays[0].name == "velocity [m/s]");
  CHECK(same_bits(values<Real>(arrays[0]), nodes[0].values));
  CHECK(same_bits(values<Real>(arrays[1]), cells[0].values));
  CHECK_THROWS_AS(io::write_vti(directory / "grid.vti", part, nodes, cells), io::OutputError);
}
