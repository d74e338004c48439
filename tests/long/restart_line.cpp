// SPDX-License-Identifier: MIT
// A run that is saved and taken up again has the bits of one that is not: models of one dimension
// under every scheme, with loads, rain, a reservoir, switches, films, free water and resampling.

#include <doctest/doctest.h>

#include "tests/restart_scenes.hpp"

using namespace vadose;
using restart_test::RigidSoil;

TEST_CASE_TEMPLATE("restart under every scheme: one dimension", M, DryModel<Uniaxial>,
                   SaturatedModel<Uniaxial>, UnsaturatedModel<Uniaxial>,
                   RigidSoil<SaturatedModel<Uniaxial>>, RigidSoil<UnsaturatedModel<Uniaxial>>,
                   FreeWaterModel<Uniaxial>) {
  restart_test::check_schemes<M>();
}
