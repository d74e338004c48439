// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Nodes of slivers. A sliver shares the pressure and the mean stress of a neighbour, so a node that
/// only slivers touch holds neither, but would hold their soil and its load: left to itself it runs
/// away under them. It moves with the nodes of that neighbour instead, and hands them what it holds:
/// by the hat functions of the neighbour, continued beyond it, so that a uniform rate of deformation
/// of the neighbour is one of the sliver and force and rate stay adjoint.

#include <algorithm>

#include <vadose/kernel/map_to_grid.hpp>

namespace vadose::kernel {

/// A carrying node keeps at least this part of its mass by each node that it carries [-].
inline constexpr Real carried_share = 0.2;

/// Whether a cell around a node owns a pressure.
template <class M>
bool has_pressure(const State<M>& state, const Index<State<M>::dim>& node) noexcept {
  constexpr int dim = State<M>::dim;
  bool found = false;
  for_cube<dim>(-1, 1, [&](const Index<dim>& step) {
    Index<dim> cell = node;
    for (int d = 0; d < dim; ++d) cell[d] += step[d];
    const std::int32_t e = state.grid.entry(cell);
    found =
        found || (e != state.grid.outside() && state.nodes.dof[static_cast<std::size_t>(e)] == e);
  });
  return found;
}

/// Whether something holds a node from outside along an axis on which it lies beyond a cell.
template <class M>
bool held_beyond(const State<M>& state, std::int32_t entry, const Index<State<M>::dim>& node,
                 const Index<State<M>::dim>& cell) noexcept {
  const std::uint16_t flags = state.nodes.node_flags[static_cast<std::size_t>(entry)];
  if (flags & node_flag::special) return true;
  for (int d = 0; d < State<M>::dim; ++d)
    if ((node[d] < cell[d] || node[d] > cell[d] + 1) && (flags & (node_flag::solid_fixed << d)))
      return true;
  return false;
}

/// Weights of the nodes of a cell in the motion of a node beyond it: hat functions continued
/// linearly, or, where that would take much of the mass of a node on the far side, drawn towards
/// those at the nearest place of the cell.
template <class M>
CarriedNode<State<M>::dim> carried_by(const State<M>& state, std::int32_t entry,
                                      const Index<State<M>::dim>& node,
                                      const Index<State<M>::dim>& cell) noexcept {
  constexpr int dim = State<M>::dim;
  const auto mass = [&](std::int32_t e) {
    return state.nodes.solid_in[static_cast<std::size_t>(e)][lane::mass];
  };
  CarriedNode<dim> carried;
  carried.entry = entry;
  Real nearest[CarriedNode<dim>::corners], part = 1;
  int i = 0;
  for_cube<dim>(0, 2, [&](const Index<dim>& corner) {
    Index<dim> at = cell;
    carried.weight[i] = nearest[i] = 1;
    for (int d = 0; d < dim; ++d) {
      at[d] += corner[d];
      const int xi = node[d] - cell[d];
      carried.weight[i] *= corner[d] ? xi : 1 - xi;
      nearest[i] *= (corner[d] == 1) == (xi >= 1) ? 1 : 0;
    }
    carried.corner[i] = state.grid.entry(at);
    const Real taken = -carried.weight[i] * mass(entry);
    if (taken > 0) part = min(part, carried_share * mass(carried.corner[i]) / taken);
    ++i;
  });
  for (i = 0; i < CarriedNode<dim>::corners; ++i)
    carried.weight[i] = nearest[i] + part * (carried.weight[i] - nearest[i]);
  return carried;
}

/// Lists the carried nodes of one sliver.
template <class M>
void list_carried(State<M>& state, const CellView<M>& view) {
  constexpr int dim = State<M>::dim;
  const std::int32_t owner = state.nodes.dof[static_cast<std::size_t>(view.entry())];
  Index<dim> cell = view.cell;  // of the owner
  for_cube<dim>(-1, 2, [&](const Index<dim>& step) {
    if (view.at_step(step) != owner) return;
    for (int d = 0; d < dim; ++d) cell[d] = view.cell[d] + step[d];
  });
  for_cube<dim>(0, 2, [&](const Index<dim>& corner) {
    Index<dim> node = view.cell;
    for (int d = 0; d < dim; ++d) node[d] += corner[d];
    const std::int32_t e = state.grid.entry(node);
    if (e == state.grid.outside() || has_pressure(state, node)) return;
    if (!(state.nodes.solid_in[static_cast<std::size_t>(e)][lane::mass] > 0)) return;
    auto carried = carried_by(state, e, node, cell);
    carried.owner = held_beyond(state, e, node, cell) ? -1 : owner;
    state.nodes.carried.push_back(carried);
  });
}

/// Lists every carried node once for each cell that carries it, in ascending order.
template <class M>
void find_carried_nodes(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& nodes = state.nodes;
  const auto is_sliver = [&](std::int32_t e) {
    const auto i = static_cast<std::size_t>(e);
    return nodes.dof[i] >= 0 && nodes.dof[i] != e && nodes.cell[i].kind == CellKind::soil;
  };
  nodes.carried.clear();
  for (int slot = 0; slot < state.grid.slots(); ++slot) {
    if (!nodes.near_sliver[static_cast<std::size_t>(slot)]) continue;
    for_cube<dim>(0, Block<dim>::edge, [&](const Index<dim>& local) {
      const CellView<M> view(state, local, slot);
      if (is_sliver(view.entry())) list_carried(state, view);
    });
  }
  const auto key = [](const auto& c) { return std::make_pair(c.entry, c.owner); };
  std::sort(nodes.carried.begin(), nodes.carried.end(),
            [&](const auto& a, const auto& b) { return key(a) < key(b); });
  nodes.carried.erase(std::unique(nodes.carried.begin(), nodes.carried.end(),
                                  [&](const auto& a, const auto& b) { return key(a) == key(b); }),
                      nodes.carried.end());
}

/// Calls f(first, last) for the entries of every carried node that nothing holds from outside.
template <int Dim, class F>
void for_carried(const GridState<Dim>& nodes, F&& f) {
  const auto& all = nodes.carried;
  for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
    while (last < all.size() && all[last].entry == all[first].entry) ++last;
    if (all[first].owner >= 0) f(first, last);
  }
}

