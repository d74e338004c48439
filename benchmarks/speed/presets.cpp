// SPDX-License-Identifier: MIT
// Whole steps of the presets as they are (linear elastic soil, GIMP, FLIP): what a point costs by
// model. Times are per solid point (with its liquid point), or per point of free water.

#include "benchmarks/speed/whole_step.hpp"

namespace {

/// The presets with soil, in 3D or in plane strain.
template <class K>
void add_presets(const std::string& space) {
  using namespace speed;
  const std::vector<std::int64_t> size{100000};
  add_steps<vadose::DryModel<K>>("preset/dry/" + space, size, {1});
  add_steps<vadose::SaturatedModel<K>>("preset/saturated/" + space, size, {1});
  add_steps<vadose::UnsaturatedModel<K>>("preset/unsaturated/" + space, size, {1});
  add_steps<Seepage<K>>("preset/unsaturated_rigid/" + space, size, {1});
}

}  // namespace

int main(int count, char** arguments) {
  using namespace vadose;
  add_presets<ThreeDimensional>("3d");
  add_presets<PlaneStrain>("2d");
  const std::vector<std::int64_t> usual{100000, 1000000};
  speed::add_steps<FreeWaterModel<ThreeDimensional>>("free_water/3d", usual, {1, 2});
  speed::add_steps<FreeWaterModel<PlaneStrain>>("free_water/2d", usual, {1, 2});
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
