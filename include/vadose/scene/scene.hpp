// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// A scene: domain, soils, free water, gravity, liquid, boundary conditions. It holds values only;
/// Solver makes points and grid from it.

#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <vadose/core/error.hpp>
#include <vadose/grid/region.hpp>
#include <vadose/model/material.hpp>
#include <vadose/scene/boundary.hpp>
#include <vadose/scene/initial_state.hpp>

namespace vadose {

/// The box that the grid fills and its cell size.
template <int Dim>
struct Domain {
  Box<Dim> box = {};       ///< [m]; axisymmetric: r >= 0
  Real cell_size = unset;  ///< edge of the square cells [m]; divides every edge of the box
};

/// The liquid of all pores and of free water.
template <class M>
struct LiquidProperties {
  Real density = 1000;                                ///< rho_l at zero pressure [kg/m3], > 0
  Real bulk_modulus = 2.2e9;                          ///< K [Pa], > 0
  [[no_unique_address]] typename M::Liquid law = {};  ///< viscous law of free water

  /// Raises SetupError unless all values are in range.
  void validate() const {
    check::in_context("liquid", [&] {
      check::positive("density", density, "kg/m3");
      check::positive("bulk_modulus", bulk_modulus, "Pa");
      if constexpr (requires { law.validate(); }) law.validate();
    });
  }
};

namespace detail {

template <class T, class... List>
inline constexpr bool is_one_of = (std::is_same_v<T, List> || ...);

/// Number of points along each axis of a cell with `points_per_cell` points in all.
template <int Dim>
int points_per_axis(int points_per_cell) {
  std::string allowed;
  for (int k = 1; k <= 8; ++k) {
    const int total = power<Dim>(k);
    if (points_per_cell == total) return k;
    allowed += (k == 1 ? "{" : ", ") + std::to_string(total);
  }
  check::fail("points_per_cell", points_per_cell, allowed + "}", "-");
}

/// Number of cells along each axis; raises SetupError unless they fill the box to 1e-9.
template <int Dim>
std::array<int, Dim> count_cells(const Domain<Dim>& domain) {
  check::proper_box("box", domain.box);
  check::positive("cell_size", domain.cell_size, "m");
  std::array<int, Dim> cells{};
  for (int d = 0; d < Dim; ++d) {
    const Real edge = domain.box.high[d] - domain.box.low[d];
    const Real exact = edge / domain.cell_size;
    const Real rounded = std::round(exact);
    if (!(rounded >= 1 && rounded < 1e9 && std::abs(exact - rounded) <= 1e-9 * rounded))
      throw SetupError("cell_size = " + check::text(domain.cell_size) + " outside {" +
                       check::text(edge) + " / integer} [m]: box edge " + check::axis_name(d) +
                       " would have " + check::text(exact) + " cells");
    cells[static_cast<std::size_t>(d)] = static_cast<int>(rounded);
  }
  return cells;
}

}  // namespace detail

/// What is simulated, for model M. Everything is checked when it is added, and validate() checks
/// what depends on several parts; both raise SetupError and leave the scene as it was.
template <class M>
class Scene {
  static_assert(CheckModel<M>::ok);

 public:
  static constexpr int dim = M::Kinematics::dim;

  Vec<dim> gravity = Vec<dim>::Zero();  ///< [m/s2]; a centrifuge at 30 g has 30 x 9.81
  LiquidProperties<M> liquid;           ///< water by default

  /// Empty scene; refuses a box or cell size that do not fit.
  explicit Scene(const Domain<dim>& domain)
      : box_(domain.box), cell_size_(domain.cell_size), cells_(detail::count_cells(domain)) {
    if (M::Kinematics::axisymmetric && !(box_.low[0] >= 0))
      check::fail("box low r", box_.low[0], "[0, inf)", "m");
  }

  /// Puts soil of a material into a region.
  template <class Model = M>
  void add_soil(const Region<dim>& region, const Material<M>& material,
                const SoilOptions<dim>& options = {}) {
    static_assert(has_skeleton<Model>, "vadose: add_soil needs a model with a Skeleton");
    if (has_liquid<M>) liquid.validate();
    material.validate(default_unit_weight());
    check::in_context(material.label(), [&] {
      check_placement(region, options);
      check_state(material.resolved(default_unit_weight()), options);
      check_stress(material, options);
    });
    SoilBody<dim> body{region, static_cast<int>(materials_.size()), options,
                       lattice(options.points_per_cell)};
    check_filled(material.label(), region, body.lattice);
    Material<M> copy = material;
    materials_.reserve(materials_.size() + 1);
    soils_.reserve(soils_.size() + 1);
    soils_.push_back(std::move(body));  // nothing can fail from here on
    materials_.push_back(std::move(copy));
  }

