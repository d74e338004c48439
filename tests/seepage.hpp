// SPDX-License-Identifier: MIT
#pragma once

#include <vadose/model/model.hpp>

namespace vadose_test {

/// Water in soil that neither moves nor carries stress.
template <class K>
struct Seepage : vadose::UnsaturatedModel<K> {
  using Skeleton = vadose::law::Rigid;
};

}  // namespace vadose_test
