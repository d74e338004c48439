#!/bin/sh
# SPDX-License-Identifier: MIT
# From a fresh clone to the examples of water at the ground: installs what is missing, builds and runs
# 03, 04, 05, 09 and 10 in out/, prints their ledgers and draws their pictures.
#   sh examples/water.sh
set -eu
cd "$(dirname "$0")/.."
. ./cmake/prepare.sh
root=$PWD
programs="03_infiltration 04_rain 05_free_water 09_rain_on_a_slope 10_reservoir_drawdown"

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
