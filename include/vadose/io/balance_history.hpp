// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The ledgers of water and grains over time as a CSV file.

#include <string>

#include <vadose/io/history.hpp>
#include <vadose/solver/report.hpp>

namespace vadose::io {

/// One row per record: every entry of both ledgers [kg], their closure errors [kg] and these over
/// the largest entry [-]. On disk when record() returns.
class WaterBalanceHistory {
 public:
  /// Replaces the file at `path` and writes the head.
  explicit WaterBalanceHistory(const std::string& path)
      : history_(path, {{"time", "s"},
                        {"water_initial", "kg"},
                        {"water_inflow", "kg"},
                        {"water_outflow", "kg"},
                        {"water_rain", "kg"},
                        {"water_film", "kg"},
                        {"water_lost", "kg"},
                        {"water_added", "kg"},
                        {"pore_water", "kg"},
                        {"free_water", "kg"},
                        {"water_closure", "kg"},
                        {"water_relative_closure", "-"},
                        {"solid_initial", "kg"},
                        {"solid_lost", "kg"},
                        {"solid_added", "kg"},
                        {"solid_stored", "kg"},
                        {"solid_closure", "kg"},
                        {"solid_relative_closure", "-"}}) {}

  /// Appends the ledgers of a Solver.
  template <class S>
  void record(const S& solver) {
    const WaterBalance w = solver.water_balance();
    const SolidBalance s = solver.solid_balance();
    history_.add({solver.time(), w.initial, w.inflow, w.outflow, w.rain, w.film, w.lost, w.added,
                  w.pore, w.free, w.closure(), w.relative_closure(), s.initial, s.lost, s.added,
                  s.stored, s.closure(), s.relative_closure()});
  }

  const std::string& path() const noexcept { return history_.path(); }

 private:
  History history_;
};

}  // namespace vadose::io
