// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The solver: owns the state of a run; the host owns the loop.

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <vadose/solver/add_bodies.hpp>
#include <vadose/solver/assemble.hpp>
#include <vadose/solver/escaped_points.hpp>
#include <vadose/solver/estimate.hpp>
#include <vadose/solver/forecast.hpp>
#include <vadose/solver/gather_films.hpp>
#include <vadose/solver/release_films.hpp>
#include <vadose/solver/release_springs.hpp>
#include <vadose/solver/report.hpp>
#include <vadose/solver/scheme.hpp>
#include <vadose/solver/walls.hpp>

namespace vadose {

/// Choices of a run; every one has a default.
template <class M>
struct SolverOptions {
  Real courant = 0.5;           ///< part of the stable step that is taken [-], in (0, 4)
  Real damping = 0;             ///< local damping of the skeleton [-], in [0, 1)
  Real displacement_cap = 0.1;  ///< largest motion in a step [cell size], in (0, 0.25]
  Real dt_max = 1e30;           ///< largest step [s], > 0
  /// Decay of what a free point's pressure differs from its cell's [1 / cell passed], >= 0.
  Real free_relaxation = 3;
  typename M::Transfer transfer = {};  ///< numbers of the velocity transfer
  int threads = 1;                     ///< >= 1; more than one only where the host links OpenMP
  Escape escaped = Escape::error;      ///< what happens to points that leave the box
  Resampling resampling = {};          ///< merge and split of free-water points
  /// Change of the saturation of a cell that a semi-implicit step aims at [-], in (0, 1]: controls the
  /// error in time of wetting and drying, where nothing else limits the step. A step with more than
  /// twice of it is repeated.
  Real saturation_step = 0.002;
  /// Slow periods of a semi-implicit run in long steps; dynamics as soon as inertia matters.
  QuasiStatic quasi_static = {};

  void validate() const {
    check::in_context("solver options", [&] {
      check::inside("courant", courant, 0, 4, "-");
      if (!(damping >= 0 && damping < 1)) check::fail("damping", damping, "[0, 1)", "-");
      if (!(displacement_cap > 0 && displacement_cap <= 0.25))
        check::fail("displacement_cap", displacement_cap, "(0, 0.25]", "cell size");
      check::positive("dt_max", dt_max, "s");
      check::non_negative("free_relaxation", free_relaxation, "-");
      transfer.validate();
      check::within("threads", threads, 1, 1024, "-");
      check::in_context("resampling", [&] { resampling.validate(); });
      if (!(saturation_step > 0 && saturation_step <= 1))
        check::fail("saturation_step", saturation_step, "(0, 1]", "-");
      check::in_context("quasi_static", [&] { quasi_static.validate(); });
    });
  }
};

/// How a skeleton is brought to rest before a run.
struct EquilibriumOptions {
  Real tolerance = 1e-4;  ///< out-of-balance force over weight [-]
  Real max_time = 10;     ///< give up after this much model time [s]
  Real damping = 0.7;     ///< local damping meanwhile [-], in [0, 1)
};

/// What equilibrate() did.
struct EquilibriumReport {
  bool converged = false;  ///< the residual fell below the tolerance
  Real residual = 0;       ///< out-of-balance force over weight at the end [-]
  Real time = 0;           ///< model time spent [s]
  std::int64_t steps = 0;  ///< taken
};

/// What a run remembers besides its state.
struct RunMemory {
  std::vector<Real> start;  ///< position of every solid point at the start, by id [m]
  Real initial_water = 0;   ///< [kg]
  Real initial_solid = 0;   ///< [kg]
  StepReport last;          ///< of the last step
};

/// A run of model M. Construction checks the scene and throws SetupError; nothing is half built. A
/// scheme that does not cover every scene has check(state) and check(state, HeldPressure).
///
/// It compiles in seconds per model. Where several source files use one model, let one compile it:
/// `extern template class vadose::Solver<Model>;` in the header that defines Model, and
/// `template class vadose::Solver<Model>;` in one source file.
template <class M, class Scheme = scheme::Explicit>
class Solver {
  static_assert(CheckModel<M>::ok);

 public:
  static constexpr int dim = M::Kinematics::dim;
  using Options = SolverOptions<M>;  ///< choices of a run

