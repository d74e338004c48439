// SPDX-License-Identifier: MIT
// Situations in which material point codes fail: each has a bound that can be missed.

#include <doctest/doctest.h>

#include "../seepage.hpp"
#include "tests/verify/verify_support.hpp"

#include <vadose/policy/law/drucker_prager.hpp>
#include <vadose/policy/law/with_opening.hpp>

namespace {

namespace vd = vadose;
using vd::Real;
using vd::Vec;

using Wet = vd::SaturatedModel<vd::PlaneStrain>;
using Dry = vd::DryModel<vd::PlaneStrain>;
using Bar = vd::DryModel<vd::Uniaxial>;
struct Sand : vd::DryModel<vd::Uniaxial> {
  using Skeleton = vd::law::DruckerPrager;
};
struct Remembering : vd::DryModel<vd::Uniaxial> {
  using Skeleton = vd::law::WithOpening<vd::law::DruckerPrager>;
};
struct Moist : vd::UnsaturatedModel<vd::Uniaxial> {
  using Skeleton = vd::law::WithOpening<vd::law::DruckerPrager>;
};
using Seepage = vadose_test::Seepage<vd::Uniaxial>;

constexpr Real load = 1e4, cell_size = 0.1;

template <class Points>
void shift(Points& points, const Vec<2>& by) {
  for (std::size_t b = 0; b < points.batches(); ++b)
    for (int l = 0; l < vd::lane_count; ++l)
      for (int d = 0; d < 2; ++d) points.at(vd::field::position, b, d)[l] += by[d];
}

/// A loaded undrained block 0.4 m x 1 m, its points moved by `by`; mean pressure over the load,
/// averaged over space and the second half of the run, and its largest value.
struct Loaded {
  Real mean = 0, largest = 0, speed = 0;
};
Loaded run_loaded(int per_cell, const Vec<2>& by, Real jitter, long steps) {
  vd::Scene<Wet> scene({.box = {{0, 0}, {0.4, 1.2}}, .cell_size = cell_size});
  scene.add_soil(vd::box({0, 0}, {0.4, 1}), verify::saturated_soil<Wet>(1e-10),
                 {.points_per_cell = per_cell, .jitter = jitter, .seed = 2});
  scene.add(vd::bc::Fixed{.face = vd::Face::bottom});
  scene.add(
      vd::bc::Traction<2>{.region = vd::box({0, 0.9}, {0.4, 1}), .traction = Vec<2>(0, -load)});
  vd::Solver<Wet> solver(scene, {.damping = 0.3});
  shift(solver.mutable_state().solid, by);
  shift(solver.mutable_state().liquid, by);
  Loaded out;
  verify::Norm mean;
  for (long i = 0; i < steps; ++i) {
    const auto step = solver.step();
    if (step.status != vd::Status::ok) FAIL(step.text());
    if (i % 10 != 0) continue;
    verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
      out.largest = std::max(out.largest, std::fabs(cell.pressure) / load);
      if (2 * i >= steps) mean.add(cell.pressure / load);
    });
  }
  out.mean = mean.mean();
  out.speed = verify::largest_speed(solver.solid());
  MESSAGE(per_cell, " per cell, moved by (", by[0], ", ", by[1], ") m, jitter ", jitter,
          ": mean p/q ", out.mean, ", largest |p|/q ", out.largest, ", scatter ",
          std::sqrt(std::max(0.0, mean.rms() * mean.rms() - out.mean * out.mean)), ", speed ",
          out.speed, " m/s");
  return out;
}

void check_loaded(const Loaded& o) {
  const Real stiffness = verify::oedometric_modulus(10e6, 0.33);
  CHECK(verify::close(o.mean, 1 / (1 + 0.4 * stiffness / 2.2e9), 0.02));
  CHECK(o.largest <= 3);
}

}  // namespace

TEST_CASE("undrained load at K = 2.2 GPa and k = 1e-10 m/s") {
  check_loaded(run_loaded(4, Vec<2>::Zero(), 0, 4000));
}
TEST_CASE("undrained load, random offsets") {
  check_loaded(run_loaded(4, Vec<2>::Zero(), 0.2, 4000));
}
TEST_CASE("undrained load, rows of points exactly on cell boundaries") {
  check_loaded(run_loaded(4, Vec<2>(0, 0.25 * cell_size), 0, 4000));
}
TEST_CASE("undrained load, rows of points a hair beyond a cell boundary") {
  check_loaded(run_loaded(4, Vec<2>(0, 0.25 * cell_size * (1 + 1e-9)), 0, 4000));
  check_loaded(run_loaded(4, Vec<2>(0, 0.25 * cell_size * (1 - 1e-9)), 0, 4000));
}
TEST_CASE("undrained load, one point per cell") {
  check_loaded(run_loaded(1, Vec<2>::Zero(), 0, 4000));
}
TEST_CASE("undrained load, one point per cell on the upper boundary of its cell") {
  check_loaded(run_loaded(1, Vec<2>(0, 0.5 * cell_size * (1 - 1e-9)), 0, 4000));
}

