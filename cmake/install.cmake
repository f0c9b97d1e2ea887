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
  INSTALL_DESTINATION "${package_dir}" PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_DATADIR NO_SET_AND_CHECK_MACRO)
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

# Drivers and live page as sources, which compile with the flags of the program that links them.
option(SKINCTL_INSTALL_ADAPTERS "Installs the drivers of devices and the live page as well" OFF)
if(SKINCTL_INSTALL_ADAPTERS)
  set(adapters_dir "${CMAKE_INSTALL_INCLUDEDIR}/skinctl_adapters/examples")
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/examples/adapters" DESTINATION "${adapters_dir}"
    FILES_MATCHING PATTERN "*.hpp" PATTERN "*.cpp" PATTERN "*.md"
    PATTERN tests EXCLUDE PATTERN camera EXCLUDE PATTERN measure_rate.cpp EXCLUDE PATTERN torque_study.cpp EXCLUDE)
  set(support exit job report_style text)
  list(TRANSFORM support PREPEND "${PROJECT_SOURCE_DIR}/examples/support/")
  list(TRANSFORM support APPEND ".hpp")
  install(FILES ${support} DESTINATION "${adapters_dir}/support")
  install(FILES "${PROJECT_SOURCE_DIR}/examples/live_page/page.hpp" "${PROJECT_SOURCE_DIR}/examples/live_page/page.cpp"
    DESTINATION "${adapters_dir}/live_page")
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/examples/live_page/" DESTINATION "${CMAKE_INSTALL_DATADIR}/skinctl/live_page"
    FILES_MATCHING PATTERN "*.html" PATTERN "*.js" PATTERN "*.css" PATTERN tests EXCLUDE)
  install(FILES "${PROJECT_SOURCE_DIR}/cmake/skinctlAdapters.cmake" DESTINATION "${package_dir}")
endif()
