// SPDX-License-Identifier: MIT
// Progress lines, with wall times given by the test.

#include <doctest/doctest.h>
#include <cstdio>
#include <string>

#include <vadose/io/progress.hpp>

namespace {

using vadose::io::Progress;

/// Everything written to a temporary stream so far.
std::string text_of(std::FILE* stream) {
  std::fflush(stream);
  std::rewind(stream);
  std::string text;
  for (int c; (c = std::fgetc(stream)) != EOF;) text += static_cast<char>(c);
  return text;
}

}  // namespace

TEST_CASE("progress: a line at most every interval, with speed and time left") {
  std::FILE* stream = std::tmpfile();
  REQUIRE(stream != nullptr);
  Progress progress(10, 5, stream);
  CHECK_FALSE(progress.update(0.1, 10, 0.0));
  CHECK_FALSE(progress.update(0.9, 90, 4.99));
  CHECK(text_of(stream).empty());
  CHECK(progress.update(1.0, 100, 5.0));
  CHECK(text_of(stream) == "t = 1 s of 10 s (10.0 %), 20 steps/s, 0:00:45 left\n");
  CHECK_FALSE(progress.update(2.0, 200, 9.0));
  // speed since the last line, time left from the whole run
  CHECK(progress.update(2.5, 1100, 1805.0));
  CHECK(text_of(stream) ==
        "t = 1 s of 10 s (10.0 %), 20 steps/s, 0:00:45 left\n"
        "t = 2.5 s of 10 s (25.0 %), 0.5556 steps/s, 1:30:15 left\n");
  std::fclose(stream);
}

TEST_CASE("progress: runs that start late, stand still or overshoot") {
  std::FILE* stream = std::tmpfile();
  REQUIRE(stream != nullptr);
  Progress progress(20, 1, stream, 10);
  CHECK(progress.update(10, 0, 1.0));
  CHECK(progress.update(15, 5, 2.0));
  CHECK(progress.update(21, 6, 3.0));
  CHECK(text_of(stream) ==
        "t = 10 s of 20 s (0.0 %), 0 steps/s, time left unknown\n"
        "t = 15 s of 20 s (50.0 %), 5 steps/s, 0:00:02 left\n"
        "t = 21 s of 20 s (110.0 %), 1 steps/s, time left unknown\n");
  // the clock's own form: no interval, so every call prints
  Progress every(1, 0, stream);
  CHECK(every.update(0.5, 1));
  std::fclose(stream);
}

TEST_CASE("progress: wrong arguments are refused") {
  CHECK_THROWS_WITH_AS(Progress(0, 1), "end_time = 0 outside (0, inf) [s]", vadose::SetupError);
  CHECK_THROWS_WITH_AS(Progress{vadose::unset},
                       "end_time = nan (missing or not finite), allowed (0, inf) [s]",
                       vadose::SetupError);
  CHECK_THROWS_WITH_AS(Progress(1, -1), "interval = -1 outside [0, inf) [s]", vadose::SetupError);
  CHECK_THROWS_AS(Progress(1, 1, nullptr), vadose::SetupError);
}
