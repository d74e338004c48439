// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// What nodes, cells and faces hold during a step. Nothing here outlives the step: the points
/// carry the state.

#include <cstdint>
#include <vector>

#include <vadose/core/aligned.hpp>
#include <vadose/grid/block_grid.hpp>

namespace vadose {

/// Lanes of a node record after mapping: mass, momentum, then the point forces and the volume.
namespace lane {
inline constexpr int mass = 0;      ///< [kg]
inline constexpr int momentum = 1;  ///< first of three [kg m/s]
inline constexpr int force = 4;     ///< first of three [N]
inline constexpr int volume = 7;    ///< bulk volume of the skeleton [m3]
// After the momentum balance:
inline constexpr int velocity = 0;   ///< first of three, new velocity [m/s]
inline constexpr int increment = 4;  ///< first of three, change of velocity [m/s]
// Sums over the pore-water points of a cell:
inline constexpr int bulk_volume = 0;    ///< V [m3]
inline constexpr int water = 1;          ///< m [kg]
inline constexpr int pore_volume = 2;    ///< n V [m3]
inline constexpr int pore_pressure = 3;  ///< n V p [J]
inline constexpr int pore_position = 4;  ///< first of three, n V x [m4]
// Sums over the free-water points of a cell:
inline constexpr int free_volume = 0;    ///< V [m3]
inline constexpr int free_water = 1;     ///< m [kg]
inline constexpr int free_pressure = 3;  ///< V p [J]
inline constexpr int free_position = 4;  ///< first of three, V x [m4]
// Second record of a cell: water content and storage at a trial pressure.
inline constexpr int content = 4;          ///< sum V theta(p) [m3]
inline constexpr int storage = 5;          ///< sum V d(theta)/dp [m3/Pa]
inline constexpr int skeleton_volume = 6;  ///< sum V of the solid points [m3]
inline constexpr int mean_stress = 7;      ///< sum V tr(sigma*)/3 [J]
// The same record once the points have their new velocities:
inline constexpr int pore_momentum = 0;  ///< first of three, of the pore water [kg m/s]
inline constexpr int free_momentum = 3;  ///< first of three, of the free water [kg m/s]
inline constexpr int near_mass = 6;      ///< free water weighted by its nearness to the soil [kg]
// The same record then: what a pore-water point takes of the gains of its cell.
inline constexpr int by_pores = 0;       ///< mass per pore volume of the point [kg/m3]
inline constexpr int by_mass = 1;        ///< mass per mass of the point [-]
inline constexpr int brought = 2;        ///< first of three, mean velocity of the cell [m/s]
inline constexpr int velocity_gain = 5;  ///< first of three, change of velocity [m/s]
}  // namespace lane

/// What fills a cell.
enum class CellKind : std::uint8_t {
  none,  ///< no water (air, or dry soil of a model without liquid)
  soil,  ///< pore water: pressure from the ledger
  free,  ///< free water: pressure carried by its points
};

/// Pressure unknown of a cell and its surroundings. Passes over the cells wait for memory: what one pass
/// needs lies together, in groups that fill cache lines in three dimensions.
template <int Dim>
struct alignas(64) Cell {
  CellKind kind = CellKind::none;
  std::uint8_t material = 0;   ///< of the largest bulk volume
  std::uint8_t members = 1;    ///< itself and the slivers that share its pressure
  bool at_air = false;         ///< a face of the cell is open to air
  bool drop = false;           ///< stands alone: no force, no volume change
  bool has_reference = false;  ///< reference_pressure applies
  bool is_fed = false;  ///< more free water comes through `ground` and other faces than leaves
  bool solved = false;  ///< an implicit solution gave `change`
  std::int8_t ground_axis =
      -1;                 ///< across the face at `ground`; -1: none, all water counts as near
  Real raw_fill = 0;      ///< filled fraction of the cell by itself
  Real pressure = 0;      ///< p_c at the centroid [Pa]
  Real saturation = 0;    ///< S_c = M_c / (rho_l(p) sum n V), at most 1
  Real porosity = 1;      ///< pore-weighted mean n
  Real conductivity = 0;  ///< k(S_c, n) [m/s]
  Real saturated_conductivity = 0;  ///< k(1, n) [m/s]

