// SPDX-License-Identifier: MIT
#pragma once

// Models that many tests use. A solver takes seconds to compile, so those below are compiled once
// for all test programs (models/*.cpp) and every test sees these declarations first.

#include <vadose/solver/scheme/semi_implicit.hpp>
#include <vadose/solver/solver.hpp>

#include "seepage.hpp"
#include "slope.hpp"

namespace vadose {

extern template class Solver<DryModel<Uniaxial>>;
extern template class Solver<DryModel<PlaneStrain>>;
extern template class Solver<SaturatedModel<Uniaxial>>;
extern template class Solver<SaturatedModel<PlaneStrain>>;
extern template class Solver<UnsaturatedModel<Uniaxial>>;
extern template class Solver<UnsaturatedModel<PlaneStrain>>;
extern template class Solver<UnsaturatedModel<Uniaxial>, scheme::SemiImplicit>;
extern template class Solver<vadose_test::Seepage<Uniaxial>>;
extern template class Solver<vadose_test::Seepage<PlaneStrain>>;
extern template class Solver<vadose_test::Slope>;
extern template class Solver<FreeWaterModel<PlaneStrain>>;

}  // namespace vadose
