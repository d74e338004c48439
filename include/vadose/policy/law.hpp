// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Everything an author or user of a constitutive law needs: the contract, the adapter and the
/// laws of the library.

#include <vadose/policy/law/drucker_prager.hpp>
#include <vadose/policy/law/inviscid_water.hpp>
#include <vadose/policy/law/law_concept.hpp>
#include <vadose/policy/law/linear_elastic.hpp>
#include <vadose/policy/law/mohr_coulomb.hpp>
#include <vadose/policy/law/newtonian_fluid.hpp>
#include <vadose/policy/law/one_of.hpp>
#include <vadose/policy/law/rigid.hpp>
#include <vadose/policy/law/umat.hpp>
#include <vadose/policy/law/with_opening.hpp>
