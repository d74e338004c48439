// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// How a run goes on: trials on a copy of it, spell by spell.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include <vadose/solver/estimate.hpp>
#include <vadose/solver/report.hpp>
#include <vadose/solver/spells.hpp>

namespace vadose::detail {

/// Steps and wall time of a run. The first spell, and every one that brings more water, is tried on the
/// copy, whose clock is put to its start; the step goes on with the trend of the trial. Where the ground
/// is left without water its cells drain: what is wet below them limits the step then.
template <class S>
class Forecast {
 public:
  /// `has_floor`: no step is shorter than that of a scene that is wet throughout.
  Forecast(const S& run, Real t_end, Real trial_seconds, bool has_floor)
      : copy_(run), has_floor_(has_floor), patience_(trial_seconds) {
    const std::vector<Spell> spells = find_spells(run.state(), t_end);
    const auto trials =
        std::count_if(spells.begin(), spells.end(), [](const Spell& s) { return s.wetter; });
    for (const Spell& spell : spells) {
      if (spell.wetter) deadline_ += trial_seconds / static_cast<Real>(trials);
      go_through(spell);
    }
  }

  /// Puts what was found into an estimate.
  void report(Estimate& e) const {
    e.dt = dt_;
    e.limit = limit_;
    e.trend = power_;
    e.shortest_dt = floor_;
    e.steps = tried_steps_ + static_cast<std::int64_t>(std::ceil(rest_steps_ - 1e-9));
    e.seconds = tried_wall_ + rest_wall_;
  }

 private:
  using Clock = std::chrono::steady_clock;

  void go_through(const Spell& spell) {
    const bool arrived = copy_.time() >= spell.start;
    if (!failed_ && (spell.wetter || (arrived && now().wall < deadline_))) {
      if (spell.wetter && trend_.level > 0) origin_ = spell.start;
      if (!arrived) copy_.mutable_state().time = spell.start;
      try_out(spell.end);
    } else if (spell.drains && has_floor_) {
      let_drain(spell.start);
    }
    const Real from = std::max(spell.start, copy_.time());
    const Real steps = trend_.steps(from - origin_, spell.end - origin_, floor_);
    rest_steps_ += steps;
    rest_wall_ += steps * pace_;
  }

  /// Runs the copy to a time or to the deadline; on to three times as long where the step may yet become
  /// much shorter, no trend of it shows, and the run is long.
  void try_out(Real end) {
    std::vector<TrialMark> marks{now()};
    run_copy(end, marks);
    for (int more = 0; more < 2 && !failed_ && copy_.time() < end && is_open(end, marks); ++more) {
      deadline_ += patience_;
      run_copy(end, marks);
    }
    if (marks.size() > 1) learn(marks);
  }
  void run_copy(Real end, std::vector<TrialMark>& marks) {
    while (copy_.time() < end && (marks.size() < 5 || marks.back().wall < deadline_)) {
      const StepReport step = copy_.step(end);
      failed_ = step.status != Status::ok;
      if (failed_) break;
      if (!(dt_ > 0) && (copy_.time() < end || limit_ == StepLimit::none)) limit_ = step.limit;
      marks.push_back(now());
    }
  }
  bool is_open(Real end, const std::vector<TrialMark>& marks) const {
    if (!has_floor_) return false;
    const StepTrend trend = StepTrend::of(marks);
    const Real wall = (marks.back().wall - marks.front().wall) *
                      (end - origin_ - marks.front().time) /
                      (marks.back().time - marks.front().time);
    return trend.power == 0 && shortest_step(copy_.state()) < 0.8 * trend.level &&
           wall > 20 * patience_;
  }

  void learn(const std::vector<TrialMark>& marks) {
    const TrialMark &first = marks.front(), &last = marks.back(),
                    &middle = marks[(marks.size() - 1) / 2];
    const auto half = static_cast<Real>(last.step - middle.step);
    const Real dt = (last.time - middle.time) / half;
    trend_ = StepTrend::of(marks);
    const Real floor = has_floor_ ? std::min(shortest_step(copy_.state()), dt) : 0;
    if (!(floor > 0)) trend_ = {.level = dt};
    if (!(dt_ > 0)) {
      dt_ = dt;
      power_ = trend_.power;
    }
    floor_ = floor_ > 0 ? std::min(floor_, floor) : floor;
    pace_ = (last.wall - middle.wall) / half;
    tried_steps_ += last.step - first.step;
    tried_wall_ += last.wall - first.wall;
  }

  /// From now on the step is that of wet soil below dry ground, or the one before if that is longer.
  void let_drain(Real time) {
    kernel::StableStep others;
    kernel::take_common_limits(copy_.state(), others);
    const Real drained = std::min(shortest_step(copy_.state(), false), others.dt);
    trend_ = {.level = std::max(trend_.at(time - origin_, floor_), drained)};
  }

  TrialMark now() const {
    return {std::chrono::duration<Real>(Clock::now() - start_).count(), copy_.time() - origin_,
            copy_.steps()};
  }

  Clock::time_point start_ = Clock::now();  // before the copy is made
  S copy_;
  bool has_floor_;
  Real patience_ = 0;  // of all trials together, if nothing is left open [s]
  Real deadline_ = 0;  // of trials [s] of wall time
  Real origin_ = 0;    // when the water came that the trend is about [s]
  bool failed_ = false;
  StepTrend trend_;
  Real floor_ = 0;  // shortest step [s]; 0: not known
  Real pace_ = 0;   // wall time of a step [s]
  Real dt_ = 0, power_ = 0;
  StepLimit limit_ = StepLimit::none;
  std::int64_t tried_steps_ = 0;
  Real tried_wall_ = 0, rest_steps_ = 0, rest_wall_ = 0;
};

}  // namespace vadose::detail
