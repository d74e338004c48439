// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Chosen numbers of a run over time as CSV: at positions, at material points, along lines, of the
/// whole scene.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <vadose/grid/region.hpp>
#include <vadose/io/history.hpp>
#include <vadose/io/sample.hpp>
#include <vadose/policy/law/law_concept.hpp>

namespace vadose::io {

/// What a gauge at a place measures. Values of the skeleton at a fixed position are those of the
/// nearest solid point in the cells around it; NaN where there is none.
enum class Measure {
  displacement,       ///< of the solid [m]
  velocity,           ///< of the solid [m/s]
  bishop_stress,      ///< all components, tension + [Pa]
  mean_stress,        ///< of the Bishop stress, tension + [Pa]
  deviatoric_stress,  ///< von Mises stress [Pa]
  law_outputs,        ///< numbers that the constitutive law offers
  porosity,           ///< of the solid [-]
  liquid_pressure,    ///< compression + [Pa]
  suction,            ///< max(0, -p) [Pa]
  saturation,         ///< [-]
};

/// Numbers of a whole scene.
enum class SceneMeasure {
  step,              ///< number of steps [-]
  time_step,         ///< last step [s]
  kinetic_energy,    ///< of both phases [J]
  max_displacement,  ///< largest norm over the solid points [m]
  run_out,           ///< largest first coordinate of a solid point [m]
  height,            ///< largest last coordinate of a solid point [m]
  pore_water,        ///< stored as pore water [kg]
  free_water,        ///< stored as free water [kg]
  water_inflow,      ///< so far [kg]
  water_outflow,     ///< so far [kg]
  water_closure,     ///< error of the water balance [kg]
  solid_closure,     ///< error of the balance of grains [kg]
};

namespace detail {

/// Name of a measure for heads and messages.
constexpr const char* name(Measure m) noexcept {
  constexpr const char* names[] = {
      "displacement", "velocity", "bishop_stress",   "mean_stress", "deviatoric_stress",
      "law_outputs",  "porosity", "liquid_pressure", "suction",     "saturation"};
  return names[static_cast<int>(m)];
}

/// Name and unit of a number of the scene.
inline Quantity describe(SceneMeasure m) {
  constexpr const char* names[][2] = {{"step", "-"},           {"time_step", "s"},
                                      {"kinetic_energy", "J"}, {"max_displacement", "m"},
                                      {"run_out", "m"},        {"height", "m"},
                                      {"pore_water", "kg"},    {"free_water", "kg"},
                                      {"water_inflow", "kg"},  {"water_outflow", "kg"},
                                      {"water_closure", "kg"}, {"solid_closure", "kg"}};
  const auto& n = names[static_cast<int>(m)];
  return {n[0], n[1]};
}

/// Name of an axis: x, y, z; r, z in axisymmetry.
template <class M>
std::string axis_label(int d) {
  if (M::Kinematics::axisymmetric) return d == 0 ? "r" : "z";
  return std::string(1, static_cast<char>('x' + d));
}

/// Name of a stress component.
template <class M>
std::string stress_label(int i) {
  constexpr const char* cartesian[] = {"xx", "yy", "zz", "xy", "yz", "zx"};
  constexpr const char* cylindrical[] = {"rr", "zz", "tt", "rz", "", ""};
  return M::Kinematics::axisymmetric ? cylindrical[i] : cartesian[i];
}

/// The model has what the measure asks for.
template <class M>
constexpr bool offers(Measure m) noexcept {
  switch (m) {
    case Measure::porosity:
      return has_skeleton<M>;
    case Measure::liquid_pressure:
    case Measure::suction:
    case Measure::saturation:
      return has_liquid<M>;
    default:
      return is_deformable<M>;
  }
}

/// Columns of a measure. Raises SetupError if the model has no such thing.
template <class M>
std::vector<Quantity> describe(Measure m) {
  if (!offers<M>(m))
    throw SetupError("measure = " + std::string(name(m)) +
                     " outside {measures of what the model has} [-]");
  std::vector<Quantity> columns;
  const bool vector = m == Measure::displacement || m == Measure::velocity;
  if (vector) {
    for (int d = 0; d < M::Kinematics::dim; ++d)
      columns.push_back(
          {std::string(name(m)) + "_" + axis_label<M>(d), m == Measure::velocity ? "m/s" : "m"});
  } else if (m == Measure::bishop_stress) {
    for (int i = 0; i < M::Kinematics::stress_size; ++i)
      columns.push_back({std::string(name(m)) + "_" + stress_label<M>(i), "Pa"});
  } else if (m == Measure::law_outputs) {
    if constexpr (is_deformable<M>)
      for (const auto& output : law::outputs<typename M::Skeleton>())
        columns.push_back({output.name, output.unit});
  } else {
    const bool ratio = m == Measure::porosity || m == Measure::saturation;
    columns.push_back({name(m), ratio ? "-" : "Pa"});
  }
  return columns;
}

/// Reads measures from a run; lives for one record.
template <class S, class M>
class Probe {
 public:
  static constexpr int dim = State<M>::dim;
  using Place = std::optional<PointPlace>;

