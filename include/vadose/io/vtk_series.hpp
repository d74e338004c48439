// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The points of a run over time as VTK files for ParaView.

#include <string>
#include <utility>
#include <vector>

#include <vadose/io/pvd_series.hpp>
#include <vadose/io/sample.hpp>
#include <vadose/policy/law/law_concept.hpp>

namespace vadose::io {

namespace detail {

/// Columns of one phase: those of `wanted` names, or all if it is empty.
template <class Points>
class PointColumns {
 public:
  PointColumns(const Points& points, int dim, const std::vector<std::string>& wanted)
      : points_(points), dim_(dim), wanted_(wanted), places_(places_by_id(points)) {}

  /// A column whose values f(place, values of the point) writes.
  template <class F>
  void add(const std::string& name, const std::string& unit, int components, F&& f) {
    known_.push_back(name);
    if (!wanted_.empty() && std::find(wanted_.begin(), wanted_.end(), name) == wanted_.end())
      return;
    const auto size = static_cast<std::size_t>(components);
    Column column{name + " [" + unit + "]", components,
                  std::vector<Real>(size * places_.size(), Real(0))};
    for (std::size_t i = 0; i < places_.size(); ++i) f(places_[i], column.values.data() + i * size);
    columns_.push_back(std::move(column));
  }
  /// A column of one value f(place).
  template <class F>
  void add_scalar(const std::string& name, const std::string& unit, F&& f) {
    add(name, unit, 1, [&](const PointPlace& place, Real* value) { *value = f(place); });
  }
  /// The first component of a stored field.
  template <class Tag>
  void add_field(Tag tag, const std::string& unit) {
    add_scalar(Tag::name, unit,
               [&](const PointPlace& p) { return points_.at(tag, p.batch)[p.lane]; });
  }
  /// Velocities, with three components.
  void add_velocity() {
    add("velocity", "m/s", 3, [&](const PointPlace& p, Real* v) {
      for (int d = 0; d < dim_; ++d) v[d] = points_.at(field::velocity, p.batch, d)[p.lane];
    });
  }

  /// Coordinates, dim per point.
  std::vector<Real> positions() const {
    std::vector<Real> x;
    x.reserve(places_.size() * static_cast<std::size_t>(dim_));
    for (const PointPlace& p : places_)
      for (int d = 0; d < dim_; ++d) x.push_back(points_.at(field::position, p.batch, d)[p.lane]);
    return x;
  }
  const std::vector<Column>& columns() const noexcept { return columns_; }
  const std::vector<std::string>& known() const noexcept { return known_; }

