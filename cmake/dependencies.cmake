# Finds what the asked parts need; when something is missing, names the Debian packages that bring it, all at once.
include_guard()
set(skinctl_missing_packages "")

# skinctl_find(<package> <version or ""> <Debian package> [<find_package arguments>...])
macro(skinctl_find package version debian)
  find_package(${package} ${version} QUIET ${ARGN})
  if(NOT ${package}_FOUND)
    list(APPEND skinctl_missing_packages ${debian})
  endif()
endmacro()

# No version asked: the package of Eigen 3.4.0 refuses ranges of two majors, that of 5 a plain 3.4. It is looked at below.
skinctl_find(Eigen3 "" libeigen3-dev)
skinctl_find(Boost 1.74 libboost-dev)
if(SKINCTL_BUILD_TESTS)
  skinctl_find(doctest 2.4 doctest-dev)
  skinctl_find(rapidcheck "" librapidcheck-dev)
endif()
if(SKINCTL_BUILD_BENCHMARKS)
  skinctl_find(benchmark 1.7 libbenchmark-dev)
  skinctl_find(nlohmann_json 3.11 nlohmann-json3-dev)
endif()
if(SKINCTL_BUILD_EXAMPLES)
  skinctl_find(CLI11 2.1 libcli11-dev)
  skinctl_find(nlohmann_json 3.11 nlohmann-json3-dev)
  skinctl_find(spdlog 1.10 libspdlog-dev)
  skinctl_find(tomlplusplus 3.3 libtomlplusplus-dev)
endif()
list(REMOVE_DUPLICATES skinctl_missing_packages)

if(skinctl_missing_packages)
  list(JOIN skinctl_missing_packages " " packages)
  message(FATAL_ERROR "skinctl: missing packages. On Debian 12: sudo apt-get install ${packages}")
endif()

if(Eigen3_VERSION VERSION_LESS 3.4 OR NOT Eigen3_VERSION VERSION_LESS 6)
  message(FATAL_ERROR
    "skinctl: needs Eigen 3.4 or 5, ${Eigen3_DIR} is ${Eigen3_VERSION}; -DEigen3_DIR=FOLDER names another")
endif()

# Optional: parsers of XML (io/urdf.hpp, io/skin_xml.hpp) and of JSON (io/skin_file.hpp). What needs one that is missing is neither
# built nor tested.
find_package(tinyxml2 QUIET)
if(NOT tinyxml2_FOUND AND (SKINCTL_BUILD_TESTS OR SKINCTL_BUILD_EXAMPLES))
  message(WARNING "skinctl: no tinyxml2: tests and examples of io/urdf.hpp and io/skin_xml.hpp are skipped. "
    "On Debian 12: sudo apt-get install libtinyxml2-dev")
endif()
find_package(nlohmann_json 3.11 QUIET)
if(NOT nlohmann_json_FOUND AND SKINCTL_BUILD_TESTS)
  message(WARNING "skinctl: no nlohmann-json: tests of io/skin_file.hpp are skipped. "
    "On Debian 12: sudo apt-get install nlohmann-json3-dev")
endif()
