#!/bin/sh
# SPDX-License-Identifier: MIT
# From a fresh clone to tested: installs what is missing, builds, runs the tests.
#   sh tests/run.sh [--all]
# --all adds the long tier. CXX=clang++ chooses the compiler.
set -eu
cd "$(dirname "$0")/.."
. ./cmake/prepare.sh

labels='^long$'
long=OFF
for argument in "$@"; do
  case "$argument" in
    --all) labels='^$' long=ON ;;
    *)
      printf 'usage: sh tests/run.sh [--all]\n' >&2
      exit 2
      ;;
  esac
done

require_packages
configure_release -DVADOSE_LONG_TESTS="$long"
say "building"
cmake --build "$build" --parallel 2 || fail "build"
say "testing"
ctest --test-dir "$build" --label-exclude "$labels" --output-on-failure --no-tests=error -j 2 ||
  fail "tests (see above)"
