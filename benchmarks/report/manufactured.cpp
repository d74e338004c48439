// SPDX-License-Identifier: MIT
// A manufactured solution of both phases in the plane, step with h^2: each shape.

#include "benchmarks/report/report.hpp"
#include "tests/verify/cases/manufactured_two_phase.hpp"

int main(int count, char** arguments) {
  using report::Resolution;
  report::Report all("manufactured", count, arguments);
  const std::vector<Resolution> cells =
      all.is_short() ? std::vector<Resolution>{{8, 0.4}, {16, 0.2}}
                     : std::vector<Resolution>{{8, 0.4}, {16, 0.2}, {32, 0.1}};
  using Shapes = report::List<report::Variant<>, report::Variant<vadose::shape::Linear>,
                              report::Variant<vadose::shape::QuadraticBSpline>>;
  all.add(Shapes{}, "manufactured S = 1", verify::ManufacturedTwoPhase<>{}, cells);
  all.add(report::List<report::Variant<>>{}, "manufactured S = 0.7",
          verify::ManufacturedTwoPhase<>{.start_saturation = 0.7}, cells);
  return all.run(count, arguments);
}
