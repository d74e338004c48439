// SPDX-License-Identifier: MIT
#pragma once

// A boundary condition: the sea at a wall, with tides.
//
// Kinds of conditions are the library's; what one's own code decides is where, when and how much: each
// takes functions of time, pressures of place too, and `active` switches it. They are called once per
// step, or per face, so they may ask whatever the host knows. (What has no kind yet, such as
// evaporation, a host does between steps, see 08_host_coupling.cpp.)

#include <cmath>
#include <numbers>

#include <vadose/scene/boundary.hpp>

/// Water at a face whose level swings about `mean` by `range` / 2 in `period`.
inline vadose::bc::Reservoir tide(vadose::Face face, vadose::Real mean, vadose::Real range,
                                  vadose::Real period) {
  return {.face = face, .function = [=](vadose::Real t) {
            return mean + 0.5 * range * std::sin(2 * std::numbers::pi * t / period);
          }};
}
