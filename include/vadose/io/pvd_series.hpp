// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// A series of VTK files over time, listed in a .pvd file that ParaView opens.

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <vadose/core/real.hpp>
#include <vadose/io/file.hpp>
#include <vadose/io/vtk_points.hpp>

namespace vadose::io {

/// Time series "<base>.pvd" of "<base>_000000.vtp", "<base>_000001.vtp", ... The .pvd file is
/// complete and valid after every write, also when the run is killed in the middle of one. Nothing
/// is written before the first one. After an OutputError the series is as it was: the run can go on
/// and the next write may succeed.
class PvdSeries {
 public:
  /// `base`: path without extension, e.g. "out/slope".
  /// `extension`: of the files in the series.
  explicit PvdSeries(std::string base, std::string extension = ".vtp")
      : base_(std::move(base)), extension_(std::move(extension)) {
    if (std::filesystem::path(base_).filename().empty())
      throw OutputError("cannot write file '" + base_ + ".pvd': the path has no file name");
  }

  /// Writes the points at time [s] and lists them. See write_vtp.
  void write(Real time, int dim, std::span<const Real> positions, std::span<const Column> columns,
             std::string_view comment = {}) {
    add(time, [&](const std::string& file) { write_vtp(file, dim, positions, columns, comment); });
  }

  /// Has write_file(path) write the next file and lists it at time [s].
  template <class F>
  void add(Real time, F&& write_file) {
    check_time(time);
    const std::string file = next_file();
    write_file(file);
    list(time, file);
  }

  /// Takes up the series that an earlier run left at this path: what it lists until time [s] stays,
  /// what is later is forgotten and its files are replaced. Nothing happens where there is none.
  void resume(Real time) {
    std::ifstream in(path());
    entries_.clear();
    for (std::string line; std::getline(in, line);) {
      const std::string start = "<DataSet timestep=\"", middle = "\" part=\"0\" file=\"";
      const std::size_t at = line.find(middle);
      if (line.rfind(start, 0) != 0 || at == std::string::npos) continue;
      const Real written = std::strtod(line.c_str() + start.size(), nullptr);
      if (written > time) break;
      const std::string file = next_file();
      entries_.emplace_back(written, std::filesystem::path(file).filename().string());
    }
  }

  /// Path of the next file.
  std::string next_file() const {
    char number[32];
    std::snprintf(number, sizeof number, "_%06zu", entries_.size());
    return base_ + number + extension_;
  }
  /// Path of the .pvd file.
  std::string path() const { return base_ + ".pvd"; }
  /// Number of times written.
  std::size_t size() const noexcept { return entries_.size(); }

 private:
  void check_time(Real time) const {
    if (is_finite(time) && (entries_.empty() || time >= entries_.back().first)) return;
    char text[96];
    std::snprintf(text, sizeof text, "time = %.17g outside [%.17g, inf) [s]", time,
                  entries_.empty() ? 0.0 : entries_.back().first);
    throw OutputError("cannot write file '" + path() + "': " + text);
  }

  void list(Real time, const std::string& file) {
    entries_.emplace_back(time, std::filesystem::path(file).filename().string());
    try {
      rewrite();
    } catch (...) {
      entries_.pop_back();
      throw;
    }
  }

  void rewrite() const {
    ReplacingFile replacing(path());
    File& out = replacing.file();
    out.write(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
        "byte_order=\"LittleEndian\">\n<Collection>\n");
    for (const auto& [time, file] : entries_)
      out.print("<DataSet timestep=\"%.17g\" part=\"0\" file=\"%s\"/>\n", time,
                detail::xml_text(file).c_str());
    out.write("</Collection>\n</VTKFile>\n");
    replacing.commit();
  }

  std::string base_, extension_;
  std::vector<std::pair<Real, std::string>> entries_;
};

}  // namespace vadose::io
