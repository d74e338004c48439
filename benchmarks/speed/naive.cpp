// SPDX-License-Identifier: MIT
// The library against the straightforward implementations of benchmarks/naive.hpp and
// naive_pair.hpp, step by step in turn, on the same start. With --check: only whether both agree
// after 100 steps; exit status 1 if not.

#include <cstdio>
#include <cstring>
#include <map>

#include "benchmarks/naive_pair.hpp"
#include "benchmarks/speed/whole_step.hpp"

namespace {

using namespace speed;

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

/// Largest relative difference after some steps.
template <class M>
double disagreement(std::int64_t points, int steps) {
  using namespace vadose;
  constexpr int dim = M::Kinematics::dim;
  Solver<M> solver(scene_of<M>(points));
  auto run = naive_run<M>(solver);
  for (int i = 0; i < steps; ++i) {
    if (solver.step().status != Status::ok) return 1;
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
  std::printf(
      "  after %d steps: position %.1e, velocity %.1e, stress %.1e, plastic strain %.1e, "
      "pressure %.1e, water %.1e\n",
      steps, position.relative(), velocity.relative(), stress.relative(), plastic.relative(),
      pressure.relative(), mass.relative());
  return std::max({position.relative(), velocity.relative(), stress.relative(), plastic.relative(),
                   pressure.relative(), mass.relative()});
}

template <class M>
bool agree(const char* name) {
  std::printf("%s\n", name);
  const double worst = disagreement<M>(4000, 100);
  if (worst <= 1e-10) return true;
  std::printf("  FAILED: more than 1e-10\n");
  return false;
}

/// Steps of both in turn; one iteration is the median of the ratios.
template <class M>
void race(benchmark::State& state, std::int64_t points) {
  vadose::Solver<M> solver(scene_of<M>(points));
  auto run = naive_run<M>(solver);
  const int steps = std::max(1, static_cast<int>(5e5 / static_cast<double>(points)));
  for (int i = 0; i < 2; ++i) solver.step();
  run.step();
  for (auto _ : state) {
    std::vector<double> ours, naive, ratio;
    for (int k = 0; k < 5; ++k) {
      double start = seconds_now();
      for (int i = 0; i < steps; ++i)
        if (solver.step().status != vadose::Status::ok) state.SkipWithError("a step failed");
      ours.push_back(seconds_now() - start);
      start = seconds_now();
      for (int i = 0; i < steps; ++i) run.step();
      naive.push_back(seconds_now() - start);
      ratio.push_back(naive.back() / ours.back());
    }
    const double count = counted_points(solver);
    state.SetIterationTime(median(ours) / steps);
    state.counters["points"] = count;
    state.counters["ns"] = 1e9 * median(ours) / steps / count;
    state.counters["ns_naive"] = 1e9 * median(naive) / steps / count;
    state.counters["ratio"] = median(ratio);
  }
}

template <class M>
void add_race(const std::string& name) {
  for (const std::int64_t points : {100000, 1000000})
    benchmark::RegisterBenchmark((name + "/points:" + std::to_string(points)).c_str(),
                                 [points](benchmark::State& state) { race<M>(state, points); })
        ->Iterations(1)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int count, char** arguments) {
  using namespace vadose;
  if (count > 1 && std::strcmp(arguments[1], "--check") == 0) {
    bool good = agree<Dry<ThreeDimensional>>("dry, 3D");
    good = agree<Dry<PlaneStrain>>("dry, plane strain") && good;
    good = agree<Unsaturated<ThreeDimensional>>("unsaturated, 3D") && good;
    good = agree<Unsaturated<PlaneStrain>>("unsaturated, plane strain") && good;
    return good ? 0 : 1;
  }
  add_race<Dry<ThreeDimensional>>("naive/dry/3d");
  add_race<Dry<PlaneStrain>>("naive/dry/2d");
  add_race<Unsaturated<ThreeDimensional>>("naive/unsaturated/3d");
  add_race<Unsaturated<PlaneStrain>>("naive/unsaturated/2d");
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
