// SPDX-License-Identifier: MIT
// Whole steps of dry soil: shapes, kinematics, threads, sizes, a law in plain doubles, a sparse box.

#include "benchmarks/speed/whole_step.hpp"

#include <vadose/policy/shape/linear.hpp>
#include <vadose/policy/shape/quadratic_b_spline.hpp>

namespace {

using namespace speed;
using namespace vadose;

/// The library's Drucker-Prager as a host would write its own law: plain doubles, an ordinary if.
struct PlainSand {
  double bulk_modulus = 10e6 / 1.2, shear_modulus = 10e6 / 2.6;
  double slope = 0.57, intercept = 819;  // phi = 35 deg, c = 1 kPa in plane strain
  struct State {
    double plastic_shear_strain = 0;
  };
  double p_wave_modulus(const State&) const { return bulk_modulus + 4 * shear_modulus / 3; }
  void validate() const {}
  template <int N>
  vadose::Status update(const vadose::StrainStep<double, N>& step,
                        vadose::SymTensor<double, N>& stress, State& state) const noexcept {
    const double volume = step.increment.trace();
    stress += (2 * shear_modulus) * step.increment;
    stress.add_isotropic((bulk_modulus - 2 * shear_modulus / 3) * volume);
    const double mean = stress.mean();
    const auto deviator = stress.deviator();
    const double shear = std::sqrt(0.5 * contract(deviator, deviator));
    double new_mean = mean, new_shear = shear;
    if (shear + slope * mean > intercept) new_shear = intercept - slope * mean;
    if (new_mean > intercept / slope) {
      new_mean = intercept / slope;
      new_shear = 0;
    }
    if (new_shear == shear && new_mean == mean) return vadose::Status::ok;
    stress = (shear > 0 ? new_shear / shear : 0.0) * deviator;
    stress.add_isotropic(new_mean);
    state.plastic_shear_strain += (shear - new_shear) / shear_modulus;
    return vadose::Status::ok;
  }
};

/// The kernels of dry soil one after the other, without a line about water.
struct Bare {
  static constexpr const char* name = "bare";
  template <class M>
  static kernel::StableStep step(State<M>& state, Real dt_limit) {
    kernel::StableStep stable;
    kernel::take_common_limits(state, stable);
    stable.take(dt_limit, StepLimit::end);
    kernel::begin_step(state, stable.dt);
    kernel::map_solid<M, false>(state);
    kernel::map_loads(state);
    kernel::advance_nodes(state);
    kernel::move_loads(state);
    kernel::update_solid<M, false>(state);
    return stable;
  }
};

}  // namespace

int main(int count, char** arguments) {
  const std::vector<std::int64_t> usual{100000, 1000000};
  add_steps<Dry<ThreeDimensional>>("dry/3d/gimp", all_sizes, {1, 2});
  add_steps<Dry<ThreeDimensional, shape::QuadraticBSpline>>("dry/3d/b_spline", usual, {1, 2});
  add_steps<Dry<ThreeDimensional, shape::Linear>>("dry/3d/linear", usual, {1, 2});
  add_steps<Dry<ThreeDimensional, shape::Gimp, PlainSand>>("dry/3d/gimp/plain_law", usual, {1});
  add_steps<Dry<PlaneStrain>>("dry/2d/gimp", all_sizes, {1, 2});
  add_steps<Dry<PlaneStrain, shape::Linear>>("dry/2d/linear", usual, {1, 2});
  add_steps<Dry<Axisymmetric>>("dry/axisymmetric/gimp", usual, {1});
  add_steps<Dry<ThreeDimensional>, Bare>("dry/3d/gimp/bare", {100000}, {1});
  // The block fills 3 % of its box.
  add_steps<Dry<ThreeDimensional>>("dry/3d/gimp/sparse", usual, {1}, {.room = 5.8});
  add_steps<Dry<ThreeDimensional>>("dry/3d/gimp/tight", usual, {1}, {.room = 1.0});
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
