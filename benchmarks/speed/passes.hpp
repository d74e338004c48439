// SPDX-License-Identifier: MIT
#pragma once

// Where the time of a step goes: the explicit scheme with a clock between its passes.

#include <array>
#include <chrono>

#include <vadose/solver/solver.hpp>

namespace speed {

inline constexpr int pass_count = 9;
inline constexpr std::array<const char*, pass_count> pass_names{
    "pressures", "limits",   "faces",     "liquid_p2g", "solid_p2g",
    "nodes",     "exchange", "solid_g2p", "liquid_g2p"};

/// Seconds spent in each pass.
struct PassTimes {
  std::array<double, pass_count> seconds{};
};

/// The explicit scheme; adds up the time of its passes. One run at a time.
struct TimedExplicit {
  static constexpr const char* name = "explicit";
  static inline PassTimes times;

  template <class M>
  static vadose::kernel::StableStep step(vadose::State<M>& state, vadose::Real dt_limit) {
    using Clock = std::chrono::steady_clock;
    auto last = Clock::now();
    return vadose::scheme::Explicit::watched(state, dt_limit, [&](vadose::scheme::Pass pass) {
      const auto now = Clock::now();
      times.seconds[static_cast<std::size_t>(pass)] +=
          std::chrono::duration<double>(now - last).count();
      last = now;
    });
  }
};

}  // namespace speed