  /// Refuses a region of another dimension, in one sentence.
  template <int Other>
  requires(Other != dim) void add_soil(const Region<Other>& /*region*/, const Material<M>& = {},
                                       const SoilOptions<dim>& = {}) {
    static_assert(Other == dim, "vadose: the region has another dimension than the scene's model");
  }
  /// Refuses a material of another model, in one sentence.
  template <class Other>
  requires(!std::is_same_v<Other, M>) void add_soil(const Region<dim>& /*region*/,
                                                    const Material<Other>& /*material*/,
                                                    const SoilOptions<dim>& = {}) {
    static_assert(std::is_same_v<Other, M>,
                  "vadose: the material is one of another model than the scene's");
  }

  /// Puts free water into a region.
  template <class Model = M>
  void add_water(const Region<dim>& region, const WaterOptions<dim>& options = {}) {
    static_assert(has_liquid<Model>, "vadose: add_water needs a model with a Liquid");
    const std::string label = water_label(waters_.size());
    check::in_context(label, [&] {
      check_placement(region, options);
      check::at_most_one(int(given(options.surface_level)) + int(bool(options.liquid_pressure)),
                         "surface_level [m], liquid_pressure [Pa]");
      if (given(options.surface_level)) check::finite("surface_level", options.surface_level, "m");
    });
    const WaterBody<dim> body{region, options, lattice(options.points_per_cell)};
    check_filled(label, region, body.lattice);
    waters_.push_back(body);
  }

  /// Adds a condition of vadose::bc.
  template <class Condition>
  void add(const Condition& condition) {
    static_assert(is_known<Condition>,
                  "vadose: Scene::add takes a condition of vadose::bc, of the scene's dimension");
    static_assert(has_liquid<M> || !acts_on_liquid<Condition>,
                  "vadose: this boundary condition acts on the liquid and the model has NoLiquid");
    static_assert(has_skeleton<M> || !acts_on_skeleton<Condition>,
                  "vadose: this boundary condition acts on soil and the model has NoSkeleton");
    if constexpr (is_known<Condition>) {
      check::in_context(Condition::name, [&] {
        condition.validate(dim);
        if constexpr (requires { condition.region; }) check_reach(condition.region);
      });
      if constexpr (std::is_same_v<Condition, bc::Drained>)
        store(condition.template prescribed<dim>());
      else if constexpr (std::is_same_v<Condition, bc::SeepageFace>)
        store(condition.drain());
      else
        store(condition);
    }
  }

  /// The domain [m], its cell size [m] and its number of cells along each axis.
  const Box<dim>& box() const noexcept { return box_; }
  Real cell_size() const noexcept { return cell_size_; }                 ///< see box()
  const std::array<int, dim>& cells() const noexcept { return cells_; }  ///< see box()

  /// What was added, in that order.
  const std::vector<SoilBody<dim>>& soils() const noexcept { return soils_; }
  const std::vector<WaterBody<dim>>& waters() const noexcept { return waters_; }  ///< see soils()
  const std::vector<Material<M>>& materials() const noexcept {
    return materials_;
  }  ///< see soils()

  /// A material whose policies have taken the shared numbers (unit weight, lambda, porosity).
  Material<M> material(int index) const {
    return materials_[static_cast<std::size_t>(index)].resolved(default_unit_weight());
  }

  /// Conditions of one type: scene.conditions<bc::Fixed>(). Drained ones are listed as
  /// PrescribedPressure, seepage faces as Drain.
  template <class Condition>
  const std::vector<Condition>& conditions() const noexcept {
    static_assert(detail::is_one_of<std::vector<Condition>, Fixed, Roller, Frictional, Traction,
                                    PrescribedVelocity, Impermeable, PrescribedPressure,
                                    PrescribedHead, Reservoir, Drain, ZeroSuction, Rain>,
                  "vadose: Scene::conditions takes a stored condition of vadose::bc");
    return std::get<std::vector<Condition>>(conditions_);
  }

