// SPDX-License-Identifier: MIT
#include "../models.hpp"

template class vadose::Solver<vadose_test::Slope>;