// Free flight: nodes at the edges of the block see masses from nothing upwards.
TEST_CASE("cell crossing at 0.3 c without stress: dry and saturated block in free flight") {
  const Real speed = 0.3 * 97.456;
  const auto fly = [&](auto tag) {
    using M = decltype(tag);
    vd::Scene<M> scene({.box = {{0, 0}, {3, 0.8}}, .cell_size = cell_size});
    vd::Material<M> material{.solid_density = 2600,
                             .porosity = 0.4,
                             .skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.33}};
    if constexpr (vd::has_liquid<M>) material = verify::saturated_soil<M>();
    scene.add_soil(vd::box({0.2, 0.2}, {0.6, 0.6}), material,
                   {.jitter = 0.1, .seed = 4, .velocity = Vec<2>(speed, 0.1 * speed / 3)});
    vd::Solver<M> solver(scene);
    solver.advance_to(2 / speed);
    Real momentum = 0, mass = 0, stress = 0;
    solver.solid().for_each([&](std::size_t b, int l) {
      const Real m = solver.solid().at(vd::field::mass, b)[l];
      mass += m;
      momentum += m * solver.solid().at(vd::field::velocity, b)[l];
      for (int i = 0; i < 4; ++i)
        stress = std::max(stress, std::fabs(solver.solid().at(vd::field::bishop_stress, b, i)[l]));
    });
    if constexpr (vd::has_liquid<M>)
      solver.liquid().for_each([&](std::size_t b, int l) {
        const Real m = solver.liquid().at(vd::field::mass, b)[l];
        mass += m;
        momentum += m * solver.liquid().at(vd::field::velocity, b)[l];
      });
    MESSAGE(std::string(vd::has_liquid<M> ? "saturated" : "dry"), ": speed off by ",
            momentum / mass / speed - 1, ", largest stress ", stress, " Pa after ", solver.steps(),
            " steps");
    CHECK(std::fabs(momentum / mass / speed - 1) <= 1e-12);
    CHECK(stress <= 1e-3);
  };
  fly(Dry{});
  fly(Wet{});
}

// A bar hits a wall at 0.3 c: strains of 30 %, many crossings.
TEST_CASE("cell crossing at 0.3 c with stress: impact on a wall") {
  vd::Scene<Bar> scene({.box = {Vec<1>(0.0), Vec<1>(4.0)}, .cell_size = cell_size});
  scene.add_soil(
      vd::box(Vec<1>(0.0), Vec<1>(1.0)),
      {.solid_density = 260,
       .porosity = 0.9,
       .skeleton = {.young_modulus = 1e5, .poisson_ratio = 0.33}},
      {.velocity = Vec<1>(-0.3 * std::sqrt(verify::oedometric_modulus(1e5, 0.33) / 26))});
  vd::Solver<Bar> solver(scene);
  const auto energy = [&] {
    Real sum = 0;
    solver.solid().for_each([&](std::size_t b, int l) {
      const Real v = solver.solid().at(vd::field::velocity, b)[l];
      sum += 0.5 * solver.solid().at(vd::field::mass, b)[l] * v * v;
    });
    return sum;
  };
  const Real start = energy();
  Real largest = 0;
  while (solver.time() < 0.03) {
    const auto step = solver.step();
    if (step.status != vd::Status::ok) FAIL(step.text());
    largest = std::max(largest, energy());
  }
  MESSAGE("kinetic energy: largest over start ", largest / start, ", at the end ",
          energy() / start);
  CHECK(largest <= 1.05 * start);
}

