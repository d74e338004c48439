// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The discrete equations of [Zhan] as printed, and what mends them one by one. Liquid points move
/// with v^l and carry p. Nothing here is part of the default step: it is the yardstick for it, and
/// what the default step does otherwise is marked DEVIATION there.

#include <vadose/kernel/momentum.hpp>
#include <vadose/kernel/time_step.hpp>
#include <vadose/kernel/update_points.hpp>

namespace vadose {

/// Which choices of the printed equations are mended; by default none.
struct PaperMends {
  bool cell_average = false;       ///< p and volume rates of liquid points are means over the cell
  bool saturation = false;         ///< the S that Eq. (20) lacks in force and drag
  bool porosity_slope = false;     ///< the term -n S_n Dn that Eq. (9) lacks
  bool porosity_gradient = false;  ///< the term w . grad n, neglected in 3.2
  bool implicit_drag = false;      ///< drag of the new velocities, in closed form at the node
};

namespace kernel {

/// Records of the printed scheme; they lie in arrays that the default scheme uses for other things.
namespace printed {
// GridState::relative, the skeleton at a node: while it is summed
inline constexpr int mass = 0;        ///< [kg]
inline constexpr int mass_pores = 1;  ///< sum m n N [kg]
// and afterwards
inline constexpr int velocity = 0;  ///< first of three, v^s [m/s]
inline constexpr int porosity = 3;  ///< n, 1 where there is no solid [-]
inline constexpr int solid = 4;     ///< 1 where there is solid, else 0
// GridState::liquid_in, beside mass, momentum and force:
inline constexpr int drag = 7;  ///< sum of drag coefficients [kg/s]
// GridState::pore, liquid points in a cell (beside V, m, n V):
inline constexpr int pressure = 3;  ///< sum V p [J]
inline constexpr int position = 4;  ///< first of three, sum V x [m4]
inline constexpr int storage = 7;   ///< sum V n (S/K + S_p) [m3/Pa]
// GridState::free, rates of liquid points in a cell:
inline constexpr int volume = 0;       ///< sum V [m3]
inline constexpr int liquid_rate = 1;  ///< sum V div v^l [m3/s]
inline constexpr int solid_rate = 2;   ///< sum V div v^s [m3/s]
inline constexpr int convection = 3;   ///< sum V w . grad n [m3/s]
// GridState::mixture: sum S p V grad S_ilp of Eq. (22) in the lanes of a force.

/// Above this porosity a liquid point is free water [-]: round-off of a sum of shape functions.
inline constexpr Real free_porosity = 1 - 1e-9;
}  // namespace printed

/// Half sizes of the domains of a batch: cubes of the points' volumes.
template <class M, class Points>
VADOSE_INLINE void domain_half_sizes(const State<M>& state, const Points& points, std::size_t b,
                                     const Lanes (&x)[State<M>::dim],
                                     Lanes (&half)[State<M>::dim]) noexcept {
  constexpr int dim = State<M>::dim;
  Lanes size(0.0);
  if constexpr (M::Shape::uses_half_size) {
    const Real h = state.grid.cell_size();
    size = points.load(field::volume, b);
    if constexpr (State<M>::Kinematics::axisymmetric)
      size *= over_radius<typename State<M>::Kinematics, dim>(x, Real(0));
    if constexpr (dim == 2) size = sqrt(size);
    if constexpr (dim == 3)
      for (int l = 0; l < lane_count; ++l) size.set(l, std::cbrt(size[l]));
    // Smaller by more than water is compressed by: a domain that ends at the ground must not reach
    // the node above whenever its pressure falls. (There is no grain to drag on, and what the water
    // does there came down as pulses of 10 % of the load.)
    size = min(max(size * Lanes(0.5 * (1 - 1e-3)), Lanes(1e-3 * h)), Lanes(0.5 * h));
  }
  for (auto& l : half) l = size;
}

/// Soil that a liquid point of a group is in where its porosity is below 1.
template <class M>
const Soil<M>& soil_of(const State<M>& state, int group) noexcept {
  return state.soils[static_cast<std::size_t>(group == state.free_group() ? 0 : group)];
}

/// Porosity of the liquid points of a batch.
template <class M>
VADOSE_INLINE Lanes porosity_of([[maybe_unused]] const State<M>& state,
                                [[maybe_unused]] std::size_t b) noexcept {
  if constexpr (has_skeleton<M>)
    return state.liquid.load(field::porosity, b);
  else
    return Lanes(1.0);
}

/// Degree of saturation of liquid points and its slopes.
struct Retained {
  Lanes saturation = Lanes(1.0);      ///< S
  Lanes slope = Lanes(0.0);           ///< S_p = dS/dp at constant n [1/Pa], >= 0
  Lanes porosity_slope = Lanes(0.0);  ///< S_n = dS/dn at constant p [-], <= 0
};

/// Eq. (12) at the present pressure and porosity; free water has S = 1.
template <class M>
VADOSE_INLINE Retained retained([[maybe_unused]] const State<M>& state,
                                [[maybe_unused]] std::size_t b) noexcept {
  Retained r;
  if constexpr (is_unsaturated<M>) {
    const auto& curve = soil_of(state, state.liquid.group(b)).material.retention;
    const Lanes p = state.liquid.load(field::liquid_pressure, b);
    const Lanes n = porosity_of(state, b);
    const Lanes within = min(n, Lanes(1 - 1e-6));
    const Lanes suction = max(-p, Lanes(0.0));
    const auto both = swrc::saturation_and_slope<Lanes>(curve, suction, within);
    const LaneMask dry = (p < Lanes(0.0)) & (n < Lanes(printed::free_porosity));
    r.saturation = select(dry, both.saturation, Lanes(1.0));
    r.slope = select(dry, -both.slope, Lanes(0.0));
    r.porosity_slope = select(dry, swrc::porosity_slope<Lanes>(curve, suction, within), Lanes(0.0));
  }
  return r;
}

/// Drag coefficient n m g / k of Eq. (20) [kg/s] of a batch, times S where that is mended, and the
/// rate at which it takes a relative velocity away [1/s]. The mass ratio is that of the soil at its
/// own porosity, n S rho_l / ((1 - n) rho_s).
template <class M>
struct PointDrag {
  Lanes coefficient = Lanes(0.0);
  Lanes rate = Lanes(0.0);