  /// A run of a scene, which may go when this returns.
  explicit Solver(const Scene<M>& scene, const Options& options = {});

  /// Refuses a scene of another model, in one sentence.
  template <class Other>
  requires(!std::is_same_v<Other, M>) explicit Solver(const Scene<Other>& /*scene*/,
                                                      const Options& = {}) {
    static_assert(std::is_same_v<Other, M>,
                  "vadose: the scene is one of another model than the solver's");
  }

  Real time() const noexcept { return state_.time; }             ///< [s]
  std::int64_t steps() const noexcept { return state_.step; }    ///< taken so far
  const State<M>& state() const noexcept { return state_; }      ///< everything
  const auto& solid() const noexcept { return state_.solid; }    ///< solid points
  const auto& liquid() const noexcept { return state_.liquid; }  ///< liquid points

  /// Adds a condition on the liquid that opens now: bc::PrescribedPressure, PrescribedHead, Drained,
  /// Drain, SeepageFace, Reservoir, ZeroSuction, Rain or Impermeable. Where several meet, those with
  /// a region go first, then those added first.
  template <class Condition>
  void add(const Condition& condition) {
    check::in_context(Condition::name, [&] {
      condition.validate(dim);
      if constexpr (requires { Scheme::check(state_); })
        Scheme::check(state_, detail::held_pressure(state_, condition));
    });
    detail::add_held(state_, condition);
    find_films();
    detail::flag_nodes(state_, walls_);
  }

  /// One step, at most to time t_end [s]. Never throws; look at the report's status.
  StepReport step(Real t_end = 1e300);

  /// Steps to time t [s] exactly; throws InstabilityError with the report of a failed step.
  void advance_to(Real t) {
    advance_to(t, [](const StepReport&) {});
  }
  /// The same; calls after_step(report) after every good step. It may change what the host may
  /// change between steps.
  template <class F>
  void advance_to(Real t, F&& after_step) {
    while (state_.time < t) {
      // A remainder below round-off is no step.
      if (t - state_.time <= 1e-14 * std::fabs(t)) {
        state_.time = t;
        break;
      }
      const StepReport report = step(t);
      if (report.status != Status::ok) throw InstabilityError(report);
      after_step(report);
    }
  }

  /// Report of the last step.
  const StepReport& last_step() const noexcept { return memory_.last; }

  /// Brings the skeleton to rest under gravity and loads with the liquid state held: pressures
  /// stay, no water moves. Afterwards velocities, time and displacements are zero and the water
  /// of each point is that of its pressure at its new porosity.
  template <class Model = M>  // a template, as not every model has it
  EquilibriumReport equilibrate(const EquilibriumOptions& o = {}) {
    static_assert(is_deformable<Model>, "vadose: equilibrate() needs a skeleton that moves");
    const Real damping = state_.options.damping;
    state_.options.damping = o.damping;
    state_.frozen = true;
    EquilibriumReport report;
    const Real start = state_.time;
    const std::int64_t first = state_.step;
    while (state_.time - start < o.max_time) {
      const StepReport s = step();
      if (s.status != Status::ok) throw InstabilityError(s);
      if ((state_.step - first) % 20 != 0) continue;
      report.residual = out_of_balance();
      if (report.residual < o.tolerance) {
        report.converged = true;
        break;
      }
    }
    report.time = state_.time - start;
    report.steps = state_.step - first;
    state_.options.damping = damping;
    state_.frozen = false;
    restart_at_rest();
    return report;
  }

  /// Water ledger [kg].
  WaterBalance water_balance() const {
    WaterBalance b;
    b.initial = memory_.initial_water;
    b.added = state_.added_water;
    for (const auto& h : state_.held) {
      b.inflow += h.inflow;
      b.outflow += h.outflow;
    }
    b.rain = state_.rain;
    b.lost = state_.lost_water;
    for (const auto& column : state_.columns) b.film += column.film;
    sum_water(b.pore, b.free);
    return b;
  }

  /// Ledger of the grains [kg].
  SolidBalance solid_balance() const {
    SolidBalance b;
    b.initial = memory_.initial_solid;
    b.added = state_.added_solid;
    b.lost = state_.lost_solid;
    state_.solid.for_each(
        [&](std::size_t i, int l) { b.stored += state_.solid.at(field::mass, i)[l]; });
    return b;
  }

