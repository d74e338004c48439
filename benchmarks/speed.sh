#!/bin/sh
# SPDX-License-Identifier: MIT
# From a fresh clone to the report on speed: installs what is missing, builds and runs the programs of
# benchmarks/speed, draws their results and prints tables in Markdown. Results in out/speed/.
#   sh benchmarks/speed.sh [--short] [--compile]
# --short: 1e5 points only; --compile: also what compiling costs. CXX=clang++ chooses the compiler.
# Timings need a quiet machine; two threads at most are used.
set -eu
cd "$(dirname "$0")/.."
. ./cmake/prepare.sh

read_options "short compile" "$@"
filter=.
if [ -n "$short" ]; then filter=points:100000/; fi

require_packages
offer_pictures
configure_release
say "building"
cmake --build "$build" --parallel 2 --target speed_programs || fail "build"
results=out/speed
mkdir -p "$results"
rm -f "$results"/*
say "agreement of the library with the straightforward implementation"
"$build/benchmarks/speed_naive" --check || fail "agreement"
for program in dry saturated unsaturated presets kernels naive; do
  say "$program"
  "$build/benchmarks/speed_$program" "--benchmark_filter=$filter|kernel" \
    "--benchmark_out=$results/$program.json" --benchmark_out_format=json \
    >"$results/$program.log" 2>&1 || fail "speed_$program (see $results/$program.log)"
done
if [ -n "$compile" ]; then
  say "what compiling costs"
  sh benchmarks/compile_cost.sh | tee "$results/compile_cost.md"
fi
if python=$(picture_python); then
  say "drawing"
  "$python" benchmarks/speed.py "$results" || fail "pictures"
else
  echo "no pictures: matplotlib (package python3-matplotlib) is not here"
fi
