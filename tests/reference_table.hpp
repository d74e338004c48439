// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <vadose/core/real.hpp>

namespace vadose_test {

using vadose::Real;

/// Rows of a file in tests/reference; lines that begin with # are skipped, the first other line is
/// the header. Fields in double quotes may hold commas.
class Table {
 public:
  explicit Table(const std::string& name) {
    const std::string here = __FILE__;
    const std::size_t slash = here.find_last_of('/');
    std::ifstream file(here.substr(0, slash == std::string::npos ? 0 : slash + 1) + "reference/" +
                       name);
    std::string line;
    while (std::getline(file, line)) {
      if (line.empty() || line.front() == '#') continue;
      std::vector<std::string> fields = split(line);
      if (header_.empty())
        header_ = std::move(fields);
      else
        rows_.push_back(std::move(fields));
    }
    // A loop over no rows would pass.
    if (rows_.empty()) throw std::runtime_error("no rows in tests/reference/" + name);
  }
  std::size_t size() const { return rows_.size(); }
  const std::string& text(std::size_t row, const std::string& column) const {
    const auto found = std::find(header_.begin(), header_.end(), column);
    return rows_.at(row).at(static_cast<std::size_t>(found - header_.begin()));
  }
  Real number(std::size_t row, const std::string& column) const {
    return std::strtod(text(row, column).c_str(), nullptr);
  }
  /// Value of `y` at x, linear between rows that are sorted by column `by`.
  Real interpolate(const std::string& by, const std::string& y, Real x) const {
    std::size_t i = 1;
    while (i + 1 < size() && number(i, by) < x) ++i;
    const Real a = number(i - 1, by), b = number(i, by);
    const Real t = (x - a) / (b - a);
    return (1 - t) * number(i - 1, y) + t * number(i, y);
  }

 private:
  static std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"')
        quoted = !quoted;
      else if (c == ',' && !quoted)
        fields.emplace_back();
      else if (c != '\r')
        fields.back() += c;
    }
    return fields;
  }
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace vadose_test
