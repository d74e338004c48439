// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Step 4: faces between cells: head gradient, upstream saturation, conductivity.

#include <algorithm>

#include <vadose/kernel/face_mobility.hpp>
#include <vadose/kernel/rain.hpp>

namespace vadose::kernel {

/// Conductivities of up to eight soil cells at their own pressure and at S = 1.
template <class M>
void find_conductivities(const State<M>& state, CellBatch<M>& batch) {
  using C = Cell<State<M>::dim>;
  if (batch.count == 0) return;
  const auto& soil = state.soils[batch.material];
  const auto& material = soil.material;
  const Lanes one(1.0), zero(0.0);
  const Lanes saturated = conductivity::saturated<Lanes>(
      material.conductivity, batch.numbers([](const C& c) { return c.soil_porosity; }));
  Lanes conductivity = saturated;
  if constexpr (is_unsaturated<M>) {
    const Lanes p = batch.numbers([](const C& c) { return c.pressure; });
    const Lanes n = batch.numbers([](const C& c) { return c.porosity; });
    const Lanes on_curve =
        swrc::saturation_and_slope<Lanes>(material.retention, max(-p, zero), n).saturation;
    const Lanes in_cell = batch.numbers([](const C& c) { return c.saturation; });
    const Lanes s = select(p > Lanes(soil.pressure_floor), on_curve, in_cell);
    const Lanes own = conductivity::value<Lanes>(
        material.conductivity, swrc::effective_saturation<Lanes>(material.retention, s), n);
    conductivity = select((p < zero) & (s < one), own, saturated);
  }
  for (int l = 0; l < batch.count; ++l) {
    batch.cell[l]->saturated_conductivity = saturated[l];
    batch.cell[l]->conductivity = conductivity[l];
  }
  batch.count = 0;
}

/// Conductivities of every soil cell. The saturation is the one that belongs to the pressure of a
/// cell, which its mean saturation does not quite: the pressure varies over the cell, and near S = 1 a
/// 1e-5 of S is 15 % of a clay's conductivity. Cells too dry for their pressure to say so count by
/// their water.
template <class M>
void find_conductivities(State<M>& state) {
  constexpr std::size_t cells = Block<State<M>::dim>::cells;
  auto& nodes = state.nodes;
  parallel_for(static_cast<std::size_t>(state.grid.slots()), state.options.threads,
               [&](std::size_t s, int) {
                 CellBatch<M> batch;
                 for (std::size_t i = s * cells; i < (s + 1) * cells; ++i) {
                   auto& cell = nodes.cell[i];
                   if (nodes.dof[i] != static_cast<std::int32_t>(i) || !(cell.soil_share > 0))
                     continue;
                   if (batch.count == lane_count || cell.material != batch.material)
                     find_conductivities(state, batch);
                   batch.material = cell.material;
                   batch.cell[batch.count++] = &cell;
                 }
                 find_conductivities(state, batch);
               });
}

/// Conductivity between two pressures by the model's mean.
template <class M>
Real face_conductivity(const State<M>& state, int material, Real upstream, Real p_a, Real p_b,
                       Real porosity, Real gravity_head) {
  if constexpr (is_unsaturated<M>) {
    if (p_a >= 0 && p_b >= 0) return upstream;
    return M::Interblock::mean(*state.soils[static_cast<std::size_t>(material)].kirchhoff,
                               FaceState<Real>{p_a, p_b, porosity, upstream, gravity_head});
  } else {
    return upstream;
  }
}

/// Area of the lower face of a cell along an axis.
template <class M>
Real face_area(const CellView<M>& view, int axis) noexcept {
  const Real h = view.state.grid.cell_size();
  Real area = power<State<M>::dim - 1>(h);
  if constexpr (State<M>::Kinematics::axisymmetric)
    area *= axis == 0 ? view.centre(0) - 0.5 * h : view.centre(0);
  return area;
}

/// |rho_l g| along an axis times a distance [Pa].
template <class M>
Real gravity_head(const State<M>& state, int axis, Real distance) noexcept {
  return state.water.density * std::fabs(state.gravity[axis]) * distance;
}

/// Factor of the conductivity between two cells for their half ways in series, 2 k_a k_b / (k_a + k_b)
/// of the saturated ones over that of the upstream cell: porosity has no upstream side. Unsaturated
/// cells of two soils differ in more than that: there the upstream cell counts alone.
template <int Dim>
Real series_factor(const Cell<Dim>& a, const Cell<Dim>& b, const Cell<Dim>& up) noexcept {
  const Real k_a = a.saturated_conductivity, k_b = b.saturated_conductivity;
  const bool comparable = a.material == b.material || (a.pressure >= 0 && b.pressure >= 0);
  if (k_a == k_b || !comparable) return 1;
  return 2 * (&up == &a ? k_b : k_a) / (k_a + k_b);
}

/// Eight faces in soil under suction, whose mean conductivities are found together.
template <class M>
struct FaceBatch {
  int count = 0;
  std::uint8_t material = 0;
  FaceFlux* face[lane_count];
  alignas(64) double pressure_a[lane_count], pressure_b[lane_count], porosity[lane_count];
  alignas(64) double upstream[lane_count], gravity_head[lane_count], factor[lane_count];
};

/// Mean conductivities of up to eight faces.
template <class M>
void find_means(const State<M>& state, FaceBatch<M>& batch) {
  if (batch.count == 0) return;
  if constexpr (is_unsaturated<M>) {
    for (int l = batch.count; l < lane_count; ++l)
      for (double* values :
           {batch.pressure_a, batch.pressure_b, batch.porosity, batch.upstream, batch.gravity_head})
        values[l] = values[0];
    const Lanes k = M::Interblock::mean(
        *state.soils[batch.material].kirchhoff,
        FaceState<Lanes>{Lanes::load(batch.pressure_a), Lanes::load(batch.pressure_b),
                         Lanes::load(batch.porosity), Lanes::load(batch.upstream),
                         Lanes::load(batch.gravity_head)});
    for (int l = 0; l < batch.count; ++l) batch.face[l]->conductivity = batch.factor[l] * k[l];
  }
  batch.count = 0;
}

/// Face between two soil cells with different pressures. The water moves as fast as the upstream
/// saturation lets it, k H / (n S_up gamma), and there is as much of it as both cells hold in the mean:
/// n (S_a + S_b) / 2. (With n S_up the fronts of rain run ahead: finite volumes of 0.1 m then miss S
/// by 0.0155 rms after 4500 s, with this by 0.0067.) Its conductivity is the upstream one, or follows from
/// `batch`.
template <class M>
void inside_face(const State<M>& state, int axis, const Cell<State<M>::dim>& a,
                 const Cell<State<M>::dim>& b, FaceFlux& face, FaceBatch<M>& batch) {
  const Real h = state.grid.cell_size();
  const Real distance = max(0.5 * h, b.centroid[axis] - a.centroid[axis]);
  const Real drop = b.pressure - a.pressure - hydrostatic(state, a.centroid, b.centroid);
  const auto& up = drop > 0 ? b : a;
  face.kind = FaceKind::inside;
  face.distance = distance;
  face.head_gradient = drop / distance;
  face.from_above = drop > 0;
  face.saturation = up.saturation;
  const Real factor = up.saturation > 0 ? series_factor(a, b, up) *
                                              (0.5 * (a.saturation + b.saturation) / up.saturation)
                                        : 1;
  face.conductivity = factor * up.conductivity;
  if (!is_unsaturated<M> || (a.pressure >= 0 && b.pressure >= 0)) return;
  if (batch.count == lane_count || batch.material != up.material) find_means(state, batch);
  const int l = batch.count++;
  batch.material = up.material;
  batch.face[l] = &face;
  batch.pressure_a[l] = a.pressure;
  batch.pressure_b[l] = b.pressure;
  batch.porosity[l] = up.porosity;
  batch.upstream[l] = up.conductivity;
  batch.factor[l] = factor;
  batch.gravity_head[l] = gravity_head(state, axis, distance);
}

/// The soil cell of the same material behind the one at an outer face, for where it has its pressure;
/// null if there is none.
template <class M>
const Cell<State<M>::dim>* cell_behind(const CellView<M>& view, int axis,
                                       const Cell<State<M>::dim>& soil, bool soil_below) noexcept {
  const auto& nodes = view.state.nodes;
  const auto& grid = view.state.grid;
  const int inward = soil_below ? -1 : 1;
  Index<State<M>::dim> place = view.cell;
  if (soil_below) --place[axis];
  for (int steps = 0; steps < 2; ++steps) {  // two where the first is a sliver of the same cell
    place[axis] += inward;
    if (place[axis] < 0 || place[axis] >= grid.cells()[axis]) return nullptr;
    const std::int32_t entry = grid.entry(place);
    if (entry == grid.outside()) return nullptr;
    const std::int32_t owner = nodes.dof[static_cast<std::size_t>(entry)];
    if (owner < 0) return nullptr;
    const auto& cell = nodes.cell[static_cast<std::size_t>(owner)];
    if (&cell == &soil) continue;
    return cell.kind == CellKind::soil && cell.material == soil.material ? &cell : nullptr;
  }
  return nullptr;
}

/// Factor of the conductivity of a cell on the way to its outer face: porosity goes on changing there as
/// from the cell behind, which makes k a power of the distance; its value half way counts. Where a
/// drained surface has halved k within a cell, k of the cell would let out far too much: consolidation
/// by 39 % then misses p by 3.7 % of the load, with this by 2.1 %.
template <class M>
Real outward_factor(const CellView<M>& view, int axis, const Cell<State<M>::dim>& soil,
                    bool soil_below, Real distance) noexcept {
  const auto* behind = cell_behind(view, axis, soil, soil_below);
  if (!behind || !(behind->saturated_conductivity > 0) ||
      behind->saturated_conductivity == soil.saturated_conductivity)
    return 1;
  const Real between = std::fabs(soil.centroid[axis] - behind->centroid[axis]);
  return std::pow(soil.saturated_conductivity / behind->saturated_conductivity,
                  0.5 * min(1.0, distance / between));
}

/// Face between soil and a held pressure (free water, an open surface or a wall) at x_face along
/// the axis. Water that enters does so at S = 1.
template <class M>
void outer_face(const CellView<M>& view, int axis, const Cell<State<M>::dim>& soil,
                const Real (&at)[State<M>::dim], Real pressure, FaceFlux& face) {
  const auto& state = view.state;
  const Real h = state.grid.cell_size();
  const Real distance = max(0.1 * h, std::fabs(at[axis] - soil.centroid[axis]));
  const Real inward = pressure - soil.pressure - hydrostatic(state, soil.centroid, at);
  face.distance = distance;
  face.head_gradient = (face.soil_below ? inward : -inward) / distance;
  const bool enters = inward > 0;
  face.saturation = enters ? 1 : soil.saturation;
  face.outward = outward_factor(view, axis, soil, face.soil_below, distance);
  face.conductivity =
      face.outward * face_conductivity(state, soil.material,
                                       enters ? soil.saturated_conductivity : soil.conductivity,
                                       soil.pressure, pressure, soil.porosity,
                                       gravity_head(state, axis, distance));
  face.held_pressure = pressure;
}

/// Middle of the lower face of a cell.
template <class M>
Vec<State<M>::dim> face_centre(const CellView<M>& view, int axis) {
  Vec<State<M>::dim> x;
  for (int d = 0; d < State<M>::dim; ++d) x[d] = view.centre(d);
  x[axis] -= 0.5 * view.state.grid.cell_size();
  return x;
}

/// What find_held returns where water is to be kept from passing.
inline constexpr std::int16_t held_closed = -2;

/// Index of the held pressure at a wall (axis, side) or at the surface (axis -1); -1: none.
template <class M>
std::int16_t find_held(const State<M>& state, int axis, int side, const Vec<State<M>::dim>& x) {
  for (std::size_t i = 0; i < state.held.size(); ++i)
    if (state.held[i].is_at(axis, side, x))
      return state.held[i].kind == HeldKind::closed ? held_closed : static_cast<std::int16_t>(i);
  return -1;
}

/// Ground under rain or a film, and the most it could take; share_supplies() gives it its share.
template <class M>
void rained_face(const State<M>& state, const Cell<State<M>::dim>& soil, bool wetted,
                 FaceFlux& face) {
  const Real inward = face.soil_below ? face.head_gradient : -face.head_gradient;
  face.fed = true;
  face.wetted = wetted;
  face.supply = wetted ? face.area * driven_flux(state, face, soil, max(0.0, inward), 0).value : 0;
}

/// Face at a held pressure, at the given point of a wall or of the ground.
template <class M>
void held_face(const CellView<M>& view, int axis, const Cell<State<M>::dim>& soil,
               const Real (&at)[State<M>::dim], FaceFlux& face) {
  const auto& state = view.state;
  const auto& held = state.held[static_cast<std::size_t>(face.held)];
  Vec<State<M>::dim> x;
  for (int d = 0; d < State<M>::dim; ++d) x[d] = at[d];
  Real p = held.pressure(x, state.time);
  const bool dry = held.kind == HeldKind::reservoir && p <= 0;
  if (dry) p = 0;
  outer_face(view, axis, soil, at, p, face);
  face.one_way = dry || held.kind == HeldKind::outlet;
  if (face.one_way)
    face.thirsty = (face.soil_below ? face.head_gradient : -face.head_gradient) >= 0;
}

/// Face between soil and air: open if a pressure is held at the surface there, else closed.
template <class M>
void surface_face(const State<M>& state, const CellView<M>& view, int axis,
                  const Cell<State<M>::dim>& soil, FaceFlux& face) {
  face.kind = FaceKind::surface;
  face.held_pressure = 0;
  face.saturation = soil.saturation;
  face.conductivity = soil.conductivity;
  face.held = find_held(state, -1, 0, face_centre(view, axis));
  const RainColumn<State<M>::dim>* column = nullptr;
  if (state.films && face.held != held_closed &&
      (face.held < 0 || state.held[static_cast<std::size_t>(face.held)].kind == HeldKind::rain))
    column = column_wetting(state, view, axis, face.soil_below);
  if (face.held < 0 && !(column && column->film > 0)) return;
  const Real h = state.grid.cell_size();
  Real at[State<M>::dim];
  for (int d = 0; d < State<M>::dim; ++d) at[d] = soil.centroid[d];
  at[axis] += (face.soil_below ? 0.5 : -0.5) * min(1.5, soil.fill) * h;
  if (column || state.held[static_cast<std::size_t>(face.held)].kind == HeldKind::rain) {
    outer_face(view, axis, soil, at, column ? film_pressure(state, *column) : 0, face);
    rained_face(state, soil, column != nullptr, face);
  } else {
    held_face(view, axis, soil, at, face);
  }
}

/// Face between soil and a wall.
template <class M>
void wall_face(const State<M>& state, const CellView<M>& view, int axis, int side,
               const Cell<State<M>::dim>& soil, FaceFlux& face) {
  const Vec<State<M>::dim> centre = face_centre(view, axis);
  const std::int16_t held = find_held(state, axis, side, centre);
  if (held < 0) return;
  face.kind = FaceKind::surface;
  face.held = held;
  Real at[State<M>::dim];
  for (int d = 0; d < State<M>::dim; ++d) at[d] = soil.centroid[d];
  at[axis] = centre[axis];
  held_face(view, axis, soil, at, face);
}

/// Face between soil and free water.
template <class M>
void water_face(const State<M>& state, const CellView<M>& view, int axis,
                const Cell<State<M>::dim>& soil, const Cell<State<M>::dim>& free, FaceFlux& face) {
  face.kind = FaceKind::to_free;
  Real at[State<M>::dim];
  for (int d = 0; d < State<M>::dim; ++d) at[d] = soil.centroid[d];
  at[axis] = face_centre(view, axis)[axis];
  const Real p = max(0.0, free.pressure + hydrostatic(state, free.centroid, at));
  outer_face(view, axis, soil, at, p, face);
}

/// The lower face of one cell along one axis.
template <class M>
void find_face(const State<M>& state, const CellView<M>& view, int axis, FaceFlux& face,
               FaceBatch<M>& batch) {
  const auto& nodes = state.nodes;
  face = FaceFlux{};
  const int cells = state.grid.cells()[axis];
  const int position = view.cell[axis];
  if (position > cells) return;
  for (int d = 0; d < State<M>::dim; ++d)
    if (d != axis && view.cell[d] >= state.grid.cells()[d]) return;
  const auto owner = [&](std::int32_t e) { return nodes.dof[static_cast<std::size_t>(e)]; };
  const std::int32_t own = position < cells ? owner(view.entry()) : -1;
  const std::int32_t low = position > 0 ? owner(view.neighbour(axis, -1)) : -1;
  if (own == low) return;
  const Cell<State<M>::dim>* above = own < 0 ? nullptr : &nodes.cell[static_cast<std::size_t>(own)];
  const Cell<State<M>::dim>* below = low < 0 ? nullptr : &nodes.cell[static_cast<std::size_t>(low)];
  if ((above && above->drop) || (below && below->drop)) return;
  const bool soil_above = above && above->kind == CellKind::soil;
  const bool soil_below = below && below->kind == CellKind::soil;
  if (!soil_above && !soil_below) return;
  face.area = face_area(view, axis);
  if (soil_above && soil_below) {
    inside_face(state, axis, *below, *above, face, batch);
    return;
  }
  face.soil_below = soil_below;
  const auto& soil = soil_below ? *below : *above;
  if (position == 0 || position == cells)
    wall_face(state, view, axis, position == 0 ? 0 : 1, soil, face);
  else if (above && below)
    water_face(state, view, axis, soil, soil_below ? *above : *below, face);
  else
    surface_face(state, view, axis, soil, face);
}

/// Calls f(axis, face) for every face of a pressure cell and its slivers.
template <class M, class F>
void for_faces(const CellView<M>& view, F&& f) {
  constexpr int dim = State<M>::dim;
  for_members(view, [&](std::int32_t, const Index<dim>& step) {
    int at = view.at;
    for (int d = 0; d < dim; ++d) at += step[d] * BlockGrid<dim>::tile_stride(d);
    for (int d = 0; d < dim; ++d)
      for (int side = 0; side < 2; ++side) {
        const auto e =
            static_cast<std::size_t>(view.tile[at + side * BlockGrid<dim>::tile_stride(d)]);
        f(d, view.state.nodes.face[e * dim + static_cast<std::size_t>(d)]);
      }
  });
}

/// Pressure of the soil cell at a held face: p + rho g dx, as outer_face() took it.
inline Real own_pressure(const FaceFlux& face) noexcept {
  return face.held_pressure - (face.soil_below ? 1 : -1) * face.head_gradient * face.distance;
}

/// What the faces of a cell at air or at a wall say of the pressure there.
struct SurfaceSums {
  Real pressure = 0;  ///< sum of pressure times area [N]
  Real area = 0;      ///< [m2]
  Real shut = 0;      ///< area of those that let nothing pass [m2]

