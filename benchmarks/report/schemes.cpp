// SPDX-License-Identifier: MIT
// Error against wall time of the schemes: Terzaghi, unsaturated consolidation, infiltration.

#include "benchmarks/report/report.hpp"
#include "tests/verify/cases/philip.hpp"
#include "tests/verify/cases/terzaghi.hpp"
#include "tests/verify/cases/unsaturated_consolidation.hpp"

namespace {

/// Semi-implicit steps that solve for the motion of the skeleton too where they are long.
struct QuasiStatic : report::WithScheme<vadose::scheme::SemiImplicit> {
  static std::string name() { return "gimp flip quasi-static"; }
};

}  // namespace

int main(int count, char** arguments) {
  report::Report all("schemes", count, arguments);
  using Default = report::Variant<>;
  using Implicit = report::WithScheme<vadose::scheme::SemiImplicit>;
  using Printed = report::Printed<>;
  // Its drag, explicit as printed, would bound the step to 1.5e-7 s.
  using Mended = report::Printed<{.implicit_drag = true}>;
  all.add(report::List<Default, Implicit, Printed>{}, "schemes: Terzaghi",
          verify::Terzaghi{.conductivity = 1e-3}, {{10}, {20}, {40}});
  all.add(report::List<Default, Implicit, Mended>{}, "schemes: unsaturated consolidation",
          verify::UnsaturatedConsolidation{}, {{5}, {10}, {20}});
  all.add(report::List<QuasiStatic>{}, "schemes: unsaturated consolidation",
          verify::UnsaturatedConsolidation{.quasi_static = {.on = true}}, {{5}, {10}, {20}});
  all.add(report::List<Default, Implicit, Mended>{}, "schemes: infiltration", verify::Philip{},
          {{20}, {40}, {80}});
  return all.run(count, arguments);
}
