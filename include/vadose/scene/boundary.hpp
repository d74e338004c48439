// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Boundary conditions as plain values. Scene::add() checks them; the solver turns them into lists
/// of nodes, points and faces.

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <vadose/core/error.hpp>
#include <vadose/grid/region.hpp>

namespace vadose {

/// Side of the domain. 1D: bottom, top (the coordinate points up). 2D: left, right (x or r),
/// bottom, top (y or z). 3D: left, right (x), front, back (y), bottom, top (z, up).
enum class Face : unsigned char { left, right, front, back, bottom, top };

/// Default of a mandatory face; every check rejects it.
inline constexpr Face unset_face = static_cast<Face>(255);

/// Coordinate that is constant on `face` in `dim` dimensions; -1 if there is no such face.
constexpr int axis(Face face, int dim) noexcept {
  switch (face) {
    case Face::left:
    case Face::right:
      return dim >= 2 ? 0 : -1;
    case Face::front:
    case Face::back:
      return dim == 3 ? 1 : -1;
    case Face::bottom:
    case Face::top:
      return dim - 1;
  }
  return -1;
}

/// 0: the face has the smallest coordinate along its axis, 1: the largest.
constexpr int side(Face face) noexcept {
  return face == Face::right || face == Face::back || face == Face::top ? 1 : 0;
}

/// Name of a face for messages.
constexpr const char* name(Face face) noexcept {
  constexpr const char* names[] = {"left", "right", "front", "back", "bottom", "top"};
  return static_cast<int>(face) < 6 ? names[static_cast<int>(face)] : "(missing)";
}

/// A Region of any dimension, or nothing (= everywhere). Region<Dim> converts to it.
class AnyRegion {
 public:
  AnyRegion() = default;
  /// A region is one of any dimension.
  template <int Dim>
  AnyRegion(Region<Dim> region)  // NOLINT(google-explicit-constructor): a region is a region
      : region_(std::move(region)) {}

  /// A region was given.
  bool given() const noexcept { return region_.index() != 0; }
  /// Dimension of the region given, else 0.
  int dim() const noexcept { return static_cast<int>(region_.index()); }
  /// The region, nullptr if none of this dimension was given.
  template <int Dim>
  const Region<Dim>* get() const noexcept {
    return std::get_if<Region<Dim>>(&region_);
  }
  /// x is in the region, or no region was given.
  template <int Dim>
  bool contains(const Vec<Dim>& x) const {
    const Region<Dim>* region = get<Dim>();
    return region ? region->contains(x) : !given();
  }

 private:
  std::variant<std::monostate, Region<1>, Region<2>, Region<3>> region_;
};

/// Factor [-] as a function of time [s]; an empty one is 1 at all times.
using TimeFactor = std::function<Real(Real)>;

/// Whether a condition acts at time t [s]; an empty one acts at all times.
using TimeSwitch = std::function<bool(Real)>;

namespace check {

/// The face exists in `dim` dimensions.
inline void face(Face face, int dim) {
  if (axis(face, dim) >= 0) return;
  const char* allowed = dim == 1   ? "{bottom, top}"
                        : dim == 2 ? "{left, right, bottom, top}"
                                   : "{left, right, front, back, bottom, top}";
  throw SetupError("face = " + std::string(name(face)) + " outside " + allowed + " [-]");
}

/// No region, or one of `dim` dimensions.
inline void region(const AnyRegion& region, int dim) {
  if (region.given() && region.dim() != dim)
    fail("region dimension", region.dim(), joined({"{", std::to_string(dim), "}"}), "-");
}

/// A region of `dim` dimensions.
inline void required_region(const AnyRegion& given, int dim) {
  if (!given.given()) throw SetupError("region = (missing), allowed: one Region [m]");
  region(given, dim);
}

/// Empty, or finite at t = 0.
inline void time_factor(const TimeFactor& factor) {
  if (factor) finite("time_factor(0 s)", factor(0), "-");
}

/// Exactly one of several alternatives was given.
inline void exactly_one(int given, std::string_view alternatives, std::string_view unit) {
  if (given != 1)
    fail("number of given " + std::string(alternatives) + " (units " + std::string(unit) + ")",
         given, "{1}", "-");
}

/// A face, a region, or both.
inline void face_or_region(Face given, const AnyRegion& part, int dim) {
  if (given == unset_face && !part.given())
    throw SetupError("face = (missing), region = (missing), allowed: one or both [m]");
  if (given != unset_face) face(given, dim);
  region(part, dim);
}

/// A face, a region, both, or neither (the whole ground surface).
inline void wall_or_ground(Face given, const AnyRegion& part, int dim) {
  if (given != unset_face) face(given, dim);
  region(part, dim);
}

/// One or none of several alternatives was given.
inline void at_most_one(int given, std::string_view alternatives) {
  if (given > 1) fail("number of given " + std::string(alternatives), given, "{0, 1}", "-");
}

}  // namespace check

/// Boundary conditions. `region` limits a condition to a part of the face, by node position.
/// validate(dim) raises SetupError unless the values suit a scene of `dim` dimensions.
namespace bc {

/// Rough rigid wall: no velocity of the solid, no flow of liquid through it.
struct Fixed {
  static constexpr const char* name = "bc::Fixed";
  Face face = unset_face;  ///< side of the domain
  AnyRegion region = {};   ///< part of it; all of it by default

