// expect: vadose: law::Umat<n> needs n >= 0
// mistake: fewer than no state variables
// SPDX-License-Identifier: MIT
#include <vadose/policy/law/umat.hpp>

#ifdef VADOSE_SHOULD_FAIL
vadose::law::Umat<-1> law;
#else
vadose::law::Umat<0> law;
#endif
