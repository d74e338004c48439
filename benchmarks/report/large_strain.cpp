// SPDX-License-Identifier: MIT
// Consolidation by 39 %, points cross cells: every choice one by one.

#include "tests/verify/cases/large_strain.hpp"
#include "benchmarks/report/report.hpp"

int main(int count, char** arguments) {
  using report::Resolution;
  report::Report all("large_strain", count, arguments);
  const std::vector<Resolution> columns = all.is_short()
                                              ? std::vector<Resolution>{{10}, {20}}
                                              : std::vector<Resolution>{{10}, {20}, {40}};
  all.add(report::OneByOne{}, "large strain k = k0 J^2", verify::LargeStrain{}, columns);
  all.add(report::List<report::Variant<>>{}, "large strain Kozeny-Carman",
          verify::LargeStrain{.square_law = false}, columns);
  for (const bool square_law : {true, false}) {
    verify::LargeStrain fine{.square_law = square_law, .points_per_cell = 8};
    if (all.is_short()) fine.times = {0.1, 0.2};
    all.add(report::List<report::Variant<>>{},
            std::string("large strain ") + (square_law ? "k = k0 J^2" : "Kozeny-Carman") +
                " 8 points per cell",
            fine, {{20}});
  }
  return all.run(count, arguments);
}