  /// Cost of a run to time t_end [s]. A copy runs for `trial_seconds` of wall time, or to the end if
  /// that comes first (in a long run up to three times as long where no trend of the step shows);
  /// its pace is taken for the rest. The step goes on as in the trial: soil that wets
  /// shortens it, down to the step of a scene that is wet throughout. Rain that starts, grows or stops
  /// and conditions that are switched later are known from their functions: a copy tries what brings
  /// more water, with its clock put forward. A slide that begins after the trial is not in the estimate.
  Estimate estimate(Real t_end, Real trial_seconds = 1) const {
    Estimate e;
    e.solid_points = state_.solid.size();
    e.liquid_points = state_.liquid.size();
    e.blocks = static_cast<std::size_t>(state_.grid.slots());
    e.megabytes = 1e-6 * static_cast<Real>(memory_bytes());
    detail::Forecast<Solver>(*this, t_end, trial_seconds, std::is_same_v<Scheme, scheme::Explicit>)
        .report(e);
    return e;
  }

  /// Displacement of a solid point since the start (or since equilibrate()) [m].
  Vec<dim> displacement(std::size_t batch, int lane) const {
    const auto id = static_cast<std::size_t>(state_.solid.at(field::id, batch)[lane]);
    Vec<dim> u;
    for (int d = 0; d < dim; ++d)
      u[d] = state_.solid.at(field::position, batch, d)[lane] -
             memory_.start[id * dim + static_cast<std::size_t>(d)];
    return u;
  }

  /// Restarts the water count: what is stored now becomes `initial`.
  void reset_balances() {
    for (auto& h : state_.held) h.inflow = h.outflow = {};
    state_.rain = state_.lost_water = state_.lost_solid = {};
    state_.added_water = state_.added_solid = {};
    count_initial();
  }

  /// Puts in the soil and the water of another scene with the same box and cells, between steps.
  /// Its materials must be those of this run, by name. Counted as `added` in the ledgers; its
  /// conditions are not looked at. Where the points go should be empty. Raises SetupError and
  /// leaves the run as it was.
  PointCount add_points(const Scene<M>& more);

  /// Takes the points of both phases in a region out, between steps, and the loads there. Counted
  /// as `added` < 0 in the ledgers.
  PointCount remove_points(const Region<dim>& region);

  /// What the run remembers besides its state.
  const RunMemory& memory() const noexcept { return memory_; }

  /// Puts an earlier state back (see io::load_checkpoint): f(state, memory, make_blocks) changes a
  /// copy that takes the place of this run when f returns; make_blocks(occupied) makes the grid
  /// around the occupied blocks. Where f throws, nothing has changed.
  template <class F>
  void restore(F&& f) {
    Solver next = *this;
    f(next.state_, next.memory_,
      [&](const std::vector<char>& occupied) { next.make_blocks(occupied); });
    *this = std::move(next);
  }

  /// Direct access for hosts that couple their own code to a run; keep the state consistent.
  State<M>& mutable_state() noexcept { return state_; }

 private:
  /// Turns conditions on and off by their switches; walls follow.
  void switch_conditions() {
    bool changed = false;
    for (auto& h : state_.held) {
      if (!h.active) continue;
      const bool acts = h.active(state_.time);
      changed = changed || acts != h.acts;
      h.acts = acts;
    }
    if (changed) detail::flag_nodes(state_, walls_);
  }

  bool has_new_liquid() const {
    if constexpr (has_liquid<M>)
      return state_.liquid.has_new();
    else
      return false;
  }

  void collect_walls(const Scene<M>& scene) {
    walls_.fixed = scene.template conditions<bc::Fixed>();
    walls_.roller = scene.template conditions<bc::Roller>();
    if constexpr (has_skeleton<M>) {
      walls_.frictional = scene.template conditions<bc::Frictional>();
      walls_.moving = scene.template conditions<bc::PrescribedVelocity<dim>>();
      for (const auto& m : walls_.moving) {
        state_.factors.push_back(m.time_factor);
        walls_.moving_factor.push_back(state_.factors.size() - 1);
      }
    }
  }

