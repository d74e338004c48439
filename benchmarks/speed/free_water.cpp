// SPDX-License-Identifier: MIT
// Whole steps of free water.

#include "benchmarks/speed/whole_step.hpp"

int main(int count, char** arguments) {
  using namespace speed;
  using namespace vadose;
  const std::vector<std::int64_t> usual{100000, 1000000};
  add_steps<FreeWater<ThreeDimensional>>("free_water/3d", usual, {1, 2});
  add_steps<FreeWater<PlaneStrain>>("free_water/2d", usual, {1, 2});
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
