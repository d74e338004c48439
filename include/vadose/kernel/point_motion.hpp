// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Steps 7 and 8 on the points of both phases, [Zhan] 3.4 (f): velocities, spin, shapes, positions.

#include <vadose/kernel/exchange.hpp>

namespace vadose::kernel {

/// Spin and rate of deformation from a velocity gradient l[a][b] = dv_a/dx_b.
template <int N, int Dim>
VADOSE_INLINE SymTensor<Lanes, N> rate_of_deformation(const Lanes (&l)[Dim][Dim],
                                                      const Lanes& hoop) noexcept {
  SymTensor<Lanes, N> rate;
  for (int i = 0; i < N; ++i) rate[i] = Lanes(0.0);
  for (int d = 0; d < Dim; ++d) rate[d] = l[d][d];
  if constexpr (Dim == 2) {
    rate[2] = hoop;
    rate[3] = Lanes(0.5) * (l[0][1] + l[1][0]);
  }
  if constexpr (Dim == 3) {
    rate[3] = Lanes(0.5) * (l[0][1] + l[1][0]);
    rate[4] = Lanes(0.5) * (l[1][2] + l[2][1]);
    rate[5] = Lanes(0.5) * (l[0][2] + l[2][0]);
  }
  return rate;
}

/// Jaumann rotation of a stress over a step: sigma += dt (W sigma - sigma W), W the spin. The
/// rotation is done exactly about the axis of W (to second order in 3D by two half steps), so that
/// invariants do not drift.
template <int N, int Dim>
VADOSE_INLINE void rotate_stress(const Lanes (&l)[Dim][Dim], Real dt,
                                 SymTensor<Lanes, N>& s) noexcept {
  if constexpr (Dim == 2) {
    // Cayley transform: cos and sin of the step's angle to third order, exactly orthogonal.
    const Lanes half = Lanes(0.25 * dt) * (l[1][0] - l[0][1]);
    const Lanes over = Lanes(1.0) / (Lanes(1.0) + half * half);
    const Lanes c = (Lanes(1.0) - half * half) * over;
    const Lanes q = Lanes(2.0) * half * over;
    const Lanes xx = s[0], yy = s[1], xy = s[3];
    s[0] = c * c * xx - Lanes(2.0) * c * q * xy + q * q * yy;
    s[1] = q * q * xx + Lanes(2.0) * c * q * xy + c * c * yy;
    s[3] = c * q * (xx - yy) + (c * c - q * q) * xy;
  }
  if constexpr (Dim == 3) {
    // R = (I - W dt/2)^-1 (I + W dt/2) = I + 2 (A + A^2) / (1 + a.a), A = W dt/2 = [a]x.
    const Lanes ax = Lanes(0.25 * dt) * (l[2][1] - l[1][2]);
    const Lanes ay = Lanes(0.25 * dt) * (l[0][2] - l[2][0]);
    const Lanes az = Lanes(0.25 * dt) * (l[1][0] - l[0][1]);
    const Lanes f = Lanes(2.0) / (Lanes(1.0) + ax * ax + ay * ay + az * az);
    const Lanes one(1.0);
    const Lanes r[3][3] = {{one - f * (ay * ay + az * az), f * (ax * ay - az), f * (ax * az + ay)},
                           {f * (ax * ay + az), one - f * (ax * ax + az * az), f * (ay * az - ax)},
                           {f * (ax * az - ay), f * (ay * az + ax), one - f * (ax * ax + ay * ay)}};
    const Lanes m[3][3] = {{s[0], s[3], s[5]}, {s[3], s[1], s[4]}, {s[5], s[4], s[2]}};
    Lanes rm[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        rm[i][j] = r[i][0] * m[0][j] + r[i][1] * m[1][j] + r[i][2] * m[2][j];
    const auto entry = [&](int i, int j) {
      return rm[i][0] * r[j][0] + rm[i][1] * r[j][1] + rm[i][2] * r[j][2];
    };
    s[0] = entry(0, 0);
    s[1] = entry(1, 1);
    s[2] = entry(2, 2);
    s[3] = entry(0, 1);
    s[4] = entry(1, 2);
    s[5] = entry(0, 2);
  }
}

/// What nodes hand back to eight points.
template <int Dim>
struct PointMotion {
  Lanes velocity[Dim];       ///< interpolated new velocity
  Lanes increment[Dim];      ///< interpolated change of velocity
  Lanes gradient[Dim][Dim];  ///< dv_a/dx_b
};

/// Interpolates velocity, its change and gradient.
template <bool Slopes, class Shape, int Dim>
VADOSE_INLINE void interpolate(const Stencil<Shape, Dim>& stencil, const Record* tile,
                               PointMotion<Dim>& motion) noexcept {
  Gather<Slopes, Shape, Dim> gather;
  gather.sum_vectors(stencil, tile);
  for (int a = 0; a < Dim; ++a) {
    motion.velocity[a] = gather.value[lane::velocity + a];
    motion.increment[a] = gather.value[lane::increment + a];
    if constexpr (Slopes)
      for (int b = 0; b < Dim; ++b) motion.gradient[a][b] = gather.slope[b][lane::velocity + a];
  }
}

/// First moments of the nodal velocity, B = sum w v (x_I - x_p)^T (APIC). For tensor-product
/// weights it needs one more pass over the nodes; done per point.
template <class Shape, int Dim>
VADOSE_INLINE void velocity_moment(const Stencil<Shape, Dim>& s, const TileFrame<Dim>& frame,
                                   Real h, const Lanes (&x)[Dim], const Record* tile,
                                   Lanes (&moment)[Dim][Dim]) noexcept {
  for (int l = 0; l < lane_count; ++l) {
    Real sum[Dim][Dim] = {};
    for_cube<Dim>(0, Shape::support, [&](const Index<Dim>& i) {
      const double w = s.product(i, l);
      int at = s.offset[l];
      for (int d = 0; d < Dim; ++d) at += i[d] * BlockGrid<Dim>::tile_stride(d);
      for (int b = 0; b < Dim; ++b) {
        const Real r = frame.first[b] + (s.first[b][l] + i[b]) * h - x[b][l];
        for (int a = 0; a < Dim; ++a) sum[a][b] += w * tile[at][lane::velocity + a] * r;
      }
    });
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) moment[a][b].set(l, sum[a][b]);
  }
}

/// New velocity of a batch by the model's transfer.
template <class M, class Shape, class Points>
VADOSE_INLINE void update_velocity(const State<M>& state, Points& points, std::size_t b,
                                   const Stencil<Shape, State<M>::dim>& stencil,
                                   const TileFrame<State<M>::dim>& frame,
                                   const Lanes (&x)[State<M>::dim], const Record* tile,
                                   const PointMotion<State<M>::dim>& motion) noexcept {
  constexpr int dim = State<M>::dim;
  if constexpr (M::Transfer::blends) {
    const Lanes keep(state.flip_share);
    for (int d = 0; d < dim; ++d) {
      const Lanes flip = points.load(field::velocity, b, d) + motion.increment[d];
      points.store(field::velocity, b, d, keep * flip + (Lanes(1.0) - keep) * motion.velocity[d]);
    }
  } else {
    for (int d = 0; d < dim; ++d) points.store(field::velocity, b, d, motion.velocity[d]);
    if constexpr (M::Transfer::stores_gradient) {
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j)
          points.store(field::affine, b, i * dim + j, motion.gradient[i][j]);
    } else {
      Lanes moment[dim][dim];
      velocity_moment(stencil, frame, state.grid.cell_size(), x, tile, moment);
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) points.store(field::affine, b, i * dim + j, moment[i][j]);
    }
  }
}

