// SPDX-License-Identifier: MIT
#pragma once

// What the machine can do, measured in the same run as the kernels: memory bandwidth by a triad, rate
// of multiply-adds; and counts of instructions and cycles where the system gives them.

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#ifdef __linux__
#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

#include <vadose/core/aligned.hpp>
#include <vadose/core/lanes.hpp>
#include <vadose/core/parallel.hpp>

namespace speed {

inline double seconds_now() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

/// Median of some numbers.
inline double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  const std::size_t n = v.size();
  return n == 0 ? 0 : 0.5 * (v[(n - 1) / 2] + v[n / 2]);
}

/// Bytes per second of a[i] = b[i] + s c[i] far beyond the caches, 24 bytes counted per element.
inline double triad_bandwidth(int threads) {
  using vadose::Lanes;
  constexpr std::size_t size = std::size_t{1} << 23, chunk = 1 << 14;
  vadose::AlignedVector<double> a(size, 0), b(size, 1), c(size, 2);
  std::vector<double> rates;
  for (int repeat = 0; repeat < 9; ++repeat) {
    const double start = seconds_now();
    vadose::parallel_for(size / chunk, threads, [&](std::size_t k, int) {
      const Lanes factor(1.5);
      for (std::size_t i = k * chunk; i < (k + 1) * chunk; i += vadose::lane_count)
        (Lanes::load(&b[i]) + factor * Lanes::load(&c[i])).store(&a[i]);
    });
    rates.push_back(24.0 * static_cast<double>(size) / (seconds_now() - start));
    b[0] = a[size - 1];  // keeps the loop
  }
  return median(rates);
}

/// Floating-point operations per second of independent multiply-adds on Lanes.
inline double fma_rate(int threads) {
  using vadose::Lanes;
  constexpr int chains = 12, loops = 200000;
  std::vector<double> rates, sink(static_cast<std::size_t>(threads));
  for (int repeat = 0; repeat < 9; ++repeat) {
    const double start = seconds_now();
    vadose::parallel_for(static_cast<std::size_t>(threads), threads, [&](std::size_t t, int) {
      Lanes x[chains];
      for (int i = 0; i < chains; ++i) x[i] = Lanes(1.0 + i);
      const Lanes factor(0.999), term(1e-3);
      for (int k = 0; k < loops; ++k)
        for (auto& v : x) v = v * factor + term;
      for (const auto& v : x) sink[t] += sum(v);
    });
    rates.push_back(2.0 * chains * vadose::lane_count * loops * threads / (seconds_now() - start));
  }
  return median(rates) + (sink[0] == 0.123 ? 1 : 0);  // keeps the loop
}

/// The limits of the machine for a number of threads, measured once.
struct Machine {
  double bandwidth = 0;  ///< [B/s]
  double fma = 0;        ///< [flop/s]

  static const Machine& get(int threads) {
    static std::vector<Machine> known(65);
    Machine& m = known[static_cast<std::size_t>(std::clamp(threads, 1, 64))];
    if (m.fma == 0) m = {triad_bandwidth(threads), fma_rate(threads)};
    return m;
  }
};

/// Counts a hardware event of this thread; zero where the system does not let us.
class Event {
 public:
  enum Kind { instructions, cycles };

#ifdef __linux__
  explicit Event(Kind kind) {
    perf_event_attr attr;
    std::memset(&attr, 0, sizeof attr);
    attr.size = sizeof attr;
    attr.type = PERF_TYPE_HARDWARE;
    attr.config = kind == instructions ? PERF_COUNT_HW_INSTRUCTIONS : PERF_COUNT_HW_CPU_CYCLES;
    attr.exclude_kernel = 1;
    attr.exclude_hv = 1;
    file_ = static_cast<int>(syscall(SYS_perf_event_open, &attr, 0, -1, -1, 0));
  }
  ~Event() {
    if (file_ >= 0) close(file_);
  }
  double read() const {
    std::uint64_t value = 0;
    if (file_ < 0 || ::read(file_, &value, sizeof value) != sizeof value) return 0;
    return static_cast<double>(value);
  }
#else
  explicit Event(Kind) {}
  double read() const {
    return 0;
  }
#endif
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;

 private:
  [[maybe_unused]] int file_ = -1;
};

}  // namespace speed
