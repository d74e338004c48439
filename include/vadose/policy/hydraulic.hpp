// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// All that the author of a retention curve, conductivity law or drag law includes: the contracts
/// with their adapters, the checks for validate(), and the lane mathematics.

#include <vadose/core/error.hpp>
#include <vadose/core/lanes_math.hpp>
#include <vadose/policy/hydraulic_concept.hpp>
