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
#include <vadose/policy/law/drucker_prager.hpp>

namespace example {

using vadose::Real;

/// Flags by name. read() raises SetupError on an unknown flag or a value that does not fit.
class Flags {
 public:
  /// `usage` is what --help prints.
  explicit Flags(const char* usage) : usage_(usage) {}

  Flags& number(const std::string& flag, Real& value) {
    return add(flag, true, [&value, flag](const std::string& text) { value = parse(flag, text); });
  }
  /// A whole number in [1, limit].
  Flags& whole(const std::string& flag, int& value, int limit) {
    return add(flag, true, [&value, flag, limit](const std::string& text) {
      const Real given = parse(flag, text);
      if (!(given >= 1 && given <= limit && given == std::floor(given)))
        throw vadose::SetupError(flag + " needs a whole number from 1 to " + std::to_string(limit));
      value = static_cast<int>(given);
    });
  }
  Flags& word(const std::string& flag, std::string& value) {
    return add(flag, true, [&value](const std::string& text) { value = text; });
  }
  /// One of some words.
  template <class T>
  Flags& choice(const std::string& flag, T& value, const std::map<std::string, T>& words) {
    return add(flag, true, [&value, flag, words](const std::string& text) {
      const auto found = words.find(text);
      if (found != words.end()) {
        value = found->second;
        return;
      }
      std::string allowed;
      for (const auto& entry : words) allowed += (allowed.empty() ? "" : ", ") + entry.first;
      throw vadose::SetupError(flag + " needs one of " + allowed + ", not '" + text + "'");
    });
  }
  Flags& cone(vadose::law::Cone& value) {
    using vadose::law::Cone;
    return choice<Cone>("--cone", value,
                        {{"outer", Cone::outer},
                         {"inner", Cone::inner},
                         {"plane-strain", Cone::plane_strain_matched},
                         {"inscribed", Cone::inscribed}});
  }
  Flags& on(const std::string& flag, bool& value) {
    return add(flag, false, [&value](const std::string&) { value = true; });
  }
  /// A flag that sets several values at once.
  Flags& preset(const std::string& flag, std::function<void()> set) {
    return add(flag, false, [set = std::move(set)](const std::string&) { set(); });
  }

  /// Reads the command line; --help prints the usage and ends the program.
  void read(int count, char** words) const {
    for (int i = 1; i < count; ++i) {
      const std::string flag = words[i];
      if (flag == "--help") {
        std::fputs(usage_, stdout);
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

  Flags& add(const std::string& flag, bool takes_value,
             std::function<void(const std::string&)> set) {
    known_[flag] = {takes_value, std::move(set)};
    return *this;
  }
  static Real parse(const std::string& flag, const std::string& text) {
    char* end = nullptr;
    const Real value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !vadose::is_finite(value))
      throw vadose::SetupError(flag + " needs a number, not '" + text + "'");
    return value;
  }

  const char* usage_;
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