  /// Points of one body of soil or water, in the order of the lattice.
  std::vector<SeedPoint<dim>> seed_soil(int soil) const {
    return seed_body(soils_[static_cast<std::size_t>(soil)]);
  }
  /// The same of a body of water.
  std::vector<SeedPoint<dim>> seed_water(int water) const {
    return seed_body(waters_[static_cast<std::size_t>(water)]);
  }

  /// Start values of the bodies; the scene must not change while it is used.
  InitialState<M> initial_state() const { return InitialState<M>(*this); }

  /// Checks everything, also what was assigned or depends on several parts. Solver calls it.
  void validate() const {
    for (int d = 0; d < dim; ++d)
      check::finite("gravity " + check::axis_name(d), gravity[d], "m/s2");
    if (has_liquid<M>) liquid.validate();
    if (soils_.empty() && waters_.empty())
      throw SetupError("number of bodies = 0 outside [1, inf) [-]: the scene has no soil or water");
    for (const Material<M>& m : materials_) m.validate(default_unit_weight());
    for (std::size_t i = 0; i < soils_.size(); ++i)
      check::in_context(soil_label(soils_[i]), [&] { validate_soil(static_cast<int>(i)); });
    for (std::size_t i = 0; i < waters_.size(); ++i)
      check::in_context(water_label(i), [&] { validate_water(static_cast<int>(i)); });
  }

 private:
  using Fixed = std::vector<bc::Fixed>;
  using Roller = std::vector<bc::Roller>;
  using Frictional = std::vector<bc::Frictional>;
  using Traction = std::vector<bc::Traction<dim>>;
  using PrescribedVelocity = std::vector<bc::PrescribedVelocity<dim>>;
  using Impermeable = std::vector<bc::Impermeable>;
  using PrescribedPressure = std::vector<bc::PrescribedPressure<dim>>;
  using ZeroSuction = std::vector<bc::ZeroSuction>;
  using Rain = std::vector<bc::Rain>;
  using PrescribedHead = std::vector<bc::PrescribedHead>;
  using Reservoir = std::vector<bc::Reservoir>;
  using Drain = std::vector<bc::Drain>;

  template <class C>
  static constexpr bool is_wall = detail::is_one_of<C, bc::Fixed, bc::Roller, bc::Frictional>;
  template <class C>
  static constexpr bool acts_on_liquid =
      detail::is_one_of<C, bc::Impermeable, bc::PrescribedPressure<dim>, bc::PrescribedHead,
                        bc::Drained, bc::Reservoir, bc::Drain, bc::SeepageFace, bc::ZeroSuction,
                        bc::Rain>;
  template <class C>
  static constexpr bool acts_on_skeleton =
      detail::is_one_of<C, bc::Frictional, bc::Traction<dim>, bc::PrescribedVelocity<dim>,
                        bc::Reservoir, bc::Drain, bc::SeepageFace, bc::ZeroSuction, bc::Rain>;
  template <class C>
  static constexpr bool is_known = is_wall<C> || acts_on_liquid<C> || acts_on_skeleton<C>;

  static bool given(Real value) noexcept { return value == value; }
  static std::string water_label(std::size_t index) {
    return "free water " + std::to_string(index);
  }
  std::string soil_label(const SoilBody<dim>& soil) const {
    return materials_[static_cast<std::size_t>(soil.material)].label();
  }
  Real default_unit_weight() const noexcept { return reference_gravity * liquid.density; }
  Lattice<dim> lattice(int points_per_cell) const {
    return {box_.low, cell_size_, detail::points_per_axis<dim>(points_per_cell)};
  }

  template <class Body>
  std::vector<SeedPoint<dim>> seed_body(const Body& body) const {
    return seed(body.region, box_.low, cell_size_, body.lattice.per_axis, body.options.jitter,
                body.options.seed);
  }

