// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Flags of the long examples: numbers, words and switches, with messages that name the flag.

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include <vadose/core/error.hpp>
#include <vadose/kernel/state.hpp>
#include <vadose/policy/law/drucker_prager.hpp>

namespace example {

using vadose::Real;

/// How a long run steps through time.
enum class Scheme { explicit_steps, semi_implicit };

/// What the long examples let their users choose alike; each has defaults of its own.
struct RunChoices {
  Scheme scheme = Scheme::semi_implicit;
  bool quasi_static = true;  ///< slow periods in long steps; semi-implicit runs only
  Real inertia = 1e-4;       ///< see vadose::QuasiStatic [-]
  vadose::SlowSkeleton slow_skeleton = vadose::SlowSkeleton::implicit;
  Real saturation_step = 0.002;  ///< change of S that a semi-implicit step aims at [-]
  bool resume = false;           ///< go on from a checkpoint
  bool check = false;            ///< a reduced run, compared with bounds
  Real end_time = 1;             ///< [s]
  Real bulk_modulus = 2.2e9;     ///< of the water [Pa]
  Real courant = 0.5;            ///< [-]
  Real damping = 0.05;           ///< local, of the skeleton [-]
  Real pic_rate = 1;             ///< relaxation of point velocities to the grid's [1/s]
  int frames = 10;               ///< states written after the first
  int threads = 1;               ///< more pay only where every one has a processor to itself
  vadose::law::Cone cone = vadose::law::Cone::plane_strain_matched;
  std::string output = ".";  ///< folder of the results
};

/// Flags by name, each with a word for its value and a line for --help, which shows its default too.
/// read() raises SetupError on an unknown flag or a value that does not fit.
class Flags {
 public:
  /// `about`: the program in a line.
  explicit Flags(std::string about) : usage_(std::move(about) + '\n') {}

  Flags& number(const std::string& flag, const char* word, Real& value, const std::string& text) {
    return add(flag, word, text, vadose::is_finite(value) ? shown(value) : "",
               [&value, flag](const std::string& given) { value = parse(flag, given); });
  }
  /// A whole number in [1, limit].
  Flags& whole(const std::string& flag, int& value, int limit, const std::string& text) {
    return add(flag, "N", text, std::to_string(value), [&value, flag, limit](const std::string& s) {
      const Real given = parse(flag, s);
      if (!(given >= 1 && given <= limit && given == std::floor(given)))
        throw vadose::SetupError(flag + " needs a whole number from 1 to " + std::to_string(limit));
      value = static_cast<int>(given);
    });
  }
  Flags& word(const std::string& flag, const char* word, std::string& value,
              const std::string& text) {
    return add(flag, word, text, value, [&value](const std::string& given) { value = given; });
  }
  /// One of some words.
  template <class T>
  Flags& choice(const std::string& flag, T& value, const std::map<std::string, T>& words) {
    std::string allowed, now;
    for (const auto& [name, meaning] : words) {
      allowed += (allowed.empty() ? "" : ", ") + name;
      if (meaning == value) now = name;
    }
    return add(flag, "WORD", allowed, now, [&value, flag, words, allowed](const std::string& text) {
      const auto found = words.find(text);
      if (found == words.end())
        throw vadose::SetupError(flag + " needs one of " + allowed + ", not '" + text + "'");
      value = found->second;
    });
  }
  Flags& on(const std::string& flag, bool& value, const std::string& text) {
    return add(flag, "", text, "", [&value](const std::string&) { value = true; });
  }
  /// A flag that sets several values at once.
  Flags& preset(const std::string& flag, std::function<void()> set, const std::string& text) {
    return add(flag, "", text, "", [set = std::move(set)](const std::string&) { set(); });
  }
  /// Those of all long examples.
  Flags& common(RunChoices& c) {
    using vadose::law::Cone;
    return number("--bulk-modulus", "K", c.bulk_modulus, "of the water in Pa; water has 2.2e9")
        .number("--end-time", "T", c.end_time, "s of model time")
        .choice<Cone>("--cone", c.cone,
                      {{"outer", Cone::outer},
                       {"inner", Cone::inner},
                       {"plane-strain", Cone::plane_strain_matched},
                       {"inscribed", Cone::inscribed}})
        .number("--damping", "A", c.damping, "local damping of the skeleton, in [0, 1)")
        .number("--courant", "C", c.courant, "part of the stable step")
        .number("--pic-rate", "R", c.pic_rate, "relaxation of velocities to the grid's in 1/s")
        .whole("--frames", c.frames, 10000, "states written as VTK files")
        .whole("--threads", c.threads, 1024, "needs OpenMP and as many idle processors")
        .word("--output", "DIR", c.output, "folder for the results");
  }

