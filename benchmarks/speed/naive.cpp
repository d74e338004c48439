// SPDX-License-Identifier: MIT
// The library against the straightforward implementations of benchmarks/naive.hpp and
// naive_pair.hpp, step by step in turn, on the same start. With --check: only whether both agree
// after 100 steps; exit status 1 if not.

#include <cstdio>
#include <cstring>

#include "benchmarks/speed/agreement.hpp"
#include "benchmarks/speed/whole_step.hpp"

namespace {

using namespace speed;

template <class M>
bool agree(const char* name) {
  std::printf("%s, after 100 steps:", name);
  const auto all = disagreements<M>(4000, 100);
  bool good = !all.empty();
  for (const auto& one : all) {
    std::printf(" %s %.1e", one.quantity, one.relative);
    good = good && one.relative <= 1e-10;
  }
  std::printf("%s\n", good ? "" : "\n  FAILED: more than 1e-10");
  return good;
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
