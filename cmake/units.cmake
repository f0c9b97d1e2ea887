# Units: several files in one translation unit. What they share, headers and templates, is read and instantiated once: for the
# 15 files of tests/tracking GCC takes 36 s instead of 57 s, Clang with sanitizers 29 s instead of 52 s.
#
# A unit includes what its files include, and then each file inside a namespace of its own, where all `#include`s have been done
# (`#pragma once`): equal names in two files do not meet. A file that cannot live in a namespace says so in its first five lines,
#   // compiled alone: why
# one that proves nothing under the sanitizers
#   // not sanitized: why
# one that runs for seconds, so that optimising it pays under the sanitizers, too
#   // runs long: what
# and one that only `cmake/test.sh --nightly` compiles
#   // by night: why
set(SKINCTL_TESTS_PER_UNIT 45 CACHE STRING "How many test files are compiled together at most")

# skinctl_marked(<variable> <mark> <source>...): the sources with this mark.
function(skinctl_marked variable mark)
  set(marked "")
  foreach(source IN LISTS ARGN)
    file(STRINGS "${source}" first LIMIT_COUNT 5)
    if(first MATCHES "// ${mark}: ")
      list(APPEND marked "${source}")
    endif()
  endforeach()
  set(${variable} "${marked}" PARENT_SCOPE)
endfunction()

# skinctl_left_out(<variable> <source>...): those that this build leaves out.
function(skinctl_left_out variable)
  set(left_out "")
  if(SKINCTL_SANITIZERS)
    skinctl_marked(marked "not sanitized" ${ARGN})
    list(APPEND left_out ${marked})
  endif()
  if(SKINCTL_GATE)
    skinctl_marked(marked "by night" ${ARGN})
    list(APPEND left_out ${marked})
  endif()
  set(${variable} "${left_out}" PARENT_SCOPE)
endfunction()

# skinctl_unit(<unit> <source>...): writes it.
function(skinctl_unit unit)
  set(includes "")
  set(files "")
  foreach(source IN LISTS ARGN)
    file(STRINGS "${source}" lines REGEX "^[ \t]*#[ \t]*(include|if|ifdef|ifndef|elif|else|endif)[ \t(!<\"]?")
    if(lines MATCHES "\\\\(;|$)")
      message(FATAL_ERROR "skinctl: ${source}: a condition over several lines, which a unit cannot take over. Write it in one")
    endif()
    list(JOIN lines "\n" lines)
    string(APPEND includes "${lines}\n")
    file(RELATIVE_PATH path "${PROJECT_SOURCE_DIR}" "${source}")
    string(REGEX REPLACE "^tests/|\\.cpp$" "" name "${path}")
    string(MAKE_C_IDENTIFIER "${name}" name)
    string(APPEND files "namespace ${name} {\n#include \"${path}\"\n}\n")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${source}")
  endforeach()
  file(CONFIGURE OUTPUT "${unit}" CONTENT "${includes}${files}" @ONLY)
endfunction()

# skinctl_units(<variable> <room> <source>...): the units of a room, of equal length.
function(skinctl_units variable room)
  list(LENGTH ARGN count)
  math(EXPR number "(${count} + ${SKINCTL_TESTS_PER_UNIT} - 1) / ${SKINCTL_TESTS_PER_UNIT}")
  math(EXPR length "(${count} + ${number} - 1) / ${number}")
  set(units "")
  foreach(k RANGE 1 ${number})
    math(EXPR start "(${k} - 1) * ${length}")
    list(SUBLIST ARGN ${start} ${length} sources)
    set(unit "${CMAKE_CURRENT_BINARY_DIR}/units/${room}_${k}.cpp")
    skinctl_unit("${unit}" ${sources})
    list(APPEND units "${unit}")
  endforeach()
  set(${variable} "${units}" PARENT_SCOPE)
endfunction()

set(SKINCTL_SOURCES_PER_UNIT 12 CACHE STRING "How many sources of an example's library are compiled together at most; 0: each alone")

# skinctl_compiled_together(<library>): sources that are no tests: CMake's own units, without namespaces. The 36 sources of the
# simulated UR5 take GCC 32 s, alone and with -O3 92 s.
function(skinctl_compiled_together library)
  if(SKINCTL_SOURCES_PER_UNIT GREATER 1)
    set_target_properties(${library} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${SKINCTL_SOURCES_PER_UNIT})
  endif()
endfunction()