/// Carried nodes hand what they hold to the nodes that carry them. Few: one thread.
template <class M>
void unload_carried_nodes(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& nodes = state.nodes;
  find_carried_nodes(state);
  for_carried(nodes, [&](std::size_t first, std::size_t last) {
    Record& held = nodes.solid_in[static_cast<std::size_t>(nodes.carried[first].entry)];
    const Lanes share = Lanes::load(held.value) * Lanes(1 / static_cast<Real>(last - first));
    for (std::size_t i = first; i < last; ++i)
      for (int c = 0; c < CarriedNode<dim>::corners; ++c) {
        Record& to = nodes.solid_in[static_cast<std::size_t>(nodes.carried[i].corner[c])];
        (Lanes::load(to.value) + Lanes(nodes.carried[i].weight[c]) * share).store(to.value);
      }
    held = Record{};
  });
}

/// Gives carried nodes the motion of those that carry them.
template <class M>
void move_carried_nodes(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& nodes = state.nodes;
  for_carried(nodes, [&](std::size_t first, std::size_t last) {
    Lanes motion(0.0);
    for (std::size_t i = first; i < last; ++i)
      for (int c = 0; c < CarriedNode<dim>::corners; ++c)
        motion += Lanes(nodes.carried[i].weight[c] / static_cast<Real>(last - first)) *
                  Lanes::load(
                      nodes.solid_out[static_cast<std::size_t>(nodes.carried[i].corner[c])].value);
    motion.store(nodes.solid_out[static_cast<std::size_t>(nodes.carried[first].entry)].value);
  });
}

}  // namespace vadose::kernel
