// SPDX-License-Identifier: MIT
// A run that is saved and taken up again has the bits of one that is not: models of plane strain
// under every scheme, with loads, rain, a reservoir, switches, films, free water and resampling.

#include <doctest/doctest.h>

#include "tests/restart_scenes.hpp"

using namespace vadose;
using restart_test::RigidSoil;

TEST_CASE_TEMPLATE("restart under every scheme: plane strain", M, DryModel<PlaneStrain>,
                   SaturatedModel<PlaneStrain>, UnsaturatedModel<PlaneStrain>,
                   RigidSoil<UnsaturatedModel<PlaneStrain>>, FreeWaterModel<PlaneStrain>) {
  restart_test::check_schemes<M>();
}
