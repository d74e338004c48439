// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Saves a run and takes it up again, bit for bit.

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <vadose/io/checkpoint_file.hpp>
#include <vadose/io/model_fingerprint.hpp>
#include <vadose/solver/solver.hpp>

namespace vadose::io {

namespace detail {

// Every function below both writes and reads: A is SectionWriter or SectionReader, and the object
// is const or not. What is written and what is read cannot differ.

/// A finite number.
template <class A, class T>
void put_number(A& a, std::string_view name, T& number) {
  a.value(name, number);
  if constexpr (A::reading)
    if (!is_finite(number)) a.refuse(name, "is not finite");
}
template <class A, class T>
void put_flag(A& a, std::string_view name, T& flag) {
  std::uint8_t byte = flag ? 1 : 0;
  a.value(name, byte);
  if constexpr (A::reading) {
    if (byte > 1) a.refuse(name, "is neither yes nor no");
    flag = byte == 1;
  }
}
template <class A, class V>
void put_vector(A& a, std::string_view name, V& vector) {
  for (int d = 0; d < static_cast<int>(vector.size()); ++d) put_number(a, name, vector[d]);
}
/// The length of a list of things of at least `size` bytes; a reader makes the list as long.
template <class A, class List>
void put_length(A& a, std::string_view name, List& list, std::size_t size) {
  auto count = static_cast<std::uint64_t>(list.size());
  a.value(name, count);
  if constexpr (A::reading) {
    a.expect(name, count, size);
    list.resize(static_cast<std::size_t>(count));
  }
}

template <class A, class F>
void put_fingerprint(A& a, F& print) {
  put_length(a, "number of entries", print.entries, 17);
  for (auto& entry : print.entries) {
    a.text("name of an entry", entry.name);
    a.text(entry.name, entry.text);
    a.value(entry.name, entry.number);
    put_flag(a, entry.name, entry.is_number);
  }
}

template <class A, class H>
void put_held(A& a, H& held) {
  auto& [face_axis, face_side, kind, limited, acts, active, contains, pressure, supply, supply_rate,
         drift, inflow, outflow] = held;
  put_flag(a, "switch of a liquid condition", acts);
  put_number(a, "supply of a liquid condition", supply_rate);
  a.value("inflow of a liquid condition", inflow);
  a.value("outflow of a liquid condition", outflow);
}

template <class A, class C>
void put_column(A& a, C& column) {
  // The potential is that of one step.
  auto& [top, top_cell, area, film, potential, gathers] = column;
  a.value("top of a column", top);
  a.value("highest cell of a column", top_cell);
  put_number(a, "area of a column", area);
  put_number(a, "film of a column", film);
  put_flag(a, "gathering of a column", gathers);
}

template <class A, class L>
void put_load(A& a, L& load, std::size_t factors) {
  auto& [position, force, factor] = load;
  put_vector(a, "position of a load", position);
  put_vector(a, "force of a load", force);
  auto number = static_cast<std::uint64_t>(factor);
  a.value("time factor of a load", number);
  if constexpr (A::reading) {
    if (number >= factors) a.refuse("time factor of a load", "does not exist");
    factor = static_cast<std::size_t>(number);
  }
}

/// What the next time step takes from the last step: the largest speeds over all threads.
template <class A, class Sums>
void put_sums(A& a, Sums& sums) {
  StepSums all;
  for (const auto& one : sums) {
    auto& [max_speed2, max_wave2, max_dry_wave2, max_drag, failed, escaped] =
        one;  // the flags are those of one step
    all.max_speed2 = max(all.max_speed2, max_speed2);
    all.max_wave2 = max(all.max_wave2, max_wave2);
    all.max_dry_wave2 = max(all.max_dry_wave2, max_dry_wave2);
    all.max_drag = max(all.max_drag, max_drag);
  }
  put_number(a, "largest speed", all.max_speed2);
  put_number(a, "largest wave speed", all.max_wave2);
  put_number(a, "largest wave speed of dry soil", all.max_dry_wave2);
  put_number(a, "fastest drag", all.max_drag);
  if constexpr (A::reading) {
    for (auto& one : sums) one = StepSums{};
    sums.front() = all;
  }
}

template <class A, class L>
void put_limit(A& a, const char* field, L& limit) {
  auto number = static_cast<std::uint8_t>(limit);
  a.value(field, number);
  if constexpr (A::reading) {
    if (number > static_cast<std::uint8_t>(last_step_limit)) a.refuse(field, "does not exist");
    limit = static_cast<StepLimit>(number);
  }
}

template <class A, class R>
void put_report(A& a, R& report) {
  auto& [status, time, dt, limit, step, trouble, solve] =
      report;  // no trouble in a run that is saved
  put_number(a, "time of the last step", time);
  put_number(a, "length of the last step", dt);
  put_limit(a, "limit of the last step", limit);
  a.value("number of the last step", step);
  if constexpr (A::reading) {
    status = Status::ok;
    trouble = Trouble{};
  }
}

/// Everything of a state but points and grid. The list of names is complete by construction: a new
/// member of State or RunMemory does not compile here until it is named and dealt with.
template <class A, class S, class R>
void put_run(A& a, S& state, R& memory) {
  // Elsewhere: solid, liquid; nodes (what outlives a step). From the scene: soils, fluid, water,
  // gravity, factors, roughness. From the options: transfer, options. Made anew: grid, special,
  // factor_values, flip_share, tiles, trouble.
  auto& [grid, nodes, system, solid, liquid, soils, fluid, transfer, water, gravity, options, time,
         dt, flip_share, step, slack, frozen, limited_water, open_impulse, loads, factors,
         factor_values, special, held, films, columns, roughness, lost_water, lost_solid, rain,
         added_water, added_solid, next_liquid_id, tiles, sums, trouble] = state;
  auto& [start, initial_water, initial_solid, last] = memory;

  put_number(a, "time", time);
  put_number(a, "step length", dt);
  put_number(a, "next step by its error", system.next_dt);
  put_limit(a, "reason of the next step", system.next_limit);
  put_number(a, "share of inertia", system.inertia_share);
  a.value("number of steps", step);
  put_number(a, "motion since the last sort", slack);
  put_flag(a, "frozen", frozen);
  put_number(a, "limited water", limited_water);
  put_vector(a, "open impulse", open_impulse);
  a.value("lost water", lost_water);
  a.value("lost solid", lost_solid);
  a.value("rain", rain);
  a.value("added water", added_water);
  a.value("added solid", added_solid);
  a.value("next liquid id", next_liquid_id);
  put_sums(a, sums);
  put_flag(a, "films", films);
  for (auto& h : held) put_held(a, h);
  put_length(a, "number of loads", loads, 8);
  for (auto& load : loads) put_load(a, load, factors.size());
  put_length(a, "number of columns", columns, 8);
  for (auto& column : columns) put_column(a, column);

  put_number(a, "initial water", initial_water);
  put_number(a, "initial solid", initial_solid);
  put_report(a, last);
  a.list("start positions", start);
}

/// Blocks of a set of points: number of the block in the box, and its batches.
struct StoredBlock {
  std::uint64_t number = 0;
  std::uint64_t batches = 0;
};

template <int Dim, class Points>
SectionWriter written_points(const BlockGrid<Dim>& grid, const Points& points) {
  SectionWriter a;
  std::vector<StoredBlock> blocks;
  for (const BatchRange& range : points.blocks())
    blocks.push_back({grid.block_number(grid.first_cell(range.slot)), range.end - range.begin});
  a.list("blocks", blocks);
  a.list("groups", points.groups());
  a.list("values", points.values());
  a.list("waiting groups", points.new_groups());
  a.list("waiting values", points.new_values());
  return a;
}

/// Points as they come from a file, checked before anything is done with them.
template <int Dim, class Points>
class ReadPoints {
 public:
  using Fields = typename Points::fields;

