// expect: vadose: equilibrate\(\) needs a skeleton that moves
// mistake: `equilibrate()` of rigid soil
// SPDX-License-Identifier: MIT
#include <vadose/solver/solver.hpp>

struct Soil : vadose::SaturatedModel<vadose::Uniaxial> {
  using Skeleton = vadose::law::Rigid;
};

void use(vadose::Solver<Soil>& solver) {
#ifdef VADOSE_SHOULD_FAIL
  solver.equilibrate();
#else
  solver.reset_balances();
#endif
}
