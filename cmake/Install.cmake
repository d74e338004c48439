# SPDX-License-Identifier: MIT
# Install rules and the package that find_package(vadose) reads.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(VADOSE_PACKAGE_DIR "${CMAKE_INSTALL_DATADIR}/cmake/vadose")
install(
  TARGETS vadose
  EXPORT vadoseTargets
  FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(
  EXPORT vadoseTargets
  NAMESPACE vadose::
  DESTINATION "${VADOSE_PACKAGE_DIR}")
configure_package_config_file(
  "${PROJECT_SOURCE_DIR}/cmake/vadoseConfig.cmake.in" "${PROJECT_BINARY_DIR}/vadoseConfig.cmake"
  INSTALL_DESTINATION "${VADOSE_PACKAGE_DIR}")
write_basic_package_version_file(
  "${PROJECT_BINARY_DIR}/vadoseConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion
  ARCH_INDEPENDENT)
install(FILES "${PROJECT_BINARY_DIR}/vadoseConfig.cmake"
              "${PROJECT_BINARY_DIR}/vadoseConfigVersion.cmake"
        DESTINATION "${VADOSE_PACKAGE_DIR}")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/vadose")
