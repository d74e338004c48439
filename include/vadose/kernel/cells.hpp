// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Step 1: from liquid points to cells: water, pores, fill, kind, pressure unknowns.

#include <algorithm>

#include <vadose/kernel/batch.hpp>

namespace vadose::kernel {

/// Sets all records to zero.
inline void clear(AlignedVector<Record>& records, int threads) {
  constexpr std::size_t chunk = 4096;
  parallel_for((records.size() + chunk - 1) / chunk, threads, [&](std::size_t c, int) {
    const std::size_t end = std::min(records.size(), (c + 1) * chunk);
    for (std::size_t i = c * chunk; i < end; ++i) Lanes(0.0).store(records[i].value);
  });
}

/// Calls f(entry, local cell coordinates, slot, thread) for every cell of a block.
template <int Dim, class F>
VADOSE_INLINE void for_cells_of(int slot, int thread, F&& f) {
  std::int32_t entry = slot * Block<Dim>::cells;
  for_cube<Dim>(0, Block<Dim>::edge, [&](const Index<Dim>& i) { f(entry++, i, slot, thread); });
}

/// The same for every cell of every existing block.
template <int Dim, class F>
void for_cells(const BlockGrid<Dim>& grid, int threads, F&& f) {
  parallel_for(static_cast<std::size_t>(grid.slots()), threads, [&](std::size_t s, int thread) {
    for_cells_of<Dim>(static_cast<int>(s), thread, f);
  });
}

/// The same of the blocks that are marked, one mark per slot.
template <int Dim, class F>
void for_cells(const BlockGrid<Dim>& grid, int threads, const std::vector<char>& marks, F&& f) {
  parallel_for(static_cast<std::size_t>(grid.slots()), threads, [&](std::size_t s, int thread) {
    if (marks[s]) for_cells_of<Dim>(static_cast<int>(s), thread, f);
  });
}

/// Adds one record per point to the cell the point is in. Points of one cell lie together as a rule:
/// what they bring is summed before it goes to the cell.
template <int Dim>
VADOSE_INLINE void add_to_cells(const CellFinder<Dim>& cells, Lanes (&record)[lane_count],
                                Tile<Dim>& tile) noexcept {
  transpose(record);
  Lanes sum = record[0];
  for (int l = 1; l <= lane_count; ++l) {
    if (l < lane_count && cells.index[l] == cells.index[l - 1]) {
      sum += record[l];
      continue;
    }
    double* r = tile.record[cells.index[l - 1]].value;
    (Lanes::load(r) + sum).store(r);
    if (l < lane_count) sum = record[l];
  }
}

/// Sums of one batch of pore water: V, m, n V, n V p, n V x.
template <class M>
VADOSE_INLINE void pore_record(const State<M>& state, std::size_t b,
                               const Lanes (&x)[State<M>::dim],
                               Lanes (&record)[lane_count]) noexcept {
  const auto& points = state.liquid;
  const Lanes volume = points.load(field::volume, b);
  const Lanes pores = volume * points.load(field::porosity, b);
  for (auto& r : record) r = Lanes(0.0);
  record[lane::bulk_volume] = volume;
  record[lane::water] = points.load(field::mass, b);
  record[lane::pore_volume] = pores;
  record[lane::pore_pressure] = pores * points.load(field::liquid_pressure, b);
  for (int d = 0; d < State<M>::dim; ++d) record[lane::pore_position + d] = pores * x[d];
}

/// Sums of one batch of free water: V, m, V p, V x.
template <class M>
VADOSE_INLINE void free_record(const State<M>& state, std::size_t b,
                               const Lanes (&x)[State<M>::dim],
                               Lanes (&record)[lane_count]) noexcept {
  const auto& points = state.liquid;
  const Lanes volume = points.load(field::volume, b);
  for (auto& r : record) r = Lanes(0.0);
  record[lane::free_volume] = volume;
  record[lane::free_water] = points.load(field::mass, b);
  record[lane::free_pressure] = volume * points.load(field::liquid_pressure, b);
  for (int d = 0; d < State<M>::dim; ++d) record[lane::free_position + d] = volume * x[d];
}

/// Whether there are points of free water.
template <class M>
bool has_free_water(const State<M>& state) noexcept {
  const auto& groups = state.liquid.groups();
  return std::find(groups.begin(), groups.end(), state.free_group()) != groups.end();
}

/// Sums the water points of every cell.
template <class M>
void sum_water(State<M>& state) {
  constexpr int dim = State<M>::dim;
  const int threads = state.options.threads;
  clear(state.nodes.pore, threads);
  if (state.nodes.holds_free) clear(state.nodes.free, threads);
  state.nodes.holds_free = has_free_water(state);
  for_blocks_adding(state.liquid, threads, [&](const BatchRange& range, int thread) {
    Tile<dim>& pore = state.tile(thread, 0);
    Tile<dim>& free = state.tile(thread, 1);
    const TileFrame<dim> frame = tile_frame(state.grid, range.slot);
    bool any_pore = false, any_free = false;
    ComingRecords<dim> coming(state.grid, range.slot, state.nodes.pore);
    for (std::size_t b = range.begin; b < range.end; ++b) {
      state.liquid.prefetch(b + 2);
      coming.ask_for_some();
      Lanes x[dim], record[lane_count];
      load_positions(state.liquid, b, x);
      CellFinder<dim> cells;
      cells.find(frame, x);
      if (state.liquid.group(b) == state.free_group()) {
        free_record(state, b, x, record);
        add_to_cells(cells, record, free);
        any_free = true;
      } else if constexpr (has_skeleton<M>) {
        pore_record(state, b, x, record);
        add_to_cells(cells, record, pore);
        any_pore = true;
      }
    }
    if (any_pore) pore.add_to(state.grid, range.slot, state.nodes.pore);
    if (any_free) free.add_to(state.grid, range.slot, state.nodes.free);
  });
}

/// Bulk volume of each material in every cell; only needed with more than one soil.
template <class M>
void sum_materials(State<M>& state) {
  constexpr int dim = State<M>::dim;
  clear(state.nodes.materials, state.options.threads);
  for_blocks_adding(state.liquid, state.options.threads, [&](const BatchRange& range, int thread) {
    Tile<dim>& tile = state.tile(thread);
    const TileFrame<dim> frame = tile_frame(state.grid, range.slot);
    for (std::size_t b = range.begin; b < range.end; ++b) {
      const int group = state.liquid.group(b);
      if (group == state.free_group()) continue;
      Lanes x[dim], record[lane_count];
      load_positions(state.liquid, b, x);
      CellFinder<dim> cells;
      cells.find(frame, x);
      for (auto& r : record) r = Lanes(0.0);
      record[group] = state.liquid.load(field::volume, b);
      add_to_cells(cells, record, tile);
    }
    tile.add_to(state.grid, range.slot, state.nodes.materials);
  });
}

/// What the cell rules need to know of a cell's surroundings.
template <class M>
struct CellView {
  static constexpr int dim = State<M>::dim;

