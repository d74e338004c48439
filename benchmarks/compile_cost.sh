#!/bin/sh
# SPDX-License-Identifier: MIT
# What a host pays to compile: seconds and kilobytes of code of every example, of the headers alone,
# and of a file that uses a solver compiled elsewhere (extern template). A table in Markdown.
#   sh benchmarks/compile_cost.sh [FILE...]
set -eu
cd "$(dirname "$0")/.."
cxx=${CXX:-g++}
eigen=${EIGEN:-/usr/include/eigen3}
flags="-std=c++20 -O3 -DNDEBUG -march=native -fno-math-errno -fno-trapping-math -fopenmp"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# cost <name> <source> [flag]...
cost() {
  name=$1 source=$2
  shift 2
  start=$(date +%s.%N)
  # shellcheck disable=SC2086  # one word per flag
  $cxx $flags -I. -Iinclude -isystem "$eigen" "$@" -c "$source" -o "$work/object.o"
  end=$(date +%s.%N)
  code=$(size "$work/object.o" | awk 'NR == 2 { printf "%.0f", $1 / 1024 }')
  awk -v n="$name" -v a="$start" -v b="$end" -v c="$code" \
    'BEGIN { printf "| %s | %.1f | %d |\n", n, b - a, c }'
}

printf '| compiled with %s %s | s | KiB of code |\n| --- | --- | --- |\n' "$cxx" \
  "$($cxx -dumpversion)"
printf '#include <vadose/vadose.hpp>\n' >"$work/headers.cpp"
cost "all headers, nothing used" "$work/headers.cpp"
cat >"$work/slope.hpp" <<'END'
#pragma once
#include <vadose/vadose.hpp>
struct Slope : vadose::UnsaturatedModel<vadose::PlaneStrain> {
  using Skeleton = vadose::law::DruckerPrager;
};
#ifdef ELSEWHERE
extern template class vadose::Solver<Slope>;
#endif
END
cat >"$work/user.cpp" <<'END'
#include "slope.hpp"
double run(const vadose::Scene<Slope>& scene) {
  vadose::Solver<Slope> solver(scene);
  solver.advance_to(1);
  return solver.time();
}
END
printf '#include "slope.hpp"\ntemplate class vadose::Solver<Slope>;\n' >"$work/solver.cpp"
cost "a file that runs a solver" "$work/user.cpp"
cost "the same, solver compiled elsewhere" "$work/user.cpp" -DELSEWHERE
cost "that solver, once" "$work/solver.cpp"
[ $# -gt 0 ] || set -- examples/*.cpp
for example in "$@"; do
  cost "$example" "$example"
done
