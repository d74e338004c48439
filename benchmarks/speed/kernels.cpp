// SPDX-License-Identifier: MIT
// Kernels by themselves, per point or per call: laws, curves, functions, sorting. Data stay in the
// caches.

#include <benchmark/benchmark.h>

#include "benchmarks/speed/whole_step.hpp"

namespace {

using namespace speed;
using vadose::Lanes;

constexpr std::size_t batches = 128;

/// 1024 numbers spread evenly from low to high.
vadose::AlignedVector<double> numbers(double low, double high) {
  vadose::AlignedVector<double> v(batches * vadose::lane_count);
  for (std::size_t i = 0; i < v.size(); ++i)
    v[i] = low +
           (high - low) * static_cast<double>(i * 7919 % v.size()) / static_cast<double>(v.size());
  return v;
}

void count(benchmark::State& state) {
  const auto points = static_cast<double>(state.iterations()) * batches * vadose::lane_count;
  state.SetItemsProcessed(static_cast<std::int64_t>(points));
  state.counters["ns"] =
      benchmark::Counter(1e-9 * points, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

/// f(batch) on lanes, or f(number) one by one.
template <class T, class F>
void map_numbers(benchmark::State& state, double low, double high, F&& f) {
  const auto in = numbers(low, high);
  vadose::AlignedVector<double> out(in.size());
  for (auto _ : state) {
    if constexpr (std::is_same_v<T, Lanes>)
      for (std::size_t i = 0; i < in.size(); i += vadose::lane_count)
        f(Lanes::load(&in[i])).store(&out[i]);
    else
      for (std::size_t i = 0; i < in.size(); ++i) out[i] = f(in[i]);
    benchmark::DoNotOptimize(out.data());
    benchmark::ClobberMemory();
  }
  count(state);
}

template <class T>
void exponential(benchmark::State& state) {
  map_numbers<T>(state, -5, 5, [](const T& x) { return vadose::exp(x); });
}
template <class T>
void water_content(benchmark::State& state) {
  const auto curve = soil<Unsaturated<vadose::PlaneStrain>>().resolved(9810).retention;
  map_numbers<T>(state, -50e3, 1e3, [&](const T& p) {
    return vadose::swrc::water_content<T>(curve, p, T(0.4), T(1 / 2.2e9)).value;
  });
}
template <class T>
void relative_conductivity(benchmark::State& state) {
  const auto law = soil<Unsaturated<vadose::PlaneStrain>>().resolved(9810).conductivity;
  map_numbers<T>(state, 0.05, 1,
                 [&](const T& s) { return vadose::conductivity::value<T>(law, s, T(0.4)); });
}
void face_conductivity(benchmark::State& state) {
  const auto m = soil<Unsaturated<vadose::PlaneStrain>>().resolved(9810);
  const vadose::KirchhoffMean mean(m.retention, m.conductivity, 0.4);
  map_numbers<double>(state, -50e3, -1e3, [&](double p) { return mean.mean(p, p - 900, 0.4); });
}

/// Return mapping of a law; the trial stresses yield or not in turn.
template <class T, class Law>
void return_mapping(benchmark::State& state, const Law& law) {
  const auto prepared = vadose::law::prepared(law);
  map_numbers<T>(state, -20e3, 20e3, [&](const T& shear) {
    vadose::SymTensor<T, 6> stress;
    for (int i = 0; i < 6; ++i) stress[i] = T(i < 3 ? -10e3 : 0.0);
    stress[3] = shear;
    vadose::StrainStep<T, 6> step;
    for (int i = 0; i < 6; ++i) step.increment[i] = T(1e-5 * i);
    T history[4] = {T(0.0), T(0.0), T(0.0), T(0.0)};
    vadose::law::apply(prepared, step, stress, history);
    return stress[3] + stress[0] + history[0];
  });
}
template <class T>
void drucker_prager(benchmark::State& state) {
  return_mapping<T>(state, soil<Dry<vadose::ThreeDimensional>>().skeleton);
}
template <class T>
void softening(benchmark::State& state) {
  auto law = soil<Dry<vadose::ThreeDimensional>>().skeleton;
  law.mobilisation.critical_shear_strain = 0.1;
  law.mobilisation.critical = {.cohesion = 0, .friction_angle = vadose::degrees(28)};
  return_mapping<T>(state, law);
}

/// Sorting all points, per point.
void sort_points(benchmark::State& state) {
  using M = Dry<vadose::ThreeDimensional>;
  vadose::Solver<M> solver(scene<M>({.points = 100000}));
  auto& s = solver.mutable_state();
  for (auto _ : state) s.solid.sort(s.grid, 2);
  const auto points = static_cast<double>(state.iterations()) * counted_points(solver);
  state.counters["ns"] =
      benchmark::Counter(1e-9 * points, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

}  // namespace

BENCHMARK(exponential<Lanes>)->Name("kernel/exp/lanes");
BENCHMARK(exponential<double>)->Name("kernel/exp/scalar");
BENCHMARK(water_content<Lanes>)->Name("kernel/water_content/lanes");
BENCHMARK(water_content<double>)->Name("kernel/water_content/scalar");
BENCHMARK(relative_conductivity<Lanes>)->Name("kernel/conductivity/lanes");
BENCHMARK(relative_conductivity<double>)->Name("kernel/conductivity/scalar");
BENCHMARK(face_conductivity)->Name("kernel/face_conductivity/scalar");
BENCHMARK(drucker_prager<Lanes>)->Name("kernel/drucker_prager/lanes");
BENCHMARK(drucker_prager<double>)->Name("kernel/drucker_prager/scalar");
BENCHMARK(softening<Lanes>)->Name("kernel/drucker_prager_softening/lanes");
BENCHMARK(softening<double>)->Name("kernel/drucker_prager_softening/scalar");
BENCHMARK(sort_points)->Name("kernel/sort/3d");
BENCHMARK_MAIN();
