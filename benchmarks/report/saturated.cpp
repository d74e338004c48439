// SPDX-License-Identifier: MIT
// Saturated columns: Terzaghi's consolidation and the two waves, every choice one by one.

#include "benchmarks/report/report.hpp"
#include "tests/verify/cases/terzaghi.hpp"
#include "tests/verify/cases/two_wave_column.hpp"

int main(int count, char** arguments) {
  using report::Resolution;
  report::Report all("saturated", count, arguments);
  const std::vector<Resolution> columns = all.is_short()
                                              ? std::vector<Resolution>{{10}, {20}}
                                              : std::vector<Resolution>{{10}, {20}, {40}};
  const verify::Terzaghi terzaghi{.conductivity = 1e-4, .load = 100};
  all.add(report::OneByOne{}, "Terzaghi k = 1e-4 m/s", terzaghi, columns);
  all.add(report::List<report::Variant<>>{}, "Terzaghi k = 9.8e-4 m/s", verify::Terzaghi{},
          {{10}, {20}, {40}});
  using Schemes = report::List<report::WithScheme<vadose::scheme::SemiImplicit>, report::Printed<>,
                               report::Printed<{.implicit_drag = true}>>;
  all.add(Schemes{}, "Terzaghi k = 1e-4 m/s", terzaghi, columns);
  const verify::TwoWaveColumn low;
  const verify::TwoWaveColumn high = verify::TwoWaveColumn::high();
  all.add(report::OneByOne{}, "two waves k = 9.8e-4 m/s", low, low.resolutions);
  all.add(report::OneByOne{}, "two waves k = 1 m/s", high, high.resolutions);
  return all.run(count, arguments);
}