  ReadPoints(SectionReader a, const BlockGrid<Dim>& grid) : a_(std::move(a)) {
    a_.list("blocks", blocks_);
    a_.list("groups", stored_.groups);
    a_.list("values", stored_.values);
    a_.list("waiting groups", stored_.new_groups);
    a_.list("waiting values", stored_.new_values);
    a_.finish();
    check_lengths(grid);
  }

  /// Marks the blocks that hold points.
  void mark(std::vector<char>& occupied) const {
    for (const StoredBlock& b : blocks_) occupied[static_cast<std::size_t>(b.number)] = 1;
  }

  /// Puts the points into a set on a grid that has these blocks. Groups and ids are below the
  /// numbers given.
  void put_into(Points& points, const BlockGrid<Dim>& grid, int groups, Real ids) && {
    std::size_t batch = 0;
    for (const StoredBlock& b : blocks_) {
      const int slot = grid.slot(static_cast<std::size_t>(b.number));
      if (!stored_.blocks.empty() && slot <= stored_.blocks.back().slot)
        a_.refuse("blocks", "are not in the order of the grid");
      const auto end = batch + static_cast<std::size_t>(b.batches);
      stored_.blocks.push_back({slot, batch, end});
      batch = end;
    }
    check_groups(stored_.groups, groups);
    check_groups(stored_.new_groups, groups);
    for (std::size_t b = 0; b < stored_.groups.size(); ++b)
      for (int l = 0; l < lane_count; ++l)
        check_point(grid, stored_.values.data() + b * Points::stride + l, lane_count, ids, true);
    for (std::size_t i = 0; i < stored_.new_groups.size(); ++i)
      check_point(grid, stored_.new_values.data() + i * Fields::total, 1, ids, false);
    points.restore(grid, std::move(stored_));
  }

