// SPDX-License-Identifier: MIT
// A run that is saved and taken up again has the bits of one that is not: models of round and of three-dimensional space under every
// scheme, with loads, rain, a reservoir, switches, films, free water and resampling.

#include <doctest/doctest.h>

#include "tests/restart_scenes.hpp"

using namespace vadose;
using restart_test::RigidSoil;

TEST_CASE_TEMPLATE("restart under every scheme: of round and of three-dimensional space", M,
                   UnsaturatedModel<Axisymmetric>, UnsaturatedModel<ThreeDimensional>) {
  restart_test::check_schemes<M>();
}
