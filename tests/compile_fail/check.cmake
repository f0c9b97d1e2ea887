# One pair of tests/compile_fail: NAME.fail.cpp must not compile, with an error that a person can use; NAME.pass.cpp, the
# same program put right, must. COMMAND (compiler and flags), PASS_COMMAND (for the twin, unless it is the same),
# PAIR (path without .fail.cpp). With SKINCTL_TWIN_ELSEWHERE in the environment the twin is another test's: compile_fail/twins
# compiles those of all pairs together.
#
# The first line of NAME.fail.cpp is `// expect: REGEX` (CMake's regular expressions). The first error, with the source
# lines and notes below it, must match; all output together has at most 20 lines.
set(most_lines 20)
set(ENV{LC_ALL} C)

function(complain about output)
  message("${output}")
  message(FATAL_ERROR "${about}")
endfunction()

if(NOT PASS_COMMAND)
  set(PASS_COMMAND ${COMMAND})
endif()
if(NOT DEFINED ENV{SKINCTL_TWIN_ELSEWHERE})
  execute_process(COMMAND ${PASS_COMMAND} "${PAIR}.pass.cpp"
    RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    complain("the twin does not compile" "${output}")
  endif()
endif()

file(READ "${PAIR}.fail.cpp" source)
if(NOT source MATCHES "^// expect: ([^\n]+)\n")
  complain("no `// expect: REGEX` in the first line" "${PAIR}.fail.cpp")
endif()
set(expected "${CMAKE_MATCH_1}")

execute_process(COMMAND ${COMMAND} "${PAIR}.fail.cpp"
  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(status EQUAL 0)
  complain("it compiles, but must not" "${output}")
endif()

string(REGEX REPLACE "[^\n]" "" newlines "${output}")
string(LENGTH "${newlines}" lines)
if(lines GREATER most_lines)
  complain("too long: ${lines} lines" "${output}")
endif()

string(FIND "${output}" "error: " start)
if(start EQUAL -1)
  complain("the compiler fails without an error" "${output}")
endif()
math(EXPR after "${start} + 7")
string(SUBSTRING "${output}" ${after} -1 first)
string(FIND "${first}" "error: " next)
string(SUBSTRING "${first}" 0 ${next} first)
if(NOT first MATCHES "${expected}")
  complain("the first error does not match: ${expected}" "${output}")
endif()
message("${lines} lines\n${output}")
