# Compiles tests/exact/program.cpp as users of skinctl::exact do, demands that no fused instruction is in it and, where this
# processor or qemu-x86_64 has its instructions, the hash in the file EXPECTED, which -DREFERENCE=ON writes:
# `cmake -DCOMPILER=... -DFLAGS=... -DINCLUDE=... -DPROGRAM=... -DBINARY=... -DEXPECTED=... -DOBJDUMP=... -DEMULATOR=... -P run.cmake`.
#
# Promise: `skinctl::exact` gives the same bits, and no fused instruction is in it
# Tried: GCC -O0, -O2, -O3 for x86-64-v2, Haswell, Skylake with AVX-512, Ice Lake, Zen 3, and x86-64-v3
# tuned for Ice Lake; Clang -O2 for Haswell, -O3 for Ice Lake; float, double, and a loop of a user's own;
# instructions that neither the processor nor qemu-x86_64 has are looked at and not run: ctest shows
# `Skipped`; by hand also a whole closed loop (`-DSKINCTL_EXACT_WHOLE`)

separate_arguments(INCLUDE)
separate_arguments(FLAGS)
execute_process(COMMAND "${COMPILER}" -std=c++20 ${INCLUDE} ${FLAGS} -DSKINCTL_NO_CONTRACT "${PROGRAM}" -o "${BINARY}"
  COMMAND_ERROR_IS_FATAL ANY)

execute_process(COMMAND "${OBJDUMP}" -d --no-show-raw-insn "${BINARY}" OUTPUT_VARIABLE code COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "vfn?m(add|sub)[0-9a-z]*" fused "${code}")
if(fused)
  list(LENGTH fused count)
  list(REMOVE_DUPLICATES fused)
  message(FATAL_ERROR "${count} fused instructions: ${fused}")
endif()

execute_process(COMMAND "${BINARY}" OUTPUT_VARIABLE hash RESULT_VARIABLE ended)
if(ended STREQUAL "Illegal instruction" AND EMULATOR)
  message(STATUS "by ${EMULATOR}")
  execute_process(COMMAND "${EMULATOR}" -cpu max "${BINARY}" OUTPUT_VARIABLE hash RESULT_VARIABLE ended ERROR_QUIET)
endif()
if(ended STREQUAL "Illegal instruction")
  message(STATUS "SKIPPED: neither this processor nor an emulator here has its instructions: looked at, but not run")
elseif(NOT ended EQUAL 0)
  message(FATAL_ERROR "ended with ${ended}")
elseif(REFERENCE)
  file(WRITE "${EXPECTED}" "${hash}")
else()
  file(READ "${EXPECTED}" expected)
  if(NOT hash STREQUAL expected)
    message(FATAL_ERROR "other bits than by GCC -O2:\n${hash}expected:\n${expected}")
  endif()
endif()
