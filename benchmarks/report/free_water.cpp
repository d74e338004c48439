// SPDX-License-Identifier: MIT
// Free water at rest, sloshing and falling; seepage through a dam and a U-tube.

#include "benchmarks/report/report.hpp"
#include "tests/verify/cases/dam_seepage.hpp"
#include "tests/verify/cases/u_tube.hpp"

int main(int count, char** arguments) {
  using report::Resolution;
  report::Report all("free_water", count, arguments);
  const report::List<report::Variant<>> standard;
  const report::List<report::Variant<vadose::shape::Gimp, vadose::transfer::Apic>> quiet;
  const std::vector<Resolution> planes = all.is_short() ? std::vector<Resolution>{{10}, {20}}
                                                        : std::vector<Resolution>{{10}, {20}, {40}};
  all.add(standard, "still water", verify::StillWater{}, {{10}});
  all.add(standard, "still water random offsets", verify::StillWater{.jitter = 0.2}, {{10}});
  all.add(report::OneByOne{}, "sloshing", verify::Sloshing{}, planes);
  all.add(standard, "dam break", verify::DamBreak{}, verify::DamBreak{}.resolutions);
  all.add(standard, "dam seepage", verify::DamSeepage{}, planes);
  all.add(standard, "U-tube one leg falls", verify::FallingLeg{}, {{10}, {20}, {40}});
  all.add(quiet, "U-tube two ponds", verify::UTubePonds{}, planes);
  all.add(quiet, "U-tube swings", verify::UTubeLeg{}, planes);
  return all.run(count, arguments);
}
