#!/bin/sh
# SPDX-License-Identifier: MIT
# The large-deformation problems of the paper, a hillside in 3D and a storm of a day: installs what is missing, builds
# and runs them in out/, prints their ledgers and draws their pictures.
#   sh examples/paper.sh column [argument of sand_column_collapse]...       4.3
#   sh examples/paper.sh centrifuge [argument of centrifuge_slope]...       4.4
#   sh examples/paper.sh clay [argument of clay_slope]...                   4.5
#   sh examples/paper.sh hillside [argument of hillside_rain]...
#   sh examples/paper.sh storm [argument of storm_slope]...
# Without arguments of its own every one takes at most three minutes on a busy core; column then runs its sweep
# in cells of 5 mm.
set -eu
cd "$(dirname "$0")/.."
. ./cmake/prepare.sh
root=$PWD
case "${1:-}" in
  column) program=sand_column_collapse ;;
  centrifuge) program=centrifuge_slope ;;
  clay) program=clay_slope ;;
  hillside) program=hillside_rain ;;
  storm) program=storm_slope ;;
  *) fail "usage: sh examples/paper.sh column|centrifuge|clay|hillside|storm [argument]..." ;;
esac
name=$1
shift
if [ "$name" = column ] && [ $# -eq 0 ]; then set -- --sweep --cell-size 0.005; fi

require_packages
offer_pictures
configure_release
say "building $program"
cmake --build "$build" --parallel 2 --target "$program" || fail "build"
mkdir -p "out/$name"
say "running $program $* (results in $root/out/$name)"
"$build/examples/$program" --output "out/$name" "$@" || fail "$program ended with status $?"
if python=$(picture_python); then
  say "drawing pictures in $root/out/$name"
  case "$name" in
    column) [ ! -f "out/$name/column_sweep.csv" ] || "$python" examples/plot/column.py "out/$name" ;;
    hillside) "$python" examples/plot/hillside.py "out/$name" ;;
    storm) "$python" examples/plot/storm.py "out/$name" ;;
    *) "$python" examples/plot/slide.py "$name" "out/$name" ;;
  esac
else
  echo "no pictures: matplotlib (package python3-matplotlib) is not here"
fi