  /// Sorts both point sets and makes the blocks they need.
  void sort();
  /// Makes the blocks around the occupied ones, their arrays and walls.
  void make_blocks(const std::vector<char>& occupied);

  /// Whether there may be films on the ground.
  void find_films() {
    if constexpr (has_liquid<M> && has_skeleton<M>) {
      if (state_.films) return;
      state_.films = kernel::has_rain(state_) || kernel::has_free_water(state_);
    }
  }

  void resize_grid() {
    auto& n = state_.nodes;
    const std::size_t size = state_.grid.size();
    const auto fresh = [&](auto& values, std::size_t count, const auto& value) {
      reserve_by_threads(values, count, state_.options.threads);
      values.assign(count, value);
    };
    const auto records = [&](auto&... of_grid) { (fresh(of_grid, size, Record{}), ...); };
    if constexpr (is_deformable<M>) records(n.solid_in, n.solid_out);
    if constexpr (has_liquid<M>) {
      records(n.liquid_in, n.liquid_out, n.mixture, n.pore, n.free, n.content, n.materials,
              n.relative);
      n.holds_free = false;
      fresh(n.cell, size, Cell<dim>{});
      fresh(n.dof, size, -1);
      fresh(n.face, size * dim, FaceFlux{});
      fresh(n.donor, size, Donor{});
      fresh(n.flux, size * dim, 0.0);
      for (auto* values : {&n.head, &n.soil, &n.filling}) fresh(*values, size, 0.0);
      fresh(n.rate, size, unset);
      n.near_sliver.assign(static_cast<std::size_t>(state_.grid.slots()), 1);
      n.retry.assign(static_cast<std::size_t>(state_.grid.slots()), 0);
    }
  }

  void remember_start() {
    memory_.start.assign(memory_.start.empty() ? state_.solid.size() * dim : memory_.start.size(),
                         0);
    state_.solid.for_each([&](std::size_t b, int l) { remember_start(b, l); });
  }
  void remember_start(std::size_t batch, int lane) {
    const auto id = static_cast<std::size_t>(state_.solid.at(field::id, batch)[lane]);
    for (int d = 0; d < dim; ++d)
      memory_.start[id * dim + static_cast<std::size_t>(d)] =
          state_.solid.at(field::position, batch, d)[lane];
  }

  /// Speed of sound in the dry skeleton and of the points, for the first step.
  void start_wave_speed() {
    StepSums& s = state_.sums[0];
    if constexpr (is_deformable<M>) {
      for (const auto& soil : state_.soils)
        s.max_wave2 = std::max(s.max_wave2, soil.p_wave_modulus / (soil.material.solid_density *
                                                                   (1 - soil.material.porosity)));
      s.max_dry_wave2 = s.max_wave2;
      s.max_speed2 = max_speed2(state_.solid);
    }
    if constexpr (has_liquid<M>) s.max_speed2 = std::max(s.max_speed2, max_speed2(state_.liquid));
  }
  template <class Points>
  static Real max_speed2(const Points& points) {
    Real most = 0;
    points.for_each([&](std::size_t b, int l) {
      Real v2 = 0;
      for (int d = 0; d < dim; ++d) {
        const Real v = points.at(field::velocity, b, d)[l];
        v2 += v * v;
      }
      most = std::max(most, v2);
    });
    return most;
  }

  void count_initial() {
    Real pore = 0, free = 0;
    sum_water(pore, free);
    for (const auto& column : state_.columns) free += column.film;
    memory_.initial_water = pore + free;
    memory_.initial_solid = solid_balance().stored;
  }
  Real stored_solid() const { return solid_balance().stored; }
  Real stored_water() const {
    Real pore = 0, free = 0;
    sum_water(pore, free);
    return pore + free;
  }
  void sum_water([[maybe_unused]] Real& pore, [[maybe_unused]] Real& free) const {
    if constexpr (has_liquid<M>)
      state_.liquid.for_each([&](std::size_t b, int l) {
        (state_.liquid.group(b) == state_.free_group() ? free : pore) +=
            state_.liquid.at(field::mass, b)[l];
      });
    if constexpr (has_liquid<M>)
      state_.liquid.for_each_new([&](const double* p, int group) {
        (group == state_.free_group() ? free : pore) +=
            p[State<M>::Liquid::fields::template offset<field::Mass>()];
      });
  }