  Probe(const S& solver, const State<M>& state) : solver_(solver), state_(state), water_(state) {}

  /// Solid point of an id.
  Place find(std::int64_t id) {
    if (by_id_.empty()) by_id_ = places_by_id(state_.solid);
    const auto at = std::lower_bound(by_id_.begin(), by_id_.end(), id,
                                     [](const PointPlace& p, std::int64_t i) { return p.id < i; });
    return at != by_id_.end() && at->id == id ? Place(*at) : Place();
  }
  /// Solid point near a position.
  Place near(const Vec<dim>& x) {
    if (!nearby_) nearby_.emplace(state_.grid, state_.solid);
    return nearby_->nearest(x);
  }

  /// Values at x [m] of a solid point (or of none, then NaN).
  void append(Measure m, const Place& solid, const Vec<dim>& x, std::vector<Real>& row) const {
    const std::size_t end = row.size() + describe<M>(m).size();
    if constexpr (has_skeleton<M>) {
      if (m == Measure::porosity && solid) row.push_back(solid_point_porosity(state_, *solid));
    }
    if constexpr (is_deformable<M>) {
      if (solid) append_solid(m, *solid, row);
    }
    if constexpr (has_liquid<M>) append_water(m, x, row);
    row.resize(end, unset);
  }

  /// A number of the scene.
  Real value(SceneMeasure m) const {
    switch (m) {
      case SceneMeasure::step:
        return static_cast<Real>(solver_.steps());
      case SceneMeasure::time_step:
        return state_.dt;
      case SceneMeasure::kinetic_energy:
        return kinetic_energy();
      case SceneMeasure::max_displacement:
        return max_displacement();
      case SceneMeasure::run_out:
        return largest_coordinate(0);
      case SceneMeasure::height:
        return largest_coordinate(dim - 1);
      case SceneMeasure::pore_water:
        return solver_.water_balance().pore;
      case SceneMeasure::free_water:
        return solver_.water_balance().free;
      case SceneMeasure::water_inflow:
        return solver_.water_balance().inflow;
      case SceneMeasure::water_outflow:
        return solver_.water_balance().outflow;
      case SceneMeasure::water_closure:
        return solver_.water_balance().closure();
      case SceneMeasure::solid_closure:
        return solver_.solid_balance().closure();
    }
    return unset;
  }

