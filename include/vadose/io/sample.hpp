// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Values of a run at points and positions, for files and gauges. Everything here only reads.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <vadose/core/sym_tensor.hpp>
#include <vadose/kernel/state.hpp>

namespace vadose::io {

/// Where a point is stored at the moment. Valid until the next step.
struct PointPlace {
  std::int64_t id = -1;   ///< number of the point; -1: none
  std::size_t batch = 0;  ///< where it is
  int lane = 0;           ///< and which of eight
};

/// Places of all points, ordered by id: files of different runs and times are comparable.
template <class Points>
std::vector<PointPlace> places_by_id(const Points& points) {
  std::vector<PointPlace> places;
  places.reserve(points.size());
  points.for_each([&](std::size_t b, int l) {
    places.push_back({static_cast<std::int64_t>(points.at(field::id, b)[l]), b, l});
  });
  std::sort(places.begin(), places.end(),
            [](const PointPlace& a, const PointPlace& b) { return a.id < b.id; });
  return places;
}

/// Position of a point [m].
template <int Dim, class Points>
Vec<Dim> position_of(const Points& points, const PointPlace& place) {
  Vec<Dim> x;
  for (int d = 0; d < Dim; ++d) x[d] = points.at(field::position, place.batch, d)[place.lane];
  return x;
}

/// The point nearest to x [m] of all points; of equally near ones that of the smallest id.
template <int Dim, class Points>
std::optional<PointPlace> nearest_of_all(const Points& points, const Vec<Dim>& x, Real cell_size) {
  std::optional<PointPlace> best;
  Real distance = std::numeric_limits<Real>::infinity();
  const Real tie = 1e-9 * cell_size;
  for (const PointPlace& place : places_by_id(points)) {
    const Real d = (position_of<Dim>(points, place) - x).norm();
    if (d < distance - tie) {
      distance = d;
      best = place;
    }
  }
  return best;
}

/// Finds points near a position: those in its cell and in the cells around it.
template <int Dim, class Points>
class NearbyPoints {
 public:
  /// For one state of a run: not valid after its next step.
  NearbyPoints(const BlockGrid<Dim>& grid, const Points& points)
      : grid_(grid), points_(points), first_(grid.size(), -1), places_(places_by_id(points)) {
    next_.reserve(places_.size());
    for (const PointPlace& place : places_) {
      const Index<Dim> cell = cell_of(position_of<Dim>(points, place));
      std::int32_t& first = first_[static_cast<std::size_t>(grid.entry(cell))];
      next_.push_back(first);
      first = static_cast<std::int32_t>(next_.size()) - 1;
    }
  }

  /// The nearest point in the cell of x [m] and its neighbours; nothing if there is none.
  std::optional<PointPlace> nearest(const Vec<Dim>& x) const {
    std::optional<PointPlace> best;
    Real distance = std::numeric_limits<Real>::infinity();
    const Real tie = 1e-9 * grid_.cell_size();
    const Index<Dim> middle = cell_of(x);
    for_cube<Dim>(-1, 2, [&](const Index<Dim>& step) {
      Index<Dim> cell = middle;
      for (int d = 0; d < Dim; ++d) cell[d] += step[d];
      std::int32_t i = first_[static_cast<std::size_t>(grid_.entry(cell))];
      for (; i >= 0; i = next_[static_cast<std::size_t>(i)]) {
        const PointPlace& place = places_[static_cast<std::size_t>(i)];
        const Real d = (position_of<Dim>(points_, place) - x).norm();
        const bool tied = best && std::fabs(d - distance) <= tie;
        if (tied ? place.id > best->id : d > distance) continue;
        distance = d;
        best = place;
      }
    });
    return best;
  }

 private:
  Index<Dim> cell_of(const Vec<Dim>& x) const {
    Index<Dim> cell;
    for (int d = 0; d < Dim; ++d) cell[d] = grid_.cell_of(x[d], d);
    return cell;
  }

