// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Everything a step works on: points, grid arrays, soils, loads. Kernels are free functions of it.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <vadose/core/compensated_sum.hpp>
#include <vadose/grid/point_set.hpp>
#include <vadose/kernel/grid_state.hpp>
#include <vadose/kernel/pressure_system.hpp>
#include <vadose/kernel/tile.hpp>
#include <vadose/model/fields.hpp>
#include <vadose/model/material.hpp>
#include <vadose/policy/kirchhoff.hpp>

namespace vadose {

/// At most this many soils in one scene: one lane each in GridState::materials.
inline constexpr int max_materials = lane_count;

/// Driest effective saturation that a pressure is computed for. Drier cells keep the pressure of
/// this one; their water content stays exact.
inline constexpr Real driest_effective_saturation = 0.01;

namespace detail {

template <class M, bool Unsaturated = is_unsaturated<M>>
struct KirchhoffOf {
  using type = KirchhoffMean<typename M::Retention, typename M::Conductivity>;
};
template <class M>
struct KirchhoffOf<M, false> {
  using type = char;
};

}  // namespace detail

/// One soil, ready for use in loops.
template <class M, bool WithLaw = has_skeleton<M>>
struct Soil {
  Material<M> material;                       ///< all shared numbers handed on
  law::PreparedOf<typename M::Skeleton> law;  ///< with derived numbers
  Real p_wave_modulus = 0;                    ///< of the initial state [Pa]
  Real shear_modulus = 0;                     ///< of the initial state [Pa]
  Real pressure_floor = -1e9;                 ///< lowest pressure sought [Pa]
  /// Mean conductivity between two pressures; only in unsaturated models.
  std::optional<typename detail::KirchhoffOf<M>::type> kirchhoff;

  /// K = E_c - 4 G / 3 [Pa].
  Real bulk_modulus() const noexcept { return p_wave_modulus - 4 * shear_modulus / 3; }
};
template <class M>
struct Soil<M, false> {};

/// A load on the ground that follows the soil: a piece of surface with a fixed force.
template <int Dim>
struct SurfaceLoad {
  Vec<Dim> position;   ///< on the surface, carried along [m]
  Vec<Dim> force;      ///< at factor 1 [N]
  std::size_t factor;  ///< which time factor
};

/// A node whose solid motion is prescribed or limited by friction.
template <int Dim>
struct SpecialNode {
  /// Of the node in the arrays of the grid.
  std::int32_t entry = -1;
  /// Motion along the axis is given.
  bool prescribed[Dim] = {};
  Real velocity[Dim] = {};  ///< at factor 1 [m/s]
  std::size_t factor = 0;   ///< which time factor
  int friction_axis = -1;   ///< normal of a frictional wall, -1: none
  int friction_side = 0;    ///< 0: wall at the lower end
  Real friction = 0;        ///< coefficient [-]
};

/// How water passes a wall or the ground surface where a condition acts.
enum class HeldKind : std::uint8_t {
  open,       ///< both ways at the held pressure
  rain,       ///< in at p <= 0 as supplied, out at p = 0
  outlet,     ///< out only, at the held pressure
  reservoir,  ///< both ways where its pressure is positive, else out only at p = 0
  closed,     ///< not at all
};

/// Where the liquid meets something at a held pressure: a wall, or the ground surface.
template <int Dim>
struct HeldPressure {
  int face_axis = -1;  ///< wall normal; -1: the ground surface
  /// 0: lower, 1: upper wall.
  int face_side = 0;
  /// Which way water goes.
  HeldKind kind = HeldKind::open;
  bool limited = false;                                 ///< to a region
  bool acts = true;                                     ///< at the present time
  std::function<bool(Real)> active = {};                ///< at time t [s]; empty: always
  std::function<bool(const Vec<Dim>&)> contains;        ///< part of it
  std::function<Real(const Vec<Dim>&, Real)> pressure;  ///< p(x, t) [Pa]
  /// Water offered at the ground surface [m/s per horizontal area] at time t [s]; empty: no limit.
  std::function<Real(Real)> supply = {};
  Real supply_rate = 0;    ///< the same at the present time [m/s]
  Real drift[Dim] = {};    ///< way of the drops along each horizontal axis per metre of fall [-]
  CompensatedSum inflow;   ///< water taken in so far [kg]
  CompensatedSum outflow;  ///< water let out so far [kg]