  VADOSE_INLINE PointDrag([[maybe_unused]] const State<M>& state, [[maybe_unused]] std::size_t b,
                          [[maybe_unused]] const Retained& liquid,
                          [[maybe_unused]] bool with_saturation) noexcept {
    if constexpr (has_skeleton<M>) {
      const auto& soil = soil_of(state, state.liquid.group(b));
      const auto& material = soil.material;
      const Lanes n = porosity_of(state, b);
      const Lanes within = min(n, Lanes(1 - 1e-6));
      const Lanes k = conductivity::value<Lanes>(
          material.conductivity,
          swrc::effective_saturation<Lanes>(material.retention, liquid.saturation), within);
      const Lanes s = with_saturation ? liquid.saturation : Lanes(1.0);
      const Lanes per_volume =
          drag::coefficient<Lanes>(material.drag, within, s, k, Lanes(material.unit_weight)) *
          Lanes(1 / state.water.density);
      const LaneMask in_soil =
          (n < Lanes(printed::free_porosity)) & (state.liquid.load(field::mass, b) > Lanes(0.0));
      coefficient = select(in_soil, per_volume * state.liquid.load(field::mass, b), Lanes(0.0));
      Lanes ratio(0.0);
      if constexpr (is_deformable<M>)
        ratio = liquid.saturation * Lanes(material.porosity * state.water.density /
                                          ((1 - material.porosity) * material.solid_density));
      rate = select(in_soil, per_volume * (Lanes(1.0) + ratio), Lanes(0.0));
    }
  }
};

/// (a) Porosity of the solid points to the nodes, weighted by mass; beside it v^s at the node.
template <class M>
void map_porosity(State<M>& state) {
  constexpr int dim = State<M>::dim;
  using Shape = typename M::Shape;
  auto& skeleton = state.nodes.relative;
  clear(skeleton, state.options.threads);
  for_blocks_adding(state.solid, state.options.threads, [&](const BatchRange& range, int thread) {
    Tile<dim>& tile = state.tile(thread);
    const TileFrame<dim> frame = tile_frame(state.grid, range.slot);
    for (std::size_t b = range.begin; b < range.end; ++b) {
      Lanes x[dim], half[dim];
      load_positions(state.solid, b, x);
      if constexpr (is_deformable<M>)
        load_half_sizes(state.solid, b, half);
      else
        domain_half_sizes(state, state.solid, b, x, half);
      Stencil<Shape, dim> stencil;
      stencil.evaluate(frame, x, half);
      const auto& material = state.soils[static_cast<std::size_t>(state.solid.group(b))].material;
      const Lanes mass = state.solid.load(field::mass, b);
      Lanes n(material.porosity);
      if constexpr (is_deformable<M>)
        n = Lanes(1.0) -
            mass / max(state.solid.load(field::volume, b) * Lanes(material.solid_density),
                       Lanes(1e-300));
      Scatter<false, false, Shape, dim> scatter;
      for (auto& r : scatter.value) r = Lanes(0.0);
      scatter.value[printed::mass] = mass;
      scatter.value[printed::mass_pores] = mass * n;
      transpose(scatter.value);
      scatter.add(stencil, tile.record);
    }
    tile.add_to(state.grid, range.slot, skeleton);
  });
  for_cells(state.grid, state.options.threads, [&](std::int32_t e, const Index<dim>&, int, int) {
    const auto i = static_cast<std::size_t>(e);
    const Real mass = skeleton[i][printed::mass];
    Record node;
    node[printed::porosity] = mass > 0 ? skeleton[i][printed::mass_pores] / mass : 1;
    node[printed::solid] = mass > 0 ? 1 : 0;
    if constexpr (is_deformable<M>) {
      const Record& solid = state.nodes.solid_in[i];
      for (int d = 0; d < dim && solid[lane::mass] > 0; ++d)
        node[printed::velocity + d] = solid[lane::momentum + d] / solid[lane::mass];
    }
    skeleton[i] = node;
  });
}

/// Basis of a batch of liquid points: that of the solid, on domains of their own.
template <class M>
VADOSE_INLINE void liquid_stencil(const State<M>& state, std::size_t b,
                                  const TileFrame<State<M>::dim>& frame, Lanes (&x)[State<M>::dim],
                                  Stencil<typename M::Shape, State<M>::dim>& stencil) noexcept {
  Lanes half[State<M>::dim];
  load_positions(state.liquid, b, x);
  domain_half_sizes(state, state.liquid, b, x, half);
  stencil.evaluate(frame, x, half);
}

/// (b) Porosity of a batch of liquid points from the nodes; Eq. (12) there; volume from the mass;
/// sums of the cells.
template <bool WithSaturation, class M>
VADOSE_INLINE void find_liquid_batch(State<M>& state, std::size_t b,
                                     const TileFrame<State<M>::dim>& frame, const Record* skeleton,
                                     Tile<State<M>::dim>& cell_sums, StepSums& sums) noexcept {
  constexpr int dim = State<M>::dim;
  auto& points = state.liquid;
  Lanes x[dim];
  Stencil<typename M::Shape, dim> stencil;
  liquid_stencil(state, b, frame, x, stencil);
  if constexpr (has_skeleton<M>) {
    Gather<false, typename M::Shape, dim> nodes;
    nodes.sum(stencil, skeleton);
    nodes.by_field();
    points.store(field::porosity, b, min(nodes.value[printed::porosity], Lanes(1.0)));
  }
  const Retained liquid = retained(state, b);
  const PointDrag<M> drag(state, b, liquid, WithSaturation);
  sums.max_drag = max(sums.max_drag, max_lane(drag.rate));

  const Lanes n = porosity_of(state, b);
  const Lanes p = points.load(field::liquid_pressure, b);
  const Lanes mass = points.load(field::mass, b);
  const Real over_modulus = 1 / state.water.bulk_modulus;
  const Lanes content = n * max(liquid.saturation, Lanes(1e-12)) * exp(p * Lanes(over_modulus));
  const Lanes volume = mass / (Lanes(state.water.density) * content);
  points.store(field::volume, b, volume);

  CellFinder<dim> cells;
  cells.find(frame, x);
  Lanes record[lane_count];
  record[lane::bulk_volume] = volume;
  record[lane::water] = mass;
  record[lane::pore_volume] = n * volume;
  record[printed::pressure] = volume * p;
  for (int d = 0; d < 3; ++d) record[printed::position + d] = d < dim ? volume * x[d] : Lanes(0.0);
  record[printed::storage] = volume * n * (liquid.saturation * Lanes(over_modulus) + liquid.slope);
  add_to_cells(cells, record, cell_sums);
}

/// A cell as reports and the step limit know it, from the sums over its liquid points.
template <class M>
Cell<State<M>::dim> printed_cell(const State<M>& state, const Record& sums,
                                 [[maybe_unused]] const Record& materials) {
  Cell<State<M>::dim> cell;
  const Real volume = sums[lane::bulk_volume];
  if (!(volume > 0)) return cell;
  cell.water = sums[lane::water];
  cell.pore_volume = sums[lane::pore_volume];
  cell.porosity = cell.pore_volume / volume;
  cell.kind = cell.porosity < printed::free_porosity ? CellKind::soil : CellKind::free;
  cell.soil_share = cell.kind == CellKind::soil ? 1 : 0;
  cell.soil_porosity = cell.porosity;
  cell.pressure = sums[printed::pressure] / volume;
  for (int d = 0; d < State<M>::dim; ++d) cell.centroid[d] = sums[printed::position + d] / volume;
  const Real compression = std::exp(cell.pressure / state.water.bulk_modulus);
  cell.saturation = min(1.0, cell.water / (state.water.density * cell.pore_volume * compression));
  cell.storage = sums[printed::storage] * compression;
  cell.modulus = effective_modulus(cell, compression);
  for (int m = 1; m < static_cast<int>(state.soils.size()); ++m)
    if (materials[m] > materials[cell.material]) cell.material = static_cast<std::uint8_t>(m);
  return cell;
}

/// (b), Eq. (12): porosity, saturation and volume of all liquid points, means of the cells, fastest
/// drag.
template <bool WithSaturation, class M>
void find_liquid(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& nodes = state.nodes;
  clear(nodes.pore, state.options.threads);
  for_blocks_adding(state.liquid, state.options.threads, [&](const BatchRange& range, int thread) {
    Tile<dim>& skeleton = state.tile(thread, 0);
    Tile<dim>& cell_sums = state.tile(thread, 1);
    if constexpr (has_skeleton<M>) skeleton.read(state.grid, range.slot, nodes.relative);
    const TileFrame<dim> frame = tile_frame(state.grid, range.slot);
    StepSums& sums = state.sums[static_cast<std::size_t>(thread)];
    for (std::size_t b = range.begin; b < range.end; ++b)
      find_liquid_batch<WithSaturation>(state, b, frame, skeleton.record, cell_sums, sums);
    cell_sums.add_to(state.grid, range.slot, nodes.pore);
    for (auto& r : skeleton.record) r = Record{};
  });
  if (state.soils.size() > 1) sum_materials(state);
  for_cells(state.grid, state.options.threads, [&](std::int32_t e, const Index<dim>&, int, int) {
    const auto i = static_cast<std::size_t>(e);
    nodes.cell[i] = printed_cell(state, nodes.pore[i], nodes.materials[i]);
    nodes.dof[i] = nodes.cell[i].kind == CellKind::none ? -1 : e;
  });
}

/// Largest step of explicit drag, 2 k / (n S g) / (1 + m_l / m_s), the least of all points.
template <class M>
Real drag_step(const State<M>& state) noexcept {
  Real rate = 0;
  for (const StepSums& s : state.sums) rate = max(rate, s.max_drag);
  return rate > 0 ? 2 / rate : 1e30;
}

/// Pressure held at the ground and at open walls, the same for all; 0 if nothing is held.
template <class M>
Real held_ground_pressure(const State<M>& state) {
  for (const auto& h : state.held)
    if (h.kind == HeldKind::open) return h.pressure(state.grid.origin(), state.time);
  return 0;
}

/// Pressure of eight points or of their cells.
template <bool CellAverage, class M>
VADOSE_INLINE Lanes pressure_in_use(const State<M>& state, std::size_t b,
                                    [[maybe_unused]] const CellFinder<State<M>::dim>& cells,
                                    [[maybe_unused]] const std::int32_t* entries) noexcept {
  Lanes p = state.liquid.load(field::liquid_pressure, b);
  if constexpr (CellAverage)
    for (int l = 0; l < lane_count; ++l)
      p.set(l, state.nodes.cell[static_cast<std::size_t>(entries[cells.index[l]])].pressure);
  return p;
}

/// Slopes and, in axisymmetry, hoop part of the force of an isotropic stress: volume_pressure
/// is V p [J].
template <class M, bool Moments, class Shape>
VADOSE_INLINE void isotropic_force(const Lanes& volume_pressure, const Lanes (&x)[State<M>::dim],
                                   Scatter<true, Moments, Shape, State<M>::dim>& scatter) noexcept {
  constexpr int dim = State<M>::dim;
  if constexpr (State<M>::Kinematics::axisymmetric)
    scatter.value[lane::force] +=
        volume_pressure * over_radius<typename State<M>::Kinematics, dim>(x, Real(0));
  for (int e = 0; e < dim; ++e) {
    for (auto& r : scatter.slope[e]) r = Lanes(0.0);
    scatter.slope[e][lane::force + e] = volume_pressure;
    transpose(scatter.slope[e]);
  }
}

/// Adds one batch of liquid points: m, m v, the sums of Eq. (20) over liquid points, and that of
/// Eq. (22) to `mixture`. `ground` is the pressure held at the ground: its boundary term, turned into a
/// volume integral, is that of -p at every point.
template <PaperMends Mends, class M>
VADOSE_INLINE void map_printed_batch(const State<M>& state, std::size_t b, Real ground,
                                     const TileFrame<State<M>::dim>& frame,
                                     const std::int32_t* entries, Record* liquid_tile,
                                     [[maybe_unused]] Record* mixture_tile) noexcept {
  constexpr int dim = State<M>::dim;
  constexpr bool affine = M::Transfer::affine;
  using Shape = typename M::Shape;
  const auto& points = state.liquid;
  Lanes x[dim];
  Stencil<Shape, dim> stencil;
  liquid_stencil(state, b, frame, x, stencil);
  CellFinder<dim> cells;
  cells.find(frame, x);
  const Retained liquid = retained(state, b);
  const Lanes p = pressure_in_use<Mends.cell_average>(state, b, cells, entries);
  const Lanes volume = points.load(field::volume, b);
  const Lanes mass = points.load(field::mass, b);

  Scatter<true, affine, Shape, dim> scatter;
  Lanes velocity[dim];
  for (int d = 0; d < dim; ++d) velocity[d] = points.load(field::velocity, b, d);
  for (auto& r : scatter.value) r = Lanes(0.0);
  if constexpr (has_skeleton<M>) {
    const PointDrag<M> drag(state, b, liquid, Mends.saturation);
    if constexpr (Mends.implicit_drag) {
      scatter.value[printed::drag] = drag.coefficient;
    } else {
      // v^s where there is solid.
      Gather<false, Shape, dim> skeleton;
      for (int l = 0; l < lane_count; ++l) {
        skeleton.value[l] = Lanes(0.0);
        for_cube<dim>(0, Shape::support, [&](const Index<dim>& i) {
          int at = stencil.offset[l];
          for (int d = 0; d < dim; ++d) at += i[d] * BlockGrid<dim>::tile_stride(d);
          const Record& node = state.nodes.relative[static_cast<std::size_t>(entries[at])];
          skeleton.value[l] += Lanes::load(node.value) * Lanes(stencil.product(i, l));
        });
      }
      skeleton.by_field();
      const Lanes share = max(skeleton.value[printed::solid], Lanes(1e-12));
      for (int d = 0; d < dim; ++d)
        scatter.value[lane::force + d] =
            -drag.coefficient * (velocity[d] - skeleton.value[printed::velocity + d] / share);
    }
  }
  Lanes pores = porosity_of(state, b) * volume;
  if constexpr (Mends.saturation) pores *= liquid.saturation;
  if constexpr (affine)
    affine_velocity(state, points, b, stencil, frame, x, mass, velocity, scatter.moment);
  scatter.value[lane::mass] = mass;
  for (int d = 0; d < dim; ++d) scatter.value[lane::momentum + d] = mass * velocity[d];
  isotropic_force<M>(pores * (p - Lanes(ground)), x, scatter);
  transpose(scatter.value);
  scatter.add(stencil, liquid_tile);
  if constexpr (has_skeleton<M>) {
    Scatter<true, false, Shape, dim> mixture;
    for (auto& r : mixture.value) r = Lanes(0.0);
    isotropic_force<M>(liquid.saturation * volume * p, x, mixture);
    transpose(mixture.value);
    mixture.add(stencil, mixture_tile);
  }
}

/// (a) Liquid points to nodes.
template <PaperMends Mends, class M>
void map_printed_liquid(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& nodes = state.nodes;
  clear(nodes.liquid_in, state.options.threads);
  clear(nodes.mixture, state.options.threads);
  const Real ground = held_ground_pressure(state);
  for_blocks_adding(state.liquid, state.options.threads, [&](const BatchRange& range, int thread) {
    Tile<dim>& liquid = state.tile(thread, 0);
    Tile<dim>& mixture = state.tile(thread, 1);
    const TileFrame<dim> frame = tile_frame(state.grid, range.slot);
    const std::int32_t* entries = state.grid.tile(range.slot);
    for (std::size_t b = range.begin; b < range.end; ++b) {
      state.liquid.prefetch(b + 2);
      map_printed_batch<Mends>(state, b, ground, frame, entries, liquid.record, mixture.record);
    }
    liquid.add_to(state.grid, range.slot, nodes.liquid_in);
    if constexpr (has_skeleton<M>) mixture.add_to(state.grid, range.slot, nodes.mixture);
  });
}

/// New velocities of a node whose skeleton may be prescribed: Eqs. (20), (22) and (24) with forces
/// that hold everything, or all but the drag `coefficient` where that is implicit.
template <bool ImplicitDrag, class M>
void advance_printed_pair(const State<M>& state, Real coefficient,
                          const Real (&prescribed)[State<M>::dim],
                          NodeMotion<State<M>::dim>& node) {
  const Real a = node.liquid_mass, b = node.solid_mass;
  const Real q = ImplicitDrag ? state.dt * coefficient : 0;
  for (int d = 0; d < State<M>::dim; ++d) {
    const Real r_l = a * node.liquid[d] + state.dt * node.liquid_force[d];
    const Real r_s = b * node.solid[d] + state.dt * node.solid_force[d];
    const bool fixed = is_finite(prescribed[d]);
    if (fixed)
      node.solid[d] = prescribed[d];
    else if (b > 0)
      node.solid[d] = r_s / b;
    const bool both = a > 0 && b > 0 && !fixed;
    if (state.frozen) {  // water goes where the skeleton goes
      if (both) node.solid[d] = (r_l + r_s) / (a + b);
      node.liquid[d] = node.solid[d];
    } else if (both && ImplicitDrag) {
      solve_pair(a, b, q, r_l, r_s, node.liquid[d], node.solid[d]);
    } else if (a > 0) {
      node.liquid[d] = (r_l + q * node.solid[d]) / (a + q);
    }
  }
}

/// (d), (e) One node: the liquid by Eq. (20), the solid by Eq. (22) less the inertia of the liquid.
template <PaperMends Mends, class M>
void advance_printed_node(State<M>& state, std::int32_t entry) {
  constexpr int dim = State<M>::dim;
  auto& nodes = state.nodes;
  const auto i = static_cast<std::size_t>(entry);
  const std::uint16_t flags = nodes.node_flags[i];
  NodeMotion<dim> node = load_node(state, i);
  const NodeMotion<dim> before = node;
  if (node.solid_mass + node.liquid_mass > 0) {
    Real prescribed[dim];
    for (Real& v : prescribed) v = unset;
    Real coefficient = 0;
    if constexpr (has_skeleton<M>) {
      if (nodes.relative[i][printed::solid] > 0) {
        find_prescribed(state, entry, flags, prescribed);
        coefficient = nodes.liquid_in[i][printed::drag];
      }
      for (int d = 0; d < dim; ++d)
        node.solid_force[d] += nodes.mixture[i][lane::force + d] +
                               node.liquid_mass * state.gravity[d] - node.liquid_force[d];
    }
    if (state.options.damping > 0 && node.solid_mass > 0) damp(state.options.damping, false, node);
    advance_printed_pair<Mends.implicit_drag>(state, coefficient, prescribed, node);
    apply_walls(state, entry, flags, node);
  }
  store_velocities(state, i, before, node);
  if constexpr (has_skeleton<M>)
    for (int d = 0; d < dim; ++d) nodes.relative[i][printed::velocity + d] = node.solid[d];
}

/// (d), (e) All nodes.
template <PaperMends Mends, class M>
void advance_printed_nodes(State<M>& state) {
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<State<M>::dim>&, int, int) {
              advance_printed_node<Mends>(state, e);
            });
}

