#!/bin/sh
# SPDX-License-Identifier: MIT
# Writes CATALOGUE.md: what the compilers say to each mistake of tests/compile/fail_*.cpp.
#   sh tests/compile/catalogue.sh [g++] [clang++-14]
set -eu
cd "$(dirname "$0")/../.."
gcc=${1:-g++}
clang=${2:-clang++-14}
eigen=/usr/include/eigen3
[ -d "$eigen" ] || eigen=/usr/local/include/eigen3
page=tests/compile/CATALOGUE.md
said=$(mktemp)
trap 'rm -f "$said"' EXIT

# errors_of <compiler> <source> <flag>...: what it says goes to $said; prints the number of errors.
errors_of() {
  compiler=$1 source=$2
  shift 2
  "$compiler" -std=c++20 -fsyntax-only -Iinclude -isystem "$eigen" -DVADOSE_SHOULD_FAIL "$@" "$source" >"$said" 2>&1 || true
  grep -c 'error: ' "$said" || true
}

{
  echo "# Mistakes and what the compiler says"
  echo
  echo "Written by \`sh tests/compile/catalogue.sh\` with $($gcc --version | head -1) and"
  echo "$($clang --version | head -1). Every row is a test: the source compiles, and with the"
  echo "mistake the compiler prints the sentence. \"errors\" counts lines with \`error:\`."
  echo
  echo "| mistake | sentence | errors, g++ | errors, clang++ |"
  echo "| --- | --- | --- | --- |"
  for source in tests/compile/fail_*.cpp; do
    mistake=$(sed -n 's|^// mistake: ||p' "$source")
    flags=$(sed -n 's|^// flags: ||p' "$source")
    expect=$(sed -n 's|^// expect: ||p' "$source")
    # shellcheck disable=SC2086  # one word per flag
    on_clang=$(errors_of "$clang" "$source" $flags)
    grep -E "error: .*$expect" "$said" >/dev/null || on_clang="$on_clang, WITHOUT the sentence"
    # shellcheck disable=SC2086
    on_gcc=$(errors_of "$gcc" "$source" $flags)
    sentence=$(grep -E "error: .*$expect" "$said" | head -1 | sed 's/.*\(vadose: .*\)/\1/; s/"$//')
    [ -n "$sentence" ] || on_gcc="$on_gcc, WITHOUT the sentence"
    echo "| $mistake | $sentence | $on_gcc | $on_clang |"
  done
} >"$page.part"
mv "$page.part" "$page"
echo "$page: $(grep -c '^| .* | vadose' "$page") mistakes"
