#!/bin/sh
# SPDX-License-Identifier: MIT
# From a fresh clone to the report on errors and their price: installs what is missing, builds and
# runs the cases of tests/verify with their resolutions and choices, writes norms and values (CSV,
# JSON), draws them and prints a table in Markdown. Results in out/report/.
#   sh benchmarks/report.sh [--short]
# --short takes fewer and coarser runs. CXX=clang++ chooses the compiler.
set -eu
cd "$(dirname "$0")/.."
. ./cmake/prepare.sh

read_options short "$@"

require_packages
offer_pictures
configure_release
say "building"
cmake --build "$build" --parallel 2 --target report_programs || fail "build"
results=out/report
mkdir -p "$results"
rm -f "$results"/*
# Two programs at a time.
run_two() {
  for program in "$@"; do
    "$build/benchmarks/report_$program" "--out=$results" ${short:+--short} \
      "--benchmark_out=$results/$program.json" >"$results/$program.log" 2>&1 &
    eval "pid_$program=$!"
  done
  for program in "$@"; do
    eval "wait \$pid_$program" || fail "report_$program (see $results/$program.log)"
  done
}
say "running (results in $results)"
run_two saturated seepage
run_two large_strain unsaturated
run_two free_water manufactured
run_two schemes
if python=$(picture_python); then
  say "drawing"
  "$python" benchmarks/report.py "$results" || fail "pictures"
else
  echo "no pictures: matplotlib (package python3-matplotlib) is not here"
fi
