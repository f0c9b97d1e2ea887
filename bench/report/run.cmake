# Runs the benchmark programs one after the other, then the report over their results.
# PROGRAMS REPORT OUTPUT COMPILER FLAGS SOURCE FILTER REPETITIONS SECONDS
find_package(Git QUIET)
set(commit "unknown")
if(GIT_FOUND)
  execute_process(COMMAND "${GIT_EXECUTABLE}" describe --always --dirty --abbrev=12 WORKING_DIRECTORY "${SOURCE}"
    OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(described)
    set(commit "${described}")
  endif()
endif()

set(filter "")
if(FILTER)
  set(filter "--benchmark_filter=${FILTER}")
endif()
file(MAKE_DIRECTORY "${OUTPUT}/results")
set(results "")
foreach(program IN LISTS PROGRAMS)
  get_filename_component(name "${program}" NAME)
  set(result "${OUTPUT}/results/${name}.json")
  file(REMOVE "${result}")
  message(STATUS "running ${name}")
  execute_process(
    COMMAND "${program}" "--benchmark_repetitions=${REPETITIONS}" "--benchmark_min_time=${SECONDS}" ${filter}
      --benchmark_enable_random_interleaving=true "--benchmark_out=${result}" --benchmark_out_format=json
    OUTPUT_QUIET ERROR_VARIABLE errors RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${name} failed (${status}):\n${errors}")
  endif()
  list(APPEND results "${result}")
endforeach()

execute_process(
  COMMAND "${REPORT}" "${OUTPUT}/results.json" "compiler=${COMPILER}" "flags=${FLAGS}" "commit=${commit}" ${results}
  COMMAND_ERROR_IS_FATAL ANY)