  const State<M>& state;
  const std::int32_t* tile;  ///< entries around the block
  int slot;                  ///< the block
  Index<dim> cell;           ///< coordinates in the grid
  int at;                    ///< own position in the tile

  CellView(const State<M>& s, const Index<dim>& local, int block)
      : state(s), tile(s.grid.tile(block)), slot(block), at(BlockGrid<dim>::tile_index(local)) {
    const Index<dim> first = s.grid.first_cell(slot);
    for (int d = 0; d < dim; ++d) cell[d] = first[d] + local[d];
  }
  /// Inside the box.
  bool inside() const noexcept {
    for (int d = 0; d < dim; ++d)
      if (cell[d] >= state.grid.cells()[d]) return false;
    return true;
  }
  /// Whether the neighbour one cell down (-1) or up (+1) an axis is inside the box.
  bool has_neighbour(int axis, int step) const noexcept {
    const int c = cell[axis] + step;
    return c >= 0 && c < state.grid.cells()[axis];
  }
  /// The same of all neighbours: the cell is at no wall.
  bool has_neighbours() const noexcept {
    for (int d = 0; d < dim; ++d)
      if (!has_neighbour(d, -1) || !has_neighbour(d, 1)) return false;
    return true;
  }
  std::int32_t entry() const noexcept { return tile[at]; }
  std::int32_t neighbour(int axis, int step) const noexcept {
    return tile[at + step * BlockGrid<dim>::tile_stride(axis)];
  }
  /// Entry of the cell a step (-1, 0, 1 along each axis) away; -1 outside the box.
  std::int32_t at_step(const Index<dim>& step) const noexcept {
    int to = at;
    for (int d = 0; d < dim; ++d) {
      if (step[d] != 0 && !has_neighbour(d, step[d])) return -1;
      to += step[d] * BlockGrid<dim>::tile_stride(d);
    }
    return tile[to] == state.grid.outside() ? -1 : tile[to];
  }
  /// Centre of the cell along an axis [m].
  Real centre(int axis) const noexcept {
    return state.grid.origin()[axis] + (cell[axis] + 0.5) * state.grid.cell_size();
  }
  Real volume() const noexcept {
    return state.cell_volume(State<M>::Kinematics::axisymmetric ? centre(0) : 1);
  }
};

/// The view of a cell or node by its entry.
template <class M>
CellView<M> view_of(const State<M>& state, std::int32_t entry) noexcept {
  constexpr int dim = State<M>::dim;
  constexpr int cells = Block<dim>::cells;
  return CellView<M>(state, BlockGrid<dim>::local_at(entry % cells), entry / cells);
}

/// Water-bearing volume of a cell (bulk of soil, and free water) [m3].
template <int Dim>
Real wet_volume(const GridState<Dim>& nodes, std::int32_t e) noexcept {
  const auto i = static_cast<std::size_t>(e);
  return nodes.pore[i][lane::bulk_volume] + nodes.free[i][lane::free_volume];
}

/// Kind and fill of every cell. A cell is soil if soil fills more than half of it or it holds no
/// free water.
template <class M>
void classify_cells(State<M>& state) {
  auto& nodes = state.nodes;
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<State<M>::dim>& local, int slot, int) {
              const auto i = static_cast<std::size_t>(e);
              auto& cell = nodes.cell[i];
              cell.kind = CellKind::none;
              nodes.soil[i] = 0;
              cell.raw_fill = 0;
              const CellView<M> view(state, local, slot);
              const Real soil = nodes.pore[i][lane::bulk_volume];
              const Real free = nodes.holds_free ? nodes.free[i][lane::free_volume] : 0;
              if (!view.inside() || soil + free <= 0) return;
              cell.raw_fill = (soil + free) / view.volume();
              const bool is_soil = soil > 0 && (free <= 0 || soil > 0.5 * view.volume());
              cell.kind = is_soil ? CellKind::soil : CellKind::free;
              nodes.soil[i] = is_soil ? 1 : 0;
            });
}