/// Stretches GIMP half sizes along the axes by rates dv_d/dx_d, at most to half a cell (the three-node
/// stencil).
template <class Points, int Dim>
VADOSE_INLINE void update_half_sizes(Points& points, std::size_t b, const Lanes (&stretching)[Dim],
                                     Real dt, Real h) noexcept {
  if constexpr (Points::fields::template has<field::HalfSize>) {
    for (int d = 0; d < Dim; ++d) {
      const Lanes half =
          points.load(field::half_size, b, d) * exp_of_small(Lanes(dt) * stretching[d]);
      points.store(field::half_size, b, d, min(max(half, Lanes(1e-3 * h)), Lanes(0.5 * h)));
    }
  }
}

/// Records the first thing found wrong with a lane of a batch.
template <class M, class Points>
void report_trouble(State<M>& state, const Points& points, std::size_t b, const LaneMask& bad,
                    const char* criterion, const char* phase, const Lanes& value) noexcept {
  for (int l = 0; l < lane_count; ++l) {
    const double id = points.at(field::id, b)[l];
    if (!bad[l] || id < 0) continue;
#ifdef _OPENMP
#pragma omp critical(vadose_trouble)
#endif
    {
      const auto number = static_cast<std::int64_t>(id);
      if (!state.trouble.criterion || number < state.trouble.id) {
        state.trouble = Trouble{criterion, phase, value[l], number, {}};
        for (int d = 0; d < State<M>::dim; ++d)
          state.trouble.position[static_cast<std::size_t>(d)] = points.at(field::position, b, d)[l];
      }
    }
  }
}

/// DEVIATION: [Zhan] Eq. (25) prints v_k; the new velocity is taken, since forward Euler is unstable
/// for undamped waves.
/// Moves a batch by dt v and checks it: finite, |v| dt below a cell, inside the box.
template <class M, class Points>
VADOSE_INLINE void move(State<M>& state, Points& points, std::size_t b, const char* phase,
                        const Lanes (&velocity)[State<M>::dim], StepSums& sums) noexcept {
  constexpr int dim = State<M>::dim;
  const Real h = state.grid.cell_size();
  Lanes speed2(0.0);
  LaneMask outside = Lanes(1.0) < Lanes(0.0);
  for (int d = 0; d < dim; ++d) {
    const Lanes x = points.load(field::position, b, d) + Lanes(state.dt) * velocity[d];
    points.store(field::position, b, d, x);
    speed2 += velocity[d] * velocity[d];
    const Real low = state.grid.origin()[d];
    const Real high = low + state.grid.cells()[d] * h;
    outside = outside | !(x >= Lanes(low)) | !(x <= Lanes(high));
  }
  const Real limit = h / state.dt;
  const LaneMask fast = !(speed2 < Lanes(limit * limit));  // also true for NaN
  const LaneMask alive = points.load(field::id, b) >= Lanes(0.0);
  const bool may_escape = state.options.escaped != Escape::error;
  if (any(outside & alive)) sums.escaped = true;
  if (any((may_escape ? fast : fast | outside) & alive)) {
    sums.failed = true;
    report_trouble(state, points, b, fast & alive, "|v| dt < cell size", phase, sqrt(speed2));
    report_trouble(state, points, b, outside & alive, "points inside the box", phase,
                   points.load(field::position, b, 0));
  }
  sums.max_speed2 = max(sums.max_speed2, max_lane(select(alive & !fast, speed2, Lanes(0.0))));
}

}  // namespace vadose::kernel
