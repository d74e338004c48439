// SPDX-License-Identifier: MIT
#pragma once

// Kicked blocks of soil: is a run stable at its step? By kinematics and basis.

#include <doctest/doctest.h>

#include "variant.hpp"
#include "verify_support.hpp"

namespace verify {

template <class K, class S>
using Wet = With<vadose::SaturatedModel<K>, Variant<S>>;
template <class K, class S>
using Moist = With<vadose::UnsaturatedModel<K>, Variant<S>>;
template <class K, class S>
using Dry = With<vadose::DryModel<K>, Variant<S>>;

/// A block of soil on a fixed base under smooth walls, `cells` wide and `tall` cells high, free on
/// top (with one layer of air) or closed in all round.
template <class M>
vadose::Scene<M> block(const vadose::Material<M>& material,
                       vadose::SoilOptions<M::Kinematics::dim> soil, Real h, int cells, int tall,
                       bool air = true) {
  constexpr int dim = M::Kinematics::dim, up = dim - 1;
  Vec<dim> low = Vec<dim>::Zero(), high = Vec<dim>::Constant(cells * h), top = high;
  high[up] = (tall + (air ? 2 : 0)) * h;
  top[up] = tall * h;
  vadose::Scene<M> scene({.box = {low, high}, .cell_size = h});
  scene.add_soil(vadose::box(low, top), material, soil);
  scene.add(vadose::bc::Fixed{.face = vadose::Face::bottom});
  return scene;
}

template <class M>
vadose::Material<M> dry_soil() {
  return {.solid_density = 2600,
          .porosity = 0.4,
          .skeleton = {.young_modulus = 10e6, .poisson_ratio = 0.33}};
}

/// Gives every point a small velocity of alternating sign, rich in short waves.
template <class M>
Real kick(vadose::Solver<M>& solver, Real speed) {
  constexpr int dim = M::Kinematics::dim;
  const auto set = [&](auto& points) {
    points.for_each([&](std::size_t b, int l) {
      for (int d = 0; d < dim; ++d) {
        const auto id = static_cast<std::uint64_t>(points.at(vadose::field::id, b)[l]);
        points.at(vadose::field::velocity, b, d)[l] =
            speed *
            (static_cast<Real>(vadose::detail::mix(3 * id + static_cast<std::uint64_t>(d)) >> 11) *
                 0x1p-52 -
             1);
      }
    });
  };
  if constexpr (vadose::has_skeleton<M>) set(solver.mutable_state().solid);
  if constexpr (vadose::has_liquid<M>) set(solver.mutable_state().liquid);
  return speed;
}

template <class M>
Real speed(const vadose::Solver<M>& solver) {
  Real most = largest_speed(solver.solid());
  if constexpr (vadose::has_liquid<M>) most = std::max(most, largest_speed(solver.liquid()));
  return most;
}

/// Whether a kicked block stays calm for so many steps: speeds below `factor` times the kick.
template <class M>
bool is_stable(const vadose::Scene<M>& scene, const vadose::SolverOptions<M>& options, long steps,
               Real factor, Real shift = 0) {
  vadose::Solver<M> solver(scene, options);
  const auto move = [&](auto& points) {
    for (std::size_t b = 0; b < points.batches(); ++b)
      for (int l = 0; l < vadose::lane_count; ++l)
        points.at(vadose::field::position, b, M::Kinematics::dim - 1)[l] += shift;
  };
  if (shift != 0) {
    move(solver.mutable_state().solid);
    if constexpr (vadose::has_liquid<M>) move(solver.mutable_state().liquid);
  }
  const Real start = kick(solver, 1e-9);
  for (long i = 0; i < steps; ++i) {
    if (solver.step().status != vadose::Status::ok) return false;
    if (i % 20 == 0 && !(speed(solver) < factor * start)) return false;
  }
  return speed(solver) < factor * start;
}

template <class K, class S>
void check_default() {
  constexpr int dim = K::dim;
  const int tall = dim == 3 ? 4 : 6, wide = dim == 3 ? 2 : 3;
  // Per axis 2 points, random offsets: harder than a lattice.
  using D = Dry<K, S>;
  using W = Wet<K, S>;
  using U = Moist<K, S>;
  const long steps = 2000;
  if constexpr (dim < 3)
    CHECK(is_stable<D>(block<D>(dry_soil<D>(), {.jitter = 0.2}, 0.1, wide, tall), {}, steps, 5));
  CHECK(
      is_stable<W>(block<W>(saturated_soil<W>(), {.jitter = 0.2}, 0.1, wide, tall), {}, steps, 5));
  CHECK(is_stable<W>(block<W>(saturated_soil<W>(1e-9), {.jitter = 0.2}, 0.1, wide, tall), {}, steps,
                     5));
  if constexpr (dim < 3)
    CHECK(is_stable<U>(block<U>(clay<U>(), {.jitter = 0.2, .suction = 1e3}, 0.1, wide, tall), {},
                       steps, 1e9));
}

}  // namespace verify
