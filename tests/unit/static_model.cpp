// SPDX-License-Identifier: MIT

// What a model costs by its types: doubles per point, empty parts. Fails to compile, not to run.

#include <doctest/doctest.h>

#include <type_traits>

#include "kernel_support.hpp"

namespace {

using namespace kernel_test;
namespace field = vadose::field;
namespace law = vadose::law;
namespace shape = vadose::shape;
namespace transfer = vadose::transfer;
using vadose::Axisymmetric;
using vadose::PlaneStrain;
using vadose::ThreeDimensional;
using vadose::Uniaxial;

template <class M>
constexpr int solid_bytes = vadose::State<M>::Solid::bytes_per_point;
template <class M>
constexpr int liquid_bytes = vadose::State<M>::Liquid::bytes_per_point;

template <class K>
struct RigidSoil : vadose::UnsaturatedModel<K> {
  using Skeleton = law::Rigid;
};
template <class K>
struct Viscous : vadose::FreeWaterModel<K> {
  using Liquid = law::NewtonianFluid;
};

/// Bytes per solid and per liquid point of a model.
template <class M, int Solid, int Liquid>
constexpr bool costs = solid_bytes<M> == Solid&& liquid_bytes<M> == Liquid;

// Bytes per point of the presets (GIMP, FLIP, linear elastic). A model with water has a liquid
// point beside every solid one.
//
//                       Uniaxial        PlaneStrain     ThreeDimensional
//                       solid liquid    solid liquid    solid liquid
//   DryModel              72      -       104      -       144      -
//   SaturatedModel        72     64       104     88       144    112
//   UnsaturatedModel      72     64       104     88       144    112
//   rigid skeleton        32     56        40     72        48     88
//   FreeWaterModel         -     48         -     64         -     80
static_assert(solid_bytes<vadose::DryModel<Uniaxial>> == 72);
static_assert(solid_bytes<vadose::DryModel<PlaneStrain>> == 104);
static_assert(solid_bytes<vadose::DryModel<ThreeDimensional>> == 144);
static_assert(costs<vadose::SaturatedModel<Uniaxial>, 72, 64>);
static_assert(costs<vadose::SaturatedModel<PlaneStrain>, 104, 88>);
static_assert(costs<vadose::SaturatedModel<ThreeDimensional>, 144, 112>);
static_assert(costs<vadose::UnsaturatedModel<Uniaxial>, 72, 64>);
static_assert(costs<vadose::UnsaturatedModel<PlaneStrain>, 104, 88>);
static_assert(costs<vadose::UnsaturatedModel<ThreeDimensional>, 144, 112>);
static_assert(costs<RigidSoil<Uniaxial>, 32, 56>);
static_assert(costs<RigidSoil<PlaneStrain>, 40, 72>);
static_assert(costs<RigidSoil<ThreeDimensional>, 48, 88>);
static_assert(liquid_bytes<vadose::FreeWaterModel<Uniaxial>> == 48);
static_assert(liquid_bytes<vadose::FreeWaterModel<PlaneStrain>> == 64);
static_assert(liquid_bytes<vadose::FreeWaterModel<ThreeDimensional>> == 80);
static_assert(costs<vadose::SaturatedModel<Axisymmetric>, 104, 88>);

// What a policy adds: a law its state, an affine transfer dim^2 numbers on both kinds of points,
// viscosity a stress; a basis without a particle domain saves the half sizes.
static_assert(solid_bytes<Dry<PlaneStrain, law::DruckerPrager>> == 104 + 8);
static_assert(solid_bytes<Dry<ThreeDimensional, law::DruckerPrager>> == 144 + 8);
static_assert(costs<Saturated<PlaneStrain, law::LinearElastic, transfer::Apic>, 104 + 32, 88 + 32>);
static_assert(costs<Saturated<PlaneStrain, law::LinearElastic, transfer::Tpic>, 104 + 32, 88 + 32>);
static_assert(costs<Saturated<PlaneStrain, law::LinearElastic, transfer::Flip, shape::Linear>,
                    104 - 16, 88 - 16>);
static_assert(liquid_bytes<Viscous<PlaneStrain>> == 64 + 32);
static_assert(liquid_bytes<Viscous<ThreeDimensional>> == 80 + 48);

// Absent physics is absent storage.
template <class M>
using SolidOf = vadose::SolidFields<M>;
template <class M>
using LiquidOf = vadose::LiquidFields<M>;
static_assert(!SolidOf<RigidSoil<PlaneStrain>>::has<field::Velocity>);
static_assert(!SolidOf<RigidSoil<PlaneStrain>>::has<field::BishopStress>);
static_assert(!SolidOf<RigidSoil<PlaneStrain>>::has<field::HalfSize>);
static_assert(!LiquidOf<RigidSoil<PlaneStrain>>::has<field::HalfSize>);
static_assert(!LiquidOf<vadose::FreeWaterModel<PlaneStrain>>::has<field::Porosity>);
static_assert(!LiquidOf<vadose::SaturatedModel<PlaneStrain>>::has<field::ViscousStress>);
static_assert(!SolidOf<vadose::DryModel<PlaneStrain>>::has<field::LiquidPressure>);
static_assert(!SolidOf<vadose::DryModel<PlaneStrain>>::has<field::LawState>);
static_assert(SolidOf<Dry<PlaneStrain, law::DruckerPrager>>::has<field::LawState>);

// Policies without numbers are empty, and so are parts of a material that a model has no use for.
static_assert(std::is_empty_v<shape::Linear> && std::is_empty_v<shape::Gimp> &&
              std::is_empty_v<shape::QuadraticBSpline>);
static_assert(std::is_empty_v<transfer::Apic> && std::is_empty_v<transfer::Tpic>);
static_assert(std::is_empty_v<vadose::NoLiquid> && std::is_empty_v<vadose::NoSkeleton>);
static_assert(std::is_empty_v<law::InviscidWater> && std::is_empty_v<law::Rigid>);
static_assert(std::is_empty_v<law::LinearElastic::State<Real>>);
static_assert(std::is_empty_v<vadose::swrc::AlwaysSaturated>);
static_assert(
    std::is_empty_v<decltype(vadose::Material<vadose::DryModel<PlaneStrain>>::retention)>);
static_assert(
    std::is_empty_v<decltype(vadose::Material<vadose::DryModel<PlaneStrain>>::conductivity)>);
static_assert(sizeof(vadose::Material<vadose::DryModel<PlaneStrain>>) <
              sizeof(vadose::Material<vadose::SaturatedModel<PlaneStrain>>));

// Sizes the kernels rely on.
static_assert(sizeof(vadose::Record) == 64 && alignof(vadose::Record) == 64);
static_assert(sizeof(Lanes) == 8 * sizeof(double));
static_assert(std::is_trivially_copyable_v<Lanes>);
static_assert(vadose::Block<1>::cells == 64 && vadose::Block<2>::cells == 64 &&
              vadose::Block<3>::cells == 64);
static_assert(vadose::power<1>(vadose::Block<1>::edge) == 64 &&
              vadose::power<2>(vadose::Block<2>::edge) == 64 &&
              vadose::power<3>(vadose::Block<3>::edge) == 64);
// Eigen's vectors of the interface have a layout that no flag changes.
static_assert(sizeof(Vec<2>) == 16 && alignof(Vec<2>) == alignof(double));
static_assert(sizeof(Vec<3>) == 24 && alignof(Vec<3>) == alignof(double));

}  // namespace

