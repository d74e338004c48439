// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Heights of the ground from a plain ESRI ASCII grid (.asc), the exchange format of most map data.

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <vadose/grid/height_field.hpp>
#include <vadose/io/file.hpp>

namespace vadose::io {

namespace detail {

/// Reads the words of an ESRI ASCII grid and names file and line in every complaint.
class EsriReader {
 public:
  explicit EsriReader(const std::string& path) : path_(path), file_(path) {
    if (!file_) fail("cannot be opened: " + std::string(std::strerror(errno)));
  }

  HeightField read() {
    read_head();
    const int columns = count("ncols", columns_), rows = count("nrows", rows_);
    if (!(cell_size_ > 0)) fail("head lacks 'cellsize'");
    if (!given(x_)) fail("head lacks 'xllcorner' or 'xllcenter'");
    if (!given(y_)) fail("head lacks 'yllcorner' or 'yllcenter'");
    std::vector<Real> heights = read_heights(columns, rows);
    return {columns,
            rows,
            x_ + (x_is_corner_ ? 0.5 * cell_size_ : 0),
            y_ + (y_is_corner_ ? 0.5 * cell_size_ : 0),
            cell_size_,
            std::move(heights)};
  }

 private:
  /// Most heights that are taken: 800 MB.
  static constexpr Real most_heights = 1e8;

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError("height grid '" + path_ + "' " + what);
  }
  [[noreturn]] void fail_here(const std::string& what) const {
    throw InputError("height grid '" + path_ + "' line " + std::to_string(line_number_) + ": " +
                     what);
  }
  static bool given(Real value) noexcept { return value == value; }

  bool next_line() {
    if (!std::getline(file_, line_)) return false;
    ++line_number_;
    if (!line_.empty() && line_.back() == '\r') line_.pop_back();
    return true;
  }

  /// A finite number; the whole word.
  Real number(const std::string& word) const {
    char* end = nullptr;
    const Real value = std::strtod(word.c_str(), &end);
    if (word.empty() || *end != '\0' || !is_finite(value))
      fail_here("'" + word + "' is no finite number");
    return value;
  }

  /// Lines of a key and a number, until one that begins with a number.
  void read_head() {
    while (next_line()) {
      std::istringstream words(line_);
      std::string key, value, more;
      if (!(words >> key)) continue;
      if (!std::isalpha(static_cast<unsigned char>(key[0]))) return;  // the first row of heights
      if (!(words >> value) || (words >> more))
        fail_here("expected one number after '" + key + "'");
      set(key, number(value));
    }
    fail("has no heights");
  }
  void set(std::string key, Real value) {
    std::transform(key.begin(), key.end(), key.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    Real* target = key == "ncols"                             ? &columns_
                   : key == "nrows"                           ? &rows_
                   : key == "cellsize"                        ? &cell_size_
                   : key == "nodata_value"                    ? &no_data_
                   : key == "xllcorner" || key == "xllcenter" ? &x_
                   : key == "yllcorner" || key == "yllcenter" ? &y_
                                                              : nullptr;
    if (!target)
      fail_here(
          "unknown key '" + key +
          "', allowed: ncols, nrows, xllcorner or xllcenter, yllcorner or yllcenter, cellsize, "
          "NODATA_value");
    if (given(*target)) fail_here("'" + key + "' a second time");
    if (key == "cellsize" && !(value > 0)) fail_here("cellsize must be > 0 [m]");
    *target = value;
    if (target == &x_) x_is_corner_ = key == "xllcorner";
    if (target == &y_) y_is_corner_ = key == "yllcorner";
  }
  int count(const char* key, Real value) const {
    if (!given(value)) fail(std::string("head lacks '") + key + "'");
    if (!(value >= 1 && value <= 1e6 && value == std::floor(value)))
      fail(std::string(key) + " = " + check::text(value) + " is no whole number from 1 to 1e6");
    return static_cast<int>(value);
  }

  /// Rows from north to south, turned around.
  std::vector<Real> read_heights(int columns, int rows) {
    const auto width = static_cast<std::size_t>(columns);
    if (static_cast<Real>(columns) * rows > most_heights) fail("has more than 1e8 heights");
    std::vector<Real> north_first;
    bool more = true;
    for (; more; more = next_line()) {
      std::istringstream words(line_);
      std::string word;
      while (words >> word) north_first.push_back(height(word, north_first.size(), width));
      if (north_first.size() > width * static_cast<std::size_t>(rows))
        fail_here("more than ncols x nrows = " +
                  std::to_string(width * static_cast<std::size_t>(rows)) + " heights");
    }
    if (north_first.size() != width * static_cast<std::size_t>(rows))
      fail("has " + std::to_string(north_first.size()) + " heights, expected ncols x nrows = " +
           std::to_string(width * static_cast<std::size_t>(rows)));
    std::vector<Real> heights(north_first.size());
    for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row)
      std::copy_n(north_first.begin() + static_cast<std::ptrdiff_t>(row * width), width,
                  heights.end() - static_cast<std::ptrdiff_t>((row + 1) * width));
    return heights;
  }
  Real height(const std::string& word, std::size_t index, std::size_t width) const {
    const Real value = number(word);
    if (value == no_data_)
      fail_here("no height (NODATA_value) in column " + std::to_string(index % width + 1) +
                ", row " + std::to_string(index / width + 1) + " from the north; fill gaps first");
    return value;
  }

  std::string path_;
  std::ifstream file_;
  std::string line_;
  int line_number_ = 0;
  Real columns_ = unset, rows_ = unset, cell_size_ = unset, no_data_ = unset, x_ = unset,
       y_ = unset;
  bool x_is_corner_ = false, y_is_corner_ = false;
};

}  // namespace detail

/// Reads an ESRI ASCII grid: lines `ncols`, `nrows`, `xllcorner` or `xllcenter`, `yllcorner` or
/// `yllcenter`, `cellsize`, optionally `NODATA_value`, in any order and case; then nrows x ncols heights
/// [m] from north to south, each row from west to east. Raises InputError that names file, line and
/// what is wrong; gaps (NODATA) are refused.
inline HeightField read_esri_grid(const std::string& path) {
  return detail::EsriReader(path).read();
}

}  // namespace vadose::io
