// SPDX-License-Identifier: MIT
#include "../models.hpp"

template class vadose::Solver<vadose::FreeWaterModel<vadose::PlaneStrain>>;