/// What changes the pressure of liquid points [1/s].
struct LiquidRates {
  Lanes liquid = Lanes(0.0);      ///< div v^l
  Lanes solid = Lanes(0.0);       ///< div v^s
  Lanes convection = Lanes(0.0);  ///< w . grad n
};

/// Rates of a batch at its points, from new velocities.
template <class M>
VADOSE_INLINE LiquidRates point_rates([[maybe_unused]] const State<M>& state,
                                      const Stencil<typename M::Shape, State<M>::dim>& stencil,
                                      const Lanes (&x)[State<M>::dim],
                                      const PointMotion<State<M>::dim>& motion,
                                      [[maybe_unused]] const Record* skeleton) noexcept {
  constexpr int dim = State<M>::dim;
  const Lanes over = over_radius<typename State<M>::Kinematics, dim>(x, Real(0));
  LiquidRates rates;
  rates.liquid = motion.velocity[0] * over;
  for (int d = 0; d < dim; ++d) rates.liquid += motion.gradient[d][d];
  if constexpr (has_skeleton<M>) {
    Gather<true, typename M::Shape, dim> solid;
    solid.sum(stencil, skeleton);
    solid.by_field();
    rates.solid = solid.value[printed::velocity] * over;
    for (int d = 0; d < dim; ++d) {
      rates.solid += solid.slope[d][printed::velocity + d];
      rates.convection += (motion.velocity[d] - solid.value[printed::velocity + d]) *
                          solid.slope[d][printed::porosity];
    }
  }
  return rates;
}

