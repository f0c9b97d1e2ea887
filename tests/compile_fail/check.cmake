# One program of tests/compile_fail: NAME.fail.cpp must not compile, with an error that a person can use; with SKINCTL_RIGHT defined,
# its twin, the same program put right, must. COMMAND (compiler and flags), PASS_COMMAND (for the twin, unless it is the same),
# PAIR (path without .fail.cpp). With SKINCTL_TWIN_ELSEWHERE in the environment the twin is another test's: compile_fail/twins
# compiles those of all programs together. TOGETHER (optional) is the file with what the compiler said of this program among others,
# written by together.sh: if it is as expected and short, that is enough; else the program is compiled alone.
#
# The first line of NAME.fail.cpp is `// expect: REGEX` (CMake's regular expressions). The first error, with the source
# lines and notes below it, must match; all output together has at most 20 lines, or as many as a line `// lines: N` says.
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
  execute_process(COMMAND ${PASS_COMMAND} -DSKINCTL_RIGHT "${PAIR}.fail.cpp"
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
if(source MATCHES "\n// lines: ([0-9]+)\n")
  set(most_lines "${CMAKE_MATCH_1}")
endif()

# first_error(<variable> <output>): the first error with what stands below it, as far as the next.
function(first_error variable output)
  string(FIND "${output}" "error: " start)
  math(EXPR start "${start} + 7")
  string(SUBSTRING "${output}" ${start} -1 first)
  string(FIND "${first}" "error: " next)
  string(SUBSTRING "${first}" 0 ${next} first)
  set(${variable} "${first}" PARENT_SCOPE)
endfunction()

# Alone a compiler says up to one line more: where the library was included, or how many errors there are.
if(TOGETHER AND EXISTS "${TOGETHER}")
  file(READ "${TOGETHER}" output)
  string(REGEX REPLACE "[^\n]" "" newlines "${output}")
  string(LENGTH "${newlines}" lines)
  math(EXPR most_together "${most_lines} - 1")
  first_error(first "${output}")
  if(lines LESS_EQUAL most_together AND output MATCHES "error: " AND first MATCHES "${expected}")
    message("${lines} lines\n${output}")
    return()
  endif()
endif()

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

if(NOT output MATCHES "error: ")
  complain("the compiler fails without an error" "${output}")
endif()
first_error(first "${output}")
if(NOT first MATCHES "${expected}")
  complain("the first error does not match: ${expected}" "${output}")
endif()
message("${lines} lines\n${output}")