  /// Region inside the domain, lattice, offsets and velocity.
  template <class Options>
  void check_placement(const Region<dim>& region, const Options& options) const {
    const Box<dim>& bounds = region.bounding_box();
    for (int d = 0; d < dim; ++d) {
      const Real slack = 1e-9 * (box_.high[d] - box_.low[d]);
      check_bound("region low " + check::axis_name(d), bounds.low[d], d, slack);
      check_bound("region high " + check::axis_name(d), bounds.high[d], d, slack);
      check::finite("velocity " + check::axis_name(d), options.velocity[d], "m/s");
    }
    const int per_axis = detail::points_per_axis<dim>(options.points_per_cell);
    check::within("jitter", options.jitter, 0, 0.5 / per_axis, "cell size");
  }
  void check_bound(const std::string& name, Real value, int d, Real slack) const {
    if (!(value >= box_.low[d] - slack && value <= box_.high[d] + slack))
      check::fail(
          name, value,
          check::joined({"[", check::text(box_.low[d]), ", ", check::text(box_.high[d]), "]"}),
          "m");
  }

  /// Exactly the start values that the model needs, each in its range.
  void check_state(const Material<M>& material, const SoilOptions<dim>& o) const {
    const int with_pressure = int(given(o.water_table)) + int(static_cast<bool>(o.liquid_pressure));
    const int unsaturated = int(given(o.suction)) + int(given(o.saturation)) + int(o.dry);
    if constexpr (is_unsaturated<M>) {
      check::exactly_one(with_pressure + unsaturated,
                         "suction, saturation, water_table, liquid_pressure, dry",
                         "Pa, -, m, Pa, -");
      if (given(o.suction)) check::non_negative("suction", o.suction, "Pa");
      if (given(o.saturation)) check_saturation(material, o.saturation);
    } else {
      static_cast<void>(material);
      if (given(o.suction)) check::fail("suction", o.suction, "{} of this model", "Pa");
      if (given(o.saturation)) check::fail("saturation", o.saturation, "{} of this model", "-");
      if (o.dry) check::fail("dry", 1, "{0} of this model", "-");
      if (has_liquid<M>) {
        check::at_most_one(with_pressure, "water_table [m], liquid_pressure [Pa]");
      } else if (with_pressure != 0) {
        check::fail("number of given water_table [m], liquid_pressure [Pa]", with_pressure,
                    "{0} of a model with NoLiquid", "-");
      }
    }
    if (given(o.water_table)) check::finite("water_table", o.water_table, "m");
  }
  void check_saturation(const Material<M>& material, Real saturation) const {
    if constexpr (is_unsaturated<M>) {
      const Real residual = swrc::residual_saturation(material.retention);
      if (!is_finite(saturation) || !(saturation > residual && saturation <= 1))
        check::fail("saturation", saturation, check::joined({"(", check::text(residual), ", 1]"}),
                    "-");
      check::finite("suction of saturation " + check::text(saturation),
                    swrc::suction(material.retention, saturation, material.porosity), "Pa");
    }
  }

  /// Geostatic stress only where a skeleton can carry it, K_0 only with it.
  void check_stress(const Material<M>& material, const SoilOptions<dim>& o) const {
    const Real ratio = o.lateral_stress_ratio;
    if (o.initial_stress == InitialStress::none) {
      if (given(ratio))
        check::fail("lateral_stress_ratio", ratio, "{} without InitialStress::geostatic", "-");
      return;
    }
    if (is_rigid<M>)
      throw SetupError("initial_stress = geostatic outside {none} of a rigid skeleton [-]");
    if (given(ratio) || !is_finite(detail::poisson_ratio_of(material.skeleton)))
      check::within("lateral_stress_ratio", ratio, 0, 10, "-");
  }

  /// Some point lies in the region, none in another body.
  void check_filled(const std::string& label, const Region<dim>& region,
                    const Lattice<dim>& lattice) const {
    if (!has_points(region, lattice))
      throw SetupError("number of points = 0 outside [1, inf) [-] in region of " + label +
                       ": it contains no lattice point at cell_size = " + check::text(cell_size_) +
                       " [m]");
    for (const auto& soil : soils_)
      check_disjoint(label, region, lattice, soil_label(soil), soil.region, soil.lattice);
    for (std::size_t i = 0; i < waters_.size(); ++i)
      check_disjoint(label, region, lattice, water_label(i), waters_[i].region, waters_[i].lattice);
  }

  /// The region of a condition touches the domain.
  void check_reach(const AnyRegion& region) const {
    const Region<dim>* part = region.get<dim>();
    if (!part) return;
    const Box<dim>& bounds = part->bounding_box();
    for (int d = 0; d < dim; ++d) {
      const Real slack = 1e-9 * (box_.high[d] - box_.low[d]);
      if (!(bounds.low[d] <= box_.high[d] + slack))
        check::fail("region low " + check::axis_name(d), bounds.low[d],
                    "(-inf, " + check::text(box_.high[d]) + "]", "m");
      if (!(bounds.high[d] >= box_.low[d] - slack))
        check::fail("region high " + check::axis_name(d), bounds.high[d],
                    check::joined({"[", check::text(box_.low[d]), ", inf)"}), "m");
    }
  }

