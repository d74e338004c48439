// SPDX-License-Identifier: MIT
#pragma once

// Scenes of the speed benchmarks: a block of soil (or water) that stands free on its right and at its
// top in a box with a fixed floor and smooth walls. Points are jittered, as they are once soil has
// moved. About as many points as are asked for; 2 per axis in a cell.

#include <cmath>
#include <cstdint>

#include <vadose/policy/law/drucker_prager.hpp>
#include <vadose/solver/solver.hpp>

namespace speed {

using vadose::Real;
using vadose::Vec;

inline constexpr Real cell_size = 0.1;  // [m]

template <class K, class S = vadose::shape::Gimp, class L = vadose::law::DruckerPrager>
struct Dry : vadose::DryModel<K> {
  using Shape = S;
  using Skeleton = L;
};
template <class K, class S = vadose::shape::Gimp>
struct Saturated : vadose::SaturatedModel<K> {
  using Shape = S;
  using Skeleton = vadose::law::DruckerPrager;
};
template <class K, class S = vadose::shape::Gimp>
struct Unsaturated : vadose::UnsaturatedModel<K> {
  using Shape = S;
  using Skeleton = vadose::law::DruckerPrager;
};
/// Soil that stays where it is: seepage alone.
template <class K>
struct Seepage : vadose::UnsaturatedModel<K> {
  using Skeleton = vadose::law::Rigid;
};

/// Silty sand of [Zhan] Table 2, with cohesion that lets the block stand.
template <class M>
vadose::Material<M> soil() {
  vadose::Material<M> m;
  if constexpr (!vadose::is_rigid<M>) m.solid_density = 2650;
  m.porosity = 0.4;
  if constexpr (requires { m.skeleton.young_modulus; })
    m.skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.3};
  if constexpr (requires { m.skeleton.elastic; }) {
    m.skeleton.elastic = {.young_modulus = 10e6, .poisson_ratio = 0.3};
    m.skeleton.friction_angle = vadose::degrees(35);
    m.skeleton.cohesion = 1e3;
  }
  if constexpr (vadose::is_unsaturated<M>) {
    m.lambda = 0.6;
    m.retention.a = 1.5;
  }
  if constexpr (vadose::has_liquid<M>) m.conductivity.saturated_conductivity = 1e-4;
  return m;
}

/// What a scene is made of besides its model.
struct Layout {
  std::int64_t points = 100000;  ///< solid points, or points of free water
  Real room = 1.25;   ///< edge of the box over that of the block, along every axis but...
  Real jitter = 0.2;  ///< [cell size], below 0.25
};

/// Cells along an edge of the block.
template <int Dim>
int block_cells(std::int64_t points) {
  const Real cells = static_cast<Real>(points) / vadose::power<Dim>(2.0);
  return std::max(1, static_cast<int>(std::lround(std::pow(cells, 1.0 / Dim))));
}

template <class M>
vadose::Scene<M> scene(const Layout& layout) {
  constexpr int dim = M::Kinematics::dim;
  const int edge = block_cells<dim>(layout.points);
  const auto room = static_cast<int>(std::ceil(edge * layout.room));
  Vec<dim> low = Vec<dim>::Zero(), high, top;
  for (int d = 0; d < dim; ++d) {
    high[d] = edge * cell_size;
    top[d] = (d == 0 || d == dim - 1 ? std::max(room, edge + 1) : edge) * cell_size;
  }
  vadose::Scene<M> scene{{.box = {low, top}, .cell_size = cell_size}};
  scene.gravity[dim - 1] = -9.81;
  const auto body = vadose::box<dim>(low, high);
  if constexpr (!vadose::has_skeleton<M>) {
    scene.add_water(body, {.jitter = layout.jitter, .surface_level = high[dim - 1]});
  } else {
    vadose::SoilOptions<dim> options{.jitter = layout.jitter};
    if constexpr (!vadose::is_rigid<M>) {
      options.initial_stress = vadose::InitialStress::geostatic;
      options.lateral_stress_ratio = 0.43;
    }
    if constexpr (vadose::is_unsaturated<M>)
      options.suction = 10e3;
    else if constexpr (vadose::has_liquid<M>)
      options.water_table = high[dim - 1];
    scene.add_soil(body, soil<M>(), options);
  }
  if constexpr (vadose::is_deformable<M>)
    scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
  if constexpr (vadose::has_skeleton<M> && vadose::has_liquid<M>)
    scene.add(vadose::bc::ZeroSuction{});
  return scene;
}

}  // namespace speed
