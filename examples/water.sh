#!/bin/sh
# SPDX-License-Identifier: MIT
# From a fresh clone to the examples of water at the ground: installs what is missing, builds and runs
# 05 to 09 in out/, prints their ledgers and draws their pictures.
#   sh examples/water.sh
set -eu
cd "$(dirname "$0")/.."
. ./cmake/prepare.sh
root=$PWD
programs="05_rain_on_a_column 06_rain_on_a_slope 07_reservoir_drawdown 08_dam_break_on_sand
          09_ponded_infiltration"

require_packages
offer_pictures
configure_release
mkdir -p out
for name in $programs; do
  say "$name"
  cmake --build "$build" --parallel 2 --target "step_$name" || fail "build"
  (cd out && "$root/$build/examples/step_$name") || fail "$name: its ledger does not close"
done
if python=$(picture_python); then
  say "drawing pictures in $root/out"
  "$python" examples/plot/columns.py out
  for base in rain_slope reservoir_drawdown dam_break; do
    "$python" examples/plot/water.py "$base" out
  done
else
  echo "no pictures: matplotlib (package python3-matplotlib) is not here"
fi