/// Below this fill a surface cell is a sliver: half, less a margin so that a lattice of points that
/// fills just half a cell does not change sides by round-off.
inline constexpr Real sliver_fill = 0.47;

/// Below this fill a sliver of free water on the ground becomes a film: before it stands alone, where for
/// one step neither its pressure nor that of a film would rest on the soil.
inline constexpr Real film_fill = 0.48;

/// The neighbour a sliver shares its pressure with: the face neighbour of the same kind that is no
/// sliver and in whose direction the fill grows most; at corners, where no face neighbour is full
/// enough, the fullest diagonal one; -1 if the cell is no sliver or stands alone.
template <class M>
std::int32_t sliver_target(const CellView<M>& view) noexcept {
  constexpr int dim = State<M>::dim;
  const auto& cells = view.state.nodes.cell;
  const auto& own = cells[static_cast<std::size_t>(view.entry())];
  if (own.raw_fill >= sliver_fill) return -1;
  const auto fits = [&](const auto& other) {
    return other.kind == own.kind && other.raw_fill >= sliver_fill;
  };
  std::int32_t target = -1;
  Real best = 0;
  for (int d = 0; d < dim; ++d) {
    Real fill[2] = {0, 0};
    for (int side = 0; side < 2; ++side)
      if (view.has_neighbour(d, 2 * side - 1))
        fill[side] =
            min(1.0, cells[static_cast<std::size_t>(view.neighbour(d, 2 * side - 1))].raw_fill);
    for (int side = 0; side < 2; ++side) {
      if (!view.has_neighbour(d, 2 * side - 1)) continue;
      const std::int32_t n = view.neighbour(d, 2 * side - 1);
      if (!fits(cells[static_cast<std::size_t>(n)])) continue;
      // Ties go to the last axis: vertical.
      const Real growth = fill[side] - fill[1 - side] + 1e-6 * (d + 1);
      if (growth > best) {
        best = growth;
        target = n;
      }
    }
  }
  if (target >= 0) return target;
  for_cube<dim>(-1, 2, [&](const Index<dim>& step) {
    const std::int32_t n = view.at_step(step);
    if (n < 0 || n == view.entry()) return;
    const auto& other = cells[static_cast<std::size_t>(n)];
    if (fits(other) && min(1.0, other.raw_fill) > best) {
      best = min(1.0, other.raw_fill);
      target = n;
    }
  });
  return target;
}

/// Marks the neighbours of marked blocks too; one entry per slot.
template <int Dim>
void widen_marks(const BlockGrid<Dim>& grid, const std::vector<char>& own,
                 std::vector<char>& marks) {
  for (int s = 0; s < grid.slots(); ++s) {
    if (!own[static_cast<std::size_t>(s)]) continue;
    for_cube<Dim>(-1, 2, [&](const Index<Dim>& step) {
      Index<Dim> c = grid.first_cell(s);
      for (int d = 0; d < Dim; ++d) c[d] += step[d] * Block<Dim>::edge;
      const std::int32_t e = grid.entry(c);
      if (e != grid.outside()) marks[static_cast<std::size_t>(e / Block<Dim>::cells)] = 1;
    });
  }
}

