// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The algorithm of [Zhan] as printed: the yardstick for the default scheme.

#include <string>

#include <vadose/kernel/paper_literal.hpp>

namespace vadose::scheme {

/// The equations of [Zhan] as printed, step by step as in 3.4; only Eq. (25) is mended (positions by
/// v_{k+1}), else nothing runs. Each choice in Mends repairs one flaw, so that what it costs can be
/// measured: `Solver<M, scheme::PaperLiteral<{.saturation = true}>>`. For comparison, not for work:
/// water is on points that move with v^l, drag is explicit and limits the step, a pond at rest pushes
/// the soil beneath, wetting fronts stall.
///
/// The ground is where the liquid has the pressure held there, 0 Pa if nothing is held: the natural
/// condition of Eq. (20). Water comes and goes with points only, so nothing flows in there. Walls let
/// no water through unless a pressure is held at them. One pressure, uniform in space, for the whole
/// scene.
template <PaperMends Mends = PaperMends{}>
struct PaperLiteral {
  static constexpr const char* name = "paper literal";

  /// Refuses a scene that the printed equations do not cover.
  template <class M>
  static void check(const State<M>& state) {
    for (const auto& h : state.held) check(state, h);
    if (state.soils.size() > 1 && kernel::has_free_water(state))
      vadose::check::fail("number of soils beside free water",
                          static_cast<Real>(state.soils.size()), "{0, 1} of the printed scheme",
                          "-");
  }

  /// Refuses a liquid condition that is no natural condition of Eq. (20), or another one than those
  /// the scene has.
  template <class M>
  static void check(const State<M>& state, const HeldPressure<State<M>::dim>& h) {
    if (h.kind == HeldKind::closed && h.face_axis >= 0 && !h.active) return;
    if (h.kind != HeldKind::open || h.active)
      throw SetupError(
          "liquid condition outside {bc::ZeroSuction, bc::Drained, bc::PrescribedPressure, each "
          "acting always, bc::Impermeable on a wall} [-] of the printed scheme");
    const Vec<State<M>::dim>& near = state.grid.origin();
    Vec<State<M>::dim> far = near;
    for (int d = 0; d < State<M>::dim; ++d)
      far[d] += state.grid.cells()[d] * state.grid.cell_size();
    const auto require = [&](Real p, Real first) {
      if (p != first)
        vadose::check::fail("held pressure", p,
                            vadose::check::joined({"{", vadose::check::text(first),
                                                   "}, one for the whole scene in the printed "
                                                   "scheme,"}),
                            "Pa");
    };
    require(h.pressure(far, state.time), h.pressure(near, state.time));
    for (const auto& other : state.held)
      if (other.kind == HeldKind::open)
        require(h.pressure(near, state.time), other.pressure(near, state.time));
  }

  /// One step of at most dt_limit [s]; returns the stable step that was used.
  template <class M>
  static kernel::StableStep step(State<M>& state, Real dt_limit) {
    static_assert(has_liquid<M>,
                  "vadose: scheme::PaperLiteral needs a liquid; dry soil runs with "
                  "scheme::Explicit");
    static_assert(!is_viscous<M>,
                  "vadose: scheme::PaperLiteral has no viscous liquid; use law::InviscidWater");
    static_assert(!QuadraticDrag<typename M::Drag>,
                  "vadose: scheme::PaperLiteral has drag linear in velocity; use drag::Darcy");
    // (a) solid points to nodes: mass, momentum, stress of Eq. (22), porosity
    if constexpr (is_deformable<M>) kernel::map_solid<M, false>(state);
    if constexpr (has_skeleton<M>) kernel::map_porosity(state);
    // (b) porosity to liquid points, S there by Eq. (12); (c) nothing needs S at solid points
    kernel::find_liquid<Mends.saturation>(state);
    kernel::StableStep stable = kernel::stable_step(state);
    if (!Mends.implicit_drag && !state.frozen)
      stable.take(state.options.courant * kernel::drag_step(state), StepLimit::drag);
    stable.take(dt_limit, StepLimit::end);
    kernel::begin_step(state, stable.dt);
    kernel::map_printed_liquid<Mends>(state);  // (a) liquid: mass, momentum, sums of Eq. (20)
    if constexpr (is_deformable<M>) kernel::map_loads(state);  // traction of Eq. (22)
    kernel::advance_printed_nodes<Mends>(state);  // (d), (e): accelerations, Eq. (24), walls
    kernel::update_printed_liquid<Mends>(state);  // (f), (g): velocities, positions, pressure
    if constexpr (is_deformable<M>) {
      kernel::move_loads(state);
      kernel::update_solid<M, false>(state);  // (f), (h): strain, Bishop stress, porosity
    }
    return stable;  // (i) the grid keeps nothing
  }
};

}  // namespace vadose::scheme
