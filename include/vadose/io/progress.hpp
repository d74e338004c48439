// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// A line about the progress of a run now and then; nothing is printed without such an object.

#include <chrono>
#include <cstdint>
#include <cstdio>

#include <vadose/core/error.hpp>
#include <vadose/core/real.hpp>

namespace vadose::io {

/// Prints "t = 1.5 s of 10 s (15.0 %), 812 steps/s, 0:01:10 left" at most every `interval` seconds
/// of wall time.
class Progress {
 public:
  /// Run from `start_time` to `end_time` [s of simulated time].
  explicit Progress(Real end_time, Real interval = 5, std::FILE* stream = stderr,
                    Real start_time = 0)
      : begin_(start_time), end_(end_time), interval_(interval), stream_(stream) {
    check::finite("start_time", start_time, "s");
    if (!is_finite(end_time) || !(end_time > start_time))
      check::fail("end_time", end_time, check::joined({"(", check::text(start_time), ", inf)"}),
                  "s");
    check::non_negative("interval", interval, "s");
    if (!stream) throw SetupError("stream = (missing), allowed: an open FILE* [-]");
  }

  /// To be called every step or every few: simulated time [s] and number of steps so far. Returns
  /// whether a line was printed.
  bool update(Real time, std::uint64_t steps) { return update(time, steps, elapsed()); }

  /// The same with the wall time [s] since construction given by the caller.
  bool update(Real time, std::uint64_t steps, Real wall) {
    if (wall < last_wall_ + interval_) return false;
    print(time, steps, wall);
    last_wall_ = wall;
    last_steps_ = steps;
    return true;
  }

 private:
  using Clock = std::chrono::steady_clock;

  Real elapsed() const { return std::chrono::duration<Real>(Clock::now() - created_).count(); }

  /// Speed of the steps since the last line; time left from the mean over the whole run.
  void print(Real time, std::uint64_t steps, Real wall) const {
    const Real done = (time - begin_) / (end_ - begin_);
    const Real span = wall - last_wall_;
    const Real speed = span > 0 ? static_cast<Real>(steps - last_steps_) / span : 0;
    std::fprintf(stream_, "t = %.6g s of %.6g s (%.1f %%), %.4g steps/s, ", time, end_, 100 * done,
                 speed);
    const Real left = done > 0 ? wall * (1 - done) / done : -1;
    if (left >= 0 && left < 3.6e8) {
      const auto seconds = static_cast<long>(left + 0.5);
      std::fprintf(stream_, "%ld:%02ld:%02ld left\n", seconds / 3600, seconds / 60 % 60,
                   seconds % 60);
    } else {
      std::fprintf(stream_, "time left unknown\n");
    }
    std::fflush(stream_);
  }

  Real begin_, end_, interval_;
  std::FILE* stream_;
  Clock::time_point created_ = Clock::now();
  Real last_wall_ = 0;
  std::uint64_t last_steps_ = 0;
};

}  // namespace vadose::io
