# Builds and runs benchmarks with both compilers and three sets of flags, and prints one table:
#
#     cmake [-DPROGRAMS=dynamics_bench] [-DFILTER=/double] [-DPRESETS=bench;bench-clang] -P bench/report/table.cmake
#
# PROGRAMS and FILTER are regular expressions of programs and rows. Results stay in build/<preset>/results.json.
cmake_minimum_required(VERSION 3.25)
if(NOT PROGRAMS)
  set(PROGRAMS "dynamics_bench|kinematics_bench|regressor_bench|cycle_bench")
endif()
if(NOT PRESETS)
  set(PRESETS bench bench-clang bench-v3 bench-v3-clang bench-plain bench-plain-clang)
endif()
get_filename_component(source "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)
set(run "${CMAKE_COMMAND}" -E chdir "${source}" "${CMAKE_COMMAND}")
set(results "")
foreach(preset IN LISTS PRESETS)
  message(STATUS "${preset}")
  execute_process(COMMAND ${run} --preset ${preset} "-DSKINCTL_BENCHMARK_PROGRAMS=${PROGRAMS}"
    "-DSKINCTL_BENCHMARK_FILTER=${FILTER}" OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${run} --build --preset ${preset} --target run_benchmarks benchmark_table
    OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  list(APPEND results "${source}/build/${preset}/results.json")
  set(table "${source}/build/${preset}/bench/benchmark_table")
endforeach()
execute_process(COMMAND "${table}" ${results} COMMAND_ERROR_IS_FATAL ANY)