/// Which cell's pressure each cell uses.
template <class M>
void assign_pressure_cells(State<M>& state) {
  auto& nodes = state.nodes;
  nodes.sought.assign(static_cast<std::size_t>(state.grid.slots()), 0);
  for_cells(state.grid, state.options.threads,
            [&](std::int32_t e, const Index<State<M>::dim>& local, int slot, int) {
              const auto i = static_cast<std::size_t>(e);
              nodes.dof[i] = -1;
              if (nodes.cell[i].kind == CellKind::none) return;
              const std::int32_t target = sliver_target(CellView<M>(state, local, slot));
              nodes.dof[i] = target < 0 ? e : target;
              if (target >= 0) nodes.sought[static_cast<std::size_t>(slot)] = 1;
            });
  nodes.near_sliver = nodes.sought;
  widen_marks(state.grid, nodes.sought, nodes.near_sliver);
}

/// Calls f(entry, step) for a cell itself and every sliver around that shares its pressure.
template <class M, class F>
void scan_members(const CellView<M>& view, F&& f) {
  constexpr int dim = State<M>::dim;
  const std::int32_t own = view.entry();
  for_cube<dim>(-1, 2, [&](const Index<dim>& step) {
    const std::int32_t n = view.at_step(step);
    if (n >= 0 && view.state.nodes.dof[static_cast<std::size_t>(n)] == own) f(n, step);
  });
}

/// The same once cells are gathered; away from the surface a cell is its only member.
template <class M, class F>
void for_members(const CellView<M>& view, F&& f) {
  if (view.state.nodes.cell[static_cast<std::size_t>(view.entry())].members > 1)
    scan_members(view, f);
  else
    f(view.entry(), Index<State<M>::dim>{});
}

/// Material with the largest bulk volume in a record of materials.
inline std::uint8_t largest(const Record& volumes, int count) noexcept {
  int best = 0;
  for (int i = 1; i < count; ++i)
    if (volumes[i] > volumes[best]) best = i;
  return static_cast<std::uint8_t>(best);
}

/// Unit vector towards the air next to a cell, from the gradient of the fill over the cells
/// around it (weights 2^(faces shared)); walls mirror. False where there is no direction.
template <class M>
bool air_normal(const CellView<M>& view, Real (&normal)[State<M>::dim]) noexcept {
  constexpr int dim = State<M>::dim;
  for (Real& n : normal) n = 0;
  for_cube<dim>(-1, 2, [&](const Index<dim>& step) {
    int at = view.at;
    Real weight = 1;
    for (int d = 0; d < dim; ++d) {
      const int s = step[d] == 0 || view.has_neighbour(d, step[d]) ? step[d] : 0;
      at += s * BlockGrid<dim>::tile_stride(d);
      if (step[d] == 0) weight *= 2;
    }
    const auto& cell = view.state.nodes.cell[static_cast<std::size_t>(view.tile[at])];
    const Real fill = min(1.0, cell.raw_fill);
    for (int d = 0; d < dim; ++d) normal[d] -= weight * step[d] * fill;
  });
  Real length2 = 0;
  for (const Real n : normal) length2 += n * n;
  if (!(length2 > 1e-12)) return false;
  for (Real& n : normal) n /= std::sqrt(length2);
  return true;
}

/// Where the pressure of a cell at air acts, and where its surface is. A plane surface that cuts off
/// 1 - f of the cell moves the centroid of what is left by half of that from the middle: exact along
/// the axes, within 0.07 h in between, and free of the scatter of the points. With slivers, or where
/// the points say something quite different (ragged soil), their centroid counts.
template <class M>
void place_quadrature(const CellView<M>& view, int members, Cell<State<M>::dim>& cell) {
  constexpr int dim = State<M>::dim;
  const Real h = view.state.grid.cell_size();
  const Real fill = min(1.0, cell.fill);
  Real normal[dim], plane[dim];
  bool flat = air_normal(view, normal) && members == 1;
  for (int d = 0; d < dim; ++d) {
    plane[d] = view.centre(d) - 0.5 * (1 - fill) * h * normal[d];
    flat = flat && std::fabs(plane[d] - cell.centroid[d]) < 0.25 * h;
  }
  // Near a cell boundary the nodes on the far side would have next to no volume.
  const Real reach = 0.35 * h;
  for (int d = 0; d < dim; ++d) {
    const Real centre = view.centre(d);
    const Real inside = min(max(cell.centroid[d], centre - reach), centre + reach);
    cell.quad_point[d] = flat ? plane[d] : inside;
    cell.surface_point[d] = cell.quad_point[d] + 0.5 * min(1.5, cell.fill) * h * normal[d];
  }
}

