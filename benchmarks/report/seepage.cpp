// SPDX-License-Identifier: MIT
// Infiltration: [Zhan] 4.2, Figs. 8 and 9, Srivastava and Yeh, Philip.

#include "benchmarks/report/report.hpp"
#include "tests/verify/cases/philip.hpp"
#include "tests/verify/cases/pond.hpp"
#include "tests/verify/cases/srivastava_yeh.hpp"

int main(int count, char** arguments) {
  using report::Resolution;
  report::Report all("seepage", count, arguments);
  const report::List<report::Variant<>> standard;
  // Conductivity between cells.
  using Flip = vadose::transfer::Flip;
  using Explicit = vadose::scheme::Explicit;
  using Means = report::List<
      report::Variant<>,
      report::Variant<vadose::shape::Gimp, Flip, Explicit, vadose::interblock::Upstream>,
      report::Variant<vadose::shape::Gimp, Flip, Explicit, vadose::interblock::Arithmetic>>;
  all.add(standard, "Srivastava and Yeh", verify::SrivastavaYeh{}, {{10}, {20}, {40}});
  all.add(Means{}, "Philip", verify::Philip{},
          all.is_short() ? std::vector<Resolution>{{20}, {40}}
                         : std::vector<Resolution>{{20}, {40}, {80}});
  const std::vector<Resolution> ponds = all.is_short() ? std::vector<Resolution>{{10}, {20}}
                                                       : std::vector<Resolution>{{10}, {20}, {40}};
  all.add(Means{}, "pond rigid", verify::Pond<vadose::law::Rigid>{}, ponds);
  all.add(standard, "pond elastic", verify::Pond<vadose::law::LinearElastic>{}, ponds);
  return all.run(count, arguments);
}
