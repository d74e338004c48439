// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Steps 5 to 7, [Zhan] 3.4 (d), (e), at one node: forces, drag, walls and new velocities.

#include <algorithm>

#include <vadose/kernel/node_sums.hpp>

namespace vadose::kernel {

/// Velocities and masses of the two phases at a node, or (Lanes) at eight.
template <int Dim, class T = Real>
struct NodeMotion {
  T solid_mass{}, liquid_mass{};
  T solid[Dim] = {}, liquid[Dim] = {};              ///< before, then after [m/s]
  T solid_force[Dim] = {}, liquid_force[Dim] = {};  ///< [N]
  T drag[Dim] = {};                                 ///< implicit, times the step [kg]
};

/// DEVIATION: [Zhan] Eq. (20) prints the point force n p V grad N, without S, which pushes (1 - n) p at
/// a pond: still water over soil does not stay still. Here the nodal liquid fraction weighs the
/// gradient of the cell pressures.
/// Forces of the liquid on both phases: f_l = phi G, f_s += R, R = sum f V S p grad N - phi G;
/// at the fringe of the skeleton (occupancy o < 0.1) R is blended out. phi weighs the liquid's part
/// by its mass at the node, so that water at rest stays at rest for any arrangement of points; what
/// no skeleton is there to take of R, and what the blend takes from it, is handed back in `open`:
/// momentum closes with its sum.
/// The volume of `sums` has to be > 0.
template <int Dim, class T>
void pressure_forces(const NodeSums<Dim, T>& sums, const T& skeleton_volume, Real liquid_density,
                     NodeMotion<Dim, T>& node, T (&open)[Dim]) noexcept {
  const T one(1.0);
  const T phi = node.liquid_mass / (T(liquid_density) * sums.volume);
  const T occupancy = min(one, skeleton_volume / sums.volume);
  const T w = min(one, occupancy * T(1 / 0.1));
  const T n = ratio_or(sums.pores, sums.soil_volume, one);
  for (int d = 0; d < Dim; ++d) {
    node.liquid_force[d] += phi * sums.force[d];
    const T full = sums.soil_force[d] - phi * sums.force[d];
    const T fringe = occupancy * (sums.soil_force[d] - n * sums.saturation[d] * sums.force[d]);
    const T taken = w * full + (one - w) * fringe;
    node.solid_force[d] += taken;
    open[d] = select(node.solid_mass > T(0.0), full - taken, full);
  }
}

/// Local damping of the skeleton: against its velocity, by its share of the mass. Grains beyond the
/// soil, among free water, are damped alone.
template <int Dim, class T>
void damp(Real damping, bool beyond_soil, NodeMotion<Dim, T>& node) noexcept {
  const T liquid(beyond_soil ? 0.0 : 1.0), zero(0.0);
  const T share = node.solid_mass / (node.solid_mass + liquid * node.liquid_mass);
  for (int d = 0; d < Dim; ++d) {
    const T out_of_balance = abs(node.solid_force[d] + liquid * node.liquid_force[d]);
    const T held_back = T(damping) * out_of_balance * share;
    const T v = node.solid[d];
    node.solid_force[d] -= select(v > zero, held_back, select(v < zero, -held_back, zero));
  }
}

/// DEVIATION: the drag is explicit in [Zhan], which needs steps of 1.5e-7 s for 4.1 unsaturated.
/// New velocities of both phases along one axis with implicit drag q = dt D:
/// [a + q, -q; -q, b + q] (v_l, v_s) = (r_l, r_s). Momentum conserving, stable for any q.
template <class T>
void solve_pair(const T& a, const T& b, const T& q, const T& r_l, const T& r_s, T& v_l,
                T& v_s) noexcept {
  const T det = a * b + q * (a + b);
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

/// Coulomb friction: the part [0, 1] that is left of what lies along a wall of normal `axis` (a velocity or an
/// impulse) where `into` > 0 presses on it.
template <int Dim>
Real left_by_friction(Real friction, int axis, Real into, const Real (&vector)[Dim]) noexcept {
  Real along = 0;
  for (int d = 0; d < Dim; ++d)
    if (d != axis) along += vector[d] * vector[d];
  along = std::sqrt(along);
  return along > 0 ? max(0.0, 1 - friction * into / along) : 0;
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
  const Real keep = left_by_friction(s.friction, n, into, node.solid);
  node.solid[n] = 0;
  for (int d = 0; d < dim; ++d)
    if (d != n) node.solid[d] *= keep;
}

/// Drag per velocity of a node along an axis for a law linear in the relative velocity, of a volume of liquid
/// [kg/s]. That of the liquid in the soil at the node is the mass that carries force and momentum, so that
/// the answer of the liquid, k / gamma in the drag limit, does not depend on it: with the upstream n S V in
/// its place soil of S = 0.3 would let in a third of what enters. A quadratic part is linearised at the
/// closed-form root (see below).
template <int Dim, class T>
T drag_coefficient(const NodeSums<Dim, T>& sums, const T& liquid_volume, int axis) noexcept {
  return select(sums.drag[axis] > T(0.0), liquid_volume * sums.drag[axis], T(1e30));
}

/// Factor 1 + B |w| / A by which a quadratic drag term raises the linear coefficient, with |w|
/// after the step from the positive root of its equation (Forchheimer, closed form).
template <class M, class T>
T quadratic_drag_factor(const State<M>& state, const NodeSums<State<M>::dim, T>& sums,
                        const T& liquid_volume, const NodeMotion<State<M>::dim, T>& node,
                        const T (&linear)[State<M>::dim]) {
  constexpr int dim = State<M>::dim;
  const T one(1.0);
  if constexpr (!QuadraticDrag<typename M::Drag>) {
    return one;
  } else {
    const T zero(0.0), dt(state.dt), each(1.0 / dim);
    const auto per_solid_mass = [&](const T& x) { return ratio_or(x, node.solid_mass, zero); };
    T w2 = zero, a = zero, k = zero, s = zero;
    const T inverse = one / node.liquid_mass + per_solid_mass(one);
    for (int d = 0; d < dim; ++d) {
      const T w =
          node.liquid[d] - node.solid[d] +
          dt * (node.liquid_force[d] / node.liquid_mass - per_solid_mass(node.solid_force[d]));
      w2 += w * w;
      a += linear[d] * each;
      k += sums.conductivity[d] * each;
      s += max(sums.saturation[d], T(least_saturation)) * each;
    }
    const auto& material = state.soils[sums.material].material;
    const T b = liquid_volume * drag::quadratic<T>(material.drag, sums.porosity, s, k,
                                                   T(material.unit_weight), T(state.water.density));
    const T p = one + dt * inverse * a;
    const T q = dt * inverse * b;
    const T w = T(2.0) * sqrt(w2) / (p + sqrt(p * p + T(4.0) * q * sqrt(w2)));
    return ratio_or(a + b * w, a, one);
  }
}

/// New velocities where both phases are, nothing is prescribed, and the soil drags the liquid.
template <class M, class T>
void advance_free_pair(const State<M>& state, const NodeSums<State<M>::dim, T>& sums,
                       const T& liquid_volume, NodeMotion<State<M>::dim, T>& node) {
  constexpr int dim = State<M>::dim;
  const T a = node.liquid_mass, b = node.solid_mass, dt(state.dt);
  T linear[dim];
  for (int d = 0; d < dim; ++d) linear[d] = drag_coefficient(sums, liquid_volume, d);
  const T factor = quadratic_drag_factor(state, sums, liquid_volume, node, linear);
  for (int d = 0; d < dim; ++d) {
    const T r_l = a * node.liquid[d] + dt * node.liquid_force[d];
    const T r_s = b * node.solid[d] + dt * node.solid_force[d];
    node.drag[d] = dt * linear[d] * factor;
    if (state.frozen)
      node.liquid[d] = node.solid[d] = (r_l + r_s) / (a + b);
    else
      solve_pair(a, b, node.drag[d], r_l, r_s, node.liquid[d], node.solid[d]);
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
  bool is_free = !is_rigid<M> && drags;
  for (const Real velocity : prescribed) is_free = is_free && !is_finite(velocity);
  if (is_free) {
    advance_free_pair(state, sums, liquid_volume, node);
    return;
  }
  Real linear[dim] = {};
  Real factor = 1;
  if (drags) {
    for (int d = 0; d < dim; ++d) linear[d] = drag_coefficient(sums, liquid_volume, d);
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

/// Velocity of a phase and its change, as points read them; `out`: a record, or those of eight nodes by
/// lane.
template <int Dim, class T, class Rows>
void set_velocities(const T (&before)[Dim], const T (&after)[Dim], Rows& out) noexcept {
  for (int d = 0; d < Dim; ++d) {
    out[lane::velocity + d] = after[d];
    out[lane::increment + d] = after[d] - before[d];
  }
}

/// Writes the velocities of one node.
template <class M>
void store_velocities(State<M>& state, std::size_t i, const NodeMotion<State<M>::dim>& before,
                      const NodeMotion<State<M>::dim>& after) {
  const auto store = [&](AlignedVector<Record>& records, const auto& from, const auto& to) {
    Record out;
    set_velocities(from, to, out);
    records[i] = out;
  };
  if constexpr (is_deformable<M>) store(state.nodes.solid_out, before.solid, after.solid);
  if constexpr (has_liquid<M>) store(state.nodes.liquid_out, before.liquid, after.liquid);
}

/// Head gradient that drives the flow through the soil at a node along an axis, per n (v^l - v^s):
/// linear drag of its soil and the inertia of a step [Pa s/m2].
template <class M, class T>
T resistance(const State<M>& state, const NodeSums<State<M>::dim, T>& sums, int axis) noexcept {
  const auto flows = (sums.soil_volume > T(0.0)) & (sums.conductivity[axis] > T(0.0));
  const T driving = T(state.water.density / state.dt) +
                    drag_coefficient<State<M>::dim, T>(sums, sums.soil_share(), axis);
  return select(flows, driving / sums.porosity, T(0.0));
}

/// What cells, faces and free water read of a node: total flux and resistance, relative flux and mean head
/// gradient; `mixture`, `relative`: a record each, or those of eight nodes by lane.
template <class M, class T, class Rows>
void set_fluxes(const State<M>& state, const NodeSums<State<M>::dim, T>& sums, const T& porosity,
                const NodeMotion<State<M>::dim, T>& after, Rows& mixture, Rows& relative) noexcept {
  for (int d = 0; d < State<M>::dim; ++d) {
    mixture[d] = porosity * after.liquid[d] + (T(1.0) - porosity) * after.solid[d];
    relative[d] = porosity * (after.liquid[d] - after.solid[d]);
    relative[4 + d] = sums.head_gradient[d];
    if constexpr (has_skeleton<M>) mixture[4 + d] = resistance<M, T>(state, sums, d);
  }
}

/// Writes the results of one node.
template <class M>
void store_node(State<M>& state, std::size_t i, const NodeSums<State<M>::dim>& sums, Real porosity,
                const NodeMotion<State<M>::dim>& before, const NodeMotion<State<M>::dim>& after) {
  store_velocities(state, i, before, after);
  if constexpr (has_liquid<M>) {
    Record mixture, relative;
    set_fluxes(state, sums, porosity, after, mixture, relative);
    state.nodes.mixture[i] = mixture;
    state.nodes.relative[i] = relative;
  }
}

/// What the solid points mapped to a node, or (rows by lane) to eight; `gravity` acts on it.
template <int Dim, class T, class Rows>
void load_solid(const Rows& sums, const Vec<Dim>& gravity, NodeMotion<Dim, T>& node) noexcept {
  node.solid_mass = sums[lane::mass];
  for (int d = 0; d < Dim; ++d) {
    node.solid[d] = ratio_or(T(sums[lane::momentum + d]), node.solid_mass, T(0.0));
    node.solid_force[d] = sums[lane::force + d] + node.solid_mass * T(gravity[d]);
  }
}

/// The same of the liquid points; liquid that is not there moves with the solid.
template <int Dim, class T, class Rows>
void load_liquid(const Rows& sums, const Vec<Dim>& gravity, NodeMotion<Dim, T>& node) noexcept {
  node.liquid_mass = sums[lane::mass];
  for (int d = 0; d < Dim; ++d) {
    node.liquid[d] = ratio_or(T(sums[lane::momentum + d]), node.liquid_mass, node.solid[d]);
    node.liquid_force[d] = sums[lane::force + d] + node.liquid_mass * T(gravity[d]);
  }
}

/// Loads what the points mapped to a node.
template <class M>
NodeMotion<State<M>::dim> load_node(const State<M>& state, std::size_t i) noexcept {
  NodeMotion<State<M>::dim> node;
  if constexpr (is_deformable<M>) load_solid(state.nodes.solid_in[i], state.gravity, node);
  if constexpr (has_liquid<M>) load_liquid(state.nodes.liquid_in[i], state.gravity, node);
  return node;
}

}  // namespace vadose::kernel
