// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Springs: free water that soil feeds. The points of the cell at the ground take what comes out of the soil
/// and move on with it; where they have left the ground, the heaviest of them leaves half of its water
/// behind as a new point. (Without it the cell at the ground would run empty, and the water above fall back.)

#include <vadose/solver/resample_water.hpp>

namespace vadose::detail {

/// A place for a point at a face, in the middle of its part of the face.
template <int Dim>
struct SpringPlace {
  Vec<Dim> x;
  int axis;      ///< across the face
  Real spacing;  ///< of full points [m]

  /// Whether one of the points is within `depth` spacings of the face, opposite this part of it.
  template <class M>
  bool has_point(const State<M>& state, std::span<const FreePoint> points, Real depth) const {
    return std::any_of(points.begin(), points.end(), [&](const FreePoint& p) {
      if (!exists(state, p)) return false;
      const auto away = (position_of(state, p) - x).cwiseAbs().eval();
      for (int d = 0; d < Dim; ++d)
        if (away[d] >= (d == axis ? depth - 0.5 : 0.5) * spacing) return false;
      return true;
    });
  }
};

/// The point that leaves half of its water at a place: the heaviest of the cell, if all have left the face and
/// it is heavy, or if all are about to leave the cell. nullptr: none. (Measured on U-tubes: at 1.5 instead of
/// 1.1 full points the cell may run empty before a point is heavy enough.)
template <class M>
const FreePoint* spring_point(const State<M>& state, std::span<const FreePoint> points,
                              const SpringPlace<State<M>::dim>& place) {
  constexpr Real heavy = 1.1, light = 0.5;  // [full points]
  if (place.has_point(state, points, 1)) return nullptr;
  const auto mass = [&](const FreePoint& p) {
    return exists(state, p) ? state.liquid.at(field::mass, p.batch)[p.lane] : 0;
  };
  const auto most =
      std::max_element(points.begin(), points.end(),
                       [&](const FreePoint& a, const FreePoint& b) { return mass(a) < mass(b); });
  if (most == points.end()) return nullptr;
  const Real least = place.has_point(state, points, 1.25) ? heavy : light;
  return mass(*most) > least * full_point_mass(state, place.x) ? &*most : nullptr;
}

/// Gives the face that feeds a cell the points that have left it.
template <class M>
void release_at_face(State<M>& state, std::span<const FreePoint> points,
                     const Index<State<M>::dim>& cell, int axis, bool at_low_side) {
  constexpr int dim = State<M>::dim;
  const int per_axis = state.options.resampling.points_per_axis;
  SpringPlace<dim> place{{}, axis, state.grid.cell_size() / per_axis};
  int parts = 1;
  for (int d = 1; d < dim; ++d) parts *= per_axis;
  for (int i = 0; i < parts; ++i) {
    int rest = i;
    for (int d = 0; d < dim; ++d) {
      int k = at_low_side ? 0 : per_axis - 1;
      if (d != axis) k = rest % per_axis, rest /= per_axis;
      place.x[d] =
          state.grid.origin()[d] + cell[d] * state.grid.cell_size() + (k + 0.5) * place.spacing;
    }
    if (const FreePoint* p = spring_point(state, points, place)) halve_point(state, *p, place.x);
  }
}

/// Points of a cell lighter than this, which the soil has drunk, join a neighbour [full points].
inline constexpr Real remnant = 0.05;

/// Renews the points of a cell at the ground, by the fluxes of the last step; new points join at the next
/// sort.
template <class M>
void renew_at_ground(State<M>& state, std::span<const FreePoint> points) {
  constexpr int dim = State<M>::dim;
  const std::int32_t owner = state.nodes.dof[static_cast<std::size_t>(points.front().cell)];
  if (owner < 0) return;
  const auto& cell = state.nodes.cell[static_cast<std::size_t>(owner)];
  const int axis = cell.ground_axis;
  if (axis < 0) return;
  merge_light(state, points, remnant);
  if (!cell.is_fed) return;
  const auto x = position_of(state, points.front());
  Index<dim> index;
  for (int d = 0; d < dim; ++d) index[d] = state.grid.cell_of(x[d], d);
  const Real h = state.grid.cell_size();
  const Real low = (cell.ground - state.grid.origin()[axis]) / h - index[axis];
  if (std::fabs(low) < 0.01) release_at_face(state, points, index, axis, true);
  if (std::fabs(low - 1) < 0.01) release_at_face(state, points, index, axis, false);
}

/// Free points come and go with the sort: springs, and merge and split where they are asked for.
template <class M>
void renew_free_points(State<M>& state) {
  const bool resamples = state.options.resampling.on;
  if (!has_skeleton<M> && !resamples) return;
  const std::vector<FreePoint> points = list_free_points(state);
  const std::span<const FreePoint> list(points);
  if (list.empty()) return;
  if (resamples) resample_water(state, list);
  if constexpr (has_skeleton<M>) {
    for_points_of_cells(list,
                        [&](std::span<const FreePoint> cell) { renew_at_ground(state, cell); });
  }
}

}  // namespace vadose::detail
