// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <functional>
#include <stdexcept>
#include <utility>

#include "verify_support.hpp"

namespace verify {

/// A run with forces of the host's own: before every step of one length dt the host adds dt b(x, t)
/// to the velocities of the points, through Solver::mutable_state(). That is the same kick as a nodal
/// force, needs nothing in the library, and may differ between the phases. Velocities live at half
/// steps: start them at -dt/2.
template <class Solver>
class Driven {
 public:
  using Kick = std::function<void(Solver&, Real)>;  ///< of the solver and dt [s]

  /// The solver's own step must be longer than dt.
  Driven(Solver solver, Real dt, Kick kick)
      : solver_(std::move(solver)), dt_(dt), kick_(std::move(kick)) {}

  /// Steps to the multiple of dt next to t.
  void advance_to(Real t) {
    const auto last = static_cast<std::int64_t>(std::llround(t / dt_));
    while (solver_.steps() < last) {
      kick_(solver_, dt_);
      const auto report = solver_.step(dt_ * static_cast<Real>(solver_.steps() + 1));
      if (report.status != vadose::Status::ok) throw vadose::InstabilityError(report);
      if (std::fabs(report.dt / dt_ - 1) > 1e-6)
        throw std::runtime_error("driven run: the step is longer than the solver allows");
    }
  }
  std::int64_t steps() const { return solver_.steps(); }
  Real time() const { return solver_.time(); }
  const auto& state() const { return solver_.state(); }
  auto& mutable_state() { return solver_.mutable_state(); }
  const auto& solid() const { return solver_.solid(); }
  const auto& liquid() const { return solver_.liquid(); }
  auto displacement(std::size_t batch, int lane) const { return solver_.displacement(batch, lane); }

 private:
  Solver solver_;
  Real dt_;
  Kick kick_;
};

/// Where a solid point started [m].
template <class Run>
auto start_of(const Run& run, std::size_t batch, int lane) {
  auto x = run.displacement(batch, lane);
  for (int d = 0; d < x.size(); ++d)
    x[d] = run.solid().at(vadose::field::position, batch, d)[lane] - x[d];
  return x;
}

}  // namespace verify
