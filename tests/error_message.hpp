// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>

namespace vadose_test {

/// What the error of type Error that f throws says; "(no error)" if it throws none.
template <class Error, class F>
std::string error_message(F&& f) {
  try {
    std::forward<F>(f)();
  } catch (const Error& error) {
    return error.what();
  }
  return "(no error)";
}

}  // namespace vadose_test
