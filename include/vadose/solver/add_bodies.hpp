// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Points that come and go between steps by the will of the host.

#include <string>
#include <vector>

#include <vadose/solver/assemble.hpp>

namespace vadose {

/// Numbers of points.
struct PointCount {
  std::size_t solid = 0;   ///< solid points
  std::size_t liquid = 0;  ///< liquid points
};

namespace detail {

/// Soil of the run for every material of another scene, by name; refuses what does not fit.
template <class M>
std::vector<int> groups_of(const State<M>& state, const Scene<M>& more) {
  constexpr int dim = State<M>::dim;
  bool same = more.cell_size() == state.grid.cell_size();
  for (int d = 0; d < dim; ++d)
    same = same && more.box().low[d] == state.grid.origin()[d] &&
           more.cells()[static_cast<std::size_t>(d)] == state.grid.cells()[d];
  if (!same) throw SetupError("box or cell_size of the points to add differ from those of the run");
  std::vector<int> groups;
  if constexpr (has_skeleton<M>) {
    for (const auto& material : more.materials()) {
      int found = -1;
      std::string known;
      for (std::size_t i = 0; i < state.soils.size(); ++i) {
        known += (i == 0 ? "'" : ", '") + state.soils[i].material.name + "'";
        if (state.soils[i].material.name == material.name && found < 0) found = static_cast<int>(i);
      }
      if (found < 0)
        throw SetupError(material.label() + " outside {" + known +
                         "} of the run: its points cannot be added");
      groups.push_back(found);
    }
  }
  return groups;
}

/// Appends the points of all bodies of a scene; solid ids start at `first_solid`.
template <class M>
PointCount append_bodies(State<M>& state, const Scene<M>& more, const std::vector<int>& groups,
                         std::size_t first_solid) {
  const InitialState<M> initial = more.initial_state();
  auto next_solid = static_cast<std::int64_t>(first_solid);
  const std::int64_t first_liquid = state.next_liquid_id;
  if constexpr (has_skeleton<M>) {
    for (std::size_t i = 0; i < more.soils().size(); ++i)
      seed_soil(state, more, initial, static_cast<int>(i),
                groups[static_cast<std::size_t>(more.soils()[i].material)], next_solid,
                state.next_liquid_id);
  }
  if constexpr (has_liquid<M>) {
    for (std::size_t i = 0; i < more.waters().size(); ++i)
      seed_water(state, more, initial, static_cast<int>(i), state.next_liquid_id);
  }
  return {static_cast<std::size_t>(next_solid) - first_solid,
          static_cast<std::size_t>(state.next_liquid_id - first_liquid)};
}

/// Removes the points of one set that lie in a region; returns how many.
template <int Dim, class Fields>
std::size_t remove_points(PointSet<Dim, Fields>& points, const Region<Dim>& region) {
  const std::size_t before = points.size();
  points.for_each([&](std::size_t b, int l) {
    Vec<Dim> x;
    for (int d = 0; d < Dim; ++d) x[d] = points.at(field::position, b, d)[l];
    if (region.contains(x)) points.remove(b, l);
  });
  return before - points.size();
}

}  // namespace detail
}  // namespace vadose