  /// Sum of nodal inertia over sum of weight (or of mass where there is no gravity).
  Real out_of_balance() const {
    Real force = 0, weight = 0;
    const Real g = std::max(state_.gravity.norm(), 1e-3);
    for (std::size_t i = 0; i + Block<dim>::cells < state_.nodes.solid_in.size(); ++i) {
      const Real m = state_.nodes.solid_in[i][lane::mass];
      if (!(m > 0)) continue;
      Real a2 = 0;
      for (int d = 0; d < dim; ++d) {
        const Real a = state_.nodes.solid_out[i][lane::increment + d] / state_.dt;
        a2 += a * a;
      }
      force += m * std::sqrt(a2);
      weight += m * g;
    }
    return weight > 0 ? force / weight : 0;
  }

  /// Zero velocity, time and displacement; water content from pressure and porosity.
  void restart_at_rest() {
    // Explicit instantiation asks for it in every model.
    if constexpr (is_deformable<M>) stop(state_.solid);
    if constexpr (has_liquid<M> && has_skeleton<M>) {
      stop(state_.liquid);
      state_.liquid.for_each([&](std::size_t b, int l) {
        auto& points = state_.liquid;
        if (points.group(b) == state_.free_group() || !(points.at(field::mass, b)[l] > 0)) return;
        const auto& material = state_.soils[static_cast<std::size_t>(points.group(b))].material;
        const auto theta = swrc::water_content<Real>(
            material.retention, points.at(field::liquid_pressure, b)[l],
            points.at(field::porosity, b)[l], 1 / state_.water.bulk_modulus);
        points.at(field::mass, b)[l] =
            state_.water.density * points.at(field::volume, b)[l] * theta.value;
      });
    }
    for (StepSums& s : state_.sums) s.max_speed2 = 0;
    state_.time = 0;
    state_.step = 0;
    remember_start();
    reset_balances();
  }
  template <class Points>
  static void stop(Points& points) {
    for (std::size_t b = 0; b < points.batches(); ++b) {
      for (int d = 0; d < dim; ++d) points.store(field::velocity, b, d, Lanes(0.0));
      if constexpr (Points::fields::template has<field::Affine>)
        for (int d = 0; d < dim * dim; ++d) points.store(field::affine, b, d, Lanes(0.0));
    }
  }

  std::size_t memory_bytes() const {
    std::size_t records = is_deformable<M> ? 2 : 0;
    std::size_t bytes = state_.solid.batches() * State<M>::Solid::stride * 8;
    if constexpr (has_liquid<M>) {
      bytes += state_.liquid.batches() * State<M>::Liquid::stride * 8;
      records += 8;
      constexpr std::size_t numbers = 4 + dim;  // head, soil, filling, rate and fluxes
      bytes += state_.grid.size() * (sizeof(Cell<dim>) + dim * sizeof(FaceFlux) + sizeof(Donor) +
                                     numbers * sizeof(Real) + sizeof(std::int32_t));
    }
    return bytes + state_.grid.size() * (records * sizeof(Record) + 2);
  }

