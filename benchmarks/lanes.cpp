// SPDX-License-Identifier: MIT
// Eight points at once against one at a time, on the arithmetic of a Drucker-Prager trial: one
// square root, one division, one branch. Compare the two rates of one run.
#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include <vadose/core/lanes.hpp>

namespace {

constexpr std::size_t batches = 64;  // 12 KiB: stays in the first-level cache
constexpr std::int64_t points_in_all = std::int64_t{batches} * vadose::lane_count;

struct alignas(64) Batch {
  double deviator[vadose::lane_count];
  double mean[vadose::lane_count];
  double scale[vadose::lane_count];
};

std::vector<Batch> make_points() {
  std::vector<Batch> points(batches);
  double value = 0.5;
  for (Batch& batch : points)
    for (int lane = 0; lane < vadose::lane_count; ++lane) {
      value = value < 0.5 ? value + 0.37 : value - 0.31;  // every other point or so yields
      batch.deviator[lane] = value;
      batch.mean[lane] = -2.0 * value;
      batch.scale[lane] = 1.0;
    }
  return points;
}

// Factor that brings a deviator of squared size j2 back to the cone.
template <class T>
T return_factor(T j2, T mean) {
  using vadose::select;
  using vadose::sqrt;
  const T size = sqrt(j2);
  const T strength = T(0.1) - T(0.6) * mean;
  return select(size > strength, strength / size, T(1.0));
}

void scalar(benchmark::State& state) {
  std::vector<Batch> points = make_points();
  for (auto _ : state) {
    for (Batch& batch : points)
      for (int lane = 0; lane < vadose::lane_count; ++lane) {
        batch.scale[lane] = return_factor(batch.deviator[lane], batch.mean[lane]);
        benchmark::DoNotOptimize(batch.scale[lane]);  // keeps the compiler from joining points
      }
    benchmark::DoNotOptimize(points.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * points_in_all);
}

void lanes(benchmark::State& state) {
  using vadose::Lanes;
  std::vector<Batch> points = make_points();
  for (auto _ : state) {
    for (Batch& batch : points)
      return_factor(Lanes::load(batch.deviator), Lanes::load(batch.mean)).store(batch.scale);
    benchmark::DoNotOptimize(points.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * points_in_all);
}

}  // namespace

BENCHMARK(scalar)->Name("return factor, one point at a time");
BENCHMARK(lanes)->Name("return factor, eight points at once");
BENCHMARK_MAIN();