 private:
  const Points& points_;
  int dim_;
  const std::vector<std::string>& wanted_;
  std::vector<PointPlace> places_;
  std::vector<Column> columns_;
  std::vector<std::string> known_;
};

/// p, s and S where the solid points are.
template <class M, class Columns>
void add_water_at_solid(Columns& columns, const State<M>& state) {
  constexpr int dim = State<M>::dim;
  const WaterSampler<M> water(state);
  const auto at = [&](const PointPlace& p) { return water.at(position_of<dim>(state.solid, p)); };
  columns.add_scalar("liquid_pressure", "Pa", [&](const PointPlace& p) { return at(p).pressure; });
  columns.add_scalar("suction", "Pa",
                     [&](const PointPlace& p) { return suction_of(at(p).pressure); });
  columns.add_scalar("saturation", "-", [&](const PointPlace& p) { return at(p).saturation; });
}

/// Motion, stress and law state of solid points.
template <class S, class M, class Columns>
void add_deformation(Columns& columns, const S& solver, const State<M>& state) {
  columns.add_velocity();
  columns.add("displacement", "m", 3, [&](const PointPlace& p, Real* u) {
    const auto moved = solver.displacement(p.batch, p.lane);
    for (int d = 0; d < State<M>::dim; ++d) u[d] = moved[d];
  });
  columns.add("bishop_stress", "Pa", 6, [&](const PointPlace& p, Real* value) {
    const auto stress = solid_point_stress(state, p);
    for (int i = 0; i < stress.size; ++i) value[i] = stress[i];
  });
  columns.add_scalar("mean_stress", "Pa",
                     [&](const PointPlace& p) { return solid_point_stress(state, p).mean(); });
  columns.add_scalar("deviatoric_stress", "Pa", [&](const PointPlace& p) {
    return deviatoric_stress(solid_point_stress(state, p));
  });
  for (const auto& output : law::outputs<typename M::Skeleton>()) {
    if constexpr (law::state_size < typename M::Skeleton >> 0)
      columns.add_scalar(output.name, output.unit, [&](const PointPlace& p) {
        return state.solid.at(field::law_state, p.batch, output.index)[p.lane];
      });
  }
}

/// All columns of the solid points.
template <class S, class M, class Columns>
void add_solid_columns(Columns& columns, const S& solver, const State<M>& state) {
  columns.add_field(field::id, "-");
  columns.add_scalar("material", "-", [&](const PointPlace& p) {
    return static_cast<Real>(state.solid.group(p.batch));
  });
  columns.add_scalar("porosity", "-",
                     [&](const PointPlace& p) { return solid_point_porosity(state, p); });
  if constexpr (is_deformable<M>) add_deformation(columns, solver, state);
  if constexpr (has_liquid<M>) add_water_at_solid(columns, state);
}

/// All columns of the liquid points.
template <class M, class Columns>
void add_liquid_columns(Columns& columns, const State<M>& state) {
  columns.add_field(field::id, "-");
  columns.add_scalar("kind", "-", [&](const PointPlace& p) {
    return state.liquid.group(p.batch) == state.free_group() ? Real(1) : Real(0);
  });
  columns.add_velocity();
  columns.add_field(field::mass, "kg");
  columns.add_field(field::liquid_pressure, "Pa");
  columns.add_scalar("saturation", "-",
                     [&](const PointPlace& p) { return liquid_point_saturation(state, p); });
  columns.add_scalar("porosity", "-",
                     [&](const PointPlace& p) { return liquid_point_porosity(state, p); });
}

}  // namespace detail

/// Files "<base>_solid_000000.vtp", "<base>_liquid_000000.vtp", ..., listed over time in
/// "<base>_solid.pvd" and "<base>_liquid.pvd". A phase that the model has not gets no file.
/// Points are ordered by id; lanes without a point are not written.
///
/// Solid: id, material (number of the soil), porosity, velocity, displacement, bishop_stress (xx yy
/// zz xy yz zx, missing shears 0), mean_stress, deviatoric_stress (von Mises), outputs of the law,
/// liquid_pressure, suction, saturation (see WaterSampler). Liquid: id, kind (0 pore water, 1 free
/// water), velocity, mass, liquid_pressure, saturation, porosity. Stress is tension positive,
/// liquid pressure compression positive.
class VtkSeries {
 public:
  /// `base`: path without extension. `columns`: names (without unit) to be written; empty: all.
  explicit VtkSeries(std::string base, std::vector<std::string> columns = {})
      : solid_(base + "_solid"),
        liquid_(base + "_liquid"),
        base_(std::move(base)),
        wanted_(std::move(columns)) {}

  /// Writes the state of a Solver at its time. Raises OutputError, also for a wanted column that
  /// the model does not have; then nothing is written.
  template <class S>
  void write(const S& solver) {
    write(solver, solver.state());
  }

  const PvdSeries& solid() const noexcept { return solid_; }    ///< files of the solid points
  const PvdSeries& liquid() const noexcept { return liquid_; }  ///< files of the liquid points

 private:
  template <class S, class M>
  void write(const S& solver, const State<M>& state) {
    constexpr int dim = State<M>::dim;
    detail::PointColumns solid(state.solid, dim, wanted_);
    detail::PointColumns liquid(state.liquid, dim, wanted_);
    if constexpr (has_skeleton<M>) detail::add_solid_columns(solid, solver, state);
    if constexpr (has_liquid<M>) detail::add_liquid_columns(liquid, state);
    check_wanted(solid.known(), liquid.known());
    const std::string text = comment(M::Kinematics::axisymmetric);
    if constexpr (has_skeleton<M>)
      solid_.write(solver.time(), dim, solid.positions(), solid.columns(), "solid points; " + text);
    if constexpr (has_liquid<M>)
      liquid_.write(solver.time(), dim, liquid.positions(), liquid.columns(),
                    "liquid points; " + text);
  }

  void check_wanted(std::vector<std::string> known, const std::vector<std::string>& more) const {
    known.insert(known.end(), more.begin(), more.end());
    for (const std::string& name : wanted_) {
      if (std::find(known.begin(), known.end(), name) != known.end()) continue;
      std::string list;
      for (const std::string& k : known) list.append(list.empty() ? "" : ", ").append(k);
      throw OutputError("cannot write file '" + base_ + "': the model has no column '" + name +
                        "', only " + list);
    }
  }

  static std::string comment(bool axisymmetric) {
    return std::string(
               "units in brackets; stress tension positive, liquid_pressure compression positive, "
               "suction = max(0, -liquid_pressure); bishop_stress components: ") +
           (axisymmetric ? "rr, zz (axis), theta theta, rz, 0, 0"
                         : "xx, yy, zz, xy, yz, zx (tensorial shears)");
  }

  PvdSeries solid_, liquid_;
  std::string base_;
  std::vector<std::string> wanted_;
};

}  // namespace vadose::io
