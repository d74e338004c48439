// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The points of a run over time, and the grid if wanted, as VTK files for ParaView.

#include <algorithm>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include <vadose/io/pvd_series.hpp>
#include <vadose/io/sample.hpp>
#include <vadose/io/vtk_grid.hpp>
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

/// The host's own fields.
template <class UserFields, class Points, class Columns>
void add_user_fields(Columns& columns, const Points& points) {
  UserFields::for_each([&](auto tag, int components) {
    using Tag = decltype(tag);
    columns.add(Tag::name, Tag::unit, components, [&](const PointPlace& p, Real* value) {
      for (int c = 0; c < components; ++c) value[c] = points.at(tag, p.batch, c)[p.lane];
    });
  });
}

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
  add_user_fields<typename vadose::detail::SolidUserFieldsOf<M>::type>(columns, state.solid);
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
  add_user_fields<typename vadose::detail::LiquidUserFieldsOf<M>::type>(columns, state.liquid);
}

/// Values of the cells and nodes of the blocks that exist, in the smallest part of the grid that
/// holds them; NaN where there is none.
template <class M>
class GridColumns {
 public:
  static constexpr int dim = State<M>::dim;

  GridColumns(const State<M>& state, const std::vector<std::string>& wanted)
      : state_(state), wanted_(wanted) {
    const auto& grid = state.grid;
    part_.dim = dim;
    part_.cell_size = grid.cell_size();
    for (int d = 0; d < dim; ++d) {
      const auto at = static_cast<std::size_t>(d);
      part_.origin[at] = grid.origin()[d];
      part_.low[at] = grid.cells()[d];
      part_.high[at] = 0;
      for (int s = 0; s < grid.slots(); ++s) {
        part_.low[at] = std::min(part_.low[at], grid.first_cell(s)[d]);
        part_.high[at] = std::max(part_.high[at], grid.first_cell(s)[d] + Block<dim>::edge);
      }
      part_.high[at] = std::max(std::min(part_.high[at], grid.cells()[d]), part_.low[at]);
    }
  }

  /// A column with f(entry of an existing cell or node, its coordinates, values).
  template <class F>
  void add(std::vector<Column>& list, const std::string& name, const std::string& unit,
           int components, F&& f) {
    known_.push_back(name);
    if (!wanted_.empty() && std::find(wanted_.begin(), wanted_.end(), name) == wanted_.end())
      return;
    const bool nodes = &list == &nodes_;
    const auto size = static_cast<std::size_t>(components);
    Column column{name + " [" + unit + "]", components,
                  std::vector<Real>(size * part_.count(nodes), unset)};
    for (std::size_t i = 0; i < part_.count(nodes); ++i) {
      const Index<dim> at = coordinates(i, nodes);
      const std::int32_t entry = state_.grid.entry(at);
      if (entry != state_.grid.outside())
        f(static_cast<std::size_t>(entry), at, column.values.data() + size * i);
    }
    list.push_back(std::move(column));
  }

  /// All columns that the model has.
  void add_all() {
    if constexpr (has_liquid<M>) add_cells();
    if constexpr (is_deformable<M>) add_velocity("solid_velocity", state_.nodes.solid_out);
    if constexpr (has_liquid<M>) add_velocity("liquid_velocity", state_.nodes.liquid_out);
  }

  const GridPart& part() const noexcept { return part_; }
  const std::vector<Column>& cells() const noexcept { return cells_; }
  const std::vector<Column>& nodes() const noexcept { return nodes_; }
  const std::vector<std::string>& known() const noexcept { return known_; }

 private:
  Index<dim> coordinates(std::size_t number, bool nodes) const {
    Index<dim> at;
    for (int d = 0; d < dim; ++d) {
      const auto axis = static_cast<std::size_t>(d);
      const auto length =
          static_cast<std::size_t>(part_.high[axis] - part_.low[axis] + (nodes ? 1 : 0));
      at[d] = part_.low[axis] + static_cast<int>(number % length);
      number /= length;
    }
    return at;
  }
  /// A column of what f(cell) says of the pressure cell.
  template <class F>
  void add_cell(const std::string& name, const std::string& unit, F&& f) {
    add(cells_, name, unit, 1, [&](std::size_t entry, const Index<dim>& at, Real* value) {
      const std::int32_t owner = state_.nodes.dof[entry];
      if (owner >= 0) *value = f(state_.nodes.cell[static_cast<std::size_t>(owner)], at);
    });
  }
  void add_cells() {
    add_cell("cell_pressure", "Pa", [&](const auto& cell, const Index<dim>& at) {
      Real p = cell.pressure;
      for (int d = 0; d < dim; ++d)
        p += state_.water.density * state_.gravity[d] *
             (state_.grid.origin()[d] + (at[d] + 0.5) * state_.grid.cell_size() - cell.centroid[d]);
      return p;
    });
    add_cell("cell_saturation", "-", [](const auto& cell, const auto&) { return cell.saturation; });
    add_cell("cell_porosity", "-", [](const auto& cell, const auto&) { return cell.porosity; });
    add_cell("cell_kind", "-",
             [](const auto& cell, const auto&) { return cell.kind == CellKind::free ? 1.0 : 0.0; });
  }
  void add_velocity(const std::string& name, const AlignedVector<Record>& records) {
    add(nodes_, name, "m/s", 3, [&](std::size_t entry, const Index<dim>&, Real* v) {
      for (int d = 0; d < 3; ++d) v[d] = d < dim ? records[entry][lane::velocity + d] : 0;
    });
  }