 private:
  void append_solid(Measure m, const PointPlace& p, std::vector<Real>& row) const {
    const auto stress = solid_point_stress(state_, p);
    switch (m) {
      case Measure::displacement: {
        const auto u = solver_.displacement(p.batch, p.lane);
        for (int d = 0; d < dim; ++d) row.push_back(u[d]);
        break;
      }
      case Measure::velocity:
        for (int d = 0; d < dim; ++d)
          row.push_back(state_.solid.at(field::velocity, p.batch, d)[p.lane]);
        break;
      case Measure::bishop_stress:
        for (int i = 0; i < stress.size; ++i) row.push_back(stress[i]);
        break;
      case Measure::mean_stress:
        row.push_back(stress.mean());
        break;
      case Measure::deviatoric_stress:
        row.push_back(deviatoric_stress(stress));
        break;
      case Measure::law_outputs:
        append_law(p, row);
        break;
      default:
        break;
    }
  }
  void append_law(const PointPlace& p, std::vector<Real>& row) const {
    using Law = typename M::Skeleton;
    if constexpr (law::state_size < Law >> 0)
      for (const auto& output : law::outputs<Law>())
        row.push_back(state_.solid.at(field::law_state, p.batch, output.index)[p.lane]);
  }
  void append_water(Measure m, const Vec<dim>& x, std::vector<Real>& row) const {
    if (m != Measure::liquid_pressure && m != Measure::suction && m != Measure::saturation) return;
    const WaterSample water = water_.at(x);
    if (m == Measure::liquid_pressure) row.push_back(water.pressure);
    if (m == Measure::suction)
      row.push_back(is_finite(water.pressure) ? suction_of(water.pressure) : unset);
    if (m == Measure::saturation) row.push_back(water.saturation);
  }

  template <class Points>
  static Real kinetic_energy_of(const Points& points) {
    Real energy = 0;
    points.for_each([&](std::size_t b, int l) {
      for (int d = 0; d < dim; ++d) {
        const Real v = points.at(field::velocity, b, d)[l];
        energy += 0.5 * points.at(field::mass, b)[l] * v * v;
      }
    });
    return energy;
  }
  Real kinetic_energy() const {
    Real energy = 0;
    if constexpr (is_deformable<M>) energy += kinetic_energy_of(state_.solid);
    if constexpr (has_liquid<M>) energy += kinetic_energy_of(state_.liquid);
    return energy;
  }
  Real max_displacement() const {
    Real most = 0;
    if constexpr (is_deformable<M>)
      state_.solid.for_each([&](std::size_t b, int l) {
        most = std::max<Real>(most, solver_.displacement(b, l).norm());
      });
    return most;
  }
  Real largest_coordinate(int d) const {
    Real most = unset;
    state_.solid.for_each([&](std::size_t b, int l) {
      const Real x = state_.solid.at(field::position, b, d)[l];
      if (!(x <= most)) most = x;
    });
    return most;
  }

  const S& solver_;
  const State<M>& state_;
  WaterSampler<M> water_;
  std::vector<PointPlace> by_id_;
  std::optional<NearbyPoints<dim, typename State<M>::Solid>> nearby_;
};

}  // namespace detail

/// CSV histories of chosen numbers:
///
///     io::Gauges gauges{"slope.csv"};
///     gauges.position("toe", {0.4, 0.1}, {io::Measure::liquid_pressure, io::Measure::saturation});
///     gauges.point("crest", {0.2, 0.3}, {io::Measure::displacement});
///     gauges.line("axis", {0.1, 0.0}, {0.1, 0.3}, 31, {io::Measure::suction});
///     gauges.scene({io::SceneMeasure::run_out, io::SceneMeasure::water_closure});
///     gauges.record(solver);  // as often as wanted
///
/// One row per record: "time [s],toe.liquid_pressure [Pa],...". Each line gauge writes a file of
/// its own per record, "slope_axis_000000.csv", with time, distance and coordinates first. The
/// files start with the first record; what is measured cannot change from then on.
class Gauges {
 public:
  /// `path` of the CSV file.
  explicit Gauges(std::string path) : path_(std::move(path)) {}

  /// At a fixed position [m].
  template <int Dim>
  void position(const std::string& name, const Vec<Dim>& x, std::vector<Measure> measures) {
    add({name, coordinates(x), Dim, false, -1, std::move(measures)});
  }
  /// The same with a list of numbers.
  template <int Dim>
  void position(const std::string& name, const Real (&x)[Dim], std::vector<Measure> measures) {
    position(name, vec(x), std::move(measures));
  }

