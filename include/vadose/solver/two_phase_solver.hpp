// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// A solver named by its policies in a row.

#include <vadose/model/model.hpp>
#include <vadose/solver/solver.hpp>

namespace vadose {

/// Solver of the model with these policies; scene and materials are those of
/// PositionalModel<Kinematics, Shape, Law, Retention, Drag>:
///
///     TwoPhaseSolver<PlaneStrain, shape::Gimp, law::DruckerPrager, swrc::Tarantino, drag::Darcy>
template <class Kinematics, class Shape, class Law, class Retention, class Drag>
using TwoPhaseSolver = Solver<PositionalModel<Kinematics, Shape, Law, Retention, Drag>>;

}  // namespace vadose
