// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// What cells and faces bring to the nodes around them.

#include <algorithm>
#include <array>

#include <vadose/kernel/faces.hpp>
#include <vadose/kernel/map_to_grid.hpp>

namespace vadose::kernel {

/// What the cells around a node give it, or (Lanes) those around each of eight.
template <int Dim, class T = Real>
struct NodeSums {
  T volume{};  ///< V_c,I = sum f V_c N_I [m3]
  /// G_I = sum f V_c (p - p_ref) grad N_I [N]; p_ref is the pressure at the surface or held wall
  /// that the node's cells end at, so that uniform pressure is at rest for any cut.
  T force[Dim] = {};
  T gradient[Dim] = {};  ///< sum f V_c grad N_I, zero inside [m2]
  T reference[Dim] =
      {};  ///< sums of reference pressures of the cells around, where they count [Pa]
  int references = 0;
  T soil_force[Dim] = {};      ///< sum f V_c S p grad N_I [N]
  T skeleton_force[Dim] = {};  ///< - sum f V_c (mean Bishop stress) grad N_I [N]
  T soil_volume{};             ///< share of V_c,I in soil cells, bulk of soil only [m3]
  T pores{};                   ///< sum of n over it [m3]
  T saturation[Dim] = {};      ///< upstream, mean over the faces across an axis
  T conductivity[Dim] = {};
  T head_gradient[Dim] = {};
  T drag[Dim] =
      {};  ///< linear, per velocity and volume of liquid; 0: the water is stuck [kg/(m3 s)]
  /// Of the control volume; that of free water is 1. Volumetric, so that a trace of solid at a node
  /// does not make it soil.
  T porosity{1};
  std::uint8_t material = 0;
  int soil_cells = 0;           ///< cells around that hold soil
  bool closed_surface = false;  ///< touches soil and air, and no water passes
  bool has_soil = false;
  bool has_free = false;  ///< touches free water
  T normal[Dim] = {};     ///< out of the soil, where closed_surface

