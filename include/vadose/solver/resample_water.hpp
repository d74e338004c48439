// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Merge and split of free-water points: light ones join their neighbours, heavy ones are halved.
/// Mass, momentum (with APIC angular momentum too) and centroid are kept; kinetic energy of the
/// motion of merged points against each other is lost. Both points of a merge lie in one cell of free
/// water, and so do both halves: nothing passes the surface of the soil. Pore water is never touched.

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <vadose/kernel/state.hpp>

namespace vadose::detail {

/// A free point and the cell it is in.
struct FreePoint {
  std::int32_t cell = -1;
  std::size_t batch = 0;
  int lane = 0;
};

/// Position of a liquid point.
template <class M>
Vec<State<M>::dim> position_of(const State<M>& state, const FreePoint& p) {
  Vec<State<M>::dim> x;
  for (int d = 0; d < State<M>::dim; ++d)
    x[d] = state.liquid.at(field::position, p.batch, d)[p.lane];
  return x;
}

/// Free points in cells of free water, those of a cell together.
template <class M>
std::vector<FreePoint> list_free_points(const State<M>& state) {
  constexpr int dim = State<M>::dim;
  std::vector<FreePoint> list;
  state.liquid.for_each([&](std::size_t b, int l) {
    if (state.liquid.group(b) != state.free_group()) return;
    Index<dim> cell;
    for (int d = 0; d < dim; ++d)
      cell[d] = state.grid.cell_of(state.liquid.at(field::position, b, d)[l], d);
    const std::int32_t e = state.grid.entry(cell);
    if (e != state.grid.outside() &&
        state.nodes.cell[static_cast<std::size_t>(e)].kind == CellKind::free)
      list.push_back({e, b, l});
  });
  std::stable_sort(list.begin(), list.end(),
                   [](const FreePoint& a, const FreePoint& b) { return a.cell < b.cell; });
  return list;
}

/// Mass of a full point at a place [kg].
template <class M>
Real full_point_mass(const State<M>& state, const Vec<State<M>::dim>& x) {
  const Real volume = state.cell_volume(State<M>::Kinematics::axisymmetric ? x[0] : 1);
  return state.water.density * volume /
         power<State<M>::dim>(Real(state.options.resampling.points_per_axis));
}

/// Moves `from` into `to`: masses add up, everything else is their mean by mass. What APIC carries
/// takes up the motion of the two about their centroid.
template <class M>
void merge_points(State<M>& state, const FreePoint& from, const FreePoint& to) {
  constexpr int dim = State<M>::dim;
  using Fields = typename State<M>::Liquid::fields;
  auto& points = state.liquid;
  Real& mass = points.at(field::mass, to.batch)[to.lane];
  const Real added = points.at(field::mass, from.batch)[from.lane];
  const Real total = mass + added;
  const Real share = total > 0 ? added / total : 0;
  const auto blend = [&](auto tag, int component) {
    Real& a = points.at(tag, to.batch, component)[to.lane];
    const Real difference = points.at(tag, from.batch, component)[from.lane] - a;
    a += share * difference;
    return difference;
  };
  Real dx[dim], dv[dim];
  for (int d = 0; d < dim; ++d) dx[d] = blend(field::position, d);
  for (int d = 0; d < dim; ++d) dv[d] = blend(field::velocity, d);
  if constexpr (Fields::template has<field::Affine>)
    for (int d = 0; d < dim; ++d)
      for (int e = 0; e < dim; ++e) {
        blend(field::affine, d * dim + e);
        if constexpr (!M::Transfer::stores_gradient)
          points.at(field::affine, to.batch, d * dim + e)[to.lane] +=
              share * (1 - share) * dv[d] * dx[e];
      }
  if constexpr (Fields::template has<field::ViscousStress>)
    for (int i = 0; i < State<M>::stress_size; ++i) blend(field::viscous_stress, i);
  blend(field::liquid_pressure, 0);
  mass = total;
  points.at(field::volume, to.batch)[to.lane] =
      total / (state.water.density * std::exp(points.at(field::liquid_pressure, to.batch)[to.lane] /
                                              state.water.bulk_modulus));
  points.remove(from.batch, from.lane);
}

/// Whether a listed point has not been merged away.
template <class M>
bool exists(const State<M>& state, const FreePoint& p) {
  return state.liquid.at(field::id, p.batch)[p.lane] >= 0;
}

/// Points of a cell lighter than this [full points] join their nearest neighbour that stays light enough not
/// to be split.
template <class M>
void merge_light(State<M>& state, std::span<const FreePoint> cell, Real below) {
  const Resampling& o = state.options.resampling;
  const auto mass = [&](const FreePoint& p) {
    return state.liquid.at(field::mass, p.batch)[p.lane];
  };
  for (const FreePoint& light : cell) {
    const auto x = position_of(state, light);
    const Real full = full_point_mass(state, x);
    if (!exists(state, light) || mass(light) >= below * full) continue;
    const FreePoint* nearest = nullptr;
    Real best = 0;
    for (const FreePoint& other : cell) {
      if (&other == &light || !exists(state, other)) continue;
      if (mass(light) + mass(other) > o.split_above * full) continue;
      const Real distance = (position_of(state, other) - x).norm();
      if (nearest && distance >= best) continue;
      nearest = &other;
      best = distance;
    }
    if (nearest) merge_points(state, light, *nearest);
  }
}

/// Offset along an axis at which a point may be halved: a quarter of the spacing of full points, less
/// where the cell ends; 0 if there is no room.
template <class M>
Real split_offset(const State<M>& state, const Vec<State<M>::dim>& x, int axis) {
  const Real h = state.grid.cell_size();
  const Real spacing = h / state.options.resampling.points_per_axis;
  const Real in_cell = x[axis] - state.grid.origin()[axis] - state.grid.cell_of(x[axis], axis) * h;
  const Real room = 0.999 * std::min(in_cell, h - in_cell);
  const Real offset = std::min(0.25 * spacing, room);
  return offset >= spacing / 16 ? offset : 0;
}

/// Axis along which the halves of a point keep farthest from the others of its cell; -1: no room.
template <class M>
int split_axis(const State<M>& state, std::span<const FreePoint> cell, const FreePoint& heavy) {
  constexpr int dim = State<M>::dim;
  const auto x = position_of(state, heavy);
  int best_axis = -1;
  Real best = 0;
  for (int d = 0; d < dim; ++d) {
    const Real offset = split_offset(state, x, d);
    Real distance = 2 * offset;
    for (const FreePoint& other : cell) {
      if (&other == &heavy || !exists(state, other)) continue;
      for (const int sign : {-1, 1}) {
        Vec<dim> half = x;
        half[d] += sign * offset;
        distance = std::min(distance, (position_of(state, other) - half).norm());
      }
    }
    if (offset > 0 && distance > best) {
      best = distance;
      best_axis = d;
    }
  }
  return best_axis;
}

/// Halves a point: the new half is put at x, with the velocity and all else of the old one.
template <class M>
void halve_point(State<M>& state, const FreePoint& p, const Vec<State<M>::dim>& x) {
  using Fields = typename State<M>::Liquid::fields;
  auto& points = state.liquid;
  points.at(field::mass, p.batch)[p.lane] *= 0.5;
  points.at(field::volume, p.batch)[p.lane] *= 0.5;
  std::array<double, static_cast<std::size_t>(Fields::total)> half{};
  points.read(p.batch, p.lane, half);
  half[static_cast<std::size_t>(Fields::template offset<field::Id>())] =
      static_cast<Real>(state.next_liquid_id++);
  for (int d = 0; d < State<M>::dim; ++d)
    half[static_cast<std::size_t>(Fields::template offset<field::Position>() + d)] = x[d];
  points.append(half, state.free_group());
}

/// Heavy points of a cell are halved; both halves move on with the same velocity.
template <class M>
void split_heavy(State<M>& state, std::span<const FreePoint> cell) {
  for (const FreePoint& heavy : cell) {
    if (!exists(state, heavy)) continue;
    auto x = position_of(state, heavy);
    const Real mass = state.liquid.at(field::mass, heavy.batch)[heavy.lane];
    if (mass <= state.options.resampling.split_above * full_point_mass(state, x)) continue;
    const int axis = split_axis(state, cell, heavy);
    if (axis < 0) continue;
    const Real offset = split_offset(state, x, axis), middle = x[axis];
    x[axis] = middle + offset;
    halve_point(state, heavy, x);
    state.liquid.at(field::position, heavy.batch, axis)[heavy.lane] = middle - offset;
  }
}

/// Calls f(points) for the points of every cell in a list.
template <class F>
void for_points_of_cells(std::span<const FreePoint> list, F&& f) {
  for (std::size_t begin = 0, end = 0; begin < list.size(); begin = end) {
    while (end < list.size() && list[end].cell == list[begin].cell) ++end;
    f(list.subspan(begin, end - begin));
  }
}

/// Merges and splits where needed, by the cells of the last step; new points join at the next sort.
template <class M>
void resample_water(State<M>& state, std::span<const FreePoint> list) {
  for_points_of_cells(list, [&](std::span<const FreePoint> cell) {
    merge_light(state, cell, state.options.resampling.merge_below);
    split_heavy(state, cell);
  });
}

}  // namespace vadose::detail
