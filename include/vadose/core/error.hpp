// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Set-up errors and the checks that raise them. Every message names the parameter, its value,
/// its unit and the allowed range.

#include <cstdio>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>

#include <vadose/core/real.hpp>

namespace vadose {

/// Thrown while a scene or solver is built; nothing is half built when it is.
class SetupError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Outcome of a constitutive update or kernel. Loops return it; they never throw.
enum class Status : unsigned char {
  ok = 0,      ///< accepted
  failed = 1,  ///< the law could not return an admissible stress
};

/// The worse of two outcomes.
constexpr Status operator|(Status a, Status b) noexcept {
  return a == Status::ok ? b : a;
}

/// Checks of set-up values.
namespace check {

/// Decimal text of a value with up to 9 significant digits.
inline std::string text(Real value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.9g", value);
  return buffer;
}

/// Pieces of text one after the other. (Appended: `"x" + std::string` draws a false -Wrestrict
/// error from g++ 12.)
inline std::string joined(std::initializer_list<std::string> pieces) {
  std::string all;
  for (const std::string& piece : pieces) all += piece;
  return all;
}

/// Raises SetupError "name = value outside range [unit]".
[[noreturn]] inline void fail(std::string_view name, Real value, std::string_view range,
                              std::string_view unit) {
  std::string message(name);
  message += " = " + text(value);
  message += is_finite(value) ? " outside " : " (missing or not finite), allowed ";
  message += std::string(range) + " [" + std::string(unit) + "]";
  throw SetupError(message);
}

namespace detail {
/// Text of an interval. Grown by appending: g++ 12 warns falsely about "(" + string.
inline std::string interval(char open, Real low, Real high, char close) {
  std::string range(1, open);
  range += text(low);
  range += ", ";
  range += text(high);
  range += close;
  return range;
}
}  // namespace detail

/// value > 0 and finite.
inline void positive(std::string_view name, Real value, std::string_view unit) {
  if (!is_finite(value) || !(value > 0)) fail(name, value, "(0, inf)", unit);
}

/// value >= 0 and finite.
inline void non_negative(std::string_view name, Real value, std::string_view unit) {
  if (!is_finite(value) || !(value >= 0)) fail(name, value, "[0, inf)", unit);
}

/// Any finite value.
inline void finite(std::string_view name, Real value, std::string_view unit) {
  if (!is_finite(value)) fail(name, value, "(-inf, inf)", unit);
}

/// low < value < high (open interval).
inline void inside(std::string_view name, Real value, Real low, Real high, std::string_view unit) {
  if (!is_finite(value) || !(value > low && value < high))
    fail(name, value, detail::interval('(', low, high, ')'), unit);
}

/// low <= value <= high (closed interval).
inline void within(std::string_view name, Real value, Real low, Real high, std::string_view unit) {
  if (!is_finite(value) || !(value >= low && value <= high))
    fail(name, value, detail::interval('[', low, high, ']'), unit);
}

/// Runs f; a SetupError from it is thrown again with " in <context>" appended.
template <class F>
void in_context(const std::string& context, F&& f) {
  try {
    f();
  } catch (const SetupError& error) {
    throw SetupError(std::string(error.what()) + " in " + context);
  }
}

}  // namespace check
}  // namespace vadose