/// Sums, centroid and quadrature of the pressure unknown of one cell. A full cell is integrated at
/// its centre; a cell at a free surface at the centroid of what fills it, so that a column at rest
/// is in exact balance for any position of its surface.
template <class M>
void gather_cell(State<M>& state, const CellView<M>& view) {
  constexpr int dim = State<M>::dim;
  auto& nodes = state.nodes;
  auto& cell = nodes.cell[static_cast<std::size_t>(view.entry())];
  const bool soil = cell.kind == CellKind::soil;
  Record pore, free, materials;
  Real fill = 0, wet = 0;
  bool at_air = false;
  int members = 0;
  const auto add = [&](std::int32_t m, const Index<dim>&) {
    const auto i = static_cast<std::size_t>(m);
    (Lanes::load(pore.value) + Lanes::load(nodes.pore[i].value)).store(pore.value);
    (Lanes::load(free.value) + Lanes::load(nodes.free[i].value)).store(free.value);
    if (state.soils.size() > 1)
      (Lanes::load(materials.value) + Lanes::load(nodes.materials[i].value)).store(materials.value);
    wet += wet_volume(nodes, m);
    fill += nodes.cell[i].raw_fill;
    ++members;
  };
  if (nodes.near_sliver[static_cast<std::size_t>(view.slot)])
    scan_members(view, add);
  else
    add(view.entry(), Index<dim>{});
  for (int d = 0; d < dim; ++d)
    for (int step = -1; step <= 1; step += 2)
      if (view.has_neighbour(d, step)) {
        const std::int32_t n = view.neighbour(d, step);
        const auto& other = nodes.cell[static_cast<std::size_t>(n)];
        if (other.kind == CellKind::none ||
            (members > 1 && nodes.dof[static_cast<std::size_t>(n)] == view.entry()))
          at_air = true;
      }
  cell.at_air = at_air;
  cell.members = static_cast<std::uint8_t>(members);
  cell.material = state.soils.size() > 1 ? largest(materials, static_cast<int>(state.soils.size()))
                                         : std::uint8_t{0};
  cell.pore_volume = soil ? pore[lane::pore_volume] : 0;
  cell.soil_share = pore[lane::bulk_volume] / wet;
  cell.soil_pores = pore[lane::pore_volume];
  cell.soil_porosity =
      pore[lane::bulk_volume] > 0 ? pore[lane::pore_volume] / pore[lane::bulk_volume] : 1;
  cell.soil_water = pore[lane::water];
  cell.water = soil ? pore[lane::water] : free[lane::free_water];
  cell.porosity = soil ? pore[lane::pore_volume] / pore[lane::bulk_volume] : 1;
  const Real weight = soil ? pore[lane::pore_volume] : free[lane::free_volume];
  const Record& sums = soil ? pore : free;
  cell.pressure = sums[lane::pore_pressure] / weight;  // mean at the centroid: start value
  for (int d = 0; d < dim; ++d) cell.centroid[d] = sums[lane::pore_position + d] / weight;
  cell.gain = 0;
  cell.solved = false;

  cell.has_reference = false;  // see find_reference_pressures
  const bool full = members == 1 && !at_air;
  if (!full || !view.has_neighbours()) nodes.has_edge[static_cast<std::size_t>(view.slot)] = 1;
  cell.fill = full ? 1 : fill;
  cell.drop = false;
  cell.quad_volume = full ? view.volume() : wet;
  for (int d = 0; d < dim; ++d) cell.quad_point[d] = view.centre(d);
  if (full) return;
  // Drops: soil or water in a sliver that stands alone is free of pressure and mean stress until it
  // joins others.
  cell.drop = members == 1 && cell.raw_fill < sliver_fill;
  if (cell.drop) cell.quad_volume = 0;
  place_quadrature(view, members, cell);
}

/// Up to eight soil cells of one material, on which curves are evaluated together.
template <class M>
struct CellBatch {
  int count = 0;
  std::uint8_t material = 0;
  Cell<State<M>::dim>* cell[lane_count];

  /// One number of each cell; that of the first where there are fewer.
  template <class F>
  Lanes numbers(F&& f) const noexcept {
    return lanes_of([&](int l) { return f(*cell[l < count ? l : 0]); });
  }
};

}  // namespace vadose::kernel
