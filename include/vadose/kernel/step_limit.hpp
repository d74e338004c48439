// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Reasons for the length of a step.

#include <cstdint>

namespace vadose {

/// What limits a time step.
enum class StepLimit : std::uint8_t {
  none,       ///< nothing yet
  two_phase,  ///< compression wave of soil and pore water
  skeleton,   ///< compression wave of dry soil
  water,      ///< sound in free water
  motion,     ///< points may not cross more than a part of a cell
  drag,       ///< drag where a scheme takes it explicitly
  user,       ///< the largest step asked for
  accuracy,   ///< change of saturation in a step (semi-implicit)
  gravity,    ///< waves on free water (semi-implicit)
  retry,      ///< a larger step found no pressures (semi-implicit)
  drainage,   ///< flow of the water that holds a column (semi-implicit)
  inertia,    ///< part of inertia in the balance of forces (semi-implicit, quasi-static)
  end,        ///< the time that the host steps to
  closing,    ///< air-filled pores of a cell that will soon be full
};

/// The last of them.
inline constexpr StepLimit last_step_limit = StepLimit::closing;

/// Name of a limit for reports.
constexpr const char* name(StepLimit limit) noexcept {
  constexpr const char* names[] = {"none",         "two-phase wave", "skeleton wave", "water",
                                   "motion",       "drag",           "user",          "accuracy",
                                   "gravity wave", "retry",          "drainage",      "inertia",
                                   "end time",     "closing pores"};
  return names[static_cast<int>(limit)];
}

}  // namespace vadose
