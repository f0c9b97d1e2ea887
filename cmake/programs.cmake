# What tests, benchmarks and examples share: ccache, their own flags, and which peers a source includes.
#
# Promise: every program answers `--help`, refuses unknown options with 2, stops cleanly at SIGTERM
# Tried: 22 programs. Also: `examples/programs`

include_guard()

find_program(SKINCTL_CCACHE ccache)
if(SKINCTL_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Precompiled headers are cached only with these; a second clone finds the objects of the first.
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CMAKE_COMMAND}" -E env "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" CCACHE_NOHASHDIR=1
    "CCACHE_SLOPPINESS=pch_defines,time_macros" "${SKINCTL_CCACHE}")
endif()

# Programs hide what they define: the weak Eigen functions that a distribution's library calls must stay its own.
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)

set(skinctl_sanitizer_flags "")
if(SKINCTL_SANITIZERS)
  # An address that wraps around is what the address sanitizer and the check of array bounds see as well; asking at every
  # member access doubles the time of compilation (tracking_test with Clang: 102 s, 51 s without).
  set(skinctl_sanitizer_flags "-fsanitize=${SKINCTL_SANITIZERS}" -fno-sanitize=pointer-overflow -fno-sanitize-recover=all
    -fno-omit-frame-pointer)
endif()

# The flags of everything of ours that is compiled.
add_library(skinctl_program INTERFACE)
target_link_libraries(skinctl_program INTERFACE skinctl::skinctl)
target_include_directories(skinctl_program INTERFACE "${PROJECT_SOURCE_DIR}")
target_compile_options(skinctl_program INTERFACE ${skinctl_sanitizer_flags})
if(SKINCTL_GATE)  # tests/support/by_day.hpp
  target_compile_definitions(skinctl_program INTERFACE SKINCTL_GATE=1)
endif()
if(SKINCTL_SANITIZERS MATCHES "address" AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  # All but small functions call the checks of addresses instead of holding them: the same checks, a quarter less to compile, and
  # twice as long to run, which is seconds (passivity_test with Clang: 7.4 s and 5.4 s; 9.6 s and 2.6 s with a threshold of 300).
  target_compile_options(skinctl_program INTERFACE "SHELL:-mllvm -asan-instrumentation-with-call-threshold=30")
  # A quarter of the time of GNU's linker for a program with checks.
  find_program(SKINCTL_LLD ld.lld)
  if(SKINCTL_LLD)
    target_link_options(skinctl_program INTERFACE -fuse-ld=lld)
  endif()
endif()
target_link_options(skinctl_program INTERFACE ${skinctl_sanitizer_flags})
# Every copy of an operator would be compiled again, and checked. Without them the gate's -O1 takes 74 instead of 116 processor seconds
# for the scenes of the main job; the preset `users` has them, as users do.
if(SKINCTL_SANITIZERS OR (SKINCTL_GATE AND NOT SKINCTL_TESTS_AS_USERS))
  target_compile_definitions(skinctl_program INTERFACE SKINCTL_NO_FORCED_INLINE)
endif()

# For tests of the library, after skinctl_program. The address sanitizer sees null and what lies beyond an object as well, and
# vectors out of alignment stop the processor; asking at every member access doubles the time of compilation
# (forward_dynamics_test with Clang: 46 s, 21 s without). Examples, which parse bytes from sockets, keep these checks.
add_library(skinctl_fewer_checks INTERFACE)
if(SKINCTL_SANITIZERS MATCHES "address.*undefined" AND CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  target_compile_options(skinctl_fewer_checks INTERFACE -fno-sanitize=null,alignment,object-size)
endif()

if(SKINCTL_MARCH)
  target_compile_options(skinctl_program INTERFACE "-march=${SKINCTL_MARCH}")
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  # Without the time stamp a precompiled header is the same in every build, so that ccache finds it.
  target_compile_options(skinctl_program INTERFACE "SHELL:-Xclang -fno-pch-timestamp")
endif()

# skinctl_runs_once(<source>...): test runners and command lines. Optimised and sanitized, the headers of doctest, CLI11 and spdlog
# take up to 18 s a file.
function(skinctl_runs_once)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "-O0;-g0")
endfunction()

# skinctl_in_the_loop(<source>...): what a robot's cycle calls, in a folder that is compiled with less. The gate asks what it does, not
# how fast: compliant_ur5/run_wrist.cpp takes GCC 68 s here, 43 s as its folder.
function(skinctl_in_the_loop)
  if(SKINCTL_GATE)
    return()
  endif()
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "$<$<CONFIG:Release>:-O3>;$<$<CONFIG:Sanitized>:-O1>")
endfunction()

# skinctl_simulates(<library>): it computes for as long as it runs, and so has the optimiser under the sanitizers as well.
function(skinctl_simulates library)
  target_compile_options(${library} PRIVATE $<$<CONFIG:Sanitized>:-O1>)
endfunction()

# skinctl_target_name(<variable> <source>): tests/core/real_test.cpp -> core_real_test
function(skinctl_target_name variable source)
  file(RELATIVE_PATH name "${PROJECT_SOURCE_DIR}" "${source}")
  string(REGEX REPLACE "^(tests|bench|examples)/|\\.cpp$" "" name "${name}")
  string(MAKE_C_IDENTIFIER "${name}" name)
  set(${variable} "${name}" PARENT_SCOPE)
endfunction()

# skinctl_included_files(<variable> <source>): quoted includes of tests/ and bench/ and angled ones, transitively.
function(skinctl_included_files variable source)
  set(seen "")
  set(open "${source}")
  while(open)
    list(POP_FRONT open file)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
    file(STRINGS "${file}" lines REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^[^<\"]*[<\"]([^>\"]*)[>\"].*" "\\1" name "${line}")
      if(name IN_LIST seen)
        continue()
      endif()
      list(APPEND seen "${name}")
      get_filename_component(folder "${file}" DIRECTORY)
      foreach(base "${folder}" "${PROJECT_SOURCE_DIR}" "${PROJECT_SOURCE_DIR}/tests" "${PROJECT_SOURCE_DIR}/bench")
        if(EXISTS "${base}/${name}")
          list(APPEND open "${base}/${name}")
          break()
        endif()
      endforeach()
    endforeach()
  endwhile()
  set(${variable} "${seen}" PARENT_SCOPE)
endfunction()
