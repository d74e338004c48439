// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Kinematics policies: which displacement components exist and which strains follow from them.

namespace vadose {

/// One coordinate; strain along it only, no lateral strain. Lengths per unit cross-section.
struct Uniaxial {
  static constexpr int dim = 1;
  static constexpr int stress_size = 3;
  static constexpr bool axisymmetric = false;
};

/// Coordinates x, y; no strain along z. Quantities per metre of thickness.
struct PlaneStrain {
  static constexpr int dim = 2;
  static constexpr int stress_size = 4;
  static constexpr bool axisymmetric = false;
};

/// Coordinates r >= 0, z; hoop strain u_r / r. Quantities per radian.
struct Axisymmetric {
  static constexpr int dim = 2;
  static constexpr int stress_size = 4;
  static constexpr bool axisymmetric = true;
};

/// Coordinates x, y, z.
struct ThreeDimensional {
  static constexpr int dim = 3;
  static constexpr int stress_size = 6;
  static constexpr bool axisymmetric = false;
};

/// K offers dim (1, 2, 3), stress_size (3, 4, 6) and axisymmetric.
template <class K>
concept KinematicsPolicy = requires {
  requires K::dim >= 1 && K::dim <= 3;
  requires K::stress_size == (K::dim == 1 ? 3 : K::dim == 2 ? 4 : 6);
  requires(!K::axisymmetric || K::dim == 2);
};

}  // namespace vadose
