// SPDX-License-Identifier: MIT
#pragma once

// A run that is saved and taken up again has the bits of one that is not.

#include <doctest/doctest.h>

#include <fstream>
#include <iterator>
#include <string>

#include <vadose/io/checkpoint.hpp>

#include "../temporary_directory.hpp"

namespace restart_test {

using vadose_test::TemporaryDirectory;

inline std::string file_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
inline void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

template <class S>
bool steps(S& solver, int count) {
  for (int i = 0; i < count; ++i)
    if (solver.step().status != vadose::Status::ok) return false;
  return true;
}

/// Everything a run holds, as bytes.
template <class S>
std::string bytes_of(const S& solver, const TemporaryDirectory& directory) {
  vadose::io::save_checkpoint(directory / "bytes", solver);
  return file_bytes(directory / "bytes");
}

/// Saves `run`, takes it up in `other`, and goes on with both.
template <class S>
void check_taken_up(S& run, S& other, int more) {
  const TemporaryDirectory directory("restart", true);
  const std::string before = bytes_of(run, directory);
  vadose::io::load_checkpoint(directory / "bytes", other);
  CHECK(before == bytes_of(other, directory));
  REQUIRE(steps(run, more));
  REQUIRE(steps(other, more));
  CHECK(run.time() == other.time());
  CHECK(run.water_balance().closure() == other.water_balance().closure());
  CHECK(bytes_of(run, directory) == bytes_of(other, directory));
}

/// N + M steps against N steps, a restart in a solver that has gone elsewhere, and M steps; with
/// another number of threads.
template <class S, class Scene>
void check_restart(const Scene& scene, const typename S::Options& options, int first, int more) {
  S run(scene, options);
  REQUIRE(steps(run, first));
  auto others = options;
  others.threads = options.threads % 2 + 1;
  S other(scene, others);
  REQUIRE(steps(other, 3));
  check_taken_up(run, other, more);
}

}  // namespace restart_test
