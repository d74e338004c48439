// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include <unistd.h>

namespace vadose_test {

/// A directory of this process in the system's folder for temporary files, removed at the beginning and the
/// end: test programs that run side by side do not meet.
struct TemporaryDirectory {
  std::filesystem::path path;
  /// With `exists` it is made empty; else the code under test has to make it.
  explicit TemporaryDirectory(const std::string& name, bool exists = false)
      : path(std::filesystem::temp_directory_path() /
             ("vadose_" + name + '_' + std::to_string(::getpid()))) {
    std::filesystem::remove_all(path);
    if (exists) std::filesystem::create_directories(path);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  ~TemporaryDirectory() { std::filesystem::remove_all(path); }
  std::string operator/(const std::string& file) const { return (path / file).string(); }
};

}  // namespace vadose_test