  void add(Real p, const FaceFlux& face) noexcept {
    pressure += face.area * p;
    area += face.area;
    if (face.is_shut()) shut += face.area;
  }
  SurfaceSums operator+(const SurfaceSums& o) const noexcept {
    return {pressure + o.pressure, area + o.area, shut + o.shut};
  }
};

/// Pressure at the surface of every soil cell at air or at a held wall: the mean of what is held at its
/// faces across an axis, or, across an axis without, at all of them; a closed surface carries the pressure
/// of the cell there, so that it drives no flow. (One mean for all axes: at rest, where closed ground and
/// a held wall meet, the weight of the water would drive it through the wall.)
template <class M>
void find_reference_pressures(State<M>& state) {
  constexpr int dim = State<M>::dim;
  auto& nodes = state.nodes;
  for_cells(state.grid, state.options.threads, nodes.has_edge,
            [&](std::int32_t e, const Index<dim>& local, int slot, int) {
              auto& cell = nodes.cell[static_cast<std::size_t>(e)];
              if (nodes.dof[static_cast<std::size_t>(e)] != e || cell.kind != CellKind::soil)
                return;
              const CellView<M> view(state, local, slot);
              if (!cell.at_air && cell.members == 1 && view.has_neighbours()) return;
              // A cell without a cut has walls for its surface and no surface_point.
              const bool cut = cell.at_air || cell.members > 1;
              const Real own =
                  cut ? cell.pressure + hydrostatic(state, cell.centroid, cell.surface_point) : 0;
              SurfaceSums across[dim], all;
              for_faces(view, [&](int axis, const FaceFlux& face) {
                if (face.kind != FaceKind::surface) return;
                across[axis].add(!face.is_shut() ? face.held_pressure
                                 : cut           ? own
                                                 : own_pressure(face),
                                 face);
              });
              for (const auto& sums : across) all = all + sums;
              cell.has_reference = all.area > 0;
              if (!cell.has_reference) return;
              for (int d = 0; d < dim; ++d) {
                const SurfaceSums& sums = across[d].area > 0 ? across[d] : all;
                cell.reference_pressure[d] = sums.pressure / sums.area;
                cell.reference_share[d] = sums.shut / sums.area;
              }
            });
}

/// Step 4 where the conductivities of the cells are known: all faces.
template <class M>
void connect_cells(State<M>& state) {
  constexpr int dim = State<M>::dim;
  if (state.films) find_columns(state);
  parallel_for(
      static_cast<std::size_t>(state.grid.slots()), state.options.threads, [&](std::size_t s, int) {
        FaceBatch<M> batch[dim];  // one for each axis: across some, pressures hardly differ
        const std::size_t first = s * Block<dim>::cells * dim;
        FaceFlux* face = &state.nodes.face[first];
        std::fill_n(&state.nodes.flux[first], Block<dim>::cells * dim, 0.0);
        for_cube<dim>(0, Block<dim>::edge, [&](const Index<dim>& local) {
          const CellView<M> view(state, local, static_cast<int>(s));
          for (int d = 0; d < dim; ++d) find_face(state, view, d, *face++, batch[d]);
        });
        for (auto& faces : batch) find_means(state, faces);
      });
  share_supplies(state);
  find_reference_pressures(state);
}

/// Step 4: all faces.
template <class M>
void find_faces(State<M>& state) {
  find_conductivities(state);
  connect_cells(state);
}

}  // namespace vadose::kernel
