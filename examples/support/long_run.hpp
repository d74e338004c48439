// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The loop of a long run: states and histories at even times, a checkpoint with every state, and
/// going on from it.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

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

/// Runs to the end. record() is called at every time of the histories, print() with every frame.
template <class S, class Record>
void drive(S& solver, const LongRun& o, std::initializer_list<std::string> fields,
           Record&& record) {
  vadose::io::print_preflight(stdout, solver, o.end_time);
  std::fflush(stdout);
  vadose::io::VtkSeries vtk{o.path(""), fields};
  if (o.resume) vtk.resume(solver.time());
  vadose::io::WaterBalanceHistory balance{o.history("_balance")};
  vadose::io::Progress progress{o.end_time, 5, stderr, solver.time()};
  const vadose::io::RunClock clock{solver};
  const Real begin = solver.time();
  for (int i = 0; i <= o.frames * o.records; ++i) {
    const Real t = o.end_time * i / (o.frames * o.records);
    if (t < begin) continue;
    vadose::io::advance(solver, t, progress);
    record();
    balance.record(solver);
    if (i % o.records != 0) continue;
    vtk.write(solver);
    if (t > begin) vadose::io::save_checkpoint(o.checkpoint(), solver);
  }
  vadose::io::print_summary(stdout, solver, clock);
  std::fflush(stdout);
}

/// What has moved.
struct Slide {
  Real largest = 0;  ///< displacement behind which all but 1 in 1000 points stay [m]
  Real volume = 0;   ///< of the soil at its start that moved a fifth of that and `least` [m3, m2]
  Real front = 0;    ///< largest first coordinate of it [m]
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

}  // namespace example