  void validate(int dim) const {
    check::face(face, dim);
    check::region(region, dim);
  }
};

/// Smooth rigid wall: no velocity along its normal, free along it.
struct Roller {
  static constexpr const char* name = "bc::Roller";
  Face face = unset_face;  ///< side of the domain
  AnyRegion region = {};   ///< part of it; all of it by default

  void validate(int dim) const {
    check::face(face, dim);
    check::region(region, dim);
  }
};

/// Rigid wall with Coulomb friction: |shear force| <= friction_coefficient x normal force of the
/// solid while it is pressed against the wall.
struct Frictional {
  static constexpr const char* name = "bc::Frictional";
  Face face = unset_face;             ///< side of the domain
  Real friction_coefficient = unset;  ///< mu [-], >= 0
  AnyRegion region = {};              ///< part of it; all of it by default

  void validate(int dim) const {
    check::face(face, dim);
    check::non_negative("friction_coefficient", friction_coefficient, "-");
    check::region(region, dim);
  }
};

/// Load on the solid points of a region at set-up (a layer at the surface); the points keep it
/// while they move. Give `traction` or `normal_pressure`.
template <int Dim>
struct Traction {
  static constexpr const char* name = "bc::Traction";
  AnyRegion region = {};                          ///< surface points, mandatory
  Vec<Dim> traction = Vec<Dim>::Constant(unset);  ///< force per area [Pa], in grid axes
  Real normal_pressure = unset;                   ///< pressure on the surface [Pa], compression +
  TimeFactor time_factor = {};                    ///< multiplies the load [-] at time t [s]

  void validate(int dim) const {
    check::required_region(region, dim);
    check::exactly_one(int(has_vector()) + int(has_pressure()), "traction, normal_pressure", "Pa");
    if (has_pressure()) check::finite("normal_pressure", normal_pressure, "Pa");
    for (int d = 0; has_vector() && d < Dim; ++d)
      check::finite("traction " + check::axis_name(d), traction[d], "Pa");
    check::time_factor(time_factor);
  }
  /// The load is `normal_pressure`.
  bool has_pressure() const noexcept { return normal_pressure == normal_pressure; }
  /// The load is `traction`.
  bool has_vector() const noexcept { return !traction.array().isNaN().all(); }
  /// Factor of the load at time t [s].
  Real factor(Real t) const { return time_factor ? time_factor(t) : 1; }
};

/// Velocity of the solid at the nodes of a region. A component that is NaN (unset) stays free.
template <int Dim>
struct PrescribedVelocity {
  static constexpr const char* name = "bc::PrescribedVelocity";
  AnyRegion region = {};                          ///< nodes, mandatory
  Vec<Dim> velocity = Vec<Dim>::Constant(unset);  ///< [m/s]; unset: free
  TimeFactor time_factor = {};                    ///< multiplies the velocity [-] at time t [s]

  void validate(int dim) const {
    check::required_region(region, dim);
    int given = 0;
    for (int d = 0; d < Dim; ++d) {
      if (!prescribes(d)) continue;
      check::finite("velocity " + check::axis_name(d), velocity[d], "m/s");
      ++given;
    }
    if (given == 0) check::fail("velocity", unset, "(-inf, inf) in one component or more", "m/s");
    check::time_factor(time_factor);
  }
  /// The component along `direction` is prescribed.
  bool prescribes(int direction) const { return velocity[direction] == velocity[direction]; }
  /// Factor of the velocity at time t [s].
  Real factor(Real t) const { return time_factor ? time_factor(t) : 1; }
};

// Where a liquid condition acts: with `face`, on that wall; without, on the current ground surface,
// found from the points in every step. `region` limits it to a part, by position. Where several meet,
// those with a region go first, then those added first. `active` switches a condition in time; while
// it is off the next one counts.

/// No liquid flows through the face. This is what every wall and the ground do without a liquid
/// condition; with a region it closes a part of what another condition opens.
struct Impermeable {
  static constexpr const char* name = "bc::Impermeable";
  Face face = unset_face;  ///< side of the domain
  AnyRegion region = {};   ///< or region
  TimeSwitch active = {};  ///< when; always by default