  Real centroid[Dim] = {};  ///< of the water-bearing volume [m]
  Real pore_volume = 0;     ///< sum n V [m3]
  Real soil_pores = 0;      ///< pore volume of the soil in the cell, as soil_porosity [m3]
  Real storage = 0;         ///< sum V d(theta)/dp [m3/Pa]
  Real content = 0;         ///< water volume at reference density, M / rho_l0 [m3]
  Real modulus = 0;         ///< K* = S / (S/K + S_p) of soil [Pa]

  Real quad_point[Dim] =
      {};                  ///< where the pressure acts: cell centre, or centroid of a cut cell [m]
  Real quad_volume = 0;    ///< volume the pressure acts in, f V_c [m3]
  Real quad_pressure = 0;  ///< pressure at quad_point [Pa]
  Real soil_share = 0;     ///< bulk volume of soil / water-bearing volume [-]
  Real soil_porosity = 1;  ///< of the soil in the cell, also where free water fills most of it

  Real water = 0;                ///< M_c [kg]
  Real gain = 0;                 ///< water received in the step [kg]
  Real mean_velocity[Dim] = {};  ///< of the water it holds, new, mass weighted [m/s]
  Real skeleton_rate = 0;        ///< div v^s [1/s]
  /// Of air-filled pores in the last step, NaN: not known; in unsaturated models [m3/s].
  Real closing = unset;
  Real change = 0;  ///< of the pressure over the step, of soil or where solved for [Pa]

  Real momentum_gain[Dim] = {};  ///< velocity change by exchanged momentum [m/s]
  Real low = 0, high = 0;        ///< bracket of the pressure while it is sought [Pa]
  Real soil_water = 0;           ///< pore water in soil_pores [kg]
  Real pore_gain = 0;            ///< water the pores of a free cell take from its free points [kg]
  Real rate = 0;                 ///< div q of free water [1/s]

  Real fill = 0;                 ///< filled fraction, slivers included; 1 away from air
  Real surface_point[Dim] = {};  ///< on the plane that cuts a cell at air [m]
  /// Liquid pressure at the surface of a cell at air, across each axis: as held there, else that of the
  /// cell itself (a closed surface carries it) [Pa].
  Real reference_pressure[Dim] = {};
  Real near_water = 0;  ///< free water weighted by its nearness to `ground` [kg]

  Real reference_share[Dim] = {};  ///< part of reference_pressure that follows that of the cell [-]
  Real ground = 0;                 ///< place on its axis of the face to soil that passes most [m]
};

/// What faces need to know of a cell that gives water.
struct Donor {
  Real limit = 1;  ///< part of its outflow that it can give [-]
  Real water = 0;  ///< Cell::water [kg]
};

/// What a face between two cells is.
enum class FaceKind : std::uint8_t {
  closed,   ///< no flux
  inside,   ///< between two soil cells
  to_free,  ///< soil and free water
  surface,  ///< soil and air, or a wall held at a pressure
};

/// The lower face of a cell along one axis. First what every pass over the faces reads.
struct FaceFlux {
  FaceKind kind = FaceKind::closed;
  bool one_way = false;     ///< lets water out only
  bool fed = false;         ///< ground under rain or a film, which takes what comes out
  bool wetted = false;      ///< and feeds it
  bool thirsty = false;     ///< the soil drinks all it is given: its surface stays under suction
  bool soil_below = false;  ///< of a surface or to_free face: the soil is on the lower side
  bool from_above = false;  ///< of an inside face: the upper cell is upstream as the step begins
  std::int16_t held = -1;   ///< which HeldPressure; -1: none
  Real head_gradient = 0;   ///< H = (dp - rho g dx) / d, upwards along the axis [Pa/m]
  Real saturation = 0;      ///< of the upstream side
  Real conductivity = 0;    ///< Kirchhoff blend [m/s]
  Real area = 0;            ///< [m2]
  Real flux = 0;            ///< volume per time, upwards along the axis, times A [m3/s]
  Real distance = 0;        ///< over which H is taken [m]
  Real held_pressure = 0;   ///< at an open surface or wall [Pa]
  Real outward = 1;  ///< factor of the conductivity of the cell on the way to its outer face [-]
  Real supply = 0;   ///< what a fed or thirsty face can take at most [m3/s]

