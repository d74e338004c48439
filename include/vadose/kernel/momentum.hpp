// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Steps 5 to 7, [Zhan] 3.4 (d), (e): forces, drag, walls and new velocities of every node.

#include <algorithm>

#include <Eigen/LU>

#include <vadose/kernel/faces.hpp>
#include <vadose/kernel/map_to_grid.hpp>

namespace vadose::kernel {

/// What the cells around a node give it.
template <int Dim>
struct NodeSums {
  Real volume = 0;  ///< V_c,I = sum f V_c N_I [m3]
  /// G_I = sum f V_c (p - p_ref) grad N_I [N]; p_ref is the pressure at the surface or held wall
  /// that the node's cells end at, so that uniform pressure is at rest for any cut.
  Real force[Dim] = {};
  Real gradient[Dim] = {};   ///< sum f V_c grad N_I, zero inside [m2]
  Real reference[Dim] = {};  ///< sums of reference pressures of the cells around [Pa]
  int references = 0;
  Real soil_force[Dim] = {};      ///< sum f V_c S p grad N_I [N]
  Real skeleton_force[Dim] = {};  ///< - sum f V_c (mean Bishop stress) grad N_I [N]
  Real soil_volume = 0;           ///< share of V_c,I in soil cells, bulk of soil only [m3]
  Real pores = 0;                 ///< sum of n over it [m3]
  Real saturation[Dim] = {};      ///< upstream, mean over the faces across an axis
  Real conductivity[Dim] = {};
  Real head_gradient[Dim] = {};
  std::uint8_t material = 0;
  int soil_cells = 0;           ///< cells around that hold soil
  bool closed_surface = false;  ///< touches soil and air, and no water passes
  bool has_soil = false;
  bool has_free = false;  ///< touches free water
  Real normal[Dim] = {};  ///< out of the soil, where closed_surface

  /// Part of the control volume that is soil; the rest is free water [-].
  Real soil_share() const noexcept { return soil_volume > 0 ? min(1.0, soil_volume / volume) : 0; }
  /// Of the control volume; that of free water is 1. Volumetric, so that a trace of solid at a node
  /// does not make it soil.
  Real porosity() const noexcept {
    return soil_volume > 0 ? 1 - (1 - pores / soil_volume) * soil_share() : 1;
  }
};

/// Value and gradient of the hat function of corner `corner` (0 or 1 per axis) of a cell.
template <int Dim>
struct CornerFunction {
  Real value = 1;
  Real gradient[Dim];

  CornerFunction(const Real (&xi)[Dim], const Index<Dim>& corner, Real over_h) noexcept {
    Real n[Dim], g[Dim];
    for (int d = 0; d < Dim; ++d) {
      n[d] = corner[d] ? xi[d] : 1 - xi[d];
      g[d] = corner[d] ? over_h : -over_h;
      value *= n[d];
    }
    for (int d = 0; d < Dim; ++d) {
      gradient[d] = g[d];
      for (int e = 0; e < Dim; ++e)
        if (e != d) gradient[d] *= n[e];
    }
  }
};

/// Coordinates of a cell's quadrature point in the cell, 0 .. 1 (up to 1.5 with slivers).
template <class M>
void quad_coordinates(const State<M>& state, const Index<State<M>::dim>& cell,
                      const Cell<State<M>::dim>& c, Real (&xi)[State<M>::dim]) noexcept {
  const Real over_h = 1 / state.grid.cell_size();
  for (int d = 0; d < State<M>::dim; ++d)
    xi[d] = (c.quad_point[d] - state.grid.origin()[d]) * over_h - cell[d];
}

/// Lanes of what a cell brings to its nodes: in the first record what goes with value and gradient
/// of a node's function, in the second what adds up over the cells around a node, and their places.
namespace cell_lane {
inline constexpr int volume = 0;         ///< f V_c [m3]
inline constexpr int pressure = 1;       ///< f V_c p [J]
inline constexpr int soil_pressure = 2;  ///< f V_c S p [J]
inline constexpr int mean_stress = 3;    ///< - f V_c (mean Bishop stress) of the soil in it [J]
inline constexpr int soil_volume = 4;    ///< f V_c of soil [m3]
inline constexpr int pores = 5;          ///< n of soil over it [m3]
inline constexpr int holds_soil = 6;     ///< f V_c where there is soil at all [m3]
// Second record:
inline constexpr int saturation = 0;    ///< of a cell with soil [-]
inline constexpr int conductivity = 1;  ///< of a cell with soil [m/s]
inline constexpr int counts = 3;  ///< 1 with a reference pressure, 16 with soil, 256 free water
inline constexpr int place = 4;   ///< first of three, quadrature point in the cell
inline constexpr int over_radius = 7;  ///< 1/r there [1/m]
}  // namespace cell_lane

/// The two records of a cell.
/// DEVIATION: [Zhan] Eq. (22) takes the whole stress of each point to the nodes.
/// The skeleton's mean stress acts here like the liquid's pressure, with the same quadrature: a
/// free surface under suction (sigma* = S p) is then in balance node by node, and a stiff liquid
/// does not lock the skeleton; the deviator acts through the points' own functions.
template <class M>
void prepare_cell(const State<M>& state, const Cell<State<M>::dim>& c,
                  const Index<State<M>::dim>& cell, Record& weighted, Record& plain) noexcept {
  constexpr int dim = State<M>::dim;
  Real xi[dim];
  quad_coordinates(state, cell, c, xi);
  const bool soil = c.soil_share > 0;
  const Real p = c.quad_volume * c.quad_pressure;
  weighted[cell_lane::volume] = c.quad_volume;
  weighted[cell_lane::pressure] = p;
  weighted[cell_lane::soil_pressure] = c.saturation * p;
  weighted[cell_lane::mean_stress] = -(c.quad_volume * c.soil_share * c.mean_stress);
  weighted[cell_lane::soil_volume] = soil ? c.quad_volume * c.soil_share : 0;
  weighted[cell_lane::pores] = weighted[cell_lane::soil_volume] * c.soil_porosity;
  weighted[cell_lane::holds_soil] = soil ? c.quad_volume : 0;
  plain[cell_lane::saturation] = soil ? c.saturation : 0;
  plain[cell_lane::conductivity] = soil ? c.conductivity : 0;
  plain[cell_lane::counts] =
      (c.has_reference ? 1 : 0) + (soil ? 16 : 0) + (c.kind == CellKind::free ? 256 : 0);
  for (int d = 0; d < dim; ++d) plain[cell_lane::place + d] = xi[d];
  plain[cell_lane::over_radius] = State<M>::Kinematics::axisymmetric ? 1 / c.quad_point[0] : 0;
}

/// The records of all cells around the nodes of a block.
template <class M>
struct CellParts {
  static constexpr int dim = State<M>::dim;
  const Record* weighted;
  const Record* plain;

