# SPDX-License-Identifier: MIT
# Filter of Doxyfile: members that every tag, policy, condition or model has are described here, once.
s|^  static constexpr const char\* name\>|  /// Name in messages and files.\n&|
s|^  static constexpr const char\* unit\>|  /// Unit in messages and files.\n&|
s|^  void validate(.*|  /// Raises SetupError unless the values are allowed.\n&|
s|^  static constexpr int dim\>|  /// Number of coordinates.\n&|
s|^  static constexpr int stress_size\>|  /// Number of stress components that are stored.\n&|
s|^  static constexpr bool axisymmetric\>|  /// Coordinates are r and z.\n&|
s|^  static constexpr bool affine\>|  /// Points carry first moments of velocity.\n&|
s|^  static constexpr bool stores_gradient\>|  /// These are velocity gradients.\n&|
s|^  static constexpr bool blends\>|  /// Points keep a part of their velocity.\n&|
s|^  const std::string& path() .*|  /// Path of the file.\n&|
s|^  VADOSE_INLINE \(friend \)\?[A-Za-z]*&\? operator[^(\[]*(.*|  /// Component by component.\n&|
s|^  [A-Za-z_& ]* operator\[\](int .*|  /// Component.\n&|
s|^inline constexpr \([A-Z][A-Za-z]*\) [a-z_]*{};|/// Value of the tag \1.\n&|