  /// At the solid point that is nearest to x [m] at the first record, wherever it moves.
  template <int Dim>
  void point(const std::string& name, const Vec<Dim>& x, std::vector<Measure> measures) {
    add({name, coordinates(x), Dim, true, -1, std::move(measures)});
  }
  /// The same with a list of numbers.
  template <int Dim>
  void point(const std::string& name, const Real (&x)[Dim], std::vector<Measure> measures) {
    point(name, vec(x), std::move(measures));
  }

  /// Along the line between two positions [m], at `count` >= 2 evenly spaced positions.
  template <int Dim>
  void line(const std::string& name, const Vec<Dim>& from, const Vec<Dim>& to, int count,
            std::vector<Measure> measures) {
    require_not_started();
    if (count < 2) check::fail("count", count, "[2, inf)", "-");
    check::in_context("gauge '" + name + "'", [&] {
      for (int d = 0; d < Dim; ++d) {
        check::finite("from " + check::axis_name(d), from[d], "m");
        check::finite("to " + check::axis_name(d), to[d], "m");
      }
    });
    lines_.push_back({name, coordinates(from), coordinates(to), Dim, count, std::move(measures)});
  }
  /// The same with lists of numbers.
  template <int Dim>
  void line(const std::string& name, const Real (&from)[Dim], const Real (&to)[Dim], int count,
            std::vector<Measure> measures) {
    line(name, vec(from), vec(to), count, std::move(measures));
  }

  /// Numbers of the whole scene.
  void scene(std::vector<SceneMeasure> measures) {
    require_not_started();
    scene_.insert(scene_.end(), measures.begin(), measures.end());
  }

  /// Appends one row, and one file per line. Raises SetupError where a gauge does not suit the
  /// model, OutputError where a file cannot be written.
  template <class S>
  void record(const S& solver) {
    record(solver, solver.state());
  }

  /// Id of the solid point that a point gauge follows; -1 before the first record.
  std::int64_t followed(const std::string& name) const {
    for (const Place& p : places_)
      if (p.follows && p.name == name) return p.id;
    return -1;
  }
  const std::string& path() const noexcept { return path_; }

 private:
  struct Place {
    std::string name;
    std::array<Real, 3> x;
    int dim;
    bool follows;
    std::int64_t id;
    std::vector<Measure> measures;
  };
  struct Line {
    std::string name;
    std::array<Real, 3> from, to;
    int dim;
    int count;
    std::vector<Measure> measures;
  };

  template <int Dim>
  static Vec<Dim> vec(const Real (&x)[Dim]) {
    Vec<Dim> v;
    for (int d = 0; d < Dim; ++d) v[d] = x[d];
    return v;
  }
  template <int Dim>
  static Vec<Dim> vec(const std::array<Real, 3>& x) {
    Vec<Dim> v;
    for (int d = 0; d < Dim; ++d) v[d] = x[static_cast<std::size_t>(d)];
    return v;
  }
  template <int Dim>
  static std::array<Real, 3> coordinates(const Vec<Dim>& x) {
    std::array<Real, 3> a{};
    for (int d = 0; d < Dim; ++d) a[static_cast<std::size_t>(d)] = x[d];
    return a;
  }

  void require_not_started() const {
    if (history_)
      throw SetupError("gauges must be added before the first record of '" + path_ + "'");
  }
  void add(Place place) {
    require_not_started();
    check::in_context("gauge '" + place.name + "'", [&] {
      for (int d = 0; d < place.dim; ++d)
        check::finite("position " + check::axis_name(d), place.x[static_cast<std::size_t>(d)], "m");
    });
    places_.push_back(std::move(place));
  }

  template <class S, class M>
  void record(const S& solver, const State<M>& state) {
    if (!history_) start(state);
    detail::Probe<S, M> probe(solver, state);
    std::vector<Real> row{solver.time()};
    for (const Place& place : places_) append(place, probe, state, row);
    for (const SceneMeasure m : scene_) row.push_back(probe.value(m));
    for (const Line& line : lines_) write_line(line, solver.time(), probe);
    history_->add(row);
    ++records_;
  }

