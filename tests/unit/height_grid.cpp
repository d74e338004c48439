// SPDX-License-Identifier: MIT
// Height fields: bilinear heights, the region below them, and ESRI ASCII grids, right and wrong.

#include <doctest/doctest.h>

#include <fstream>
#include <string>

#include <vadose/grid/height_field.hpp>
#include <vadose/io/esri_grid.hpp>

#include "../error_message.hpp"
#include "../temporary_directory.hpp"

namespace {

using namespace vadose;
using vadose_test::error_message;
using vadose_test::TemporaryDirectory;

const std::string head = "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 2\n";
const std::string heights = "4 5 6\n1 2 3\n";

/// What is wrong with a file of this text.
std::string complaint(const std::string& text) {
  TemporaryDirectory folder("height_grid", true);
  const std::string path = folder / "ground.asc";
  std::ofstream(path) << text;
  std::string message = error_message<io::InputError>([&] { io::read_esri_grid(path); });
  const std::size_t at = message.find("ground.asc' ");
  return at == std::string::npos ? message : message.substr(at + 12);
}

HeightField read(const std::string& text) {
  TemporaryDirectory folder("height_grid", true);
  std::ofstream(folder / "ground.asc") << text;
  return io::read_esri_grid(folder / "ground.asc");
}

}  // namespace

TEST_CASE("height field: bilinear between the centres, constant beyond them") {
  const HeightField ground(3, 2, 11, 21, 2, {1, 2, 3, 4, 5, 6});
  CHECK(ground(11, 21) == 1);
  CHECK(ground(15, 23) == 6);
  CHECK(ground(12, 21) == doctest::Approx(1.5));
  CHECK(ground(12, 22) == doctest::Approx(3));  // 1 + (x - 11)/2 + 3 (y - 21)/2
  CHECK(ground(14.5, 22.5) == doctest::Approx(5));
  CHECK(ground(10, 20) == 1);
  CHECK(ground(16, 24) == 6);
  CHECK(ground.lowest() == 1);
  CHECK(ground.highest() == 6);
  CHECK(ground.extent().low[0] == 10);
  CHECK(ground.extent().high[1] == 24);
  const HeightField flat(1, 1, 0, 0, 5, {7});
  CHECK(flat(-2, 2) == 7);
}

TEST_CASE("height field: sizes and heights that do not fit are refused") {
  CHECK(error_message<SetupError>([] {
          HeightField(2, 2, 0, 0, 1, {1, 2, 3});
        }) == "number of heights = 3 outside {4} [-] in height field");
  CHECK(error_message<SetupError>([] {
          HeightField(2, 1, 0, 0, 0, {1, 2});
        }) == "cell_size = 0 outside (0, inf) [m] in height field");
  CHECK(
      error_message<SetupError>([] {
        HeightField(2, 1, 0, 0, 1, {1, unset});
      }) ==
      "height of column 1, row 0 from the south = nan (missing or not finite), allowed (-inf, inf) "
      "[m] in height field");
}

TEST_CASE("height field: the region below it") {
  const HeightField ground(3, 2, 11, 21, 2, {1, 2, 3, 4, 5, 6});
  const Region<3> soil = below(ground, Box<3>({10, 20, 0}, {16, 24, 8}));
  CHECK(soil.contains(Vec<3>(12, 22, 2.99)));
  CHECK_FALSE(soil.contains(Vec<3>(12, 22, 3.01)));
  CHECK_FALSE(soil.contains(Vec<3>(12, 22, -0.1)));
  CHECK(error_message<SetupError>([&] {
          below(ground, Box<3>({10, 20, 0}, {17, 24, 8}));
        }) == "box high x = 17 outside [10, 16] of the height field [m]");
}

TEST_CASE("height grid: a file of either convention, rows from north to south") {
  const HeightField corner = read(head + heights);
  CHECK(corner.columns() == 3);
  CHECK(corner.rows() == 2);
  CHECK(corner(11, 21) == 1);
  CHECK(corner(15, 23) == 6);
  const HeightField centre = read(
      "NROWS 2\r\nNCOLS 3\r\nxllcenter 11\r\nYLLCENTER 21\r\ncellsize 2.0\r\nNODATA_value -9999\r\n"
      "4 5\r\n6 1e0 2 3\r\n");
  CHECK(centre(11, 21) == 1);
  CHECK(centre(13, 23) == 5);
}

TEST_CASE("height grid: what is wrong is said with file and line") {
  TemporaryDirectory folder("height_grid_missing", true);
  CHECK(error_message<io::InputError>([&] {
          io::read_esri_grid(folder / "none.asc");
        }).find("none.asc' cannot be opened: No such file") != std::string::npos);
  CHECK(complaint("") == "has no heights");
  CHECK(complaint(head) == "has no heights");
  CHECK(complaint("nrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3 4\n") ==
        "head lacks 'ncols'");
  CHECK(complaint("ncols 2\nnrows 1\nyllcorner 0\ncellsize 1\n1 2\n") ==
        "head lacks 'xllcorner' or 'xllcenter'");
  CHECK(complaint("ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\n1 2\n") == "head lacks 'cellsize'");
  CHECK(complaint("ncols two\n") == "line 1: 'two' is no finite number");
  CHECK(complaint("ncols\n") == "line 1: expected one number after 'ncols'");
  CHECK(complaint("ncols 2 3\n") == "line 1: expected one number after 'ncols'");
  CHECK(complaint("ncols 2\nncols 2\n") == "line 2: 'ncols' a second time");
  CHECK(complaint("xllcorner 2\nxllcenter 2\n") == "line 2: 'xllcenter' a second time");
  CHECK(complaint("width 2\n").find("line 1: unknown key 'width', allowed: ncols") == 0);
  CHECK(complaint("cellsize -1\n") == "line 1: cellsize must be > 0 [m]");
  CHECK(complaint("ncols 2.5\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n") ==
        "ncols = 2.5 is no whole number from 1 to 1e6");
  CHECK(complaint("ncols 1000000\nnrows 1000000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n") ==
        "has more than 1e8 heights");
  CHECK(complaint(head + "4 5 6\n1 2\n") == "has 5 heights, expected ncols x nrows = 6");
  CHECK(complaint(head + heights + "7\n") == "line 8: more than ncols x nrows = 6 heights");
  CHECK(complaint(head + "4 5 6\n1 x 3\n") == "line 7: 'x' is no finite number");
  CHECK(complaint(head + "4 5 6\n1 nan 3\n") == "line 7: 'nan' is no finite number");
  CHECK(complaint(head + "NODATA_value -9999\n4 5 6\n1 -9999 3\n") ==
        "line 8: no height (NODATA_value) in column 2, row 2 from the north; fill gaps first");
}
