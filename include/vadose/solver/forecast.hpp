// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// How a run goes on: trials on a copy of it, spell by spell.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <vector>

#include <vadose/kernel/cells.hpp>
#include <vadose/solver/estimate.hpp>
#include <vadose/solver/report.hpp>
#include <vadose/solver/spells.hpp>

namespace vadose::detail {

/// Steps and wall time of a run. The first spell, and every one that brings more water, is tried on the
/// copy, whose clock is put to its start; the step goes on with the trend of the trial. Where the ground
/// is left without water its cells drain: what is wet below them limits the step then. Ground that slides
/// in the trial will be cut by the cells anywhere.
template <class S>
class Forecast {
 public:
  /// `has_floor`: no step is shorter than that of a scene that is wet throughout.
  Forecast(const S& run, Real t_end, Real trial_seconds, bool has_floor)
      : copy_(run), has_floor_(has_floor), patience_(trial_seconds) {
    is_wet_ = has_free_water();
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
    e.limit = static_cast<StepLimit>(std::max_element(limited_.begin(), limited_.end()) -
                                     limited_.begin());
    e.trend = power_;
    e.shortest_dt = floor_;
    e.steps = tried_steps_ + static_cast<std::int64_t>(std::ceil(rest_steps_ - 1e-9));
    e.seconds = tried_wall_ + rest_wall_;
    if (!has_floor_) return;
    e.most_steps = tried_steps_ + static_cast<std::int64_t>(std::ceil(rest_most_ - 1e-9));
    e.most_seconds = tried_wall_ + rest_most_ * pace_;
  }

 private:
  using Clock = std::chrono::steady_clock;

  void go_through(const Spell& spell) {
    for (const Real offer : spell.offer) is_wet_ = is_wet_ || offer > 0;
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
    if (spell.end > from) rest_most_ += std::max(steps, (spell.end - from) / shortest_in_reach());
    rest_wall_ += steps * pace_;
  }

  /// Runs the copy to a time or to the deadline; on to three times as long where the step may yet become
  /// much shorter, no trend of it shows, and the run is long.
  void try_out(Real end) {
    std::vector<TrialMark> marks{now()};
    const std::vector<Real> before = displacements();
    run_copy(end, marks);
    for (int more = 0; more < 2 && !failed_ && copy_.time() < end && is_open(end, marks); ++more) {
      deadline_ += patience_;
      run_copy(end, marks);
    }
    if (marks.size() < 2) return;
    learn(marks);
    const Real time = copy_.time() - origin_ - marks.front().time;
    if (trend_.power == 0 &&
        motion_since(before) * (end - copy_.time()) > time * copy_.state().grid.cell_size())
      trend_.level = std::min(trend_.level, slid_step(copy_.state()));
  }
  void run_copy(Real end, std::vector<TrialMark>& marks) {
    while (copy_.time() < end && (marks.size() < 5 || marks.back().wall < deadline_)) {
      const StepReport step = copy_.step(end);
      failed_ = step.status != Status::ok;
      if (failed_) break;
      if (!(dt_ > 0)) ++limited_[static_cast<std::size_t>(step.limit)];
      marks.push_back(now());
    }
  }
  bool is_open(Real end, const std::vector<TrialMark>& marks) const {
    if (!has_floor_ || !is_wet_) return false;
    const StepTrend trend = StepTrend::of(marks);
    const Real wall = (marks.back().wall - marks.front().wall) *
                      (end - origin_ - marks.front().time) /
                      (marks.back().time - marks.front().time);
    return trend.power == 0 && shortest_step(copy_.state()) < 0.8 * trend.level &&
           wall > 5 * patience_;
  }
  bool has_free_water() const { return kernel::has_free_water(copy_.state()); }

  /// Shortest step in reach [s]: of wet soil once water has come, of cells cut by ground that may slide.
  Real shortest_in_reach() const {
    if (!(last_dt_ > 0)) return 1e30;
    const auto& state = copy_.state();
    Real dt = last_dt_;
    if (can_slide(state)) dt = std::min(dt, slid_step(state));
    if (is_wet_ && floor_ > 0) {
      dt = std::min(dt, shortest_step(state));
      if (can_slide(state)) dt = std::min(dt, kernel::cut_cell_step * shortest_step(state, false));
    }
    return dt;
  }

  /// Displacements of all solid points by id, where the soil can slide [m].
  std::vector<Real> displacements() const {
    std::vector<Real> all;
    if (!can_slide(copy_.state())) return all;
    all.resize(copy_.memory().start.size());
    const auto& solid = copy_.state().solid;
    solid.for_each([&](std::size_t b, int l) {
      const auto id = static_cast<std::size_t>(solid.at(field::id, b)[l]);
      const auto u = copy_.displacement(b, l);
      for (int d = 0; d < S::dim; ++d) all[id * S::dim + static_cast<std::size_t>(d)] = u[d];
    });
    return all;
  }
  /// Largest displacement of a point since then, along one axis [m].
  Real motion_since(const std::vector<Real>& before) const {
    const std::vector<Real> now = displacements();
    Real most = 0;
    for (std::size_t i = 0; i < now.size(); ++i)
      most = std::max(most, std::fabs(now[i] - before[i]));
    return most;
  }

  void learn(const std::vector<TrialMark>& marks) {
    const TrialMark &first = marks.front(), &last = marks.back(),
                    &middle = marks[(marks.size() - 1) / 2];
    const auto half = static_cast<Real>(last.step - middle.step);
    const Real dt = (last.time - middle.time) / half;
    trend_ = StepTrend::of(marks);
    const Real floor = has_floor_ ? std::min(shortest_step(copy_.state()), dt) : 0;
    // Without water that comes the soil gets no wetter.
    if (!(floor > 0) || !is_wet_) trend_ = {.level = dt};
    if (!(dt_ > 0)) {
      dt_ = dt;
      power_ = trend_.power;
    }
    floor_ = floor_ > 0 ? std::min(floor_, floor) : floor;
    last_dt_ = dt;
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
  Real last_dt_ = 0;     // mean step at the end of the last trial [s]
  bool is_wet_ = false;  // water is on the ground or has come
  /// Steps of the first trial by what limited them. (The last one alone may be any that the wall time of a
  /// trial ends with.)
  std::array<std::int64_t, static_cast<std::size_t>(last_step_limit) + 1> limited_{};
  std::int64_t tried_steps_ = 0;
  Real tried_wall_ = 0, rest_steps_ = 0, rest_wall_ = 0, rest_most_ = 0;
};

}  // namespace vadose::detail
