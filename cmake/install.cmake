# `cmake --install`: headers, the CMake package and a pkg-config file. The package needs Eigen and Boost's headers only.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_DATADIR}/cmake/skinctl")
install(
  TARGETS skinctl skinctl_exact skinctl_quick skinctl_io skinctl_calibration skinctl_skin_network skinctl_semantics
  EXPORT skinctl FILE_SET HEADERS FILE_SET io)
install(FILES "${PROJECT_SOURCE_DIR}/include/skinctl/io/io.cpp" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/skinctl/io")
install(EXPORT skinctl NAMESPACE skinctl:: FILE skinctlTargets.cmake DESTINATION "${package_dir}")

configure_package_config_file(
  "${PROJECT_SOURCE_DIR}/cmake/skinctlConfig.cmake.in" "${PROJECT_BINARY_DIR}/package/skinctlConfig.cmake"
  INSTALL_DESTINATION "${package_dir}" NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/package/skinctlConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
install(
  FILES "${PROJECT_BINARY_DIR}/package/skinctlConfig.cmake" "${PROJECT_BINARY_DIR}/package/skinctlConfigVersion.cmake"
  DESTINATION "${package_dir}")

get_target_property(boost_include Boost::headers INTERFACE_INCLUDE_DIRECTORIES)
list(GET boost_include 0 boost_include)
configure_file("${PROJECT_SOURCE_DIR}/cmake/skinctl.pc.in" "${PROJECT_BINARY_DIR}/package/skinctl.pc" @ONLY)
install(FILES "${PROJECT_BINARY_DIR}/package/skinctl.pc" DESTINATION "${CMAKE_INSTALL_DATADIR}/pkgconfig")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}")