/// Means of the rates over the cells of eight points.
template <class M>
VADOSE_INLINE LiquidRates mean_rates(const State<M>& state, const CellFinder<State<M>::dim>& cells,
                                     const std::int32_t* entries) noexcept {
  LiquidRates rates;
  for (int l = 0; l < lane_count; ++l) {
    const Record& sums = state.nodes.free[static_cast<std::size_t>(entries[cells.index[l]])];
    if (!(sums[printed::volume] > 0)) continue;
    const Real over = 1 / sums[printed::volume];
    rates.liquid.set(l, over * sums[printed::liquid_rate]);
    rates.solid.set(l, over * sums[printed::solid_rate]);
    rates.convection.set(l, over * sums[printed::convection]);
  }
  return rates;
}

/// A batch of liquid points with what the nodes hand back to it.
template <class M>
struct LiquidBatch {
  static constexpr int dim = State<M>::dim;
  Lanes x[dim];
  Stencil<typename M::Shape, dim> stencil;
  CellFinder<dim> cells;
  PointMotion<dim> motion;

  VADOSE_INLINE LiquidBatch(const State<M>& state, std::size_t b, const TileFrame<dim>& frame,
                            const Record* liquid) noexcept {
    liquid_stencil(state, b, frame, x, stencil);
    cells.find(frame, x);
    interpolate<true>(stencil, liquid, motion);
  }
};

