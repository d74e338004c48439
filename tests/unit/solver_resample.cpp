// SPDX-License-Identifier: MIT
// Merge and split of free-water points: what is kept exactly, what is never touched, and a pond that
// sinks away without becoming a cloud of light points.

#include <doctest/doctest.h>

#include <cmath>

#include "../seepage.hpp"
#include "kernel_support.hpp"

namespace {

namespace vd = vadose;
namespace field = vadose::field;
using namespace kernel_test;

template <class K, class Tr>
struct Water : vd::FreeWaterModel<K> {
  using Transfer = Tr;
};
using Pond = vadose_test::Seepage<vd::Uniaxial>;

/// A tank of water with points of very unequal mass and random motion, one step old.
template <class M>
vd::Solver<M> uneven_tank(unsigned seed) {
  constexpr int dim = M::Kinematics::dim;
  const Vec<dim> zero = Vec<dim>::Zero(), one = Vec<dim>::Ones();
  const Real h = dim == 1 ? 1.0 / 32 : dim == 2 ? 1.0 / 8 : 1.0 / 4;
  vd::Scene<M> scene({.box = {zero, one}, .cell_size = h});
  scene.liquid.bulk_modulus = 1e6;
  scene.add_water(vd::box<dim>(0.25 * one, 0.75 * one));
  vd::Solver<M> solver(scene, {.resampling = {.on = true}});
  solver.step();
  Random random(seed);
  auto& points = solver.mutable_state().liquid;
  points.for_each([&](std::size_t b, int l) {
    const Real factor = random.below(2) ? random.in(0, 0.4) : random.in(1, 4);
    points.at(field::mass, b)[l] *= factor;
    points.at(field::volume, b)[l] *= factor;
    for (int d = 0; d < dim; ++d) {
      points.at(field::velocity, b, d)[l] = random.in(-1, 1);
      points.at(field::position, b, d)[l] += random.in(-0.08, 0.08) * h;
    }
    if constexpr (M::Transfer::affine)
      for (int i = 0; i < dim * dim; ++i) points.at(field::affine, b, i)[l] = random.in(-0.1, 0.1);
  });
  return solver;
}

/// Mass times position of a point set.
template <int Dim, class Points>
Total first_moment(const Points& points) {
  Total total;
  points.for_each([&](std::size_t b, int l) {
    const Wide m = points.at(field::mass, b)[l];
    for (int d = 0; d < Dim; ++d)
      total.sum[static_cast<std::size_t>(d)] += m * points.at(field::position, b, d)[l];
    total.size += m;
  });
  return total;
}

template <class M>
void check_kept(unsigned seed) {
  constexpr int dim = M::Kinematics::dim;
  auto solver = uneven_tank<M>(seed);
  auto& state = solver.mutable_state();
  auto& points = state.liquid;
  const Wide mass = total_mass(points);
  const Total centroid = first_moment<dim>(points);
  Total momentum, momentum_after;
  add_momentum<dim>(points, momentum);
  Total spin;
  if constexpr (dim > 1 && M::Transfer::affine) spin = angular_momentum<dim>(points);
  const std::size_t before = points.size();

  vd::detail::resample_water(state, vd::detail::list_free_points(state));
  const std::size_t merged = before - points.size();
  CHECK(merged > 3);
  CHECK(points.has_new());
  points.sort(state.grid, 1);
  CHECK(points.size() > before - merged + 3);

  add_momentum<dim>(points, momentum_after);
  CHECK(std::fabs(static_cast<Real>(total_mass(points) / mass - 1)) <= 1e-15);
  CHECK(first_moment<dim>(points).relative_to(centroid) <= 1e-15);
  CHECK(momentum_after.relative_to(momentum) <= 1e-15);
  if constexpr (dim > 1 && M::Transfer::affine && !M::Transfer::stores_gradient)
    CHECK(angular_momentum<dim>(points).relative_to(spin) <= 1e-15);

  std::map<std::int64_t, int> ids;
  points.for_each([&](std::size_t b, int l) {
    ++ids[static_cast<std::int64_t>(points.at(field::id, b)[l])];
    const Real p = points.at(field::liquid_pressure, b)[l];
    const Real m = points.at(field::mass, b)[l];
    CHECK(points.at(field::volume, b)[l] == doctest::Approx(m / 1000 * std::exp(-p / 1e6)));
  });
  CHECK(ids.size() == points.size());
}

/// A pond of 0.25 m on 0.5 m of dry sand: all of it sinks in.
vd::Solver<Pond> sinking_pond(const vd::Resampling& resampling) {
  vd::Scene<Pond> scene({.box = {Vec<1>(0.0), Vec<1>(1.0)}, .cell_size = 0.05});
  scene.gravity = Vec<1>(-9.81);
  scene.liquid.bulk_modulus = 1e5;
  scene.add_soil(vd::box(Vec<1>(0.0), Vec<1>(0.5)),
                 {.name = "sand",
                  .porosity = 0.4,
                  .lambda = 0.63,
                  .retention = {.a = 3, .porosity_dependent = false},
                  .conductivity = {.saturated_conductivity = 2e-2, .porosity_dependent = false}},
                 {.saturation = 0.3});
  scene.add_water(vd::box(Vec<1>(0.5), Vec<1>(0.7)), {.points_per_cell = 4, .surface_level = 0.7});
  return vd::Solver<Pond>(scene, {.resampling = resampling});
}

/// Number of free points and the mass of the lightest of them [kg].
struct FreePoints {
  int count = 0;
  Real lightest = 1e30;
};
FreePoints free_points(const vd::Solver<Pond>& solver) {
  FreePoints result;
  const auto& state = solver.state();
  state.liquid.for_each([&](std::size_t b, int l) {
    if (state.liquid.group(b) != state.free_group()) return;
    ++result.count;
    result.lightest = std::min(result.lightest, state.liquid.at(field::mass, b)[l]);
  });
  return result;
}

}  // namespace