  CellParts(State<M>& state, int slot, int thread)
      : weighted(state.tile(thread, 2).record), plain(state.tile(thread, 3).record) {
    const auto& grid = state.grid;
    const Index<dim> first = grid.first_cell(slot);
    for_cube<dim>(-1, Block<dim>::edge, [&](const Index<dim>& i) {
      const int at = BlockGrid<dim>::tile_index(i);
      const std::int32_t e = grid.tile(slot)[at];
      if (state.nodes.dof[static_cast<std::size_t>(e)] != e) return;
      Index<dim> cell = first;
      for (int d = 0; d < dim; ++d) cell[d] += i[d];
      prepare_cell(state, state.nodes.cell[static_cast<std::size_t>(e)], cell,
                   state.tile(thread, 2).record[at], state.tile(thread, 3).record[at]);
    });
  }
};

/// Sums over the cells around a node, as they are added up.
template <int Dim>
struct CellSums {
  Lanes value{0.0}, plain{0.0};
  Lanes slope[Dim];

  CellSums() noexcept {
    for (auto& s : slope) s = Lanes(0.0);
  }
  /// Adds a cell of which the node is corner `corner`.
  VADOSE_INLINE void add(const Record& weighted, const Record& marks, const Index<Dim>& corner,
                         Real over_h) noexcept {
    Real xi[Dim];
    for (int d = 0; d < Dim; ++d) xi[d] = marks[cell_lane::place + d];
    CornerFunction<Dim> shape(xi, corner, over_h);
    shape.gradient[0] += shape.value * marks[cell_lane::over_radius];
    const Lanes w = Lanes::load(weighted.value);
    value += w * Lanes(shape.value);
    for (int d = 0; d < Dim; ++d) slope[d] += w * Lanes(shape.gradient[d]);
    plain += Lanes::load(marks.value);
  }
  /// What the node needs of them.
  void store(NodeSums<Dim>& node) const noexcept {
    const int counts = static_cast<int>(plain[cell_lane::counts]);
    node.references = counts % 16;
    node.soil_cells = counts / 16 % 16;
    node.has_soil = node.soil_cells > 0;
    node.has_free = counts >= 256;
    node.volume = value[cell_lane::volume];
    node.soil_volume = value[cell_lane::soil_volume];
    node.pores = value[cell_lane::pores];
    for (int d = 0; d < Dim; ++d) {
      node.force[d] = slope[d][cell_lane::pressure];
      node.gradient[d] = slope[d][cell_lane::volume];
      node.soil_force[d] = slope[d][cell_lane::soil_pressure];
      node.skeleton_force[d] = slope[d][cell_lane::mean_stress];
      node.normal[d] = -slope[d][cell_lane::holds_soil];
      node.saturation[d] = plain[cell_lane::saturation];  // fallback where no face crosses the axis
      node.conductivity[d] = plain[cell_lane::conductivity];
    }
  }
};

/// Position of the face that counts at a node for the lower face of the cell at `at` in a tile: that
/// face, or, where it lies between a sliver and the cell whose pressure the sliver shares, the surface
/// on the sliver's far side. (The water of the sliver is at the nodes of that cell.)
template <class M>
std::size_t face_at_node(const State<M>& state, const std::int32_t* tile, int at,
                         int axis) noexcept {
  constexpr int dim = State<M>::dim;
  const auto& nodes = state.nodes;
  const auto face = [&](std::int32_t cell) {
    return static_cast<std::size_t>(cell) * dim + static_cast<std::size_t>(axis);
  };
  const std::size_t near = face(tile[at]);
  if (nodes.face[near].kind != FaceKind::closed) return near;
  const int stride = BlockGrid<dim>::tile_stride(axis);
  const std::int32_t cell = tile[at], low = tile[at - stride];
  const std::int32_t owner = nodes.dof[static_cast<std::size_t>(cell)];
  if (owner < 0 || cell == low || owner != nodes.dof[static_cast<std::size_t>(low)]) return near;
  if (owner != low && owner != cell) return near;
  const std::size_t far = face(owner == low ? tile[at + stride] : low);
  return nodes.face[far].kind == FaceKind::inside ? near : far;
}

/// Gathers cells and faces around a node (local index in its block).
template <class M>
NodeSums<State<M>::dim> gather_node(const State<M>& state, const CellView<M>& view,
                                    const CellParts<M>& parts) {
  constexpr int dim = State<M>::dim;
  const auto& nodes = state.nodes;
  NodeSums<dim> node;
  int air = 0, faces[dim] = {};
  Real saturation[dim] = {}, conductivity[dim] = {}, gradient[dim] = {};
  bool open = false;
  CellSums<dim> sums;
  const Real over_h = 1 / state.grid.cell_size();
  for_cube<dim>(0, 2, [&](const Index<dim>& corner) {
    // The cell of which this node is corner `corner`.
    int at = view.at;
    bool inside = true;
    for (int d = 0; d < dim; ++d) {
      const int cell = view.cell[d] - corner[d];
      at -= corner[d] * BlockGrid<dim>::tile_stride(d);
      inside = inside && cell >= 0 && cell < state.grid.cells()[d];
    }
    const auto e = static_cast<std::size_t>(view.tile[at]);
    const std::int32_t owner = nodes.dof[e];
    if (inside && owner < 0) ++air;
    if (inside && owner == view.tile[at]) {
      sums.add(parts.weighted[at], parts.plain[at], corner, over_h);
      if (nodes.cell[e].has_reference)
        for (int d = 0; d < dim; ++d) node.reference[d] += nodes.cell[e].reference_pressure[d];
      if (state.soils.size() > 1 && nodes.cell[e].soil_share > 0)
        node.material = nodes.cell[e].material;
    }
    // Faces whose plane goes through the node: lower faces of the cells on its upper side.
    for (int d = 0; d < dim; ++d) {
      if (corner[d]) continue;
      const FaceFlux& f = nodes.face[face_at_node(state, view.tile, at, d)];
      if (f.kind == FaceKind::closed || f.is_shut()) continue;
      open = open || f.kind == FaceKind::surface;
      ++faces[d];
      saturation[d] += f.saturation;
      conductivity[d] += f.conductivity;
      gradient[d] += f.head_gradient;
    }
  });
  sums.store(node);
  if (node.references > 0 && !node.has_free)
    for (int d = 0; d < dim; ++d)
      node.force[d] -= node.reference[d] / node.references * node.gradient[d];
  for (int d = 0; d < dim; ++d) {
    if (faces[d] > 0) {
      node.saturation[d] = saturation[d] / faces[d];
      node.conductivity[d] = conductivity[d] / faces[d];
      node.head_gradient[d] = gradient[d] / faces[d];
    } else if (node.soil_cells > 0) {
      node.saturation[d] /= node.soil_cells;
      node.conductivity[d] /= node.soil_cells;
    }
  }
  node.closed_surface = node.soil_cells > 0 && air > 0 && !open && !node.has_free;
  return node;
}

/// Velocities and masses of the two phases at a node.
template <int Dim>
struct NodeMotion {
  Real solid_mass = 0, liquid_mass = 0;
  Real solid[Dim] = {}, liquid[Dim] = {};              ///< before, then after [m/s]
  Real solid_force[Dim] = {}, liquid_force[Dim] = {};  ///< [N]
  Real drag[Dim] = {};                                 ///< implicit, times the step [kg]
};

/// DEVIATION: [Zhan] Eq. (20) prints the point force n p V grad N, without S, which pushes (1 - n) p at
/// a pond: still water over soil does not stay still. Here the nodal liquid fraction weighs the
/// gradient of the cell pressures.
/// Forces of the liquid on both phases: f_l = phi G, f_s += R, R = sum f V S p grad N - phi G;
/// at the fringe of the skeleton (occupancy o < 0.1) R is blended out. phi weighs the liquid's part
/// by its mass at the node, so that water at rest stays at rest for any arrangement of points; what
/// no skeleton is there to take of R, and what the blend takes from it, is handed back in `open`:
/// momentum closes with its sum.
template <int Dim>
void pressure_forces(const NodeSums<Dim>& sums, Real skeleton_volume, Real liquid_density,
                     NodeMotion<Dim>& node, Real (&open)[Dim]) noexcept {
  if (!(sums.volume > 0)) return;
  const Real phi = node.liquid_mass / (liquid_density * sums.volume);
  const Real occupancy = min(1.0, skeleton_volume / sums.volume);
  const Real w = min(1.0, occupancy / 0.1);
  const Real n = sums.soil_volume > 0 ? sums.pores / sums.soil_volume : 1;
  for (int d = 0; d < Dim; ++d) {
    node.liquid_force[d] += phi * sums.force[d];
    const Real full = sums.soil_force[d] - phi * sums.force[d];
    const Real fringe = occupancy * (sums.soil_force[d] - n * sums.saturation[d] * sums.force[d]);
    const Real taken = w * full + (1 - w) * fringe;
    node.solid_force[d] += taken;
    open[d] = node.solid_mass > 0 ? full - taken : full;
  }
}

/// Local damping of the skeleton: against its velocity, by its share of the mass. Grains beyond the
/// soil, among free water, are damped alone.
template <int Dim>
void damp(Real damping, bool beyond_soil, NodeMotion<Dim>& node) noexcept {
  const Real liquid = beyond_soil ? 0 : 1;
  const Real share = node.solid_mass / (node.solid_mass + liquid * node.liquid_mass);
  for (int d = 0; d < Dim; ++d) {
    const Real out_of_balance = std::fabs(node.solid_force[d] + liquid * node.liquid_force[d]);
    const Real v = node.solid[d];
    if (v != 0) node.solid_force[d] -= std::copysign(damping * out_of_balance * share, v);
  }
}

/// DEVIATION: the drag is explicit in [Zhan], which needs steps of 1.5e-7 s for 4.1 unsaturated.
/// New velocities of both phases along one axis with implicit drag q = dt D:
/// [a + q, -q; -q, b + q] (v_l, v_s) = (r_l, r_s). Momentum conserving, stable for any q.
inline void solve_pair(Real a, Real b, Real q, Real r_l, Real r_s, Real& v_l, Real& v_s) noexcept {
  const Real det = a * b + q * (a + b);
  v_l = ((b + q) * r_l + q * r_s) / det;
  v_s = ((a + q) * r_s + q * r_l) / det;
}

/// Takes the relative velocity along the outward normal away, keeping the momentum of the pair.
template <int Dim>
void tie_normal(const Real (&normal)[Dim], bool rigid, NodeMotion<Dim>& node) noexcept {
  Real length = 0;
  for (int d = 0; d < Dim; ++d) length += normal[d] * normal[d];
  if (!(length > 0)) return;
  Real relative = 0;
  for (int d = 0; d < Dim; ++d) relative += (node.liquid[d] - node.solid[d]) * normal[d];
  relative /= length;
  const Real total = node.liquid_mass + node.solid_mass;
  const Real liquid_share = rigid ? 1 : node.solid_mass / total;
  for (int d = 0; d < Dim; ++d) {
    node.liquid[d] -= liquid_share * relative * normal[d];
    node.solid[d] += (1 - liquid_share) * relative * normal[d];
  }
}

/// The entry of a node that is flagged as special.
template <class M>
const SpecialNode<State<M>::dim>& special_node(const State<M>& state, std::int32_t entry) {
  // Flagged nodes are listed, in ascending order.
  return *std::lower_bound(
      state.special.begin(), state.special.end(), entry,
      [](const SpecialNode<State<M>::dim>& s, std::int32_t wanted) { return s.entry < wanted; });
}

/// Velocity that a node's skeleton is given from outside; NaN along an axis that is free.
template <class M>
void find_prescribed(const State<M>& state, std::int32_t entry, std::uint16_t flags,
                     Real (&velocity)[State<M>::dim]) {
  constexpr int dim = State<M>::dim;
  for (int d = 0; d < dim; ++d)
    velocity[d] = is_rigid<M> || (flags & (node_flag::solid_fixed << d)) ? 0 : unset;
  if (!(flags & node_flag::special)) return;
  const auto& s = special_node(state, entry);
  for (int d = 0; d < dim; ++d)
    if (s.prescribed[d]) velocity[d] = state.factor_values[s.factor] * s.velocity[d];
}

/// Motion of a node prescribed by the user, and friction on walls.
template <class M>
void apply_special(const State<M>& state, std::int32_t entry, NodeMotion<State<M>::dim>& node) {
  constexpr int dim = State<M>::dim;
  const SpecialNode<dim>& s = special_node(state, entry);
  for (int d = 0; d < dim; ++d)
    if (s.prescribed[d]) node.solid[d] = state.factor_values[s.factor] * s.velocity[d];
  if (s.friction_axis < 0) return;
  const int n = s.friction_axis;
  const Real outward = s.friction_side == 0 ? -1 : 1;
  const Real into = outward * node.solid[n];
  if (into <= 0) return;  // leaves the wall: no contact
  node.solid[n] = 0;
  Real speed = 0;
  for (int d = 0; d < dim; ++d)
    if (d != n) speed += node.solid[d] * node.solid[d];
  speed = std::sqrt(speed);
  const Real keep = speed > 0 ? max(0.0, 1 - s.friction * into / speed) : 0;
  for (int d = 0; d < dim; ++d)
    if (d != n) node.solid[d] *= keep;
}

/// Soil is not drier than this for the drag [-].
inline constexpr Real least_saturation = 1e-12;

/// DEVIATION: [Zhan] Eq. (20) prints n m g / k without S; Eq. (2) has it, and so has this.
/// Drag per velocity of a node along each axis for a law linear in the relative velocity: its
/// coefficient, per volume of liquid, times the liquid volume in the soil at the node. That is the mass
/// that carries force and momentum, so that the answer of the liquid, k / gamma in the drag limit, does
/// not depend on it: with the upstream n S V in its place soil of S = 0.3 would let in a third of what
/// enters. A quadratic part is linearised at the closed-form root (see below).
template <class M>
Real drag_coefficient(const State<M>& state, const NodeSums<State<M>::dim>& sums,
                      Real liquid_volume, int axis) {
  const Real s = max(sums.saturation[axis], least_saturation);
  const Real k = sums.conductivity[axis];
  const auto& material = state.soils[sums.material].material;
  if (!(k > 0)) return 1e30;
  return liquid_volume *
         drag::coefficient<Real>(material.drag, sums.porosity(), s, k, material.unit_weight);
}

/// Factor 1 + B |w| / A by which a quadratic drag term raises the linear coefficient, with |w|
/// after the step from the positive root of its equation (Forchheimer, closed form).
template <class M>
Real quadratic_drag_factor(const State<M>& state, const NodeSums<State<M>::dim>& sums,
                           Real liquid_volume, const NodeMotion<State<M>::dim>& node,
                           const Real (&linear)[State<M>::dim]) {
  constexpr int dim = State<M>::dim;
  if constexpr (!QuadraticDrag<typename M::Drag>) {
    return 1;
  } else {
    Real w2 = 0, a = 0, k = 0, s = 0;
    const Real inverse = 1 / node.liquid_mass + (node.solid_mass > 0 ? 1 / node.solid_mass : 0.0);
    for (int d = 0; d < dim; ++d) {
      const Real w = node.liquid[d] - node.solid[d] +
                     state.dt * (node.liquid_force[d] / node.liquid_mass -
                                 (node.solid_mass > 0 ? node.solid_force[d] / node.solid_mass : 0));
      w2 += w * w;
      a += linear[d] / dim;
      k += sums.conductivity[d] / dim;
      s += max(sums.saturation[d], least_saturation) / dim;
    }
    const auto& material = state.soils[sums.material].material;
    const Real b = liquid_volume * drag::quadratic<Real>(material.drag, sums.porosity(), s, k,
                                                         material.unit_weight, state.water.density);
    const Real p = 1 + state.dt * inverse * a;
    const Real q = state.dt * inverse * b;
    const Real w = 2 * std::sqrt(w2) / (p + std::sqrt(p * p + 4 * q * std::sqrt(w2)));
    return a > 0 ? 1 + b * w / a : 1;
  }
}

/// New velocities of a node that may hold both phases; the drag feels a prescribed skeleton.
template <class M>
void advance_pair(const State<M>& state, const NodeSums<State<M>::dim>& sums,
                  const Real (&prescribed)[State<M>::dim], NodeMotion<State<M>::dim>& node) {
  constexpr int dim = State<M>::dim;
  const Real dt = state.dt;
  const bool has_solid = is_rigid<M> ? sums.has_soil : node.solid_mass > 0;
  const bool has_water = node.liquid_mass > 0;
  const Real liquid_volume = node.liquid_mass / state.water.density * sums.soil_share();
  const bool drags = has_solid && liquid_volume > 0;
  Real linear[dim] = {};
  Real factor = 1;
  if (drags) {
    for (int d = 0; d < dim; ++d) linear[d] = drag_coefficient(state, sums, liquid_volume, d);
    factor = quadratic_drag_factor(state, sums, liquid_volume, node, linear);
  }
  for (int d = 0; d < dim; ++d) {
    const Real a = node.liquid_mass, b = node.solid_mass;
    const Real r_l = a * node.liquid[d] + dt * node.liquid_force[d];
    const Real r_s = b * node.solid[d] + dt * node.solid_force[d];
    const Real q = dt * linear[d] * factor;
    node.drag[d] = q;
    const bool fixed = is_finite(prescribed[d]);
    if (fixed)
      node.solid[d] = prescribed[d];
    else if (has_solid)
      node.solid[d] = r_s / b;
    if (has_water) node.liquid[d] = (r_l + q * node.solid[d]) / (a + q);
    if (has_water && has_solid && !fixed) {
      if (drags && state.frozen)
        node.liquid[d] = node.solid[d] = (r_l + r_s) / (a + b);
      else if (drags)
        solve_pair(a, b, q, r_l, r_s, node.liquid[d], node.solid[d]);
    }
    if (!has_water) node.liquid[d] = node.solid[d];
  }
}

/// Walls and prescribed motion, after the velocities.
template <class M>
void apply_walls(const State<M>& state, std::int32_t entry, std::uint16_t flags,
                 NodeMotion<State<M>::dim>& node) {
  for (int d = 0; d < State<M>::dim; ++d) {
    if (flags & (node_flag::solid_fixed << d)) node.solid[d] = 0;
    if (flags & (node_flag::liquid_fixed << d)) node.liquid[d] = 0;
  }
  if (flags & node_flag::special) apply_special(state, entry, node);
}

/// Closed surfaces and walls, after the velocities.
template <class M>
void apply_boundaries(const State<M>& state, const NodeSums<State<M>::dim>& sums,
                      std::int32_t entry, std::uint16_t flags, NodeMotion<State<M>::dim>& node) {
  constexpr int dim = State<M>::dim;
  const bool both = node.liquid_mass > 0 && (is_rigid<M> || node.solid_mass > 0);
  if (sums.closed_surface && both) {
    // Along a wall only what lies in the wall counts: the other half of the soil is missing there.
    Real normal[dim];
    for (int d = 0; d < dim; ++d)
      normal[d] = flags & (node_flag::liquid_fixed << d) ? 0 : sums.normal[d];
    tie_normal(normal, is_rigid<M>, node);
  }
  apply_walls(state, entry, flags, node);
}

/// Walls mirror what is before them: both before and after a step nothing crosses them, so that they
/// give points no change of velocity of their own. (A node of a wall still receives momentum from points
/// that only come near it. Taken for a change of velocity, what the wall keeps back of it brakes the
/// points beside it in every step: div v off by 9 to 21 % in two layers of cells.)
template <int Dim>
void mirror_at_walls(std::uint16_t flags, NodeMotion<Dim>& before) noexcept {
  for (int d = 0; d < Dim; ++d) {
    if (flags & (node_flag::solid_fixed << d)) before.solid[d] = 0;
    if (flags & (node_flag::liquid_fixed << d)) before.liquid[d] = 0;
  }
}

/// Velocity of a phase and its change, as points read them.
template <int Dim>
Record velocity_record(const Real (&before)[Dim], const Real (&after)[Dim]) noexcept {
  Record out;
  for (int d = 0; d < Dim; ++d) {
    out[lane::velocity + d] = after[d];
    out[lane::increment + d] = after[d] - before[d];
  }
  return out;
}

/// Writes the velocities of one node.
template <class M>
void store_velocities(State<M>& state, std::size_t i, const NodeMotion<State<M>::dim>& before,
                      const NodeMotion<State<M>::dim>& after) {
  if constexpr (is_deformable<M>)
    state.nodes.solid_out[i] = velocity_record(before.solid, after.solid);
  if constexpr (has_liquid<M>)
    state.nodes.liquid_out[i] = velocity_record(before.liquid, after.liquid);
}

/// Head gradient that drives the flow through the soil at a node along an axis, per n (v^l - v^s):
/// linear drag of its soil and the inertia of a step [Pa s/m2].
template <class M>
Real resistance(const State<M>& state, const NodeSums<State<M>::dim>& sums, int axis) noexcept {
  if (!(sums.soil_volume > 0) || !(sums.conductivity[axis] > 0)) return 0;
  return (state.water.density / state.dt + drag_coefficient(state, sums, sums.soil_share(), axis)) /
         sums.porosity();
}

/// Writes the results of one node.
template <class M>
void store_node(State<M>& state, std::size_t i, const NodeSums<State<M>::dim>& sums, Real porosity,
                const NodeMotion<State<M>::dim>& before, const NodeMotion<State<M>::dim>& after) {
  constexpr int dim = State<M>::dim;
  auto& nodes = state.nodes;
  store_velocities(state, i, before, after);
  if constexpr (has_liquid<M>) {
    Record flux, relative;
    for (int d = 0; d < dim; ++d) {
      flux[d] = porosity * after.liquid[d] + (1 - porosity) * after.solid[d];
      relative[d] = porosity * (after.liquid[d] - after.solid[d]);
      relative[4 + d] = sums.head_gradient[d];
      if constexpr (has_skeleton<M>) flux[4 + d] = resistance(state, sums, d);
    }
    nodes.mixture[i] = flux;
    nodes.relative[i] = relative;
  }
}

/// Loads what the points mapped to a node.
template <class M>
NodeMotion<State<M>::dim> load_node(const State<M>& state, std::size_t i) noexcept {
  constexpr int dim = State<M>::dim;
  NodeMotion<dim> node;
  if constexpr (is_deformable<M>) {
    const Record& s = state.nodes.solid_in[i];
    node.solid_mass = s[lane::mass];
    for (int d = 0; d < dim; ++d) {
      if (s[lane::mass] > 0) node.solid[d] = s[lane::momentum + d] / s[lane::mass];
      node.solid_force[d] = s[lane::force + d] + s[lane::mass] * state.gravity[d];
    }
  }
  if constexpr (has_liquid<M>) {
    const Record& l = state.nodes.liquid_in[i];
    node.liquid_mass = l[lane::mass];
    for (int d = 0; d < dim; ++d) {
      node.liquid[d] = l[lane::mass] > 0 ? l[lane::momentum + d] / l[lane::mass] : node.solid[d];
      node.liquid_force[d] = l[lane::force + d] + l[lane::mass] * state.gravity[d];
    }
  }
  return node;
}

/// Velocities per force of one phase or a pair along every axis, as advance_pair finds them.
template <class M>
void find_mobilities(const State<M>& state, const NodeMotion<State<M>::dim>& node, bool has_solid,
                     const Real (&prescribed)[State<M>::dim], NodeResponse<State<M>::dim>& r) {
  const Real a = node.liquid_mass, b = node.solid_mass;
  for (int d = 0; d < State<M>::dim; ++d) {
    const Real q = node.drag[d];
    const bool free = has_solid && !is_finite(prescribed[d]);
    const Real det = a * b + q * (a + b);
    if (a > 0) r.liquid_liquid[d] = state.dt * (free && q > 0 ? (b + q) / det : 1 / (a + q));
    if (free) r.solid_solid[d] = state.dt * (a > 0 && q > 0 ? (a + q) / det : 1 / b);
    if (a > 0 && free && q > 0) r.liquid_solid[d] = state.dt * q / det;
    if (!free) r.solid_held |= static_cast<std::uint8_t>(1 << d);
  }
}

/// How the pressure forces of a node follow from the gradients, as in pressure_forces.
template <int Dim>
void find_force_parts(const NodeSums<Dim>& sums, Real skeleton_volume, Real liquid_density,
                      const NodeMotion<Dim>& node, NodeResponse<Dim>& r) noexcept {
  if (!(sums.volume > 0)) return;
  const Real occupancy = min(1.0, skeleton_volume / sums.volume);
  const Real w = min(1.0, occupancy / 0.1);
  const Real n = sums.soil_volume > 0 ? sums.pores / sums.soil_volume : 1;
  r.liquid_part = node.liquid_mass / (liquid_density * sums.volume);
  r.bishop_part = w + (1 - w) * occupancy;
  for (int d = 0; d < Dim; ++d) {
    r.pore_part[d] = w * r.liquid_part + (1 - w) * occupancy * n * sums.saturation[d];
    r.gradient[d] = sums.gradient[d];
  }
  r.references = sums.has_free ? 0 : sums.references;
}

/// Walls, friction and ties of the phases at a node, as apply_boundaries sets them.
template <class M>
void find_constraints(const State<M>& state, const NodeSums<State<M>::dim>& sums,
                      std::int32_t entry, std::uint16_t flags,
                      const NodeMotion<State<M>::dim>& node, NodeResponse<State<M>::dim>& r) {
  constexpr int dim = State<M>::dim;
  const bool both = node.liquid_mass > 0 && (is_rigid<M> || node.solid_mass > 0);
  Real length2 = 0;
  for (int d = 0; d < dim; ++d) {
    if (sums.closed_surface && both && !(flags & (node_flag::liquid_fixed << d)))
      r.normal[d] = sums.normal[d];
    length2 += r.normal[d] * r.normal[d];
    if (flags & (node_flag::solid_fixed << d)) r.solid_held |= static_cast<std::uint8_t>(1 << d);
    if (flags & (node_flag::liquid_fixed << d)) r.liquid_held |= static_cast<std::uint8_t>(1 << d);
  }
  for (Real& n : r.normal) n = length2 > 0 ? n / std::sqrt(length2) : 0;
  r.liquid_share = is_rigid<M> ? 1 : node.solid_mass / (node.solid_mass + node.liquid_mass);
  if (!(flags & node_flag::special)) return;
  const auto& special = special_node(state, entry);
  const int axis = special.friction_axis;
  if (axis >= 0 && node.solid[axis] == 0) r.solid_held |= static_cast<std::uint8_t>(1 << axis);
}

/// Coulomb friction at a wall, where the skeleton is solved for: grains that press on it stick, or slide
/// against what it takes.
template <int Dim>
void apply_friction(const SpecialNode<Dim>& wall, SkeletonNode<Dim>& node) {
  const int n = wall.friction_axis;
  if (n < 0) return;
  const Real into = (wall.friction_side == 0 ? -1 : 1) * node.impulse[n];
  if (into <= 0) return;
  node.held |= static_cast<std::uint8_t>(1 << n);
  Real along = 0;
  for (int d = 0; d < Dim; ++d)
    if (d != n) along += node.impulse[d] * node.impulse[d];
  along = std::sqrt(along);
  const Real keep = along > 0 ? max(0.0, 1 - wall.friction * into / along) : 0;
  for (int d = 0; d < Dim; ++d) {
    if (d == n) continue;
    node.impulse[d] *= keep;
    if (!(keep > 0)) node.held |= static_cast<std::uint8_t>(1 << d);
  }
}

/// What the balance of the skeleton needs of a node; `before`: velocities before the step.
template <class M>
void record_skeleton(State<M>& state, std::size_t i, const Real (&prescribed)[State<M>::dim],
                     const NodeMotion<State<M>::dim>& before,
                     const NodeMotion<State<M>::dim>& node) {
  constexpr int dim = State<M>::dim;
  constexpr Real tie = 1e9;  // drag along a tied normal, in masses of the liquid
  using Matrix = Eigen::Matrix<Real, dim, dim>;
  auto& r = state.system.response[i];
  SkeletonNode<dim> s;
  const Real a = node.liquid_mass;
  Matrix coupling = Matrix::Zero();
  if (a > 0 && node.solid_mass > 0) {
    Matrix drag = Matrix::Zero();
    for (int d = 0; d < dim; ++d) {
      drag(d, d) = node.drag[d];
      for (int e = 0; e < dim; ++e) drag(d, e) += tie * a * r.normal[d] * r.normal[e];
    }
    coupling = (a * Matrix::Identity() + drag).inverse() * drag;
  }
  Real liquid[dim];
  for (int d = 0; d < dim; ++d) liquid[d] = a * before.liquid[d] + state.dt * node.liquid_force[d];
  for (int d = 0; d < dim; ++d) {
    s.impulse[d] = node.solid_mass * before.solid[d] + state.dt * node.solid_force[d];
    for (int e = 0; e < dim; ++e) {
      const Real own = d == e ? 1 : 0;
      s.coupling[d][e] = coupling(d, e);
      s.inertia[d][e] = own * node.solid_mass + a * coupling(d, e);
      s.impulse[d] += coupling(d, e) * liquid[e];
      if (!(a > 0)) continue;
      s.liquid_mobility[d][e] = state.dt * (own - coupling(d, e)) / a;
      s.liquid_velocity[d] += (own - coupling(d, e)) / a * liquid[e];
    }
    if (is_finite(prescribed[d]) || (r.solid_held >> d & 1)) {
      s.held |= static_cast<std::uint8_t>(1 << d);
      s.given[d] = node.solid[d];
    }
  }
  if (state.nodes.node_flags[i] & node_flag::special)
    apply_friction(special_node(state, static_cast<std::int32_t>(i)), s);
  r.solid_held = s.held;
  for (int d = 0; d < dim; ++d)
    if (!(s.held >> d & 1)) s.unbalanced += power<2>(node.solid_force[d] + node.liquid_force[d]);
  s.unbalanced = std::sqrt(s.unbalanced);
  state.system.skeleton.node[i] = s;
}

/// Keeps how a node answers to forces, for an implicit solution.
template <class M>
void record_response(State<M>& state, std::size_t i, const NodeSums<State<M>::dim>& sums,
                     Real porosity, Real skeleton_volume, const NodeMotion<State<M>::dim>& before,
                     const NodeMotion<State<M>::dim>& node) {
  constexpr int dim = State<M>::dim;
  const auto entry = static_cast<std::int32_t>(i);
  const std::uint16_t flags = state.nodes.node_flags[i];
  NodeResponse<dim> r;
  r.active = true;
  r.grains = node.solid_mass > 0;
  r.follows = !(node.liquid_mass > 0);
  r.porosity = porosity;
  for (int d = 0; d < dim; ++d) {
    r.liquid[d] = node.liquid[d];
    r.solid[d] = node.solid[d];
    r.liquid_before[d] = before.liquid[d];
    r.solid_before[d] = before.solid[d];
  }
  Real prescribed[dim];
  find_prescribed(state, entry, flags, prescribed);
  find_mobilities(state, node, !is_rigid<M> && node.solid_mass > 0, prescribed, r);
  find_force_parts(sums, skeleton_volume, state.water.density, node, r);
  find_constraints(state, sums, entry, flags, node, r);
  state.system.response[i] = r;
  if constexpr (is_deformable<M> && has_liquid<M>)
    if (state.system.skeleton.on) record_skeleton(state, i, prescribed, before, node);
}

/// Local damping of this step: in quasi-static periods more, less and less as inertia begins to matter.
template <bool Recorded, class M>
Real damping_now(const State<M>& state) noexcept {
  const auto& choice = state.options.quasi_static;
  if (!Recorded || !choice.on || state.system.skeleton.on) return state.options.damping;
  const Real still = max(0.0, 1 - state.system.inertia_share / choice.dynamic);
  return max(state.options.damping, still * choice.damping);
}

/// One node: forces, drag, boundaries, new velocities. `Recorded`: for an implicit solution.
template <bool Recorded = false, class M, class Parts>
void advance_node(State<M>& state, const CellView<M>& view, [[maybe_unused]] const Parts& parts) {
  constexpr int dim = State<M>::dim;
  const auto i = static_cast<std::size_t>(view.entry());
  const std::uint16_t flags = state.nodes.node_flags[i];
  NodeMotion<dim> node = load_node(state, i);
  NodeSums<dim> sums;
  Real porosity = 1;
  if (node.solid_mass + node.liquid_mass <= 0) {
    if constexpr (Recorded) state.system.response[i] = {};
    store_node(state, i, sums, porosity, node, node);
    return;
  }
  NodeMotion<dim> before = node;
  Real skeleton_volume = 0;
  if constexpr (has_liquid<M>) {
    sums = gather_node(state, view, parts);
    if constexpr (is_deformable<M>)
      skeleton_volume = state.nodes.solid_in[i][lane::volume];
    else if constexpr (has_skeleton<M>)
      skeleton_volume = sums.soil_volume;
    porosity = sums.porosity();
    for (int d = 0; d < dim; ++d) node.solid_force[d] += sums.skeleton_force[d];
    Real open[dim] = {};
    pressure_forces(sums, skeleton_volume, state.water.density, node, open);
    for (int d = 0; d < dim; ++d)
      state.nodes.open_impulse[static_cast<std::size_t>(view.slot * dim + d)] += state.dt * open[d];
  }
  const Real damping = damping_now<Recorded>(state);
  if (damping > 0 && node.solid_mass > 0) damp(damping, !(sums.soil_share() > 0), node);
  if constexpr (Recorded) node.solid_mass *= state.system.report.inertia;
  if constexpr (has_liquid<M> && has_skeleton<M>) {
    Real prescribed[dim];
    find_prescribed(state, view.entry(), flags, prescribed);
    advance_pair(state, sums, prescribed, node);
  } else {
    for (int d = 0; d < dim; ++d) {
      if (node.solid_mass > 0) node.solid[d] += state.dt * node.solid_force[d] / node.solid_mass;
      if (node.liquid_mass > 0)
        node.liquid[d] += state.dt * node.liquid_force[d] / node.liquid_mass;
    }
  }
  apply_boundaries(state, sums, view.entry(), flags, node);
  // Free water hits walls, and drops carry no pressure that could stop them: there the wall does.
  if (!has_liquid<M> || (sums.volume > 0 && !sums.has_free)) mirror_at_walls(flags, before);
  if constexpr (Recorded) record_response(state, i, sums, porosity, skeleton_volume, before, node);
  store_node(state, i, sums, porosity, before, node);
}

/// Stands for the cells of a model without liquid.
struct NoParts {
  template <class M>
  NoParts(const State<M>&, int, int) noexcept {}
};

/// All nodes.
template <bool Recorded = false, class M>
void advance_nodes(State<M>& state) {
  constexpr int dim = State<M>::dim;
  if constexpr (has_liquid<M>)
    state.nodes.open_impulse.assign(static_cast<std::size_t>(state.grid.slots() * dim), 0);
  using Parts = std::conditional_t<has_liquid<M>, CellParts<M>, NoParts>;
  parallel_for(static_cast<std::size_t>(state.grid.slots()), state.options.threads,
               [&](std::size_t s, int thread) {
                 const int slot = static_cast<int>(s);
                 const Parts parts(state, slot, thread);
                 for_cube<dim>(0, Block<dim>::edge, [&](const Index<dim>& local) {
                   advance_node<Recorded>(state, CellView<M>(state, local, slot), parts);
                 });
               });
  if constexpr (has_liquid<M>)
    for (std::size_t i = 0; i < state.nodes.open_impulse.size(); ++i)
      state.open_impulse[static_cast<int>(i % dim)] += state.nodes.open_impulse[i];
}

}  // namespace vadose::kernel
