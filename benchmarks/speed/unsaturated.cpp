// SPDX-License-Identifier: MIT
// Whole steps of unsaturated soil by all schemes; times are per pair of a solid and a liquid point.

#include <vadose/solver/scheme/paper_literal.hpp>
#include <vadose/solver/scheme/semi_implicit.hpp>

#include "benchmarks/speed/whole_step.hpp"

int main(int count, char** arguments) {
  using namespace speed;
  using namespace vadose;
  add_steps<Unsaturated<ThreeDimensional>>("unsaturated/3d", all_sizes, {1, 2});
  add_steps<Unsaturated<PlaneStrain>>("unsaturated/2d", all_sizes, {1, 2});
  add_steps<Unsaturated<PlaneStrain>, scheme::SemiImplicit>("unsaturated/2d/semi_implicit",
                                                            {10000, 100000}, {1, 2});
  add_steps<Unsaturated<PlaneStrain>, scheme::PaperLiteral<>>("unsaturated/2d/paper_literal",
                                                              {10000, 100000}, {1, 2});
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