  /// Whether it is at a place: a wall of this axis and side, or the ground (axis -1).
  bool is_at(int axis, int side, const Vec<Dim>& x) const {
    return acts && face_axis == axis && (axis < 0 || face_side == side) && contains(x);
  }
};

/// A vertical column of cells, where films may stand on the ground.
template <int Dim>
struct RainColumn {
  std::int32_t top = -1;  ///< highest cell that holds soil or water, -1: none
  Index<Dim> top_cell{};  ///< its coordinates
  Real area = 0;          ///< horizontal [m2]
  Real film = 0;          ///< water on the ground that is no point [kg]; outlives the step
  Real potential = 0;     ///< what the soil could take of it [m3/s]
  bool gathers = false;   ///< its free points in the top cell become film
};

/// Numbers of the liquid.
struct LiquidNumbers {
  Real density = 1000;        ///< rho_l0 [kg/m3]
  Real bulk_modulus = 2.2e9;  ///< K [Pa]
};

/// What happens to points that leave the box.
enum class Escape : std::uint8_t {
  error,    ///< the step fails
  outflow,  ///< they are taken out and counted as lost
  clamp,    ///< they are put back on the wall, at rest across it
};

/// Merge and split of free-water points, done when points are sorted. A full point has the mass
/// rho_l (h / points_per_axis)^dim.
struct Resampling {
  bool on = false;          ///< off: points keep their number
  Real merge_below = 0.25;  ///< lighter ones join a neighbour [full points], in [0, 0.5]
  Real split_above = 2;     ///< heavier ones are halved [full points], >= 1.5
  int points_per_axis = 2;  ///< of full points in a cell, in [1, 8]

  void validate() const {
    check::within("merge_below", merge_below, 0, 0.5, "full points");
    if (!(split_above >= 1.5)) check::fail("split_above", split_above, "[1.5, inf)", "full points");
    check::within("points_per_axis", points_per_axis, 1, 8, "-");
  }
};

/// What lets quasi-static steps be longer than those of waves in the skeleton.
enum class SlowSkeleton : std::uint8_t {
  implicit,  ///< its motion is solved for, with the elastic stiffness of the points
  heavy,     ///< its grains resist acceleration with as much more inertia as that takes
};

/// Quasi-static periods of a semi-implicit run: its steps are not bound by waves in the skeleton, and damping
/// brings it to rest. Where the forces out of balance (with heavy grains: inertia) come to more than a small
/// part of the weights and loads, steps shorten until, at the step of the waves, the motion is dynamic, and
/// damping fades.
struct QuasiStatic {
  bool on = false;                                 ///< off: every step is dynamic
  SlowSkeleton skeleton = SlowSkeleton::implicit;  ///< see there
  /// Forces out of balance, or inertia, over weights and loads that a step aims at [-], in (0, 0.1]
  Real inertia = 1e-4;
  /// The same from which on only SolverOptions::damping damps [-], above `inertia`.
  Real dynamic = 1e-2;
  Real damping = 0.5;  ///< local damping of the skeleton at rest [-], in [0, 1)

  void validate() const {
    if (!(inertia > 0 && inertia <= 0.1)) check::fail("inertia", inertia, "(0, 0.1]", "-");
    if (!(dynamic > inertia)) check::fail("dynamic", dynamic, "(inertia, inf)", "-");
    if (!(damping >= 0 && damping < 1)) check::fail("damping", damping, "[0, 1)", "-");
  }
};

/// Choices of a step.
struct StepOptions {
  Real courant = 0.5;           ///< C [-] of the stable step
  Real damping = 0;             ///< local damping of the skeleton [-], in [0, 1)
  Real displacement_cap = 0.1;  ///< largest motion in a step, in cells
  Real dt_max = 1e30;           ///< largest step [s]
  /// Decay of what a free point's pressure differs from its cell's [1 / cell passed], >= 0.
  Real free_relaxation = 3;
  int threads = 1;  ///< used where the host links OpenMP
  /// Points that leave the box.
  Escape escaped = Escape::error;
  /// Of free water.
  Resampling resampling = {};
  Real saturation_step = 0.002;  ///< change of S that a semi-implicit step aims at [-]
  /// Of semi-implicit runs.
  QuasiStatic quasi_static = {};
};

/// Sums of one thread, in its own cache lines.
struct alignas(64) StepSums {
  Real max_speed2 = 0;  ///< [m2/s2]
  Real max_wave2 = 0;   ///< largest dry p-wave speed squared [m2/s2]
  /// The same of soil outside the cells with water, in columns with water: only there water holds the
  /// soil of its cells.
  Real max_dry_wave2 = 0;
  Real max_drag = 0;  ///< fastest decay of a relative velocity by explicit drag [1/s]
  /// A point is in an impossible state.
  bool failed = false;
  bool escaped = false;  ///< a point left the box
};

/// What went wrong where.
struct Trouble {
  const char* criterion = nullptr;  ///< nullptr: nothing
  const char* phase = "";           ///< "solid", "liquid"
  /// Of what the criterion looks at.
  Real value = 0;
  /// Of the point; -1: none.
  std::int64_t id = -1;
  /// [m].
  std::array<Real, 3> position{};
};

/// State of a run of model M.
template <class M>
struct State {
  /// Of the model.
  using Kinematics = typename M::Kinematics;
  static constexpr int dim = Kinematics::dim;
  static constexpr int stress_size = Kinematics::stress_size;
  /// Set of solid points.
  using Solid = PointSet<dim, SolidFields<M>>;
  /// Set of liquid points.
  using Liquid = PointSet<dim, LiquidFields<M>>;