  State<M> state_;
  detail::Walls<dim> walls_;
  RunMemory memory_;
};

// What compiles long is not inline: `extern template class` leaves it to one source file.

template <class M, class Scheme>
Solver<M, Scheme>::Solver(const Scene<M>& scene, const Options& options) {
  options.validate();
  constexpr bool can_be_quasi_static = requires {
    Scheme::knows_quasi_static;
  }
  &&has_liquid<M>&& is_deformable<M>;
  if (options.quasi_static.on && !can_be_quasi_static)
    throw SetupError(
        "solver options: quasi_static.on = true outside {false} [-] but for scheme::SemiImplicit "
        "and a "
        "model with water in a skeleton that deforms");
  scene.validate();
  state_.transfer = options.transfer;
  state_.options = {options.courant,     options.damping,         options.displacement_cap,
                    options.dt_max,      options.free_relaxation, options.threads,
                    options.escaped,     options.resampling,      options.saturation_step,
                    options.quasi_static};
  detail::assemble(state_, scene);
  collect_walls(scene);
  state_.tiles.resize(static_cast<std::size_t>(State<M>::tiles_per_thread * options.threads));
  state_.sums.resize(static_cast<std::size_t>(options.threads));
  sort();
  remember_start();
  start_wave_speed();
  count_initial();
  if constexpr (requires { Scheme::check(state_); }) Scheme::check(state_);
}

template <class M, class Scheme>
StepReport Solver<M, Scheme>::step(Real t_end) {
  if (state_.slack > 0.25 * state_.grid.cell_size() || state_.solid.has_new() || has_new_liquid()) {
    if constexpr (has_liquid<M>)
      if (!state_.frozen) detail::renew_free_points(state_);
    sort();
  }
  switch_conditions();
  state_.trouble = Trouble{};
  const kernel::StableStep used = Scheme::step(state_, t_end - state_.time);
  state_.time += state_.dt;
  ++state_.step;
  StepReport report{Status::ok,  state_.time, state_.dt,           used.limit,
                    state_.step, {},          state_.system.report};
  Real speed2 = 0;
  for (const StepSums& s : state_.sums) {
    if (s.failed) report.status = Status::failed;
    speed2 = std::max(speed2, s.max_speed2);
  }
  report.trouble = state_.trouble;
  state_.slack += state_.dt * std::sqrt(speed2);
  detail::handle_escaped(state_);
  if constexpr (has_liquid<M> && has_skeleton<M>) {
    detail::gather_films(state_);
    detail::release_films(state_);
  }
  memory_.last = report;
  return report;
}

template <class M, class Scheme>
PointCount Solver<M, Scheme>::add_points(const Scene<M>& more) {
  more.validate();
  const std::vector<int> groups = detail::groups_of(state_, more);
  const Real solid_before = stored_solid(), water_before = stored_water();
  const std::size_t first = memory_.start.size() / dim;
  const PointCount added = detail::append_bodies(state_, more, groups, first);
  sort();
  memory_.start.resize(memory_.start.size() + added.solid * dim, 0);
  state_.solid.for_each([&](std::size_t b, int l) {
    if (state_.solid.at(field::id, b)[l] >= static_cast<Real>(first)) remember_start(b, l);
  });
  start_wave_speed();
  state_.added_solid += stored_solid() - solid_before;
  state_.added_water += stored_water() - water_before;
  return added;
}

template <class M, class Scheme>
PointCount Solver<M, Scheme>::remove_points(const Region<dim>& region) {
  const Real solid_before = stored_solid(), water_before = stored_water();
  PointCount removed;
  if constexpr (has_skeleton<M>) removed.solid = detail::remove_points(state_.solid, region);
  if constexpr (has_liquid<M>) removed.liquid = detail::remove_points(state_.liquid, region);
  std::erase_if(state_.loads, [&](const auto& load) { return region.contains(load.position); });
  sort();
  state_.added_solid += stored_solid() - solid_before;
  state_.added_water += stored_water() - water_before;
  return removed;
}

template <class M, class Scheme>
void Solver<M, Scheme>::sort() {
  std::vector<char> occupied(state_.grid.block_count(), 0);
  state_.solid.mark_blocks(state_.grid, occupied);
  if constexpr (has_liquid<M>) state_.liquid.mark_blocks(state_.grid, occupied);
  make_blocks(occupied);
  const int groups = static_cast<int>(state_.soils.size()) + 1;
  // What comes from cells and goes to them is shared by points of one cell; without it only nodes count.
  constexpr SortBy by = !has_liquid<M> && M::Shape::support == 3 ? SortBy::node : SortBy::cell;
  state_.solid.sort(state_.grid, groups, by, state_.options.threads);
  if constexpr (has_liquid<M>) state_.liquid.sort(state_.grid, groups, by, state_.options.threads);
  find_films();
  state_.slack = 0;
}

template <class M, class Scheme>
void Solver<M, Scheme>::make_blocks(const std::vector<char>& occupied) {
  state_.grid.rebuild(occupied);
  resize_grid();
  detail::flag_nodes(state_, walls_);
}

}  // namespace vadose