 private:
  void check_lengths(const BlockGrid<Dim>& grid) const {
    const std::size_t batches = stored_.groups.size();
    if (stored_.values.size() != batches * Points::stride)
      a_.refuse("values", "are not as many as the groups need");
    if (stored_.new_values.size() != stored_.new_groups.size() * Fields::total)
      a_.refuse("waiting values", "are not as many as the waiting groups need");
    std::size_t left = batches;
    for (const StoredBlock& b : blocks_) {
      if (b.number >= grid.block_count()) a_.refuse("blocks", "are not all in the box");
      if (b.batches == 0 || b.batches > left) a_.refuse("blocks", "do not add up to the groups");
      left -= static_cast<std::size_t>(b.batches);
    }
    if (left != 0) a_.refuse("blocks", "do not add up to the groups");
  }
  void check_groups(const std::vector<std::uint8_t>& list, int groups) const {
    for (const std::uint8_t g : list)
      if (g >= groups) a_.refuse("groups", "are not all of a soil of the run");
  }
  void check_point(const BlockGrid<Dim>& grid, const double* p, int step, Real ids,
                   bool may_be_unused) const {
    const Real id = p[Fields::template offset<field::Id>() * step];
    if (id == -1 && may_be_unused) return;
    if (!(id >= 0 && id < ids) || id != std::floor(id)) a_.refuse("id of a point", "is impossible");
    Vec<Dim> x;
    for (int d = 0; d < Dim; ++d) x[d] = p[(Fields::template offset<field::Position>() + d) * step];
    if (!grid.contains(x)) a_.refuse("position of a point", "is outside the box");
  }