  /// Those of the long examples that choose how they step and can go on from a checkpoint.
  Flags& stepping(RunChoices& c) {
    return choice<Scheme>(
               "--scheme", c.scheme,
               {{"explicit", Scheme::explicit_steps}, {"semi-implicit", Scheme::semi_implicit}})
        .quasi_static(c)
        .choice<bool>("--quasi-static", c.quasi_static, {{"on", true}, {"off", false}})
        .resume(c);
  }
  /// Those of runs that are always semi-implicit and quasi-static.
  Flags& quasi_static(RunChoices& c) {
    using vadose::SlowSkeleton;
    return number("--inertia", "I", c.inertia,
                  "forces out of balance over weights and loads that slow steps aim at")
        .choice<SlowSkeleton>(
            "--slow-skeleton", c.slow_skeleton,
            {{"implicit", SlowSkeleton::implicit}, {"heavy", SlowSkeleton::heavy}})
        .number("--saturation-step", "D", c.saturation_step,
                "change of S that a semi-implicit step aims at");
  }
  Flags& resume(RunChoices& c) {
    return on("--resume", c.resume, "go on from the checkpoint in the output folder");
  }

  Flags& check(RunChoices& c) {
    return on("--check", c.check, "a reduced run of seconds, compared with bounds");
  }

  /// Reads the command line; --help prints the usage and ends the program.
  void read(int count, char** words) const {
    for (int i = 1; i < count; ++i) {
      const std::string flag = words[i];
      if (flag == "--help") {
        std::fputs((usage_ + line("--help", "this text")).c_str(), stdout);
        std::exit(0);
      }
      const auto found = known_.find(flag);
      if (found == known_.end())
        throw vadose::SetupError("unknown flag '" + flag + "'; --help lists them");
      if (found->second.takes_value && ++i == count)
        throw vadose::SetupError(flag + " needs a value");
      found->second.set(words[i]);
    }
  }

 private:
  struct Flag {
    bool takes_value;
    std::function<void(const std::string&)> set;
  };

  Flags& add(const std::string& flag, const std::string& word, const std::string& text,
             const std::string& now, std::function<void(const std::string&)> set) {
    usage_ +=
        line(word.empty() ? flag : flag + ' ' + word, now.empty() ? text : text + " (" + now + ')');
    known_[flag] = {!word.empty(), std::move(set)};
    return *this;
  }
  static std::string line(const std::string& flag, const std::string& text) {
    const std::size_t gap = flag.size() < 20 ? 21 - flag.size() : 1;
    return "  " + flag + std::string(gap, ' ') + text + '\n';
  }
  static std::string shown(Real value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
  }
  static Real parse(const std::string& flag, const std::string& text) {
    char* end = nullptr;
    const Real value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !vadose::is_finite(value))
      throw vadose::SetupError(flag + " needs a number, not '" + text + "'");
    return value;
  }

  std::string usage_;
  std::map<std::string, Flag> known_;
};

/// Prints a number and its bounds; 0 if it is within them, else 1.
inline int expect(const char* what, Real value, Real low, Real high) {
  const bool good = value >= low && value <= high;
  std::printf("%s: %.4g, allowed [%g, %g]%s\n", what, value, low, high, good ? "" : ": FAILED");
  return good ? 0 : 1;
}

/// Runs f(), the body of main, and prints what it throws. Returns 2 where the set-up is wrong, 1
/// where the run failed (the files hold the states before that), else what f returned.
template <class F>
int guarded(const char* program, F&& f) {
  try {
    return f();
  } catch (const vadose::SetupError& e) {
    std::fprintf(stderr, "%s: %s\n", program, e.what());
    return 2;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: %s\n", program, e.what());
    return 1;
  }
}

}  // namespace example
