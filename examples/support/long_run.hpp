// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The loop of a long run: states and histories at even times, a checkpoint with every state, and
/// going on from it.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <vector>

#include <sys/resource.h>
#include <examples/support/flags.hpp>
#include <vadose/vadose.hpp>

namespace example {

using vadose::Real;

/// What a long run writes, and where.
struct LongRun {
  std::string folder;       ///< of the results
  std::string base;         ///< first part of every file's name
  Real end_time = 1;        ///< [s]
  int frames = 10;          ///< states after the first, each with a checkpoint
  int records = 10;         ///< rows of the histories per frame
  bool resume = false;      ///< go on from the checkpoint in the folder
  std::string suffix = {};  ///< of the histories: they start anew where a run goes on

  std::string path(const std::string& name) const { return folder + "/" + base + name; }
  std::string history(const std::string& name) const { return path(name + suffix + ".csv"); }
  std::string checkpoint() const { return path(".vdck"); }
};

/// Files and times of a run with the given choices; `base` begins every file's name.
inline LongRun long_run(const RunChoices& c, const std::string& base) {
  vadose::check::positive("--end-time", c.end_time, "s");
  std::filesystem::create_directories(c.output);
  return {.folder = c.output,
          .base = base,
          .end_time = c.end_time,
          .frames = c.frames,
          .resume = c.resume};
}

/// Options of a solver of model M with scheme S.
template <class M, class S>
vadose::SolverOptions<M> solver_options(const RunChoices& c) {
  constexpr bool implicit = std::is_same_v<S, vadose::scheme::SemiImplicit>;
  return {.courant = c.courant,
          .damping = c.damping,
          .transfer = {.pic_rate = c.pic_rate},
          .threads = c.threads,
          .saturation_step = c.saturation_step,
          .quasi_static = {
              .on = implicit && c.quasi_static, .skeleton = c.slow_skeleton, .inertia = c.inertia}};
}

/// Largest number that the law keeps on a solid point, e.g. its plastic shear strain.
template <class S>
Real largest_law_state(const S& solver) {
  Real largest = 0;
  const auto& solid = solver.solid();
  solid.for_each([&](std::size_t b, int l) {
    largest = std::max<Real>(largest, solid.at(vadose::field::law_state, b)[l]);
  });
  return largest;
}

/// Brings the skeleton to rest, unless the run goes on from a checkpoint, and says so.
template <class S>
void bring_to_rest(S& solver, const LongRun& o, const vadose::EquilibriumOptions& options) {
  if (o.resume) return;
  const auto report = solver.equilibrate(options);
  std::printf(
      "before the rain: out of balance %.1e of the weight, largest plastic shear strain %.2g%s\n",
      report.residual, largest_law_state(solver), report.converged ? "" : "; NOT at rest");
}

/// Takes up the checkpoint where that is wanted; call it after all conditions have been added.
template <class S>
void take_up(S& solver, LongRun& o) {
  if (!o.resume) return;
  vadose::io::load_checkpoint(o.checkpoint(), solver);
  char text[40];
  std::snprintf(text, sizeof text, "_from_%.4gs", solver.time());
  o.suffix = text;
  std::printf("taken up at t = %g s\n", solver.time());
}

/// What the steps of a run were like.
class StepCourse {
 public:
  void record(const vadose::StepReport& step) {
    ++steps_;
    longest_ = std::max(longest_, step.dt);
    // Steps cut short by a time of the output are not the scheme's own.
    if (step.limit != vadose::StepLimit::end) shortest_ = std::min(shortest_, step.dt);
    newton_ += step.solve.newton;
    linear_ += step.solve.linear;
    retries_ += step.solve.retries;
    if (!step.solve.skeleton && !(step.solve.inertia > 1)) return;
    ++slow_steps_;
    slow_time_ += step.dt;
  }
  /// Range of the steps, those with inertia added, and the largest memory of the program so far.
  void print(std::FILE* out) const {
    std::fprintf(out, "  steps    of %.2g to %.2g s", std::min(shortest_, longest_), longest_);
    if (slow_steps_ > 0)
      std::fprintf(out, "; %lld of %lld quasi-static, %.4g s together",
                   static_cast<long long>(slow_steps_), static_cast<long long>(steps_), slow_time_);
    if (newton_ > 0)
      std::fprintf(
          out, "\n  solver   %.3g Newton and %.3g linear iterations per step, %lld retries",
          static_cast<Real>(newton_) / static_cast<Real>(steps_),
          static_cast<Real>(linear_) / static_cast<Real>(steps_), static_cast<long long>(retries_));
    rusage usage = {};
    getrusage(RUSAGE_SELF, &usage);
    std::fprintf(out, "\n  memory   %.0f MB at most\n", static_cast<Real>(usage.ru_maxrss) / 1024);
  }