  void validate(int dim) const {
    if (region.given())
      check::face_or_region(face, region, dim);
    else
      check::face(face, dim);
  }
};

/// Liquid pressure held at a face, at a region, or at the part of a face that is in the region.
/// Give `pressure` or `function`.
template <int Dim>
struct PrescribedPressure {
  static constexpr const char* name = "bc::PrescribedPressure";
  Face face = unset_face;                                    ///< side of the domain
  AnyRegion region = {};                                     ///< or region
  Real pressure = unset;                                     ///< p [Pa], compression +
  std::function<Real(const Vec<Dim>&, Real)> function = {};  ///< p(x [m], t [s]) [Pa]
  TimeSwitch active = {};                                    ///< when; always by default

  void validate(int dim) const {
    check::face_or_region(face, region, dim);
    check::exactly_one(int(pressure == pressure) + int(static_cast<bool>(function)),
                       "pressure, function", "Pa");
    if (!function) check::finite("pressure", pressure, "Pa");
  }
  /// Pressure [Pa] held at x [m] at time t [s].
  Real at(const Vec<Dim>& x, Real t) const { return function ? function(x, t) : pressure; }
};

/// Drained wall: PrescribedPressure of 0 Pa.
struct Drained {
  static constexpr const char* name = "bc::Drained";
  Face face = unset_face;  ///< side of the domain
  AnyRegion region = {};   ///< or region
  TimeSwitch active = {};  ///< when; always by default

  /// The same condition as a prescribed pressure.
  template <int Dim>
  PrescribedPressure<Dim> prescribed() const {
    return {.face = face, .region = region, .pressure = 0, .active = active};
  }
  void validate(int dim) const { check::face_or_region(face, region, dim); }
};

/// Liquid pressure held at 0 at the current ground surface, wherever it has moved to: the paper's
/// rain, [Zhan] 4.4. Water is supplied without limit and counted as inflow.
struct ZeroSuction {
  static constexpr const char* name = "bc::ZeroSuction";
  AnyRegion region = {};   ///< part of the surface; all of it by default
  TimeSwitch active = {};  ///< when; always by default

  void validate(int dim) const { check::region(region, dim); }
};

/// Rain on the current ground and on free water, straight down or along `direction`: then slopes that
/// face it catch more than level ground, slopes that turn away less or nothing (no shadow is cast on
/// ground behind them). Per column of cells the soil drinks up to what it can take; what is left stays on the ground as a film, runs down
/// slopes (sheet flow by Manning's formula, without momentum), soaks in elsewhere, and becomes points
/// of free water as soon as it fills half a cell. Under rain no water is drawn in without supply, and
/// water that seeps out joins the film. Give `rate`, `table` or `function`. Evaporation has no model:
/// negative rates are refused, and from a function read as 0.
struct Rain {
  static constexpr const char* name = "bc::Rain";
  Real rate = unset;  ///< r [m/s] per horizontal area, >= 0
  /// Hyetograph: from time t [s] on it rains r [m/s], {{t, r}, ...}, t ascending; dry before.
  std::vector<std::array<Real, 2>> table = {};
  std::function<Real(Real)> function = {};  ///< r(t [s]) [m/s]
  AnyRegion region = {};                    ///< part of the ground; all of it by default
  /// Where the drops go, along the grid axes, of any length: {1, -2} drives them one to the right for
  /// every two down. Zero: straight down. The component along the last axis is negative.
  std::array<Real, 3> direction = {};
  /// Manning's n [s/m^(1/3)], > 0. One for all ground: that of the rain added last.
  Real roughness = 0.03;
  TimeSwitch active = {};  ///< when; always by default