  const State<M>& state_;
  const std::vector<std::string>& wanted_;
  GridPart part_;
  std::vector<Column> cells_, nodes_;
  std::vector<std::string> known_;
};

}  // namespace detail

/// Files "<base>_solid_000000.vtp", "<base>_liquid_000000.vtp", ..., listed over time in
/// "<base>_solid.pvd" and "<base>_liquid.pvd". A phase that the model has not gets no file.
/// Points are ordered by id; lanes without a point are not written.
///
/// Solid: id, material (number of the soil), porosity, velocity, displacement, bishop_stress (xx yy
/// zz xy yz zx, missing shears 0), mean_stress, deviatoric_stress (von Mises), outputs of the law,
/// liquid_pressure, suction, saturation (see WaterSampler). Liquid: id, kind (0 pore water, 1 free
/// water), velocity, mass, liquid_pressure, saturation, porosity. Both: the host's own fields. Stress
/// is tension positive, liquid pressure compression positive.
///
/// With the grid: "<base>_grid_000000.vti", ... and "<base>_grid.pvd" with cell_pressure (at the
/// centre), cell_saturation, cell_porosity, cell_kind (0 soil, 1 free water) of the pressure cells and
/// solid_velocity, liquid_velocity of the nodes, as the last step left them (nodes: 0 before the first
/// step and after a restart), NaN where there is nothing.
class VtkSeries {
 public:
  /// Whether cells and nodes are written too.
  enum class Grid : bool { no, yes };

  /// `base`: path without extension. `columns`: names (without unit) to be written; empty: all.
  explicit VtkSeries(std::string base, std::vector<std::string> columns = {}, Grid grid = Grid::no)
      : solid_(base + "_solid"),
        liquid_(base + "_liquid"),
        grid_(base + "_grid", ".vti"),
        base_(std::move(base)),
        wanted_(std::move(columns)),
        with_grid_(grid == Grid::yes) {}

  /// After a restart: goes on with the series of an earlier run. See PvdSeries::resume.
  void resume(Real time) {
    solid_.resume(time);
    liquid_.resume(time);
    grid_.resume(time);
  }

  /// Writes the state of a Solver at its time. Raises OutputError, also for a wanted column that
  /// the model does not have; then nothing is written.
  template <class S>
  void write(const S& solver) {
    write(solver, solver.state());
  }

  const PvdSeries& solid() const noexcept { return solid_; }    ///< files of the solid points
  const PvdSeries& liquid() const noexcept { return liquid_; }  ///< files of the liquid points
  const PvdSeries& grid() const noexcept { return grid_; }      ///< files of the grid

 private:
  template <class S, class M>
  void write(const S& solver, const State<M>& state) {
    constexpr int dim = State<M>::dim;
    detail::PointColumns solid(state.solid, dim, wanted_);
    detail::PointColumns liquid(state.liquid, dim, wanted_);
    if constexpr (has_skeleton<M>) detail::add_solid_columns(solid, solver, state);
    if constexpr (has_liquid<M>) detail::add_liquid_columns(liquid, state);
    detail::GridColumns<M> grid(state, wanted_);
    if (with_grid_) grid.add_all();
    check_wanted({solid.known(), liquid.known(), grid.known()});
    const std::string text = comment(M::Kinematics::axisymmetric);
    if constexpr (has_skeleton<M>)
      solid_.write(solver.time(), dim, solid.positions(), solid.columns(), "solid points; " + text);
    if constexpr (has_liquid<M>)
      liquid_.write(solver.time(), dim, liquid.positions(), liquid.columns(),
                    "liquid points; " + text);
    if (with_grid_)
      grid_.add(solver.time(), [&](const std::string& file) {
        write_vti(file, grid.part(), grid.cells(), grid.nodes(), "cells and nodes; " + text);
      });
  }

  void check_wanted(std::initializer_list<std::vector<std::string>> lists) const {
    std::vector<std::string> known;
    for (const auto& list : lists) known.insert(known.end(), list.begin(), list.end());
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

  PvdSeries solid_, liquid_, grid_;
  std::string base_;
  std::vector<std::string> wanted_;
  bool with_grid_;
};

}  // namespace vadose::io
