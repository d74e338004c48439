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
  return all.run(count, arguments);
}