  const BlockGrid<Dim>& grid_;
  const Points& points_;
  std::vector<std::int32_t> first_;  ///< first point of each cell entry
  std::vector<std::int32_t> next_;   ///< next point of the same cell
  std::vector<PointPlace> places_;
};

/// s = max(0, -p) [Pa].
inline Real suction_of(Real liquid_pressure) noexcept {
  return liquid_pressure < 0 ? -liquid_pressure : 0;
}

/// Porosity of a liquid point: n of pore water, 1 of free water [-].
template <class M>
Real liquid_point_porosity(const State<M>& state, const PointPlace& place) {
  if constexpr (State<M>::Liquid::fields::template has<field::Porosity>)
    return state.liquid.at(field::porosity, place.batch)[place.lane];
  else
    return 1;
}

/// Degree of saturation of a liquid point, S = m / (rho_l(p) n V) [-]: exact from the water it
/// carries. It is not cut at 1: points of a saturated cell share its water to round-off only.
template <class M>
Real liquid_point_saturation(const State<M>& state, const PointPlace& place) {
  const auto value = [&](auto tag) { return state.liquid.at(tag, place.batch)[place.lane]; };
  const Real density =
      state.water.density * std::exp(value(field::liquid_pressure) / state.water.bulk_modulus);
  return value(field::mass) /
         (density * liquid_point_porosity(state, place) * value(field::volume));
}

/// Water at a position; NaN where there is none.
struct WaterSample {
  Real pressure = unset;    ///< p, compression + [Pa]
  Real saturation = unset;  ///< S [-]
};

/// Liquid pressure and saturation at positions.
template <class M>
class WaterSampler {
 public:
  static constexpr int dim = State<M>::dim;

  /// Reads `state` while it lives; the state must not change meanwhile.
  explicit WaterSampler(const State<M>& state) : state_(state) {}

  /// Water at x [m]: p = p_c + rho_l g . (x - x_c) and S of the pressure cell of the last step that
  /// x lies in. Before the first step (also after equilibrate(), which gives the points the water of
  /// their pressure and leaves the cells as they were), and where the cell had no water then, that of
  /// the nearest liquid point in the cells around.
  WaterSample at(const Vec<dim>& x) const {
    Index<dim> index;
    for (int d = 0; d < dim; ++d) index[d] = state_.grid.cell_of(x[d], d);
    const auto entry = static_cast<std::size_t>(state_.grid.entry(index));
    const auto& nodes = state_.nodes;
    if (state_.step > 0 && entry < nodes.dof.size() && nodes.dof[entry] >= 0) {
      const auto& cell = nodes.cell[static_cast<std::size_t>(nodes.dof[entry])];
      WaterSample sample{cell.pressure, cell.saturation};
      for (int d = 0; d < dim; ++d)
        sample.pressure += state_.water.density * state_.gravity[d] * (x[d] - cell.centroid[d]);
      return sample;
    }
    return from_points(x);
  }

 private:
  WaterSample from_points(const Vec<dim>& x) const {
    if (!nearby_) nearby_.emplace(state_.grid, state_.liquid);
    const auto place = nearby_->nearest(x);
    if (!place) return {};
    WaterSample sample{state_.liquid.at(field::liquid_pressure, place->batch)[place->lane],
                       liquid_point_saturation(state_, *place)};
    const Vec<dim> offset = x - position_of<dim>(state_.liquid, *place);
    for (int d = 0; d < dim; ++d)
      sample.pressure += state_.water.density * state_.gravity[d] * offset[d];
    return sample;
  }

  const State<M>& state_;
  mutable std::optional<NearbyPoints<dim, typename State<M>::Liquid>> nearby_;
};

/// Porosity of a solid point, n = 1 - m / (rho_s V) [-].
template <class M>
Real solid_point_porosity(const State<M>& state, const PointPlace& place) {
  const auto& material =
      state.soils[static_cast<std::size_t>(state.solid.group(place.batch))].material;
  if constexpr (is_rigid<M>)
    return material.porosity;
  else
    return 1 -
           state.solid.at(field::mass, place.batch)[place.lane] /
               (material.solid_density * state.solid.at(field::volume, place.batch)[place.lane]);
}

/// Bishop stress of a solid point [Pa], tension +.
template <class M>
SymTensor<Real, State<M>::stress_size> solid_point_stress(const State<M>& state,
                                                          const PointPlace& place) {
  SymTensor<Real, State<M>::stress_size> stress;
  for (int i = 0; i < State<M>::stress_size; ++i)
    stress[i] = state.solid.at(field::bishop_stress, place.batch, i)[place.lane];
  return stress;
}

/// Deviatoric (von Mises) stress sqrt(3/2) |s| [Pa], >= 0; sigma_1 - sigma_3 in triaxial states.
template <int N>
Real deviatoric_stress(const SymTensor<Real, N>& stress) {
  return std::sqrt(1.5) * stress.deviator().norm();
}

}  // namespace vadose::io
