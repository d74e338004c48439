// SPDX-License-Identifier: MIT
#pragma once

// Runs cases of tests/verify as benchmarks: errors are counters beside the time, and both norms and
// values go to files that benchmarks/report.py draws.

#include <benchmark/benchmark.h>

#include <cstring>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/verify/case.hpp"

namespace report {

using verify::Outcome;
using verify::Real;
using verify::Resolution;
using verify::Variant;

/// A list of types.
template <class... V>
struct List {};

/// The default with another scheme.
template <class Scheme>
using WithScheme = Variant<vadose::shape::Gimp, vadose::transfer::Flip, Scheme>;

/// The printed equations, with some of their flaws mended: named by what is mended.
template <vadose::PaperMends Mends = vadose::PaperMends{}>
struct Printed : WithScheme<vadose::scheme::PaperLiteral<Mends>> {
  static std::string name() {
    std::string mended;
    const auto add = [&](bool is, const char* what) {
      if (is) mended += std::string("+") + what;
    };
    add(Mends.implicit_drag, "implicit_drag");
    add(Mends.cell_average, "cell_average");
    add(Mends.saturation, "S");
    add(Mends.porosity_slope, "S_n");
    return "gimp flip printed" + mended;
  }
};

/// Choices that differ from the default in one thing.
using OneByOne =
    List<Variant<>, Variant<vadose::shape::Linear>, Variant<vadose::shape::QuadraticBSpline>,
         Variant<vadose::shape::Gimp, vadose::transfer::Apic>,
         Variant<vadose::shape::Gimp, vadose::transfer::Tpic>>;

/// Registers runs and writes what they gave: <folder>/<program>_norms.csv, one row per quantity
/// and time, and <folder>/<program>_values.csv, one row per value.
class Report {
 public:
  /// --out=FOLDER (default: here) and --short; both are taken out of the arguments.
  Report(const std::string& program, int& count, char** arguments) {
    std::string folder = ".";
    int kept = 1;
    for (int i = 1; i < count; ++i) {
      if (std::strncmp(arguments[i], "--out=", 6) == 0)
        folder = arguments[i] + 6;
      else if (std::strcmp(arguments[i], "--short") == 0)
        short_ = true;
      else
        arguments[kept++] = arguments[i];
    }
    count = kept;
    norms_.open(folder + '/' + program + "_norms.csv");
    values_.open(folder + '/' + program + "_values.csv");
    norms_ << "case,variant,cells,courant,points,steps,seconds,closure,failed,"
              "quantity,time,rms,max,bound\n";
    values_ << "case,variant,cells,quantity,time,place,computed,reference\n";
  }

  /// Fewer and coarser runs are asked for.
  bool is_short() const { return short_; }

  /// Registers a case under a label at every resolution, for each of the variants.
  template <class... V, class Case>
  void add(List<V...>, const std::string& label, const Case& problem,
           const std::vector<Resolution>& resolutions) {
    (add_variant<V>(label, problem, resolutions), ...);
  }

  /// Runs everything.
  int run(int count, char** arguments) {
    benchmark::Initialize(&count, arguments);
    if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return norms_.flush() && values_.flush() ? 0 : 1;
  }

 private:
  template <class V, class Case>
  void add_variant(const std::string& label, const Case& problem,
                   const std::vector<Resolution>& resolutions) {
    for (const Resolution& r : resolutions) {
      const std::string name = label + '/' + V::name() + '/' + std::to_string(r.cells);
      benchmark::RegisterBenchmark(name.c_str(),
                                   [=, this](benchmark::State& state) {
                                     Outcome outcome;
                                     for (auto _ : state) {
                                       outcome = verify::run<V>(problem, r);
                                       state.SetIterationTime(outcome.seconds);
                                     }
                                     write(state, label, problem, outcome);
                                   })
          ->Iterations(1)
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
  }

  template <class Case>
  void write(benchmark::State& state, const std::string& label, const Case& problem,
             const Outcome& outcome) {
    if (!outcome.failure.empty()) state.SkipWithError(outcome.failure.c_str());
    state.counters["steps"] = static_cast<Real>(outcome.steps);
    state.counters["point_steps_per_s"] = outcome.point_steps() / outcome.seconds;
    const std::string run =
        label + ',' + outcome.variant + ',' + std::to_string(outcome.resolution.cells) + ',';
    for (const verify::Comparison& c : outcome.comparisons) {
      const verify::Norm norm = c.norm();
      state.counters["rms " + c.quantity + " at " + vadose::check::text(c.time)] = norm.rms();
      norms_ << run << outcome.resolution.courant << ',' << outcome.points << ',' << outcome.steps
             << ',' << outcome.seconds << ',' << outcome.closure << ',' << !outcome.failure.empty()
             << ',' << c.quantity << ',' << c.time << ',' << norm.rms() << ',' << norm.max << ','
             << problem.bound(c, outcome.resolution) << '\n';
      for (const auto& v : c.values)
        values_ << run << c.quantity << ',' << c.time << ',' << v.place << ',' << v.computed << ','
                << v.reference << '\n';
    }
    if (outcome.comparisons.empty())
      norms_ << run << outcome.resolution.courant << ',' << outcome.points << ',' << outcome.steps
             << ',' << outcome.seconds << ',' << outcome.closure << ",1,none,0,nan,nan,nan\n";
    norms_.flush();
    values_.flush();
  }

  bool short_ = false;
  std::ofstream norms_, values_;
};

}  // namespace report