  mutable SectionReader a_;
  std::vector<StoredBlock> blocks_;
  typename Points::Storage stored_;
};

/// What hosts, output, resampling (the kind of every cell, slivers too) and the search for the next step
/// read of the cells. Steps read nothing else of the grid that an earlier step left there.
template <class M, class A, class G>
void put_cells(A& a, G& nodes) {
  const std::size_t size = nodes.dof.size();
  for (std::size_t i = 0; i < size; ++i) {
    auto& owner = nodes.dof[i];
    a.value("pressure cell", owner);
    if constexpr (A::reading)
      if (owner < -1 || owner >= static_cast<std::int64_t>(size))
        a.refuse("pressure cell", "does not exist");
    auto& cell = nodes.cell[i];
    auto kind = static_cast<std::uint8_t>(cell.kind);
    a.value("cell kind", kind);
    if constexpr (A::reading) {
      if (kind > static_cast<std::uint8_t>(CellKind::free)) a.refuse("cell kind", "is impossible");
      cell.kind = static_cast<CellKind>(kind);
    }
    if (owner != static_cast<std::int32_t>(i)) continue;
    a.value("cell pressure", cell.pressure);
    a.value("cell saturation", cell.saturation);
    a.value("cell porosity", cell.porosity);
    a.value("cell water", cell.water);
    a.value("cell fill", cell.raw_fill);
    if constexpr (is_unsaturated<M>) a.value("closing of the pores of a cell", cell.closing);
    for (auto& x : cell.centroid) a.value("cell centroid", x);
    a.value("axis of the ground at a cell", cell.ground_axis);
    if constexpr (A::reading)
      if (cell.ground_axis < -1 || cell.ground_axis >= static_cast<int>(std::size(cell.centroid)))
        a.refuse("axis of the ground at a cell", "does not exist");
    a.value("ground at a cell", cell.ground);
    auto fed = static_cast<std::uint8_t>(cell.is_fed);
    a.value("whether soil feeds a cell", fed);
    if constexpr (A::reading) cell.is_fed = fed != 0;
  }
}

/// Everything a file holds beyond the fingerprint, into a state of the same scene.
template <class M, class MakeBlocks>
void read_state(CheckpointReader& file, State<M>& state, RunMemory& memory,
                MakeBlocks&& make_blocks) {
  constexpr int dim = State<M>::dim;
  {
    SectionReader run = file.next("run");
    put_run(run, state, memory);
    run.finish();
    if (memory.start.size() % dim != 0) run.refuse("start positions", "are not whole");
    if (state.next_liquid_id < 0) run.refuse("next liquid id", "is negative");
  }
  ReadPoints<dim, typename State<M>::Solid> solid(file.next("solid points"), state.grid);
  ReadPoints<dim, typename State<M>::Liquid> liquid(file.next("liquid points"), state.grid);
  std::vector<char> occupied(state.grid.block_count(), 0);
  solid.mark(occupied);
  liquid.mark(occupied);
  make_blocks(occupied);
  const int soils = static_cast<int>(state.soils.size());
  std::move(solid).put_into(state.solid, state.grid, soils,
                            static_cast<Real>(memory.start.size() / dim));
  std::move(liquid).put_into(state.liquid, state.grid, soils + 1,
                             static_cast<Real>(state.next_liquid_id));
  SectionReader cells = file.next("cells");
  put_cells<M>(cells, state.nodes);
  cells.finish();
  file.finish();
}

}  // namespace detail

/// Saves a run: N steps, saved and loaded, and M steps are N + M steps, bit for bit. Saved are both
/// sets of points in their order (all fields of the model), films, loads, ledgers, conditions'
/// counts, time. Not saved, since they come from the scene, the options and the host: materials,
/// conditions (functions), walls, options, gauges and open files.
///
/// The file has a version, lengths and checksums; it takes the place of an older one only when it is
/// complete and on the disk. Raises OutputError, also after a step that failed.
template <class M, class Scheme>
void save_checkpoint(const std::string& path, const Solver<M, Scheme>& solver) {
  if (solver.last_step().status != Status::ok)
    throw OutputError("cannot write checkpoint '" + path + "': the last step failed");
  const State<M>& state = solver.state();
  detail::CheckpointWriter file;
  detail::SectionWriter model, run, cells;
  const auto print = detail::ModelFingerprint::of<Scheme>(state);
  detail::put_fingerprint(model, print);
  file.add("model", std::move(model));
  detail::put_run(run, state, solver.memory());
  file.add("run", std::move(run));
  file.add("solid points", detail::written_points(state.grid, state.solid));
  file.add("liquid points", detail::written_points(state.grid, state.liquid));
  detail::put_cells<M>(cells, state.nodes);
  file.add("cells", std::move(cells));
  file.write(path);
}

/// Takes a saved run up again in a solver of the same scene: same model, materials, grid, walls and
/// conditions (also those added later), in the same order. Number of threads and options may differ.
/// Raises InputError that names what is damaged or does not fit; the solver is then as it was. Never
/// reads past the file, never takes memory for lengths that the file does not have.
template <class M, class Scheme>
void load_checkpoint(const std::string& path, Solver<M, Scheme>& solver) {
  detail::CheckpointReader file(path);
  detail::ModelFingerprint saved;
  {
    detail::SectionReader model = file.next("model");
    detail::put_fingerprint(model, saved);
    model.finish();
  }
  const std::string difference =
      saved.difference(detail::ModelFingerprint::of<Scheme>(solver.state()));
  if (!difference.empty())
    throw InputError("cannot read checkpoint '" + path + "': it is of another run: " + difference);
  solver.restore([&](State<M>& state, RunMemory& memory, auto&& make_blocks) {
    detail::read_state(file, state, memory, make_blocks);
  });
}

}  // namespace vadose::io