TEST_CASE("a dry model's state has no liquid points and no arrays of the liquid") {
  using M = vadose::DryModel<PlaneStrain>;
  vadose::Scene<M> scene({.box = {{0, 0}, {1, 1}}, .cell_size = 0.1});
  scene.add_soil(vadose::box({0, 0}, {0.5, 0.5}), soil<M>());
  vadose::Solver<M> solver(scene);
  REQUIRE(run(solver, 3));
  const auto& state = solver.state();
  CHECK(state.liquid.size() == 0);
  CHECK(state.liquid.batches() == 0);
  const auto& n = state.nodes;
  CHECK(n.solid_in.size() == state.grid.size());
  CHECK(n.solid_out.size() == state.grid.size());
  for (const auto* records : {&n.liquid_in, &n.liquid_out, &n.mixture, &n.pore, &n.free, &n.content,
                              &n.materials, &n.relative})
    CHECK(records->empty());
  CHECK(n.cell.empty());
  CHECK(n.face.empty());
  CHECK(n.dof.empty());
}

TEST_CASE("models without a skeleton that moves have no solid arrays") {
  using Water = vadose::FreeWaterModel<PlaneStrain>;
  vadose::Scene<Water> pool({.box = {{0, 0}, {1, 1}}, .cell_size = 0.1});
  pool.add_water(vadose::box({0, 0}, {0.5, 0.5}));
  vadose::Solver<Water> water(pool);
  CHECK(water.solid().size() == 0);
  CHECK(water.state().nodes.solid_in.empty());
  CHECK(water.state().soils.empty());

  using Rock = RigidSoil<PlaneStrain>;
  vadose::Scene<Rock> scene({.box = {{0, 0}, {1, 1}}, .cell_size = 0.1});
  scene.add_soil(vadose::box({0, 0}, {0.5, 0.5}), soil<Rock>(), {.suction = 1e3});
  vadose::Solver<Rock> rock(scene);
  CHECK(rock.state().nodes.solid_in.empty());
  CHECK(rock.state().nodes.solid_out.empty());
  CHECK(rock.solid().size() == rock.liquid().size());
}

TEST_CASE("batches hold one cache line per number of a point") {
  using Points = vadose::State<vadose::SaturatedModel<ThreeDimensional>>::Solid;
  CHECK(Points::stride * 8 == Points::bytes_per_point * lane_count);
  int components = 0;
  Points::fields::for_each([&](auto, int c) { components += c; });
  CHECK(components == Points::fields::total);
}