// Every node is given the velocity of a homogeneous stretch; the law must return M ln J.
TEST_CASE("elastic bar pressed to a fifth and stretched twentyfold: stress M ln J") {
  for (const Real stretch : {0.2, 20.0}) {
    CAPTURE(stretch);
    const Real rate = stretch - 1, high = stretch > 1 ? 21 : 1.2;
    vd::Scene<Bar> scene({.box = {Vec<1>(0.0), Vec<1>(high)}, .cell_size = cell_size});
    scene.add_soil(vd::box(Vec<1>(0.0), Vec<1>(1.0)),
                   {.solid_density = 2600,
                    .porosity = 0.9,
                    .skeleton = {.young_modulus = 1e5, .poisson_ratio = 0.33}});
    const int nodes = static_cast<int>(std::lround(high / cell_size));
    for (int i = 0; i <= nodes; ++i) {
      const Real z = i * cell_size, near = 0.1 * cell_size;
      scene.add(
          vd::bc::PrescribedVelocity<1>{.region = vd::box(Vec<1>(z - near), Vec<1>(z + near)),
                                        .velocity = Vec<1>(rate * z),
                                        .time_factor = [=](Real t) { return 1 / (1 + rate * t); }});
    }
    vd::Solver<Bar> solver(scene, {.dt_max = 1e-4});
    solver.advance_to(1);
    const Real expected = verify::oedometric_modulus(1e5, 0.33) * std::log(stretch);
    verify::Norm stress, volume;
    solver.solid().for_each([&](std::size_t b, int l) {
      stress.add(solver.solid().at(vd::field::bishop_stress, b)[l] / expected - 1);
      volume.add(solver.solid().at(vd::field::volume, b)[l] / (0.05 * stretch) - 1);
    });
    MESSAGE("stretch ", stretch, ": largest error of stress ", stress.max, ", of volume ",
            volume.max, ", steps ", solver.steps());
    CHECK(stress.max <= 0.01);
    CHECK(volume.max <= 0.01);
  }
}

TEST_CASE("sand without cohesion is torn apart: no tension, no energy from nowhere") {
  vd::Scene<Sand> scene({.box = {Vec<1>(0.0), Vec<1>(6.0)}, .cell_size = cell_size});
  scene.add_soil(vd::box(Vec<1>(2.5), Vec<1>(3.5)),
                 {.solid_density = 2600,
                  .porosity = 0.4,
                  .skeleton = {.elastic = {.young_modulus = 10e6, .poisson_ratio = 0.33},
                               .friction_angle = vd::degrees(30)}});
  vd::Solver<Sand> solver(scene);
  auto& solid = solver.mutable_state().solid;
  const auto energy = [&] {
    Real sum = 0;
    solid.for_each([&](std::size_t b, int l) {
      const Real v = solid.at(vd::field::velocity, b)[l];
      sum += 0.5 * solid.at(vd::field::mass, b)[l] * v * v;
    });
    return sum;
  };
  solid.for_each([&](std::size_t b, int l) {
    solid.at(vd::field::velocity, b)[l] = 2 * (solid.at(vd::field::position, b)[l] - 3);
  });
  const Real start = energy();
  while (solver.time() < 1) {
    const auto step = solver.step();
    if (step.status != vd::Status::ok) FAIL(step.text());
  }
  Real tension = 0;
  solid.for_each([&](std::size_t b, int l) {
    Real mean = 0;
    for (int i = 0; i < 3; ++i) mean += solid.at(vd::field::bishop_stress, b, i)[l] / 3;
    tension = std::max(tension, mean);
  });
  MESSAGE("largest mean tension ", tension, " Pa, kinetic energy left ", energy() / start);
  CHECK(tension <= 1e-6);
  CHECK(energy() <= start * (1 + 1e-9));
  CHECK(energy() >= 0.9 * start);
}

