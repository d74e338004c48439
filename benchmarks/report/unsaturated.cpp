// SPDX-License-Identifier: MIT
// Unsaturated consolidation, [Zhan] 4.1, Figs. 6 and 7, and Liakopoulos' drainage.

#include "benchmarks/report/report.hpp"
#include "tests/verify/cases/figure_consolidation.hpp"
#include "tests/verify/cases/liakopoulos.hpp"

int main(int count, char** arguments) {
  using report::Resolution;
  report::Report all("unsaturated", count, arguments);
  const report::List<report::Variant<>> standard;
  for (const double modulus : {10e6, 3e6})
    for (const bool coupled : {true, false}) {
      const std::string soil = modulus > 5e6 ? " E = 10 MPa" : " E = 3 MPa";
      const std::string laws = coupled ? " S(n) k(n)" : " S and k at n0";
      verify::UnsaturatedConsolidation small{.young_modulus = modulus,
                                             .porosity_dependent = coupled};
      all.add(standard, "unsaturated" + soil + laws, small, small.resolutions);
      if (coupled && modulus > 5e6) {
        using Choices =
            report::List<report::WithScheme<vadose::scheme::SemiImplicit>,
                         report::Printed<{.implicit_drag = true}>,
                         report::Printed<{.saturation = true, .implicit_drag = true}>,
                         report::Printed<{.porosity_slope = true, .implicit_drag = true}>>;
        all.add(Choices{}, "unsaturated" + soil + laws, small, {{10}});
      }
      verify::FigureConsolidation figure(modulus, coupled);
      figure.times = {0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5,
                      0.6,  0.8,  1,    1.2, 1.4,  1.6, 2,   2.5, 3};
      all.add(standard, "figures 6 and 7" + soil + laws, figure, {{10}, {20}});
    }
  all.add(standard, "Liakopoulos", verify::Liakopoulos{}, {{10}, {20}});
  if (!all.is_short())
    all.add(standard, "Liakopoulos to 2 h",
            verify::Liakopoulos{.times = {300, 600, 1200, 2400, 4800, 7200}}, {{10}, {20}});
  return all.run(count, arguments);
}
