// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// The schemes of a step.

#include <vadose/solver/scheme/explicit.hpp>
#include <vadose/solver/scheme/paper_literal.hpp>
#include <vadose/solver/scheme/semi_implicit.hpp>