  void validate(int dim) const {
    check::exactly_one(int(rate == rate) + int(!table.empty()) + int(static_cast<bool>(function)),
                       "rate, table, function", "m/s");
    if (function) check::non_negative("function(0 s)", function(0), "m/s");
    if (rate == rate) check::non_negative("rate", rate, "m/s");
    for (std::size_t i = 0; i < table.size(); ++i) {
      check::finite("table time", table[i][0], "s");
      check::non_negative("table rate", table[i][1], "m/s");
      if (i > 0 && !(table[i][0] > table[i - 1][0]))
        check::fail("table time", table[i][0], "(time before, inf)", "s");
    }
    check::positive("roughness", roughness, "s/m^(1/3)");
    check::region(region, dim);
    if (direction == std::array<Real, 3>{}) return;
    for (int d = 0; d < 3; ++d)
      check::finite("direction " + check::axis_name(d), direction[static_cast<std::size_t>(d)],
                    "-");
    for (int d = dim; d < 3; ++d)
      if (direction[static_cast<std::size_t>(d)] != 0)
        check::fail("direction " + check::axis_name(d), direction[static_cast<std::size_t>(d)],
                    "{0}", "-");
    if (!(fall(dim) < 0))
      check::fail("direction " + check::axis_name(dim - 1), fall(dim), "(-inf, 0)", "-");
  }
  /// Way of the drops along a horizontal axis for each metre that they fall [-].
  Real drift(int axis, int dim) const noexcept {
    return fall(dim) < 0 ? direction[static_cast<std::size_t>(axis)] / -fall(dim) : 0;
  }
  /// Component of the direction along the last of `dim` axes.
  Real fall(int dim) const noexcept { return direction[static_cast<std::size_t>(dim - 1)]; }
  /// Rate [m/s] at time t [s].
  Real at(Real t) const {
    if (function) return function(t);
    if (table.empty()) return rate;
    Real now = 0;
    for (const auto& [time, from_then_on] : table)
      if (time <= t) now = from_then_on;
    return now;
  }
};

/// Hydraulic head held at a wall or at a part of the ground: p = gamma_l (H - z), z the height against
/// gravity, gamma_l = rho_l |g|. Above H that is suction; water passes both ways. Give `head` or
/// `function`.
struct PrescribedHead {
  static constexpr const char* name = "bc::PrescribedHead";
  Face face = unset_face;                   ///< side of the domain
  AnyRegion region = {};                    ///< or region
  Real head = unset;                        ///< H [m], the height at which p = 0
  std::function<Real(Real)> function = {};  ///< H(t [s]) [m]
  TimeSwitch active = {};                   ///< when; always by default

  void validate(int dim) const {
    check::face_or_region(face, region, dim);
    check::exactly_one(int(head == head) + int(static_cast<bool>(function)), "head, function", "m");
    check::finite(function ? "function(0 s)" : "head", at(0), "m");
  }
  /// H [m] at time t [s].
  Real at(Real t) const { return function ? function(t) : head; }
};

/// Still water outside the soil, up to a level that may rise and fall: below the level p = gamma_l
/// (level - z) on the soil, whose weight the ground carries; above it a seepage face: water may come
/// out, none goes in. Give `level` or `function`. With neither face nor region: the whole ground.
struct Reservoir {
  static constexpr const char* name = "bc::Reservoir";
  Face face = unset_face;                   ///< side of the domain
  AnyRegion region = {};                    ///< part of it, or of the ground
  Real level = unset;                       ///< height of the water surface [m]
  std::function<Real(Real)> function = {};  ///< level(t [s]) [m]
  TimeSwitch active = {};                   ///< when; always by default

  void validate(int dim) const {
    check::wall_or_ground(face, region, dim);
    check::exactly_one(int(level == level) + int(static_cast<bool>(function)), "level, function",
                       "m");
    check::finite(function ? "function(0 s)" : "level", at(0), "m");
  }
  /// Level [m] at time t [s].
  Real at(Real t) const { return function ? function(t) : level; }
};

/// Water leaves the soil where its pressure exceeds `pressure`; none goes in. With neither face nor
/// region: the whole ground.
struct Drain {
  static constexpr const char* name = "bc::Drain";
  Face face = unset_face;  ///< side of the domain
  AnyRegion region = {};   ///< part of it, or of the ground
  Real pressure = 0;       ///< in the drain [Pa]
  TimeSwitch active = {};  ///< when; always by default

  void validate(int dim) const {
    check::wall_or_ground(face, region, dim);
    check::finite("pressure", pressure, "Pa");
  }
};

/// Soil open to the air, where springs may come out but no water goes in: Drain at 0 Pa.
struct SeepageFace {
  static constexpr const char* name = "bc::SeepageFace";
  Face face = unset_face;  ///< side of the domain
  AnyRegion region = {};   ///< part of it, or of the ground
  TimeSwitch active = {};  ///< when; always by default

  /// The same condition as a drain.
  Drain drain() const { return {.face = face, .region = region, .active = active}; }
  void validate(int dim) const { check::wall_or_ground(face, region, dim); }
};

}  // namespace bc
}  // namespace vadose