  /// A surface that lets no water through, as far as pressures and nodes are concerned.
  bool is_shut() const noexcept {
    return kind == FaceKind::surface && ((held < 0 && !fed) || thirsty);
  }
  /// Whether the soil that lets the water pass is above: the upstream cell, at a boundary the soil.
  bool is_from_above() const noexcept {
    return kind == FaceKind::inside ? from_above : !soil_below;
  }
};

/// A node that only slivers touch, and the nodes of a cell that carry it.
template <int Dim>
struct CarriedNode {
  static constexpr int corners = 1 << Dim;
  std::int32_t entry = -1;            ///< of the node
  std::int32_t owner = -1;            ///< the carrying cell; -1: the node is held from outside
  std::int32_t corner[corners] = {};  ///< nodes of that cell
  Real weight[corners] = {};          ///< their parts in its motion and its loads; they sum to 1
};

/// All arrays of the grid; one entry per cell or node of the existing blocks.
template <int Dim>
struct GridState {
  AlignedVector<Record> solid_in;    ///< solid mass, momentum, force, volume
  AlignedVector<Record> solid_out;   ///< solid velocity and its change
  AlignedVector<Record> liquid_in;   ///< liquid mass, momentum, force
  AlignedVector<Record> liquid_out;  ///< liquid velocity and its change
  AlignedVector<Record> mixture;     ///< q (lanes 0 .. 2), flow resistance of a node (4 .. 6)
  AlignedVector<Record> pore;        ///< sums over pore-water points of a cell
  AlignedVector<Record> free;        ///< sums over free-water points of a cell
  AlignedVector<Record> content;     ///< liquid momentum, content and storage of a cell
  AlignedVector<Record> materials;   ///< bulk volume of each material in a cell
  AlignedVector<Record> relative;    ///< n (v^l - v^s) and mean face H of a node
  bool holds_free = false;           ///< `free` is not all zero
  std::vector<Real> limited;         ///< water the donor limiter held back, per block [kg]
  std::vector<Real> frequency2;      ///< highest frequency squared of soil, per block [1/s2]
  std::vector<Real> open_impulse;    ///< pressure force that no phase took, Dim per block [N s]
  std::vector<Real> ledger_in;       ///< inflow of a block through each HeldPressure [kg]
  std::vector<Cell<Dim>> cell;
  std::vector<char> retry;        ///< blocks whose pressures are not found yet, one per slot
  std::vector<char> sought;       ///< scratch: marks of blocks before they are widened
  std::vector<char> near_sliver;  ///< blocks that hold a sliver or lie beside one, one per slot
  /// Blocks with a pressure cell at air, at a wall or with a sliver, one per slot.
  std::vector<char> has_edge;
  /// Pressure of the water of a cell at the origin, p_c - rho_l g . x_c, by the cell whose pressure it
  /// uses; one per cell [Pa].
  std::vector<Real> head;
  std::vector<Real> soil;     ///< 1 for cells of soil, 0 for others: what points read of them [-]
  std::vector<Real> filling;  ///< mass per pore volume of saturated soil, else 0 [kg/m3]
  std::vector<Real> rate;  ///< div v^s of the soil cell whose pressure a cell uses; NaN: none [1/s]
  std::vector<std::int32_t> dof;  ///< entry of the cell whose pressure a cell uses, -1: none
  std::vector<FaceFlux> face;     ///< Dim per cell
  /// FaceFlux::flux of them, as loops over neighbours read it; then the water that passes in the step,
  /// upwards along the axis [kg].
  std::vector<Real> flux;
  std::vector<Donor> donor;               ///< one per cell that owns its pressure
  std::vector<CarriedNode<Dim>> carried;  ///< in ascending order, once per carrying cell
  std::vector<std::uint16_t> node_flags;  ///< walls and prescribed motion, see NodeFlag
};

/// Bits of GridState::node_flags.
namespace node_flag {
inline constexpr std::uint16_t solid_fixed = 1;   ///< << axis: no solid velocity along the axis
inline constexpr std::uint16_t liquid_fixed = 8;  ///< << axis: no liquid velocity along the axis
inline constexpr std::uint16_t special = 64;      ///< friction or prescribed motion: look it up
}  // namespace node_flag

}  // namespace vadose
