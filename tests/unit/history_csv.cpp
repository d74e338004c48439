// SPDX-License-Identifier: MIT
// History files: on disk after every row, numbers read back bit for bit.

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/resource.h>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <vadose/io/history.hpp>

#include "../error_message.hpp"

namespace {

namespace io = vadose::io;
using vadose::Real;
using vadose_test::error_message;

std::string history_path(const std::string& name) {
  return (std::filesystem::temp_directory_path() / ("vadose_history_" + name)).string();
}

std::vector<std::string> lines_of(const std::string& path) {
  std::ifstream in(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<Real> numbers_of(const std::string& line) {
  std::vector<Real> numbers;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');)
    numbers.push_back(std::strtod(cell.c_str(), nullptr));
  return numbers;
}

}  // namespace

TEST_CASE("history: head and rows are on disk at once and read back bit for bit") {
  const std::string path = history_path("rows.csv");
  {
    io::History history(path, {{"time", "s"}, {"settlement", "m"}, {"liquid_pressure", "Pa"}});
    REQUIRE(lines_of(path).size() == 1);
    CHECK(lines_of(path)[0] == "time [s],settlement [m],liquid_pressure [Pa]");
    const std::vector<std::vector<Real>> rows = {
        {0.0, -0.0, 1.0 / 3},
        {0.1, 5e-324, -std::numeric_limits<Real>::max()},
        {0.1 + 0.2, 1e-17, std::numeric_limits<Real>::infinity()},
    };
    for (std::size_t r = 0; r < rows.size(); ++r) {
      history.add(rows[r]);
      const auto lines = lines_of(path);  // while the file is still open
      REQUIRE(lines.size() == r + 2);
      const auto numbers = numbers_of(lines[r + 1]);
      REQUIRE(numbers.size() == 3);
      for (std::size_t i = 0; i < 3; ++i)
        CHECK(std::bit_cast<std::uint64_t>(numbers[i]) == std::bit_cast<std::uint64_t>(rows[r][i]));
    }
    history.add({1, 2, vadose::unset});
    CHECK(lines_of(path)[4] == "1,2,nan");
  }
  CHECK(lines_of(path).size() == 5);
  std::filesystem::remove(path);
}

TEST_CASE("history: wrong rows, wrong names and unwritable paths are refused") {
  const std::string path = history_path("wrong.csv");
  {
    io::History history(path, {{"time", "s"}, {"inflow", "kg"}});
    const std::string message = error_message<io::OutputError>([&] { history.add({1.0}); });
    CHECK(message.find("row has 1 values, expected 2") != std::string::npos);
    CHECK(message.find(path) != std::string::npos);
    CHECK(lines_of(path).size() == 1);
  }
  std::filesystem::remove(path);
  CHECK(error_message<io::OutputError>([&] {
          io::History(path, {{"a,b", "m"}});
        }).find("a,b [m]") != std::string::npos);
  CHECK(error_message<io::OutputError>([&] {
          io::History(path, {{"", "m"}});
        }).find("is empty") != std::string::npos);
  CHECK(error_message<io::OutputError>([&] {
          io::History(path, std::vector<io::Quantity>{});
        }).find("no columns") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(path));
  const std::string below = "/dev/null/history.csv";
  CHECK(error_message<io::OutputError>([&] {
          io::History(below, {{"time", "s"}});
        }).find("/dev/null") != std::string::npos);
}

TEST_CASE("history: a row that does not fit on the disk leaves no part, and later rows follow") {
  const std::string path = history_path("full.csv");
  {
    io::History history(path, {{"time", "s"}, {"inflow", "kg"}});
    history.add({1, 0.5});
    // The disk is full in the middle of the next row: a limit on the size of files.
    rlimit before{};
    REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
    rlimit small = before;
    small.rlim_cur = std::filesystem::file_size(path) + 4;
    const auto handler = signal(SIGXFSZ, SIG_IGN);
    REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
    const std::string message = error_message<io::OutputError>([&] { history.add({2, 1.0 / 3}); });
    REQUIRE(setrlimit(RLIMIT_FSIZE, &before) == 0);
    signal(SIGXFSZ, handler);
    CHECK(message == "cannot write file '" + path + "': File too large");
    CHECK(lines_of(path) == std::vector<std::string>{"time [s],inflow [kg]", "1,0.5"});
    history.add({3, 0.25});
  }
  CHECK(lines_of(path) == std::vector<std::string>{"time [s],inflow [kg]", "1,0.5", "3,0.25"});
  std::filesystem::remove(path);
  CHECK(error_message<io::OutputError>([&] {
          io::History("/dev/full", {{"time", "s"}});
        }) == "cannot write file '/dev/full': No space left on device");
}

TEST_CASE("history: files append, move and tell that they are closed") {
  const std::string path = history_path("file.txt");
  std::filesystem::remove(path);
  io::File first(path);
  first.print("%d-%s\n", 7, "x");
  io::File second(std::move(first));
  CHECK_FALSE(first.is_open());
  second.write("y\n");
  second.close();
  second.close();
  CHECK(error_message<io::OutputError>([&] { second.write("z"); }).find("it is closed") !=
        std::string::npos);
  {
    io::File more(path, true);
    more.write("z\n");
  }
  CHECK(lines_of(path) == std::vector<std::string>{"7-x", "y", "z"});
  {
    // nothing is put in place without commit
    io::ReplacingFile replacing(path);
    replacing.file().write("other");
  }
  CHECK(lines_of(path).size() == 3);
  CHECK_FALSE(std::filesystem::exists(path + ".part"));
  std::filesystem::remove(path);
}
