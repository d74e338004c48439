// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Quantities over time as a CSV file.

#include <cstdio>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <vadose/core/real.hpp>
#include <vadose/io/file.hpp>

namespace vadose::io {

/// Name and unit of a column of History.
struct Quantity {
  std::string name;  ///< e.g. "settlement"
  std::string unit;  ///< e.g. "m"
};

/// CSV file: a head "time [s],settlement [m]", then one row per call, on disk when the call
/// returns. Numbers have 17 digits and read back bit for bit.
class History {
 public:
  /// Replaces the file and writes the head. Names and units: no comma, quote or line break.
  History(const std::string& path, std::span<const Quantity> columns)
      : columns_(columns.size()), file_(checked(path, columns)) {
    std::string head;
    for (const Quantity& c : columns)
      head.append(head.empty() ? "" : ",").append(c.name + " [" + c.unit + "]");
    file_.write(head + "\n");
    file_.flush();
  }
  /// The same with a list in braces.
  History(const std::string& path, std::initializer_list<Quantity> columns)
      : History(path, std::span<const Quantity>(columns.begin(), columns.size())) {}

  /// Appends one row with a value for every column. Where that fails (OutputError, also on a full disk)
  /// no part of it is in the file, and later rows can follow.
  void add(std::span<const Real> values) {
    if (values.size() != columns_)
      throw OutputError("cannot write file '" + file_.path() + "': row has " +
                        std::to_string(values.size()) + " values, expected " +
                        std::to_string(columns_));
    std::string row;
    for (const Real value : values) {
      char text[40];
      std::snprintf(text, sizeof text, "%.17g", value);
      if (!row.empty()) row += ',';
      row += text;
    }
    file_.append_whole(row + "\n");
  }
  /// The same with a list in braces.
  void add(std::initializer_list<Real> values) {
    add(std::span<const Real>(values.begin(), values.size()));
  }

  const std::string& path() const noexcept { return file_.path(); }

 private:
  static const std::string& checked(const std::string& path, std::span<const Quantity> columns) {
    const auto refuse = [&](const std::string& why) {
      throw OutputError("cannot write file '" + path + "': " + why);
    };
    if (columns.empty()) refuse("no columns");
    for (const Quantity& c : columns)
      if (c.name.empty() || (c.name + c.unit).find_first_of(",\"\r\n") != std::string::npos)
        refuse("column name '" + c.name + " [" + c.unit +
               "]' is empty or has a comma, quote or line break");
    return path;
  }

  std::size_t columns_;
  File file_;
};

}  // namespace vadose::io
