// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// How a node answers to forces, kept for an implicit solution.

#include <Eigen/LU>

#include <vadose/kernel/node_motion.hpp>

namespace vadose::kernel {

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
  const Real keep = left_by_friction(wall.friction, n, into, node.impulse);
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

}  // namespace vadose::kernel
