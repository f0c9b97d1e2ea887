# Flags that change what arithmetic gives: the headers refuse what the compiler shows in a macro, a scene refuses the rest
# when it is built, and under Clang, which shows less, the library's code gives the same bits:
# `cmake -DGCC=... -DCLANG=... -DINCLUDE=... -DPROGRAM=... -DBINARY=... -P run.cmake`. CLANG may be empty.
#
# Promise: arithmetic that is not IEEE in the order in which it is written is refused, or changes no bit
# Tried: `-ffast-math`, `-funsafe-math-optimizations`, `-fassociative-math`, `-freciprocal-math`,
# `-ffinite-math-only`, `-mfpmath=387`, i686: by a macro; the same behind GCC's back: a scene throws with
# its sine, its sum or its NaN; under Clang, which shows less, sines, tanh, compensated sums and gravity
# torques are the same to the bit

separate_arguments(INCLUDE)
set(wrong "")

# refused(<compiler> <flags> <reason>): by the first header.
function(refused compiler flags reason)
  separate_arguments(list UNIX_COMMAND "${flags}")
  file(WRITE "${BINARY}.cpp" "#include \"skinctl/core/config.hpp\"\n")
  execute_process(COMMAND "${compiler}" -std=c++20 ${INCLUDE} ${list} -fsyntax-only "${BINARY}.cpp"
    RESULT_VARIABLE failed ERROR_VARIABLE told)
  if(NOT failed OR NOT told MATCHES "skinctl: ${reason}")
    set(wrong "${wrong}${compiler} ${flags}: not refused, or in other words: ${told}\n" PARENT_SCOPE)
  endif()
endfunction()

# run(<compiler> <flags> <exit code> <text>): the program, and what it must say; `bits` is a hash of its numbers.
function(run compiler flags code text)
  separate_arguments(list UNIX_COMMAND "${flags}")
  execute_process(COMMAND "${compiler}" -std=c++20 ${INCLUDE} ${list} "${PROGRAM}" -o "${BINARY}" COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND "${BINARY}" RESULT_VARIABLE ended OUTPUT_VARIABLE numbers ERROR_VARIABLE told)
  string(MD5 hash "${numbers}")
  message(STATUS "${compiler} ${flags}: ${ended} ${hash} ${told}")
  if(NOT ended EQUAL code OR NOT told MATCHES "^${text}")
    set(wrong "${wrong}${compiler} ${flags}: exit ${ended} in place of ${code}: ${told}\n" PARENT_SCOPE)
  endif()
  set(bits "${hash}" PARENT_SCOPE)
endfunction()

set(reordered "-fassociative-math -fno-signed-zeros -fno-trapping-math")
refused("${GCC}" "-O2 -ffast-math" "-ffast-math")
refused("${GCC}" "-O2 -funsafe-math-optimizations" "-funsafe-math-optimizations")
refused("${GCC}" "-O2 ${reordered}" "-funsafe-math-optimizations and its parts")
refused("${GCC}" "-O2 -freciprocal-math" "-funsafe-math-optimizations and its parts")
refused("${GCC}" "-O2 -ffinite-math-only" "-ffinite-math-only")
refused("${GCC}" "-O2 -mfpmath=387" "80-bit registers")
refused("${GCC}" "-O2 -mfpmath=sse+387" "80-bit registers")
refused("${GCC}" "-O2 -m32 -march=i686" "80-bit registers")
# The same with the macros taken away: the scene finds them.
run("${GCC}" "-O2" 0 "")
run("${GCC}" "-O2 ${reordered} -U__ASSOCIATIVE_MATH__" 3 "skinctl: sin\\(0.5\\).* = [-0-9.e]+, allowed: 0.479425539")
run("${GCC}" "-O2 -mfpmath=387 -U__FLT_EVAL_METHOD__" 3 "skinctl: sin\\(0.5\\).* = [-0-9.e]+, allowed: 0.479425539")
run("${GCC}" "-O2 -ffinite-math-only -U__FINITE_MATH_ONLY__" 3 "skinctl: a NaN")
if(CLANG)
  refused("${CLANG}" "-O2 -ffast-math" "-ffast-math")
  refused("${CLANG}" "-O2 -ffinite-math-only" "-ffinite-math-only")
  refused("${CLANG}" "-O2 -m32 -march=i686" "80-bit registers")
  run("${CLANG}" "-O2" 0 "")
  set(expected ${bits})
  foreach(flags IN ITEMS "-O2 -funsafe-math-optimizations" "-O2 ${reordered}")
    run("${CLANG}" "${flags}" 0 "")
    if(NOT bits STREQUAL expected)
      string(APPEND wrong "${CLANG} ${flags}: other bits than without\n")
    endif()
  endforeach()
endif()
if(wrong)
  message(FATAL_ERROR "${wrong}")
endif()
