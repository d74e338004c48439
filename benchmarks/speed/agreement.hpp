// SPDX-License-Identifier: MIT
#pragma once

// The library beside the straightforward implementations of benchmarks/naive.hpp and naive_pair.hpp,
// step by step, on the same start.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "benchmarks/naive_pair.hpp"
#include "benchmarks/speed/scenes.hpp"

namespace speed {

/// Soil that fills a closed box: for the pair, whose rules at the ground surface are not written
/// down a second time.
template <class M>
vadose::Scene<M> closed_box(std::int64_t points) {
  constexpr int dim = M::Kinematics::dim;
  const Vec<dim> low = Vec<dim>::Zero();
  const Vec<dim> high = Vec<dim>::Constant(block_cells<dim>(points) * cell_size);
  vadose::Scene<M> scene{{.box = {low, high}, .cell_size = cell_size}};
  scene.gravity[dim - 1] = -9.81;
  scene.add_soil(vadose::box<dim>(low, high), soil<M>(), {.jitter = 0.2, .suction = 10e3});
  scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
  return scene;
}

template <class M>
vadose::Scene<M> scene_of(std::int64_t points) {
  if constexpr (vadose::is_unsaturated<M>)
    return closed_box<M>(points);
  else
    return scene<M>({.points = points});
}
template <class M>
auto naive_run(const vadose::Solver<M>& solver) {
  if constexpr (vadose::is_unsaturated<M>)
    return naive::PairRun<M>(solver);
  else
    return naive::DryRun<M::Kinematics::dim>(solver);
}

/// Largest difference of a quantity over its largest value.
struct Difference {
  double most = 0, size = 0;
  void take(double a, double b) {
    most = std::max(most, std::abs(a - b));
    size = std::max(size, std::abs(b));
  }
  double relative() const { return size > 0 ? most / size : most; }
};

/// Compares the points of a set, by id.
template <int Dim, class Points, class List, class F>
void compare(const Points& points, const List& list, F&& f) {
  std::map<std::int64_t, const typename List::value_type*> by_id;
  for (const auto& p : list) by_id[p.id] = &p;
  points.for_each([&](std::size_t b, int l) {
    f(*by_id.at(static_cast<std::int64_t>(points.at(vadose::field::id, b)[l])), b, l);
  });
}

/// A quantity, and its largest difference over its largest value.
struct Disagreement {
  const char* quantity;
  double relative;
};

/// Largest relative differences after some steps, in every quantity; empty where a step fails.
template <class M>
std::vector<Disagreement> disagreements(std::int64_t points, int steps) {
  using namespace vadose;
  constexpr int dim = M::Kinematics::dim;
  Solver<M> solver(scene_of<M>(points));
  auto run = naive_run<M>(solver);
  for (int i = 0; i < steps; ++i) {
    if (solver.step().status != Status::ok) return {};
    run.step();
  }
  Difference position, velocity, stress, plastic, pressure, mass;
  const auto& solid = solver.solid();
  compare<dim>(solid, run.points(), [&](const auto& p, std::size_t b, int l) {
    for (int d = 0; d < dim; ++d) {
      position.take(p.position[d], solid.at(field::position, b, d)[l]);
      velocity.take(p.velocity[d], solid.at(field::velocity, b, d)[l]);
    }
    for (int d = 0; d < 3; ++d)
      stress.take(p.stress(d, d), solid.at(field::bishop_stress, b, d)[l]);
    stress.take(p.stress(0, 1), solid.at(field::bishop_stress, b, 3)[l]);
    plastic.take(p.plastic_strain, solid.at(field::law_state, b)[l]);
  });
  if constexpr (has_liquid<M>) {
    const auto& liquid = solver.liquid();
    compare<dim>(liquid, run.water(), [&](const auto& w, std::size_t b, int l) {
      for (int d = 0; d < dim; ++d)
        velocity.take(w.velocity[d], liquid.at(field::velocity, b, d)[l]);
      pressure.take(w.pressure, liquid.at(field::liquid_pressure, b)[l]);
      mass.take(w.mass, liquid.at(field::mass, b)[l]);
    });
  }
  return {{"position", position.relative()}, {"velocity", velocity.relative()},
          {"stress", stress.relative()},     {"plastic strain", plastic.relative()},
          {"pressure", pressure.relative()}, {"water", mass.relative()}};
}

}  // namespace speed