/// Sand flies apart until it is 1.7 times as long, and back: largest pressure before the grains meet, and
/// what their porosity is off by then, in the mean, where the sand is 6 % longer than at first.
struct Return {
  Real pressure = 0, porosity = 0, widest = 0;
};
template <class M>
Return flown_apart_and_back() {
  vd::Scene<M> scene({.box = {Vec<1>(0.0), Vec<1>(6.0)}, .cell_size = cell_size});
  vd::Material<M> sand{.solid_density = 2600, .porosity = 0.4};
  const vd::law::DruckerPrager law{.elastic = {.young_modulus = 10e6, .poisson_ratio = 0.33},
                                   .friction_angle = vd::degrees(30)};
  if constexpr (std::is_same_v<typename M::Skeleton, vd::law::DruckerPrager>)
    sand.skeleton = law;
  else
    sand.skeleton = {law};
  vd::SoilOptions<1> options;
  if constexpr (vd::has_liquid<M>) {
    sand.lambda = 0.6;
    sand.retention.a = 1e3;  // next to no suction, which would pull it together
    sand.conductivity.saturated_conductivity = 1e-3;
    options.suction = 100;
  }
  scene.add_soil(vd::box(Vec<1>(2.5), Vec<1>(3.5)), sand, options);
  vd::Solver<M> solver(scene);
  auto& state = solver.mutable_state();
  const auto set_speed = [&](Real rate) {
    const auto set = [&](auto& points) {
      points.for_each([&](std::size_t b, int l) {
        points.at(vd::field::velocity, b)[l] = rate * (points.at(vd::field::position, b)[l] - 3);
      });
    };
    set(state.solid);
    if constexpr (vd::has_liquid<M>) set(state.liquid);
  };
  Return out;
  const auto run_to = [&](Real time) {
    while (solver.time() < time) {
      const auto step = solver.step(time);
      if (step.status != vd::Status::ok) FAIL(step.text());
      state.solid.for_each([&](std::size_t b, int l) {
        Real mean = 0;
        for (int i = 0; i < 3; ++i) mean += state.solid.at(vd::field::bishop_stress, b, i)[l] / 3;
        out.pressure = std::max(out.pressure, -mean);
        out.widest = std::max(out.widest, 1 - state.solid.at(vd::field::mass, b)[l] /
                                                  (2600 * state.solid.at(vd::field::volume, b)[l]));
      });
    }
  };
  set_speed(20);
  run_to(0.035);
  set_speed(-20 / 1.7);
  run_to(0.067);
  state.solid.for_each([&](std::size_t b, int l) {
    const Real n = 1 - state.solid.at(vd::field::mass, b)[l] /
                           (2600 * state.solid.at(vd::field::volume, b)[l]);
    out.porosity += std::fabs(n - (1 - 0.6 / 1.06)) / static_cast<Real>(state.solid.size());
  });
  return out;
}

TEST_CASE("sand flies apart and back: grains that do not touch do not push") {
  const Return forgetful = flown_apart_and_back<Sand>(), dry = flown_apart_and_back<Remembering>(),
               moist = flown_apart_and_back<Moist>();
  for (const auto& [name, r] : {std::pair{"forgotten", forgetful}, {"dry", dry}, {"moist", moist}})
    MESSAGE(std::string(name), ": largest pressure ", r.pressure, " Pa, porosity at most ",
            r.widest, ", off at the end by ", r.porosity);
  CHECK(forgetful.pressure > 1e5);
  for (const Return& r : {dry, moist}) {
    CHECK(r.pressure < 1e3);
    CHECK(r.porosity < 0.02);
    CHECK(r.widest > 0.6);
  }
}

TEST_CASE("wetting front into sand next to its residual saturation") {
  vd::Scene<Seepage> scene({.box = {Vec<1>(0.0), Vec<1>(1.0)}, .cell_size = 0.05});
  scene.gravity[0] = -9.81;
  scene.liquid.bulk_modulus = 5e6;
  const Real residual = 0.05;
  scene.add_soil(
      vd::box(Vec<1>(0.0), Vec<1>(1.0)),
      {.porosity = 0.4,
       .lambda = 0.63,
       .retention = {.residual_saturation = residual, .a = 3, .porosity_dependent = false},
       .conductivity = {.saturated_conductivity = 1e-3, .porosity_dependent = false}},
      {.saturation = residual + 0.002});
  scene.add(vd::bc::PrescribedPressure<1>{.face = vd::Face::top, .pressure = 0});
  vd::Solver<Seepage> solver(scene);
  Real lowest = 1, highest = 0, least_rise = 1;
  for (int i = 1; i <= 40; ++i) {
    solver.advance_to(1.0 * i);
    Real below = 0;  // saturation grows upwards behind a front that comes from the top
    verify::for_cells(solver, vd::CellKind::soil, [&](const auto& cell) {
      lowest = std::min(lowest, cell.saturation);
      highest = std::max(highest, cell.saturation);
      if (below > 0) least_rise = std::min(least_rise, cell.saturation - below);
      below = cell.saturation;
    });
  }
  const auto balance = solver.water_balance();
  MESSAGE("S from ", lowest, " to ", highest, ", least rise from cell to cell ", least_rise,
          ", inflow ", balance.inflow / 1000, " m, closure ", balance.relative_closure());
  CHECK(lowest >= residual * (1 - 0.05));
  CHECK(highest <= 1);
  CHECK(least_rise >= -1e-3);
  CHECK(balance.inflow / 1000 >= 0.05);
  CHECK(std::fabs(balance.relative_closure()) <= 1e-12);
}
