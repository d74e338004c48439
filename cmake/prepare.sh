# SPDX-License-Identifier: MIT
# Read by the scripts that build and run (POSIX sh, from the repository root): installs what is
# missing on Debian 12, Ubuntu 24.04 or newer and configures a release build in $build.
# CXX chooses the compiler (default g++).

say() { printf '\n== %s\n' "$*"; }
fail() {
  printf '\nFAILED: %s\n' "$*" >&2
  exit 1
}
have() { command -v "$1" >/dev/null 2>&1; }
have_header() {
  for prefix in /usr/include /usr/local/include /usr/include/eigen3 /usr/local/include/eigen3; do
    [ -f "$prefix/$1" ] && return 0
  done
  return 1
}

# read_options <names> <argument>...: sets the variable of every name to yes or, where --name is not
# among the arguments, to nothing; stops at any other argument.
read_options() {
  names=$1
  shift
  for name in $names; do eval "$name="; done
  for argument in "$@"; do
    case " $names " in
      *" ${argument#--} "*) eval "${argument#--}=yes" ;;
      *)
        printf '%s: options are%s\n' "$0" "$(printf ' --%s' $names)" >&2
        exit 2
        ;;
    esac
  done
}

# The newest Debian and Ubuntu name all packages alike.
apt_system() {
  have apt-get && [ -r /etc/os-release ] || return 1
  (
    . /etc/os-release
    case "${ID:-}" in
      debian) oldest=12 ;;
      ubuntu) oldest=24 ;;
      *) exit 1 ;;
    esac
    number=${VERSION_ID:-$oldest} # Debian's testing has none
    [ "${number%%.*}" -ge "$oldest" ]
  )
}

install_packages() {
  as_root=
  if [ "$(id -u)" -ne 0 ]; then
    have sudo || fail "no sudo here; as root: apt-get install $*"
    as_root=sudo
  fi
  say "installing: $*"
  $as_root apt-get update &&
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@"
}

# require_packages: what the build cannot do without.
require_packages() {
  missing=
  have cmake || missing="$missing cmake"
  case "$cxx" in
    *clang++*)
      suffix=${cxx##*clang++} # clang++-14 is of package clang-14
      have "$cxx" || missing="$missing clang$suffix libomp$suffix-dev"
      have g++ || missing="$missing g++" # the C++ library that clang++ uses
      ;;
    g++) have g++ || missing="$missing g++" ;;
    *) have "$cxx" || fail "compiler $cxx not found" ;;
  esac
  have ninja || have make || missing="$missing ninja-build"
  have_header Eigen/Core || missing="$missing libeigen3-dev"
  have_header doctest/doctest.h || missing="$missing doctest-dev"
  have_header benchmark/benchmark.h || missing="$missing libbenchmark-dev"
  [ -z "$missing" ] && return 0
  apt_system || fail "please install what these packages of Debian 12 hold, then run again:$missing"
  # shellcheck disable=SC2086  # one word per package
  install_packages $missing || fail "apt could not install:$missing"
  have "$cxx" || fail "compiler $cxx not found"
}

# offer <package> <command>...: installs a package unless the command succeeds; never a reason to stop.
offer() {
  package=$1
  shift
  "$@" >/dev/null 2>&1 && return 0
  if apt_system && (install_packages "$package") && "$@" >/dev/null 2>&1; then return 0; fi
  say "no $package: what needs it is skipped"
}

# picture_python: prints a python3 that has matplotlib.
picture_python() {
  for python in python3 /usr/bin/python3; do
    have "$python" && "$python" -c 'import matplotlib' >/dev/null 2>&1 || continue
    echo "$python"
    return 0
  done
  return 1
}

# offer_pictures: matplotlib if it is missing and can be had; never a reason to stop.
offer_pictures() {
  picture_python >/dev/null && return 0
  if apt_system && (install_packages python3-matplotlib) && picture_python >/dev/null; then return 0; fi
  if have gnuplot; then
    say "no matplotlib (package python3-matplotlib): gnuplot will draw the histories only"
  else
    say "no matplotlib (package python3-matplotlib) and no gnuplot: no pictures"
  fi
}

# use_ninja <build folder>: Ninja where there is one; a configured folder keeps its generator.
use_ninja() {
  if have ninja && [ ! -f "$1/CMakeCache.txt" ]; then
    export CMAKE_GENERATOR=Ninja
  else
    unset CMAKE_GENERATOR
  fi
}

# configure_release [argument of cmake]...
configure_release() {
  say "configuring $build ($cxx)"
  use_ninja "$build"
  cmake --preset release -B "$build" -DCMAKE_CXX_COMPILER="$cxx" "$@" || fail "configure"
}

cxx=${CXX:-g++}
case "$cxx" in
  g++) build=build/release ;;
  *) build=build/release-${cxx##*/} ;;
esac
