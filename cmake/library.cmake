include(GNUInstallDirs)

# The library: an interface target with its headers in two file sets. Those in `io` need a parser that a user may lack.
add_library(skinctl INTERFACE)
add_library(skinctl::skinctl ALIAS skinctl)
target_compile_features(skinctl INTERFACE cxx_std_20)
target_link_libraries(skinctl INTERFACE Eigen3::Eigen Boost::headers)
# On ARM GCC notes, at each use of a struct with empty members, that GCC 9 passed it otherwise: 1900 lines a file.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm)")
  target_compile_options(skinctl INTERFACE "$<$<CXX_COMPILER_ID:GNU>:-Wno-psabi>")
endif()

file(GLOB_RECURSE skinctl_headers CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/include/skinctl/*.hpp")
set(skinctl_io_headers ${skinctl_headers})
list(FILTER skinctl_io_headers INCLUDE REGEX "/include/skinctl/io/")
list(FILTER skinctl_headers EXCLUDE REGEX "/include/skinctl/io/")

target_sources(skinctl
  INTERFACE
    FILE_SET HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}/include" FILES ${skinctl_headers}
    FILE_SET io TYPE HEADERS BASE_DIRS "${PROJECT_SOURCE_DIR}/include" FILES ${skinctl_io_headers})

# What serves above or beside the loop and is not in skinctl.hpp: targets of their own.
foreach(part IN ITEMS calibration skin_network semantics)
  add_library(skinctl_${part} INTERFACE)
  add_library(skinctl::${part} ALIAS skinctl_${part})
  set_target_properties(skinctl_${part} PROPERTIES EXPORT_NAME ${part})
  target_link_libraries(skinctl_${part} INTERFACE skinctl)
endforeach()
target_link_libraries(skinctl_calibration INTERFACE skinctl_skin_network)

# The same bits at every level of optimisation, on every instruction set, from GCC and Clang: no fused multiplication and addition.
# The definition enters the library's inline namespace, so that files built with and without it do not meet.
add_library(skinctl_exact INTERFACE)
add_library(skinctl::exact ALIAS skinctl_exact)
set_target_properties(skinctl_exact PROPERTIES EXPORT_NAME exact)
target_link_libraries(skinctl_exact INTERFACE skinctl)
set(skinctl_exact_options -ffp-contract=off)
# GCC 12's vectorisers, of loops and of statements in a row, write vfmaddsub in spite of the option above.
set(skinctl_exact_options_GNU -fno-tree-vectorize)
target_compile_options(skinctl_exact INTERFACE ${skinctl_exact_options} "$<$<CXX_COMPILER_ID:GNU>:${skinctl_exact_options_GNU}>")
target_compile_definitions(skinctl_exact INTERFACE SKINCTL_NO_CONTRACT)

# For editing and tests: a scene compiles in half to two thirds of the time that -O3 takes, and a cycle takes up to four times as long. For
# all files of a program: code of both kinds has the same names, and a linker keeps either.
add_library(skinctl_quick INTERFACE)
add_library(skinctl::quick ALIAS skinctl_quick)
set_target_properties(skinctl_quick PROPERTIES EXPORT_NAME quick)
target_link_libraries(skinctl_quick INTERFACE skinctl)
target_compile_options(skinctl_quick INTERFACE -O1)
target_compile_definitions(skinctl_quick INTERFACE SKINCTL_NO_FORCED_INLINE)

# Parsers and files compiled once: one source of the program that links this, with the program's flags. Without it each file that includes
# io/urdf.hpp or recording/mcap_recorder.hpp compiles their bodies. Link it to a program, PRIVATE;
# it reads URDF files where the program has found tinyxml2.
add_library(skinctl_io INTERFACE)
add_library(skinctl::io ALIAS skinctl_io)
set_target_properties(skinctl_io PROPERTIES EXPORT_NAME io)
target_link_libraries(skinctl_io INTERFACE skinctl $<TARGET_NAME_IF_EXISTS:tinyxml2::tinyxml2>)
target_compile_definitions(skinctl_io INTERFACE SKINCTL_COMPILED_IO
  $<$<TARGET_EXISTS:tinyxml2::tinyxml2>:SKINCTL_HAS_TINYXML2>)
target_sources(skinctl_io INTERFACE "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include/skinctl/io/io.cpp>"
  "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/skinctl/io/io.cpp>")
