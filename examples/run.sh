#!/bin/sh
# SPDX-License-Identifier: MIT
# From a fresh clone to the main job: installs what is missing, builds and runs sand_slope in out/
# and draws pictures of its results.
#   sh examples/run.sh [argument of sand_slope]...
# CXX=clang++ chooses the compiler.
set -eu
cd "$(dirname "$0")/.."
. ./cmake/prepare.sh

# draw <folder with the results>
draw() {
  if python=$(picture_python); then
    "$python" "$root/examples/plot/slope.py" "$1"
  elif have gnuplot; then
    gnuplot -c "$root/examples/plot/history.gp" "$1" && echo "picture: $1/slope_history.png"
  else
    echo "no pictures: neither matplotlib (package python3-matplotlib) nor gnuplot is here"
  fi
}

root=$PWD
results=.
before=
for word in "$@"; do
  if [ "$before" = --output ]; then results=$word; fi
  before=$word
done

require_packages
offer_pictures
configure_release
say "building sand_slope"
cmake --build "$build" --parallel 2 --target sand_slope || fail "build"
program=$root/$build/examples/sand_slope
mkdir -p out
cd out
say "running sand_slope $* (results in $PWD)"
rm -f "$results/slope_choices.csv"
status=0
"$program" "$@" || status=$?
[ "$status" -eq 0 ] || fail "sand_slope ended with status $status"
[ -f "$results/slope_choices.csv" ] || exit 0 # --help
say "drawing pictures"
draw "$results" || fail "pictures"
