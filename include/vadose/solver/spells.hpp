// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The spells of a run: rain that starts and stops, conditions that are switched.

#include <algorithm>
#include <limits>
#include <vector>

#include <vadose/kernel/state.hpp>

namespace vadose::detail {

/// Part of a run in which the liquid conditions offer about the same.
struct Spell {
  Real start = 0, end = 0;  ///< [s]
  std::vector<Real> offer;  ///< of every condition at its start, see offers()
  bool wetter = true;       ///< one of them offers more than in the spell before
  bool drains = false;      ///< none on the ground offers water, where one did before
};

/// What the liquid conditions offer at time t [s], one number for each: rain [m/s], infinity where
/// water comes without limit, 0 where none comes.
template <class M>
std::vector<Real> offers(const State<M>& state, Real t) {
  std::vector<Real> all;
  for (const auto& h : state.held) {
    const bool feeds =
        (!h.active || h.active(t)) && h.kind != HeldKind::closed && h.kind != HeldKind::outlet;
    const Real most = h.supply ? std::max<Real>(0, h.supply(t)) : std::numeric_limits<Real>::max();
    all.push_back(feeds ? most : 0);
  }
  return all;
}

/// The spell that begins at `start` with this offer and follows another one.
template <class M>
Spell following(const State<M>& state, const Spell& before, Real start) {
  Spell spell{start, before.end, offers(state, start), false, false};
  bool had = false, has = false;
  for (std::size_t i = 0; i < spell.offer.size(); ++i) {
    spell.wetter = spell.wetter || spell.offer[i] > 1.5 * before.offer[i];
    if (state.held[i].face_axis >= 0) continue;
    had = had || before.offer[i] > 0;
    has = has || spell.offer[i] > 0;
  }
  spell.drains = had && !has;
  return spell;
}

/// Whether at time t a condition offers half as much again as in a spell, or nothing where it did.
template <class M>
bool differs(const State<M>& state, const Spell& spell, Real t) {
  const std::vector<Real> now = offers(state, t);
  for (std::size_t i = 0; i < now.size(); ++i)
    if (now[i] > 1.5 * spell.offer[i] || (spell.offer[i] > 0 && !(now[i] > 0))) return true;
  return false;
}

/// The spells from now to t_end [s], from the conditions' functions at a thousand times; eight at
/// most, the last of which is the rest.
template <class M>
std::vector<Spell> find_spells(const State<M>& state, Real t_end) {
  constexpr int samples = 1000, most = 8, halvings = 20;
  std::vector<Spell> spells{{state.time, t_end, offers(state, state.time), true, false}};
  const Real apart = (t_end - state.time) / samples;
  for (int i = 1; i < samples && spells.size() < most; ++i) {
    Spell& last = spells.back();
    Real after = state.time + i * apart, before = std::max(last.start, after - apart);
    if (!differs(state, last, after)) continue;
    for (int k = 0; k < halvings; ++k) {
      const Real middle = 0.5 * (before + after);
      (differs(state, last, middle) ? after : before) = middle;
    }
    const Spell next = following(state, last, after);
    last.end = after;
    spells.push_back(next);
  }
  return spells;
}

}  // namespace vadose::detail
