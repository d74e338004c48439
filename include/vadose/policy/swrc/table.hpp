// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <vadose/core/error.hpp>
#include <vadose/core/monotone_table.hpp>
#include <vadose/policy/hydraulic_concept.hpp>

namespace vadose::swrc {

/// Measured retention curve: (suction, saturation) pairs joined by a monotone cubic in
/// log(suction), or in suction where asked for. S = 1 below the first entry, which must have S = 1
/// (the air-entry value), and constant above the last. Independent of porosity. Called lane by
/// lane.
class Table {
 public:
  /// One measurement.
  struct Entry {
    Real suction = unset;     ///< [Pa], > 0 for logarithmic, >= 0 for linear
    Real saturation = unset;  ///< [-], (0, 1]
  };
  /// Abscissa of the interpolation.
  enum class Abscissa {
    logarithmic,  ///< log(suction)
    linear,       ///< suction
  };

  /// An empty table; validate() refuses it.
  Table() = default;

  /// At least two entries, suction strictly increasing, saturation never increasing from 1.
  /// Throws SetupError naming the entry.
  explicit Table(const std::vector<Entry>& entries, Abscissa abscissa = Abscissa::logarithmic)
      : abscissa_(abscissa) {
    std::vector<Real> x;
    std::vector<Real> y;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      check_entry(entries[i], i + 1);
      x.push_back(abscissa == Abscissa::linear ? entries[i].suction : std::log(entries[i].suction));
      y.push_back(entries[i].saturation);
    }
    if (!y.empty() && (y.front() != 1 || y.back() > y.front()))
      throw SetupError("retention table: entry 1: saturation = " + check::text(y.front()) +
                       ", must be 1 [-]");
    table_ = MonotoneTable("retention table", std::move(x), std::move(y));
  }

  void validate() const {
    if (table_.empty()) throw SetupError("retention table: no entries");
  }

  /// Degree of saturation [-] and dS/ds [1/Pa] at suction [Pa].
  SaturationAndSlope<Real> saturation_and_slope(Real suction_value, Real /*porosity*/) const {
    if (!(suction_value > 0)) return {1, 0};
    const bool linear = abscissa_ == Abscissa::linear;
    const auto point = table_.at(linear ? suction_value : std::log(suction_value));
    return {point.value, linear ? point.slope : point.slope / suction_value};
  }
  /// Degree of saturation [-].
  Real saturation(Real suction_value, Real porosity) const {
    return saturation_and_slope(suction_value, porosity).saturation;
  }
  /// dS/ds [1/Pa], <= 0.
  Real saturation_slope(Real suction_value, Real porosity) const {
    return saturation_and_slope(suction_value, porosity).slope;
  }
  /// dS/dn = 0 [-].
  Real saturation_porosity_slope(Real /*suction*/, Real /*porosity*/) const { return 0; }

  /// Smallest suction [Pa] with that saturation; 0 for S >= 1, infinite below the last entry's S.
  Real suction(Real saturation_value, Real /*porosity*/) const {
    if (!(saturation_value < 1)) return 0;
    if (saturation_value < table_.at(table_.back()).value)
      return std::numeric_limits<Real>::infinity();
    const Real x = table_.inverse(saturation_value);
    return abscissa_ == Abscissa::linear ? x : std::exp(x);
  }

 private:
  void check_entry(const Entry& entry, std::size_t number) const {
    check::in_context("retention table, entry " + std::to_string(number), [&] {
      if (abscissa_ == Abscissa::linear)
        check::non_negative("suction", entry.suction, "Pa");
      else
        check::positive("suction", entry.suction, "Pa");
      if (!(entry.saturation > 0 && entry.saturation <= 1))
        check::fail("saturation", entry.saturation, "(0, 1]", "-");
    });
  }

  MonotoneTable table_;
  Abscissa abscissa_ = Abscissa::logarithmic;
};

static_assert(RetentionCurve<Table>);

}  // namespace vadose::swrc