TEST_CASE("merge and split keep mass, centroid and momentum, with APIC angular momentum too") {
  for (const unsigned seed : {1u, 2u, 3u}) {
    check_kept<Water<vd::Uniaxial, vd::transfer::Flip>>(seed);
    check_kept<Water<vd::PlaneStrain, vd::transfer::Apic>>(seed);
    check_kept<Water<vd::ThreeDimensional, vd::transfer::Apic>>(seed);
    check_kept<Water<vd::PlaneStrain, vd::transfer::Tpic>>(seed);
  }
}

TEST_CASE("a pond that sinks away loses its points, and no water") {
  auto with = sinking_pond({.on = true, .merge_below = 0.5, .points_per_axis = 4});
  auto without = sinking_pond({});
  const auto pore_points = [](const vd::Solver<Pond>& s) {
    return static_cast<int>(s.liquid().size()) - free_points(s).count;
  };
  const int soil = pore_points(with);
  const int start = free_points(with).count;
  for (int i = 1; i <= 4; ++i) {
    with.advance_to(0.4 * i);
    without.advance_to(0.4 * i);
    CAPTURE(with.time());
    const auto w = with.water_balance();
    CHECK(std::fabs(w.relative_closure()) <= 1e-12);
    CHECK(pore_points(with) == soil);
    MESSAGE("t ", with.time(), " s: ", free_points(with).count, " of ", start, " points, lightest ",
            free_points(with).lightest, " kg; without ", free_points(without).count, ", ",
            free_points(without).lightest, " kg; pond and film ", w.free + w.film, " and ",
            without.water_balance().free + without.water_balance().film, " kg");
    CHECK(
        w.free + w.film ==
        doctest::Approx(without.water_balance().free + without.water_balance().film).epsilon(0.05));
  }
  CHECK(free_points(with).count < free_points(without).count);
  CHECK(free_points(with).lightest > free_points(without).lightest);
}

TEST_CASE("resampling options are checked") {
  const auto error = [](vd::Resampling r) {
    try {
      sinking_pond(r);
    } catch (const vd::SetupError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK(error({.merge_below = 0.6}).find("merge_below = 0.6 outside [0, 0.5]") !=
        std::string::npos);
  CHECK(error({.split_above = 1.2}).find("split_above = 1.2 outside [1.5, inf)") !=
        std::string::npos);
  CHECK(error({.points_per_axis = 9}).find("points_per_axis = 9 outside [1, 8]") !=
        std::string::npos);
  CHECK(error({.points_per_axis = 9}).find("resampling") != std::string::npos);
}