  template <class Probe, class M>
  static void append(const Place& place, Probe& probe, const State<M>& state,
                     std::vector<Real>& row) {
    constexpr int dim = State<M>::dim;
    Vec<dim> x = vec<dim>(place.x);
    typename Probe::Place solid;
    if constexpr (has_skeleton<M>) {
      solid = place.follows ? probe.find(place.id) : probe.near(x);
      if (place.follows && solid) x = position_of<dim>(state.solid, *solid);
      if (place.follows && !solid) x.setConstant(unset);
    }
    for (const Measure m : place.measures)
      if (place.follows && !solid)
        row.resize(row.size() + detail::describe<M>(m).size(), unset);
      else
        probe.append(m, solid, x, row);
  }

  /// Chooses the points that are followed and writes the head.
  template <class M>
  void start(const State<M>& state) {
    std::vector<Quantity> columns{{"time", "s"}};
    for (Place& place : places_) {
      check::in_context("gauge '" + place.name + "'", [&] {
        check_dim<M>(place.dim);
        if (place.follows) place.id = nearest_id(state, vec<State<M>::dim>(place.x));
        for (const Measure m : place.measures)
          for (const Quantity& q : detail::describe<M>(m))
            columns.push_back({place.name + "." + q.name, q.unit});
      });
    }
    for (const Line& line : lines_) {
      check::in_context("gauge '" + line.name + "'", [&] {
        check_dim<M>(line.dim);
        for (const Measure m : line.measures) static_cast<void>(detail::describe<M>(m));
      });
    }
    for (const SceneMeasure m : scene_) columns.push_back(detail::describe(m));
    history_.emplace(path_, columns);
  }
  template <class M>
  static void check_dim(int dim) {
    constexpr const char* allowed[] = {"{1}", "{2}", "{3}"};
    if (dim != State<M>::dim) check::fail("dimension", dim, allowed[State<M>::dim - 1], "-");
  }
  template <class M>
  static std::int64_t nearest_id(const State<M>& state, const Vec<State<M>::dim>& x) {
    const auto nearest = nearest_of_all<State<M>::dim>(state.solid, x, state.grid.cell_size());
    if (!nearest) throw SetupError("number of solid points = 0 outside [1, inf) [-]");
    return nearest->id;
  }

  template <class S, class M>
  void write_line(const Line& line, Real time, detail::Probe<S, M>& probe) const {
    constexpr int dim = State<M>::dim;
    std::vector<Quantity> columns{{"time", "s"}, {"distance", "m"}};
    for (int d = 0; d < dim; ++d) columns.push_back({detail::axis_label<M>(d), "m"});
    for (const Measure m : line.measures)
      for (const Quantity& q : detail::describe<M>(m)) columns.push_back(q);
    History file(line_path(line.name), columns);
    const Vec<dim> from = vec<dim>(line.from), to = vec<dim>(line.to);
    for (int i = 0; i < line.count; ++i) {
      const Real part = static_cast<Real>(i) / (line.count - 1);
      const Vec<dim> x = from + part * (to - from);
      std::vector<Real> row{time, part * (to - from).norm()};
      for (int d = 0; d < dim; ++d) row.push_back(x[d]);
      typename detail::Probe<S, M>::Place solid;
      if constexpr (has_skeleton<M>) solid = probe.near(x);
      for (const Measure m : line.measures) probe.append(m, solid, x, row);
      file.add(row);
    }
  }
  std::string line_path(const std::string& name) const {
    const std::filesystem::path path(path_);
    char number[32];
    std::snprintf(number, sizeof number, "_%06zu", records_);
    return (path.parent_path() / (path.stem().string() + "_" + name + number + ".csv")).string();
  }

  std::string path_;
  std::vector<Place> places_;
  std::vector<Line> lines_;
  std::vector<SceneMeasure> scene_;
  std::optional<History> history_;
  std::size_t records_ = 0;
};

}  // namespace vadose::io
