// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Loops over independent tasks. Threads exist only if the host compiles and links OpenMP; the
/// result of a loop never depends on their number.

#include <cstddef>

#ifdef _OPENMP
#include <omp.h>
#endif
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace vadose {

/// Flushes subnormal numbers to zero in the calling thread while it lives: damped regions
/// otherwise cost up to half again as much.
class FlushSubnormals {
 public:
#if defined(__SSE2__)
  FlushSubnormals() noexcept : saved_(_mm_getcsr()) {
    _mm_setcsr(saved_ | 0x8040u);
  }
  ~FlushSubnormals() {
    _mm_setcsr(saved_);
  }
#else
  FlushSubnormals() noexcept = default;
  ~FlushSubnormals() = default;
#endif
  FlushSubnormals(const FlushSubnormals&) = delete;
  FlushSubnormals& operator=(const FlushSubnormals&) = delete;

 private:
#if defined(__SSE2__)
  unsigned saved_;
#endif
};

/// Threads a loop can use: the host's OpenMP maximum, or 1.
inline int available_threads() noexcept {
#ifdef _OPENMP
  return omp_get_max_threads();
#else
  return 1;
#endif
}

// One copy of every task: in two, one for each of the loops below, the compiler may fuse multiplications and
// additions differently, and the bits of a run would depend on the number of threads.
#if defined(__GNUC__) && !defined(__clang__)
#define VADOSE_ONE_COPY [[gnu::noinline, gnu::noclone]]
#elif defined(__clang__)
#define VADOSE_ONE_COPY [[gnu::noinline]]
#else
#define VADOSE_ONE_COPY
#endif

/// Runs one task of parallel_for().
template <class F>
VADOSE_ONE_COPY void run_task(F& f, std::size_t task, int thread) {
  f(task, thread);
}

/// Calls f(task, thread) for task = 0 .. count - 1; tasks must not touch each other's data.
template <class F>
void parallel_for(std::size_t count, [[maybe_unused]] int threads, F&& f) {
#ifdef _OPENMP
  if (threads > 1 && count > 1) {
    // Threads take several tasks at once while many are left: each taking costs as much as a short task.
    const int chunk = static_cast<int>(count / (16 * static_cast<std::size_t>(threads))) + 1;
#pragma omp parallel num_threads(threads)
    {
      const FlushSubnormals flush;
      const int thread = omp_get_thread_num();
#pragma omp for schedule(dynamic, chunk)
      for (std::size_t task = 0; task < count; ++task) run_task(f, task, thread);
    }
    return;
  }
#endif
  const FlushSubnormals flush;
  for (std::size_t task = 0; task < count; ++task) run_task(f, task, 0);
}

#undef VADOSE_ONE_COPY

}  // namespace vadose