 private:
  std::int64_t steps_ = 0, slow_steps_ = 0, newton_ = 0, linear_ = 0, retries_ = 0;
  Real longest_ = 0, shortest_ = 1e30, slow_time_ = 0;
};

/// Runs to the end. record() is called at every time of the histories, every(report) after every step.
template <class S, class Record, class Every = std::nullptr_t>
void drive(S& solver, const LongRun& o, std::initializer_list<std::string> fields, Record&& record,
           [[maybe_unused]] Every&& every = nullptr) {
  vadose::io::print_preflight(stdout, solver, o.end_time);
  std::fflush(stdout);
  vadose::io::VtkSeries vtk{o.path(""), fields};
  if (o.resume) vtk.resume(solver.time());
  vadose::io::WaterBalanceHistory balance{o.history("_balance")};
  vadose::io::Progress progress{o.end_time, 5, stderr, solver.time()};
  const vadose::io::RunClock clock{solver};
  const Real begin = solver.time();
  StepCourse course;
  for (int i = 0; i <= o.frames * o.records; ++i) {
    const Real t = o.end_time * i / (o.frames * o.records);
    if (t < begin) continue;
    solver.advance_to(t, [&](const vadose::StepReport& step) {
      course.record(step);
      progress.update(step.time, static_cast<std::uint64_t>(step.step));
      if constexpr (std::is_invocable_v<Every, const vadose::StepReport&>) every(step);
    });
    record();
    balance.record(solver);
    const bool taken_up = o.resume && !(t > begin);  // the series has this state
    if (i % o.records != 0 || taken_up) continue;
    vtk.write(solver);
    if (t > begin) vadose::io::save_checkpoint(o.checkpoint(), solver);
  }
  vadose::io::print_summary(stdout, solver, clock);
  course.print(stdout);
  std::fflush(stdout);
}

/// What has moved.
struct Slide {
  Real largest = 0;  ///< displacement behind which all but 1 in 1000 points stay [m]
  Real volume = 0;   ///< of the soil at its start that moved a fifth of that and `least` [m3, m2]
  Real front = 0;    ///< largest first coordinate of it [m]
};

/// What a run came to.
struct Outcome {
  Slide slide;
  vadose::WaterBalance water;
};

/// The slide, for soil of one material. Less than `least` [m] is no slide.
template <class S>
Slide measure_slide(const S& solver, Real solid_density, Real porosity, Real least) {
  const auto& solid = solver.solid();
  std::vector<Real> moved;
  moved.reserve(solid.size());
  solid.for_each([&](std::size_t b, int l) { moved.push_back(solver.displacement(b, l).norm()); });
  std::vector<Real> sorted = moved;
  std::sort(sorted.begin(), sorted.end());
  Slide s;
  s.largest = sorted[sorted.size() - 1 - sorted.size() / 1000];
  std::size_t i = 0;
  solid.for_each([&](std::size_t b, int l) {
    if (moved[i++] < std::max(0.2 * s.largest, least)) return;
    s.volume += solid.at(vadose::field::mass, b)[l] / (solid_density * (1 - porosity));
    s.front = std::max<Real>(s.front, solid.at(vadose::field::position, b, 0)[l]);
  });
  return s;
}

/// When the largest displacement first passed some values.
class Passages {
 public:
  explicit Passages(std::vector<Real> levels) : levels_(std::move(levels)) {
    times_.assign(levels_.size(), -1);
  }
  void record(Real time, Real displacement) {
    for (std::size_t i = 0; i < levels_.size(); ++i)
      if (times_[i] < 0 && displacement >= levels_[i]) times_[i] = time;
  }
  void print(std::FILE* out) const {
    for (std::size_t i = 0; i < levels_.size(); ++i)
      if (times_[i] >= 0)
        std::fprintf(out, "  moved    %g mm after %.4g s\n", 1e3 * levels_[i], times_[i]);
      else
        std::fprintf(out, "  moved    less than %g mm\n", 1e3 * levels_[i]);
  }

 private:
  std::vector<Real> levels_, times_;
};

}  // namespace example