  /// Part of the control volume that is soil; the rest is free water [-].
  T soil_share() const noexcept {
    return min(T(1.0), max(T(0.0), ratio_or(soil_volume, volume, T(0.0))));
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
inline constexpr int counts = 3;        ///< cell_count of what it holds
inline constexpr int place = 4;         ///< first of three, quadrature point in the cell
inline constexpr int over_radius = 7;   ///< 1/r there [1/m]
}  // namespace cell_lane

/// Marks of the cells around a node, as cell_lane::counts adds them up.
namespace cell_count {
inline constexpr int reference = 1;  ///< has a reference pressure
inline constexpr int soil = 16;
inline constexpr int free = 256;
}  // namespace cell_count

/// Mean Bishop stress of the skeleton in a pressure cell and its slivers, as its points brought it [Pa].
template <class M>
Real mean_stress(const State<M>& state, std::int32_t entry) noexcept {
  const auto e = static_cast<std::size_t>(entry);
  const bool alone = state.nodes.cell[e].members == 1;
  const Record sums =
      alone ? state.nodes.content[e] : member_sums(view_of(state, entry), state.nodes.content);
  return ratio_or(sums[lane::mean_stress], sums[lane::skeleton_volume], 0.0);
}

/// The two records of a cell.
/// DEVIATION: [Zhan] Eq. (22) takes the whole stress of each point to the nodes.
/// The skeleton's mean stress acts here like the liquid's pressure, with the same quadrature: a
/// free surface under suction (sigma* = S p) is then in balance node by node, and a stiff liquid
/// does not lock the skeleton; the deviator acts through the points' own functions.
template <class M>
void prepare_cell(const State<M>& state, std::int32_t entry, const Index<State<M>::dim>& cell,
                  Record& weighted, Record& plain) noexcept {
  constexpr int dim = State<M>::dim;
  const auto& c = state.nodes.cell[static_cast<std::size_t>(entry)];
  Real xi[dim];
  quad_coordinates(state, cell, c, xi);
  const bool soil = c.soil_share > 0;
  const Real p = c.quad_volume * c.quad_pressure;
  weighted[cell_lane::volume] = c.quad_volume;
  weighted[cell_lane::pressure] = p;
  weighted[cell_lane::soil_pressure] = c.saturation * p;
  weighted[cell_lane::mean_stress] =
      is_deformable<M> ? -(c.quad_volume * c.soil_share * mean_stress(state, entry)) : 0;
  weighted[cell_lane::soil_volume] = soil ? c.quad_volume * c.soil_share : 0;
  weighted[cell_lane::pores] = weighted[cell_lane::soil_volume] * c.soil_porosity;
  weighted[cell_lane::holds_soil] = soil ? c.quad_volume : 0;
  plain[cell_lane::saturation] = soil ? c.saturation : 0;
  plain[cell_lane::conductivity] = soil ? c.conductivity : 0;
  plain[cell_lane::counts] = (c.has_reference ? cell_count::reference : 0) +
                             (soil ? cell_count::soil : 0) +
                             (c.kind == CellKind::free ? cell_count::free : 0);
  for (int d = 0; d < dim; ++d) plain[cell_lane::place + d] = xi[d];
  plain[cell_lane::over_radius] = State<M>::Kinematics::axisymmetric ? 1 / c.quad_point[0] : 0;
}

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
};

/// What a node needs of the sums over its cells; rows are indexed by lane: a sum each, or those of eight
/// nodes.
template <int Dim, class T, class Rows>
VADOSE_INLINE void take_cells(const Rows& value, const Rows& plain, const Rows (&slope)[Dim],
                              NodeSums<Dim, T>& node) noexcept {
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

/// Corner number of a cube index of zeros and ones.
template <int Dim>
constexpr int corner_number(const Index<Dim>& corner) noexcept {
  int number = 0;
  for (int d = 0; d < Dim; ++d) number += corner[d] << d;
  return number;
}

/// Lanes of what the lower faces of a cell bring to the nodes in them; three each, by axis.
namespace face_lane {
inline constexpr int saturation = 0;    ///< [-]
inline constexpr int conductivity = 4;  ///< [m/s]
// Second record:
inline constexpr int head_gradient = 0;  ///< [Pa/m]
inline constexpr int counts = 4;         ///< 1 where water can pass, face_at_air more at a surface
}  // namespace face_lane

/// Mark of a face between soil and air in face_lane::counts.
inline constexpr int face_at_air = 16;

/// By corner of a cell: 1 in lanes d and 4 + d where it is one of the lower face across axis d, else 0.
template <int Dim>
inline constexpr std::array<Record, 1 << Dim> in_lower_face = [] {
  std::array<Record, 1 << Dim> marks;
  for (std::size_t corner = 0; corner < marks.size(); ++corner)
    for (std::size_t d = 0; d < Dim; ++d)
      marks[corner].value[d] = marks[corner].value[4 + d] = (corner >> d) & 1 ? 0 : 1;
  return marks;
}();

/// in_lower_face of a corner, as lanes.
template <int Dim>
VADOSE_INLINE Lanes lower_faces_at(const Index<Dim>& corner) noexcept {
  return Lanes::load(in_lower_face<Dim>[static_cast<std::size_t>(corner_number(corner))].value);
}

/// The two records of the lower faces of a cell in or below a block, as they count at the block's nodes.
template <class M>
void prepare_faces(const State<M>& state, const std::int32_t* tile,
                   const Index<State<M>::dim>& local, Record& flow, Record& head) noexcept {
  const int at = BlockGrid<State<M>::dim>::tile_index(local);
  flow = head = Record{};
  for (int d = 0; d < State<M>::dim; ++d) {
    if (local[d] < 0) continue;  // its lower face lies below the nodes of the block
    const FaceFlux& f = state.nodes.face[face_at_node(state, tile, at, d)];
    if (f.kind == FaceKind::closed || f.is_shut()) continue;
    flow[face_lane::saturation + d] = f.saturation;
    flow[face_lane::conductivity + d] = f.conductivity;
    head[face_lane::head_gradient + d] = f.head_gradient;
    head[face_lane::counts + d] = f.kind == FaceKind::surface ? 1 + face_at_air : 1;
  }
}

/// The records of all cells and faces around the nodes of a block.
template <class M>
struct CellParts {
  static constexpr int dim = State<M>::dim;
  const Record *weighted, *plain;  ///< of cells; zero where they do not own their pressure
  const Record *flow, *head;       ///< of the lower faces of cells

  CellParts(State<M>& state, int slot, int thread)
      : weighted(state.tile(thread, 2).record),
        plain(state.tile(thread, 3).record),
        flow(state.tile(thread, 4).record),
        head(state.tile(thread, 5).record) {
    const auto& grid = state.grid;
    const std::int32_t* tile = grid.tile(slot);
    const Index<dim> first = grid.first_cell(slot);
    for_cube<dim>(-1, Block<dim>::edge, [&](const Index<dim>& i) {
      const int at = BlockGrid<dim>::tile_index(i);
      prepare_faces(state, tile, i, state.tile(thread, 4).record[at],
                    state.tile(thread, 5).record[at]);
      const auto e = static_cast<std::size_t>(tile[at]);
      Record &shares = state.tile(thread, 2).record[at], &marks = state.tile(thread, 3).record[at];
      if (state.nodes.dof[e] != tile[at]) {
        shares = marks = Record{};
        return;
      }
      Index<dim> cell = first;
      for (int d = 0; d < dim; ++d) cell[d] += i[d];
      prepare_cell(state, tile[at], cell, shares, marks);
    });
  }
};

/// Sums over the faces whose planes go through a node, as they are added up: the lower faces of the cells on
/// its upper side.
template <int Dim>
struct FaceSums {
  Lanes flow{0.0}, head{0.0};

  /// Adds those of a cell of which the node is corner `corner`.
  VADOSE_INLINE void add(const Record& flows, const Record& heads,
                         const Index<Dim>& corner) noexcept {
    const Lanes touches = lower_faces_at(corner);
    flow += touches * Lanes::load(flows.value);
    head += touches * Lanes::load(heads.value);
  }
};

/// Means over the faces across an axis, `over_faces` being 1 over their number.
template <int Dim, class T, class Rows>
VADOSE_INLINE void take_faces(const Rows& flow, const Rows& head, int axis, const T& over_faces,
                              NodeSums<Dim, T>& node) noexcept {
  node.saturation[axis] = flow[face_lane::saturation + axis] * over_faces;
  node.conductivity[axis] = flow[face_lane::conductivity + axis] * over_faces;
  node.head_gradient[axis] = head[face_lane::head_gradient + axis] * over_faces;
}

/// Means along every axis that faces cross, in place of those over the cells; whether one is open to air.
template <int Dim>
bool take_faces(const FaceSums<Dim>& faces, NodeSums<Dim>& node) noexcept {
  bool open = false;
  for (int d = 0; d < Dim; ++d) {
    const int counts = static_cast<int>(faces.head[face_lane::counts + d]);
    const int across = counts % face_at_air;
    open = open || counts >= face_at_air;
    if (across > 0) {
      take_faces(faces.flow, faces.head, d, 1.0 / across, node);
    } else if (node.soil_cells > 0) {
      node.saturation[d] /= node.soil_cells;
      node.conductivity[d] /= node.soil_cells;
    }
  }
  return open;
}

/// Soil is not drier than this for the drag [-].
inline constexpr Real least_saturation = 1e-12;

/// DEVIATION: [Zhan] Eq. (20) prints n m g / k without S; Eq. (2) has it, and so has this.
/// Porosity of a node and its drag along each axis, from the sums over what is around it.
template <class M, class T>
void find_drag(const State<M>& state, NodeSums<State<M>::dim, T>& node) noexcept {
  const T one(1.0), zero(0.0);
  node.porosity = one - (one - ratio_or(node.pores, node.soil_volume, one)) * node.soil_share();
  if constexpr (has_skeleton<M>) {
    const auto& material = state.soils[node.material].material;
    for (int d = 0; d < State<M>::dim; ++d) {
      const T conductivity = node.conductivity[d];
      const auto drags = (node.soil_volume > zero) & (conductivity > zero);
      node.drag[d] =
          select(drags,
                 drag::coefficient<T>(material.drag, node.porosity,
                                      max(node.saturation[d], T(least_saturation)),
                                      select(drags, conductivity, one), T(material.unit_weight)),
                 zero);
    }
  }
}

/// Calls f(place in the tile, corner) for the cells around a node, of which it is that corner.
template <class M, class F>
VADOSE_INLINE void for_cells_at(const CellView<M>& node, F&& f) {
  constexpr int dim = State<M>::dim;
  for_cube<dim>(0, 2, [&](const Index<dim>& corner) {
    int at = node.at;
    for (int d = 0; d < dim; ++d) at -= corner[d] * BlockGrid<dim>::tile_stride(d);
    f(at, corner);
  });
}

/// Whether the cell of which a node is that corner lies in the box.
template <class M>
bool is_in_box(const CellView<M>& node, const Index<State<M>::dim>& corner) noexcept {
  for (int d = 0; d < State<M>::dim; ++d) {
    const int cell = node.cell[d] - corner[d];
    if (cell < 0 || cell >= node.state.grid.cells()[d]) return false;
  }
  return true;
}

/// Takes what is held at the surfaces and walls that the cells around a node end at off its pressure force.
template <class M>
void take_reference(const State<M>& state, const CellView<M>& view,
                    NodeSums<State<M>::dim>& node) noexcept {
  constexpr int dim = State<M>::dim;
  for_cells_at(view, [&](int at, const Index<dim>&) {
    const std::int32_t e = view.tile[at];
    if (state.nodes.dof[static_cast<std::size_t>(e)] != e) return;
    const auto& cell = state.nodes.cell[static_cast<std::size_t>(e)];
    if (cell.has_reference)
      for (int d = 0; d < dim; ++d) node.reference[d] += cell.reference_pressure[d];
  });
  for (int d = 0; d < dim; ++d)
    node.force[d] -= node.reference[d] / node.references * node.gradient[d];
}

/// Sums over the cells and faces around a node.
template <int Dim>
struct SumsAround {
  CellSums<Dim> cells;
  FaceSums<Dim> faces;

  SumsAround() = default;
  /// Around node `at` of a tile.
  template <class M>
  VADOSE_INLINE SumsAround(const CellParts<M>& parts, int at, Real over_h) noexcept {
    for_cube<Dim>(0, 2, [&](const Index<Dim>& corner) {
      int cell = at;
      for (int d = 0; d < Dim; ++d) cell -= corner[d] * BlockGrid<Dim>::tile_stride(d);
      cells.add(parts.weighted[cell], parts.plain[cell], corner, over_h);
      faces.add(parts.flow[cell], parts.head[cell], corner);
    });
  }
};

/// What the sums around a node (local index in its block) say of it.
template <class M>
NodeSums<State<M>::dim> gather_node(const State<M>& state, const CellView<M>& view,
                                    const SumsAround<State<M>::dim>& around) {
  constexpr int dim = State<M>::dim;
  const auto& nodes = state.nodes;
  const bool several = state.soils.size() > 1;
  NodeSums<dim> node;
  const int counts = static_cast<int>(around.cells.plain[cell_lane::counts]);
  node.references = counts % cell_count::soil;
  node.soil_cells = counts / cell_count::soil % (cell_count::free / cell_count::soil);
  node.has_soil = node.soil_cells > 0;
  node.has_free = counts >= cell_count::free;
  bool air = false;
  for_cells_at(view, [&](int at, const Index<dim>& corner) {
    const auto e = static_cast<std::size_t>(view.tile[at]);
    if (nodes.dof[e] < 0)
      air = air || is_in_box(view, corner);
    else if (several && nodes.dof[e] == view.tile[at] && nodes.cell[e].soil_share > 0)
      node.material = nodes.cell[e].material;
  });
  take_cells(around.cells.value, around.cells.plain, around.cells.slope, node);
  const bool open = take_faces(around.faces, node);
  if (node.references > 0 && !node.has_free) take_reference(state, view, node);
  node.closed_surface = node.soil_cells > 0 && air && !open && !node.has_free;
  find_drag(state, node);
  return node;
}

}  // namespace vadose::kernel
