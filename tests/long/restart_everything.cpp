// SPDX-License-Identifier: MIT
// A run that is saved and taken up again has the bits of one that is not: every kind of model under
// every scheme, with loads, rain, a reservoir, switches, films, free water and resampling.

#include <doctest/doctest.h>

#include "tests/restart_scenes.hpp"

namespace {

namespace vd = vadose;
using restart_test::check_any_restart;

template <class Preset>
struct Rigid : Preset {
  using Skeleton = vd::law::Rigid;
};
constexpr vd::PaperMends all_mends{.cell_average = true,
                                   .saturation = true,
                                   .porosity_slope = true,
                                   .porosity_gradient = true,
                                   .implicit_drag = true};

template <class M>
void check_schemes() {
  check_any_restart<M, vd::scheme::Explicit>(20, 17);
  if constexpr (vd::has_liquid<M>) {
    check_any_restart<M, vd::scheme::SemiImplicit>(20, 7);
    check_any_restart<M, vd::scheme::PaperLiteral<>>(20, 17, true);
    check_any_restart<M, vd::scheme::PaperLiteral<all_mends>>(20, 17, true);
  }
}

}  // namespace

TEST_CASE_TEMPLATE("restart under every scheme", M, vd::DryModel<vd::Uniaxial>,
                   vd::SaturatedModel<vd::Uniaxial>, vd::UnsaturatedModel<vd::Uniaxial>,
                   Rigid<vd::SaturatedModel<vd::Uniaxial>>,
                   Rigid<vd::UnsaturatedModel<vd::Uniaxial>>, vd::FreeWaterModel<vd::Uniaxial>,
                   vd::SaturatedModel<vd::PlaneStrain>, vd::UnsaturatedModel<vd::PlaneStrain>,
                   Rigid<vd::UnsaturatedModel<vd::PlaneStrain>>,
                   vd::FreeWaterModel<vd::PlaneStrain>, vd::UnsaturatedModel<vd::Axisymmetric>) {
  check_schemes<M>();
}