/// Sums the rates of the liquid points of every cell.
template <class M>
void sum_rates(State<M>& state) {
  constexpr int dim = State<M>::dim;
  clear(state.nodes.free, state.options.threads);
  state.nodes.holds_free = true;
  for_blocks_adding(state.liquid, state.options.threads, [&](const BatchRange& range, int thread) {
    Tile<dim>& liquid = state.tile(thread, 0);
    Tile<dim>& skeleton = state.tile(thread, 1);
    liquid.read(state.grid, range.slot, state.nodes.liquid_out);
    if constexpr (has_skeleton<M>) skeleton.read(state.grid, range.slot, state.nodes.relative);
    const TileFrame<dim> frame = tile_frame(state.grid, range.slot);
    const std::int32_t* entries = state.grid.tile(range.slot);
    for (std::size_t b = range.begin; b < range.end; ++b) {
      const LiquidBatch<M> batch(state, b, frame, liquid.record);
      const LiquidRates rates =
          point_rates(state, batch.stencil, batch.x, batch.motion, skeleton.record);
      const Lanes volume = state.liquid.load(field::volume, b);
      for (int l = 0; l < lane_count; ++l) {
        // Straight to the cells: both tiles are taken, and no two threads share a cell here.
        const std::int32_t e = entries[batch.cells.index[l]];
        if (e == state.grid.outside()) continue;
        Record& sums = state.nodes.free[static_cast<std::size_t>(e)];
        sums[printed::volume] += volume[l];
        sums[printed::liquid_rate] += volume[l] * rates.liquid[l];
        sums[printed::solid_rate] += volume[l] * rates.solid[l];
        sums[printed::convection] += volume[l] * rates.convection[l];
      }
    }
    for (auto& r : liquid.record) r = Record{};
    for (auto& r : skeleton.record) r = Record{};
  });
}

