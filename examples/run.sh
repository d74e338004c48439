#!/bin/sh
# SPDX-License-Identifier: MIT
# From a fresh clone to the main job: installs what is missing, builds and runs sand_slope in out/.
#   sh examples/run.sh [argument of sand_slope]...
# CXX=clang++ chooses the compiler.
set -eu
cd "$(dirname "$0")/.."
. ./cmake/prepare.sh

[ -f examples/sand_slope.cpp ] || fail "there is no examples/sand_slope.cpp in this version"
require_packages
offer_pictures
configure_release
say "building sand_slope"
cmake --build "$build" --parallel 2 --target sand_slope || fail "build"
program=$PWD/$build/examples/sand_slope
mkdir -p out
cd out
say "running sand_slope $* (results in $PWD)"
status=0
"$program" "$@" || status=$?
[ "$status" -eq 0 ] || fail "sand_slope ended with status $status"
