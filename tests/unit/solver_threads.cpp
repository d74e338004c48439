// SPDX-License-Identifier: MIT

// A run has the same bits for one, two and three threads. (Without OpenMP in the build the loops
// run in one thread and the test says nothing.) So has a run that is saved and taken up again.

#include <doctest/doctest.h>

#include "kernel_support.hpp"
#include "restart_support.hpp"

namespace {

using namespace kernel_test;

template <class M>
void check_same_bits(const vadose::Scene<M>& scene, int steps, Real courant = 0.5) {
  std::map<std::int64_t, std::vector<double>> solid, liquid;
  Real time = 0;
  for (const int threads : {1, 2, 3}) {
    vadose::Solver<M> solver(scene, {.courant = courant, .threads = threads});
    REQUIRE(run(solver, steps));
    const auto s = by_id(solver.solid());
    std::map<std::int64_t, std::vector<double>> l;
    if constexpr (vadose::has_liquid<M>) l = by_id(solver.liquid());
    if (threads == 1) {
      solid = s;
      liquid = l;
      time = solver.time();
      continue;
    }
    CHECK(solver.time() == time);
    REQUIRE(s.size() == solid.size());
    REQUIRE(l.size() == liquid.size());
    int different = 0;
    for (const auto& [id, values] : solid) different += !same_bits(values, s.at(id));
    for (const auto& [id, values] : liquid) different += !same_bits(values, l.at(id));
    CHECK(different == 0);
  }
  restart_test::check_restart<vadose::Solver<M>>(scene, {.courant = courant}, steps / 2, steps / 4);
}

}  // namespace

TEST_CASE("same bits for any number of threads: collapse of a dry column") {
  using M = Dry<vadose::PlaneStrain, vadose::law::DruckerPrager>;
  vadose::Scene<M> scene({.box = {{0, 0}, {2, 1.2}}, .cell_size = 0.05});
  scene.gravity = {0, -9.81};
  auto sand = soil<M>();
  sand.skeleton.cohesion = 0;
  sand.skeleton.tensile_strength = 0;
  scene.add_soil(vadose::box({0, 0}, {0.5, 1.0}), sand, {.jitter = 0.1});
  scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
  check_same_bits(scene, 200);
}

TEST_CASE("same bits for any number of threads: saturated column") {
  using M = Saturated<vadose::PlaneStrain>;
  vadose::Scene<M> scene({.box = {{0, 0}, {0.5, 2.4}}, .cell_size = 0.1});
  scene.gravity = {0, -9.81};
  scene.liquid.bulk_modulus = 2e7;
  scene.add_soil(vadose::box({0, 0}, {0.5, 2.0}), soil<M>(), {.water_table = 2.0});
  scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
  check_same_bits(scene, 200);
}

TEST_CASE("same bits for any number of threads: unsaturated block in space") {
  using M = Unsaturated<vadose::ThreeDimensional>;
  vadose::Scene<M> scene({.box = {{0, 0, 0}, {1.2, 0.8, 1.2}}, .cell_size = 0.1});
  scene.gravity = {0, 0, -9.81};
  scene.liquid.bulk_modulus = 2e7;
  scene.add_soil(vadose::box({0, 0, 0}, {0.6, 0.8, 0.6}), soil<M>(), {.suction = 5e3});
  check_same_bits(scene, 200);
}