/// (g) Pressure of a batch by Eq. (9), read along the liquid:
/// n (S/K + S_p) dp = -S [(1 - n) div v^s + n div v^l] dt, with the mended terms
/// -S (w . grad n) dt and -n S_n [(1 - n) div v^s + w . grad n] dt. Eq. (10) where n = 1.
template <PaperMends Mends, class M>
VADOSE_INLINE void update_printed_pressure(State<M>& state, std::size_t b,
                                           const LiquidRates& rates) noexcept {
  const Retained liquid = retained(state, b);
  const Lanes n = porosity_of(state, b);
  Lanes porosity_rate = (Lanes(1.0) - n) * rates.solid;
  if constexpr (Mends.porosity_gradient) porosity_rate += rates.convection;
  Lanes lost = liquid.saturation * (porosity_rate + n * rates.liquid);
  if constexpr (Mends.porosity_slope) lost += n * liquid.porosity_slope * porosity_rate;
  const Lanes storage =
      n * (liquid.saturation * Lanes(1 / state.water.bulk_modulus) + liquid.slope);
  const Lanes p = state.liquid.load(field::liquid_pressure, b);
  state.liquid.store(field::liquid_pressure, b, p - Lanes(state.dt) * lost / storage);
}

/// (f), (g) Nodes to liquid points: velocity and position by v^l, pressure.
template <PaperMends Mends, class M>
void update_printed_liquid(State<M>& state) {
  constexpr int dim = State<M>::dim;
  if constexpr (Mends.cell_average)
    if (!state.frozen) sum_rates(state);
  for_blocks(state.liquid, state.options.threads, [&](const BatchRange& range, int thread) {
    Tile<dim>& liquid = state.tile(thread, 0);
    Tile<dim>& skeleton = state.tile(thread, 1);
    liquid.read(state.grid, range.slot, state.nodes.liquid_out);
    if constexpr (has_skeleton<M>) skeleton.read(state.grid, range.slot, state.nodes.relative);
    const TileFrame<dim> frame = tile_frame(state.grid, range.slot);
    const std::int32_t* entries = state.grid.tile(range.slot);
    StepSums& sums = state.sums[static_cast<std::size_t>(thread)];
    for (std::size_t b = range.begin; b < range.end; ++b) {
      state.liquid.prefetch(b + 2);
      if (state.frozen && state.liquid.group(b) == state.free_group()) continue;
      const LiquidBatch<M> batch(state, b, frame, liquid.record);
      if (!state.frozen) {
        const LiquidRates rates = Mends.cell_average ? mean_rates(state, batch.cells, entries)
                                                     : point_rates(state, batch.stencil, batch.x,
                                                                   batch.motion, skeleton.record);
        update_printed_pressure<Mends>(state, b, rates);
      }
      update_velocity(state, state.liquid, b, batch.stencil, frame, batch.x, liquid.record,
                      batch.motion);
      move(state, state.liquid, b, "liquid", batch.motion.velocity, sums);
    }
    for (auto& r : liquid.record) r = Record{};
    for (auto& r : skeleton.record) r = Record{};
  });
}

}  // namespace kernel
}  // namespace vadose
