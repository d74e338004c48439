// SPDX-License-Identifier: MIT
#pragma once

// Whole steps of a model as benchmarks: time per point and step in all and by pass, beside what the
// machine could do.

#include <benchmark/benchmark.h>

#include <cstdint>
#include <string>
#include <vector>

#include "benchmarks/speed/machine.hpp"
#include "benchmarks/speed/passes.hpp"
#include "benchmarks/speed/scenes.hpp"

namespace speed {

/// Useful floating-point operations of mapping, interpolation, shape functions and law per solid
/// point and step, counted by hand on the separable sums (a multiply-add is two).
constexpr double operations(int dim, int support) {
  if (dim == 3) return support == 3 ? 1835 : 720;
  return support == 3 ? 530 : 256;
}

/// Bytes of point data that a step has to move per point: read for the map to the nodes, read and
/// written on the way back.
template <class Points>
constexpr double traffic() {
  return 3.0 * Points::bytes_per_point;
}

/// Points that a time is divided by: solid points (a pair of solid and liquid point counts once), or
/// those of free water.
template <class Solver>
double counted_points(const Solver& solver) {
  const auto solid = solver.solid().size();
  return static_cast<double>(solid > 0 ? solid : solver.liquid().size());
}

/// Runs and times steps of model M; one iteration is the median of five spells.
template <class M, class Scheme>
void time_steps(benchmark::State& state, const vadose::Scene<M>& scene, int threads) {
  using Solver = vadose::Solver<M, Scheme>;
  Solver solver(scene, {.threads = threads});
  const double points = counted_points(solver);
  const auto good = [&] {
    const bool ok = solver.step().status == vadose::Status::ok;
    if (!ok) state.SkipWithError("a step failed");
    return ok;
  };
  const int steps = std::max(3, static_cast<int>(1.5e6 / points));
  for (int i = 0; i < 3; ++i)
    if (!good()) return;
  for (auto _ : state) {
    std::vector<double> spells;
    std::vector<PassTimes> passes;
    const Event instructions(Event::instructions), cycles(Event::cycles);
    const double i0 = instructions.read(), c0 = cycles.read();
    for (int k = 0; k < 5; ++k) {
      TimedExplicit::times = {};
      const double start = seconds_now();
      for (int i = 0; i < steps; ++i)
        if (!good()) return;
      spells.push_back(seconds_now() - start);
      passes.push_back(TimedExplicit::times);
    }
    const double per_step = median(spells) / steps;
    state.SetIterationTime(per_step);
    const double ns = 1e9 * per_step / points;
    auto& c = state.counters;
    c["points"] = points;
    c["ns"] = ns;
    c["points/s"] = 1e9 / ns;
    for (std::size_t p = 0; p < pass_count; ++p) {
      std::vector<double> of_pass;
      for (const auto& t : passes) of_pass.push_back(t.seconds[p]);
      const double value = 1e9 * median(of_pass) / steps / points;
      if (value > 0) c[std::string("ns_") + pass_names[p]] = value;
    }
    if (threads == 1 && instructions.read() > 0) {
      c["instructions"] = (instructions.read() - i0) / (5 * steps * points);
      c["cycles"] = (cycles.read() - c0) / (5 * steps * points);
    }
    using State = vadose::State<M>;
    double bytes = 0, moved = 0;
    if (vadose::has_skeleton<M>) {
      bytes += State::Solid::bytes_per_point;
      moved += traffic<typename State::Solid>();
    }
    if (vadose::has_liquid<M>) {
      bytes += State::Liquid::bytes_per_point;
      moved += traffic<typename State::Liquid>();
    }
    c["bytes"] = bytes;
    c["MB"] = solver.estimate(solver.time(), 0).megabytes;
    const Machine& machine = Machine::get(threads);
    c["GB/s_triad"] = 1e-9 * machine.bandwidth;
    c["Gflop/s_fma"] = 1e-9 * machine.fma;
    c["of_bandwidth"] = 1e9 * moved / ns / machine.bandwidth;
    if (!vadose::has_liquid<M>)
      c["of_fma"] = 1e9 * operations(State::dim, M::Shape::support) / ns / machine.fma;
  }
}

/// Registers model M at sizes and thread counts.
template <class M, class Scheme = TimedExplicit>
void add_steps(const std::string& name, const std::vector<std::int64_t>& sizes,
               const std::vector<int>& thread_counts, Layout layout = {}) {
  for (const std::int64_t size : sizes)
    for (const int threads : thread_counts) {
      layout.points = size;
      const std::string full =
          name + "/points:" + std::to_string(size) + "/threads:" + std::to_string(threads);
      benchmark::RegisterBenchmark(full.c_str(),
                                   [layout, threads](benchmark::State& state) {
                                     time_steps<M, Scheme>(state, scene<M>(layout), threads);
                                   })
          ->Iterations(1)
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
}

/// Sizes of the curves of time over size.
inline const std::vector<std::int64_t> all_sizes{10000, 100000, 1000000, 4000000};

}  // namespace speed