  /// Cells and blocks that exist.
  BlockGrid<dim> grid;
  /// What cells, faces and nodes hold.
  GridState<dim> nodes;
  PressureSystem<dim> system;  ///< of a semi-implicit run
  /// Grains.
  Solid solid;
  /// Pore water and free water.
  Liquid liquid;
  /// Groups of points.
  std::vector<Soil<M>> soils;
  /// Viscous law of free water.
  [[no_unique_address]] std::conditional_t<has_liquid<M>, typename M::Liquid, NoLiquid> fluid;
  /// Velocities to points.
  typename M::Transfer transfer;
  /// Density, compressibility.
  LiquidNumbers water;
  /// [m/s2].
  Vec<dim> gravity = Vec<dim>::Zero();
  /// Of the run.
  StepOptions options;

  Real time = 0;           ///< [s]
  Real dt = 0;             ///< step in work [s]
  Real flip_share = 1;     ///< exp(-pic_rate dt) of a blending transfer [-]
  std::int64_t step = 0;   ///< steps taken
  Real slack = 0;          ///< motion since the last sort [m]
  bool frozen = false;     ///< liquid state held while the skeleton settles
  Real limited_water = 0;  ///< held back by the donor limiter so far [kg]
  /// Impulse of pressure forces that no phase took so far [N s]: at nodes of free water, by packing
  /// noise of its points; at the fringe of the skeleton. Momentum of a closed system closes with it.
  Vec<dim> open_impulse = Vec<dim>::Zero();

  /// Follow the ground.
  std::vector<SurfaceLoad<dim>> loads;
  std::vector<std::function<Real(Real)>> factors;  ///< of time [s]; empty: 1
  std::vector<Real> factor_values;                 ///< the same at the present time [-]
  std::vector<SpecialNode<dim>> special;           ///< in ascending order of entry
  /// Conditions of the liquid, in their order.
  std::vector<HeldPressure<dim>> held;
  bool films = false;                    ///< rain or free water: there may be films on the ground
  std::vector<RainColumn<dim>> columns;  ///< empty without films
  Real roughness = 0.03;                 ///< Manning's, of the ground [s/m^(1/3)]
  CompensatedSum lost_water;             ///< that left the box with its points [kg]
  CompensatedSum lost_solid;             ///< the same of the grains [kg]
  CompensatedSum rain;                   ///< fallen so far [kg]
  CompensatedSum added_water;            ///< put in less taken out by the host [kg]
  CompensatedSum added_solid;            ///< the same of the grains [kg]
  std::int64_t next_liquid_id = 0;       ///< of the next liquid point

  static constexpr int tiles_per_thread = 6;  ///< see tile()
  AlignedVector<kernel::Tile<dim>> tiles;     ///< tiles_per_thread each
  std::vector<StepSums> sums;                 ///< one per thread
  /// Of the last step.
  Trouble trouble;

  /// Group of free water among liquid points.
  int free_group() const noexcept { return static_cast<int>(soils.size()); }
  /// Scratch tile of a thread: 0 and 1 are zero between uses, the others are read into.
  kernel::Tile<dim>& tile(int thread, int use = 0) noexcept {
    return tiles[static_cast<std::size_t>(tiles_per_thread * thread + use)];
  }
  /// Volume of a cell (per metre, per radian): h^dim, times the radius of its centre.
  Real cell_volume(Real radius) const noexcept {
    const Real v = power<dim>(grid.cell_size());
    return Kinematics::axisymmetric ? v * radius : v;
  }
};

}  // namespace vadose
