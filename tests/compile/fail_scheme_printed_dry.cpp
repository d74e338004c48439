// expect: vadose: scheme::PaperLiteral needs a liquid
// mistake: printed scheme without water
// SPDX-License-Identifier: MIT
#include <vadose/solver/solver.hpp>

using Soil = vadose::DryModel<vadose::Uniaxial>;
using Run = vadose::Solver<Soil, vadose::scheme::PaperLiteral<>>;

vadose::Real use(Run& solver) {
#ifdef VADOSE_SHOULD_FAIL
  solver.step();
#endif
  return solver.time();
}
