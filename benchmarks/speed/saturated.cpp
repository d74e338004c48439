// SPDX-License-Identifier: MIT
// Whole steps of saturated soil; times are per pair of a solid and a liquid point.

#include "benchmarks/speed/whole_step.hpp"

namespace {

using namespace speed;
using namespace vadose;

/// A retention curve that has no body: if the program links, a saturated model runs no such code.
struct NoCurve {
  static constexpr bool always_saturated = true;
  void validate() const {}
  Real saturation(Real suction, Real porosity) const;
  Real saturation_slope(Real suction, Real porosity) const;
};
template <class K>
struct Full : Saturated<K> {
  using Retention = NoCurve;
};

}  // namespace

int main(int count, char** arguments) {
  add_steps<Full<ThreeDimensional>>("saturated/3d", all_sizes, {1, 2});
  add_steps<Full<PlaneStrain>>("saturated/2d", all_sizes, {1, 2});
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
