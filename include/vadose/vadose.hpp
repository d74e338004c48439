// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The whole library.

#define VADOSE_VERSION_MAJOR 0
#define VADOSE_VERSION_MINOR 1
#define VADOSE_VERSION_PATCH 0

#include <vadose/core/aligned.hpp>
#include <vadose/core/error.hpp>
#include <vadose/core/field.hpp>
#include <vadose/core/kinematics.hpp>
#include <vadose/core/lanes.hpp>
#include <vadose/core/lanes_math.hpp>
#include <vadose/core/lanes_transpose.hpp>
#include <vadose/core/monotone_table.hpp>
#include <vadose/core/parallel.hpp>
#include <vadose/core/real.hpp>
#include <vadose/core/sym_tensor.hpp>
