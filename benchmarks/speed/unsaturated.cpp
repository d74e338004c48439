// SPDX-License-Identifier: MIT
// Whole steps of unsaturated soil; times are per pair of a solid and a liquid point.

#include "benchmarks/speed/whole_step.hpp"

int main(int count, char** arguments) {
  using namespace speed;
  using namespace vadose;
  add_steps<Unsaturated<ThreeDimensional>>("unsaturated/3d", all_sizes, {1, 2});
  add_steps<Unsaturated<PlaneStrain>>("unsaturated/2d", all_sizes, {1, 2});
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
