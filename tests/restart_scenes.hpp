// SPDX-License-Identifier: MIT
#pragma once

// One scene for any model: soil with a step in it, water on it and beside it, and every condition
// that keeps something between steps.

#include <algorithm>
#include <optional>
#include <type_traits>

#include <vadose/model/model.hpp>
#include <vadose/scene/scene.hpp>
#include <vadose/solver/scheme.hpp>
#include <vadose/solver/solver.hpp>

#include "unit/restart_support.hpp"

namespace restart_test {

template <class M>
vadose::Material<M> any_soil() {
  vadose::Material<M> m{.name = "soil", .porosity = 0.4};
  if constexpr (!vadose::is_rigid<M>) {
    m.solid_density = 2650;
    m.skeleton = {.young_modulus = 2e6, .poisson_ratio = 0.3};
  }
  if constexpr (vadose::is_unsaturated<M>) {
    m.lambda = 0.63;
    m.retention = {.a = 3};
  }
  if constexpr (vadose::has_liquid<M>) m.conductivity = {.saturated_conductivity = 1e-3};
  return m;
}

/// What a scheme can have in the scene.
enum class Setting {
  whole,   ///< everything
  walls,   ///< of the conditions on the liquid, open surfaces and closed walls only
  no_pond  ///< of these, and no free water beside the soil
};

/// What the liquid meets.
template <class M>
void add_liquid_conditions(vadose::Scene<M>& scene, Setting setting) {
  using vadose::Face;
  using vadose::Real;
  if (setting != Setting::whole) {
    scene.add(vadose::bc::ZeroSuction{});
    return;
  }
  scene.add(vadose::bc::Drained{.face = Face::bottom, .active = [](Real t) { return t > 0.03; }});
  scene.add(vadose::bc::Rain{.rate = 0.05});
  if constexpr (M::Kinematics::dim > 1)
    scene.add(vadose::bc::Reservoir{.face = Face::right,
                                    .function = [](Real t) { return t < 0.02 ? 0.25 : 0.15; }});
}

/// Soil 0.4 m high, water above it in 1D and beside it else.
template <class M>
vadose::Scene<M> any_scene(Setting setting = Setting::whole) {
  using vadose::Real;
  using vadose::Vec;
  constexpr int dim = M::Kinematics::dim, up = dim - 1;
  const Real length = dim == 3 ? 0.4 : 0.8;
  Vec<dim> low = Vec<dim>::Zero(), high = Vec<dim>::Constant(length);
  high[up] = 0.8;
  vadose::Scene<M> scene({.box = {low, high}, .cell_size = 0.1});
  scene.gravity[up] = -9.81;
  Vec<dim> soil_top = high, water_low = low, water_top = high;
  soil_top[up] = 0.4;
  water_low[up] = dim == 1 && vadose::has_skeleton<M> ? 0.4 : 0;
  water_top[up] = dim == 1 ? 0.6 : 0.3;
  if (dim > 1) soil_top[0] = water_low[0] = 0.5 * length;
  if constexpr (vadose::has_skeleton<M>) {
    vadose::SoilOptions<dim> start;
    if constexpr (vadose::is_unsaturated<M>)
      start.saturation = 0.6;
    else if constexpr (vadose::has_liquid<M>)
      start.water_table = 0.4;
    scene.add_soil(vadose::box<dim>(low, soil_top), any_soil<M>(), start);
    if constexpr (!vadose::is_rigid<M>) {
      scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
      Vec<dim> edge = low, force = Vec<dim>::Zero();
      edge[up] = 0.35;
      force[up] = -1e3;
      scene.add(vadose::bc::Traction<dim>{.region = vadose::box<dim>(edge, soil_top),
                                          .traction = force,
                                          .time_factor = [](Real t) { return 10 * t; }});
    }
    if constexpr (vadose::has_liquid<M>) add_liquid_conditions(scene, setting);
  }
  if constexpr (vadose::has_liquid<M>) {
    scene.liquid.bulk_modulus = 1e6;
    Vec<dim> drift = Vec<dim>::Zero();
    if (dim > 1) drift[0] = 1.5;
    if (setting != Setting::no_pond || dim == 1 || !vadose::has_skeleton<M>)
      scene.add_water(vadose::box<dim>(water_low, water_top),
                      {.surface_level = water_top[up], .velocity = drift});
  }
  return scene;
}

template <class M, class Scheme>
auto any_options() {
  typename vadose::Solver<M, Scheme>::Options options;
  options.dt_max = 2e-3;
  options.escaped = vadose::Escape::outflow;
  options.resampling.on = vadose::has_liquid<M>;
  return options;
}

/// A run of the scene is saved and taken up `times` times, `apart` steps after one another, each time
/// in a solver that has gone elsewhere and with another number of threads. `slow`: quasi-static,
/// after steps that inertia limits or that the skeleton was solved for.
template <class M, class Scheme>
void check_any_restart(int times, int apart, Setting setting = Setting::whole,
                       std::optional<vadose::SlowSkeleton> slow = {}) {
  using S = vadose::Solver<M, Scheme>;
  const auto scene = any_scene<M>(setting);
  auto options = any_options<M, Scheme>();
  // Rigid soil has no other limit in its first semi-implicit step.
  if (std::is_same_v<Scheme, vadose::scheme::SemiImplicit>) options.dt_max = 0.05;
  const bool solves = slow == vadose::SlowSkeleton::implicit;
  if (slow) options.quasi_static = {.on = true, .skeleton = *slow};
  if (solves) options.quasi_static.inertia = 0.05, options.quasi_static.dynamic = 0.5;
  S run(scene, options);
  bool slowed = false;
  for (int i = 0; slow && i < 1000 && !slowed; ++i) {
    REQUIRE(run.step().status == vadose::Status::ok);
    const auto& step = run.last_step();
    slowed = solves ? step.solve.skeleton : step.limit == vadose::StepLimit::inertia;
  }
  // In a column the water holds the skeleton.
  if (M::Kinematics::dim > 1) CHECK(slowed == slow.has_value());
  options.threads = 2;
  S other(scene, options);
  REQUIRE(steps(other, 3));
  for (int i = 0; i < times; ++i) {
    CAPTURE(run.steps());
    check_taken_up(run, other, apart);
  }
  MESSAGE(run.last_step().text(), "; ", run.solid().size(), " solid, ", run.liquid().size(),
          " liquid points");
}

/// What the printed scheme cannot do stops it. Explicit drag tears the few grains at the edge of the
/// soil away with the water beside it, pressures reach 1e12 Pa in two steps; mended, a point of water is
/// thrown from the foot of rigid soil at 80 m/s. Until then every number is finite.
template <class M, class Scheme>
void check_stops() {
  using S = vadose::Solver<M, Scheme>;
  S run(any_scene<M>(Setting::walls), any_options<M, Scheme>());
  const auto finite = [&](const auto& points, auto tag, int components) {
    bool all = true;
    points.for_each([&](std::size_t b, int lane) {
      for (int i = 0; i < components; ++i)
        all = all && vadose::is_finite(points.at(tag, b, i)[lane]);
    });
    return all;
  };
  constexpr int dim = M::Kinematics::dim;
  int taken = 0;
  for (; taken < 20 && run.step().status == vadose::Status::ok; ++taken) {
    CHECK(finite(run.solid(), vadose::field::position, dim));
    if constexpr (vadose::is_deformable<M>) {
      CHECK(finite(run.solid(), vadose::field::velocity, dim));
      CHECK(finite(run.solid(), vadose::field::bishop_stress, M::Kinematics::stress_size));
    }
    CHECK(finite(run.liquid(), vadose::field::position, dim));
    CHECK(finite(run.liquid(), vadose::field::velocity, dim));
    CHECK(finite(run.liquid(), vadose::field::liquid_pressure, 1));
  }
  MESSAGE(run.last_step().text());
  CHECK(taken < 20);
  CHECK(run.last_step().trouble.criterion != nullptr);
  S again(any_scene<M>(Setting::walls), any_options<M, Scheme>());
  CHECK_THROWS_AS(again.advance_to(1), vadose::InstabilityError);
}

template <class Preset>
struct RigidSoil : Preset {
  using Skeleton = vadose::law::Rigid;
};

inline constexpr vadose::PaperMends all_mends{.cell_average = true,
                                              .saturation = true,
                                              .porosity_slope = true,
                                              .porosity_gradient = true,
                                              .implicit_drag = true};

/// A model under every scheme there is for it.
template <class M>
void check_schemes() {
  check_any_restart<M, vadose::scheme::Explicit>(20, 17);
  if constexpr (vadose::has_liquid<M>) {
    check_any_restart<M, vadose::scheme::SemiImplicit>(20, 7);
    if constexpr (vadose::is_deformable<M>)
      for (const auto slow : {vadose::SlowSkeleton::implicit, vadose::SlowSkeleton::heavy})
        check_any_restart<M, vadose::scheme::SemiImplicit>(20, 7, Setting::no_pond, slow);
    check_any_restart<M, vadose::scheme::PaperLiteral<>>(20, 17, Setting::no_pond);
    using Mended = vadose::scheme::PaperLiteral<all_mends>;
    check_any_restart<M, Mended>(20, 17,
                                 vadose::is_deformable<M> ? Setting::walls : Setting::no_pond);
    if constexpr (M::Kinematics::dim > 1 && vadose::has_skeleton<M>)
      check_stops<M, std::conditional_t<vadose::is_deformable<M>, vadose::scheme::PaperLiteral<>,
                                        Mended>>();
  }
}

}  // namespace restart_test