  template <class Condition>
  void store(const Condition& condition) {
    if constexpr (is_wall<Condition>) {
      refuse_conflict<Fixed>(condition);
      refuse_conflict<Roller>(condition);
      refuse_conflict<Frictional>(condition);
    } else if constexpr (acts_on_liquid<Condition>) {
      refuse_conflict<Impermeable>(condition);
      refuse_conflict<PrescribedPressure>(condition);
      refuse_conflict<PrescribedHead>(condition);
      refuse_conflict<Reservoir>(condition);
      refuse_conflict<Drain>(condition);
      refuse_conflict<ZeroSuction>(condition);
      refuse_conflict<Rain>(condition);
    }
    std::get<std::vector<Condition>>(conditions_).push_back(condition);
  }

  /// Two conditions of one kind for a whole face, or for the whole ground, contradict each other.
  template <class List, class Condition>
  void refuse_conflict(const Condition& added) const {
    if (limited(added)) return;
    const Face face = face_of(added);
    for (const auto& other : std::get<List>(conditions_)) {
      if (face_of(other) != face || limited(other)) continue;
      const std::string place = face == unset_face
                                    ? "region = (everywhere) outside {parts of the surface} [m]: "
                                    : joined_face(face);
      throw SetupError(place + added.name + " contradicts " + other.name +
                       " there; give one a region");
    }
  }
  static std::string joined_face(Face face) {
    return "face = " + std::string(name(face)) + " outside {free faces} [-]: ";
  }
  /// The wall of a condition; unset: the ground surface.
  template <class Condition>
  static Face face_of(const Condition& condition) {
    if constexpr (requires { condition.face; })
      return condition.face;
    else
      return unset_face;
  }
  /// Acts on a part of its face or of the ground, or not always.
  template <class Condition>
  static bool limited(const Condition& condition) {
    if constexpr (requires { condition.active; })
      if (condition.active) return true;
    if constexpr (requires { condition.region; })
      return condition.region.given();
    else
      return false;
  }

  void check_gravity(const char* reason) const {
    if (!(gravity.norm() > 0))
      check::fail("gravity", gravity.norm(), std::string("(0, inf), needed by ") + reason, "m/s2");
  }

  void validate_soil(int index) const {
    const SoilBody<dim>& soil = soils_[static_cast<std::size_t>(index)];
    check_state(material(soil.material), soil.options);
    if (given(soil.options.water_table)) check_gravity("water_table");
    if (soil.options.initial_stress == InitialStress::geostatic) check_gravity("geostatic stress");
    if (!soil.options.liquid_pressure) return;
    for (const SeedPoint<dim>& point : seed_soil(index))
      check::finite("liquid_pressure", soil.options.liquid_pressure(point.position), "Pa");
  }

  void validate_water(int index) const {
    const WaterOptions<dim>& o = waters_[static_cast<std::size_t>(index)].options;
    if (given(o.surface_level)) check_gravity("surface_level");
    if (!given(o.surface_level) && !o.liquid_pressure) return;
    const InitialState<M> state(*this);
    for (const SeedPoint<dim>& point : seed_water(index)) {
      const Real pressure = state.water_pressure(index, point.position);
      check::finite("liquid_pressure", pressure, "Pa");
      if (given(o.surface_level) && !(pressure >= 0))
        check::fail("surface_level", o.surface_level,
                    check::joined({"[", check::text(height(point.position, gravity)),
                                   ", inf), the height of the points"}),
                    "m");
    }
  }

  Box<dim> box_;
  Real cell_size_;
  std::array<int, dim> cells_;
  std::vector<SoilBody<dim>> soils_;
  std::vector<WaterBody<dim>> waters_;
  std::vector<Material<M>> materials_;
  std::tuple<Fixed, Roller, Frictional, Traction, PrescribedVelocity, Impermeable,
             PrescribedPressure, PrescribedHead, Reservoir, Drain, ZeroSuction, Rain>
      conditions_;
};

}  // namespace vadose
