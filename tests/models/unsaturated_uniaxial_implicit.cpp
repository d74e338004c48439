// SPDX-License-Identifier: MIT
#include "../models.hpp"

template class vadose::Solver<vadose::UnsaturatedModel<vadose::Uniaxial>,
                              vadose::scheme::SemiImplicit>;
