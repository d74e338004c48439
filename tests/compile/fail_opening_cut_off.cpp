// expect: vadose: law::WithOpening needs a law with a cut-off
// mistake: opening of a law that has no cut-off
// SPDX-License-Identifier: MIT
#include <vadose/policy/law/drucker_prager.hpp>
#include <vadose/policy/law/with_opening.hpp>

#ifdef VADOSE_SHOULD_FAIL
vadose::law::WithOpening<vadose::law::LinearElastic> law;
#else
vadose::law::WithOpening<vadose::law::DruckerPrager> law;
#endif
