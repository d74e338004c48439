// SPDX-License-Identifier: MIT
#pragma once

#include <type_traits>

namespace vadose_test {

/// A model with another law, transfer and basis.
template <class Model, class Law, class TransferType, class ShapeType>
struct Changed : Model {
  using Skeleton = Law;
  using Transfer = TransferType;
  using Shape = ShapeType;
};

/// The same, or the model itself where these are its own, as that is compiled already.
template <class Model, class Law, class TransferType, class ShapeType>
using With = std::conditional_t<std::is_same_v<Law, typename Model::Skeleton> &&
                                    std::is_same_v<TransferType, typename Model::Transfer> &&
                                    std::is_same_v<ShapeType, typename Model::Shape>,
                                Model, Changed<Model, Law, TransferType, ShapeType>>;

}  // namespace vadose_test
