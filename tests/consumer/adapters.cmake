# Installs SOURCE with its drivers into PREFIX, through a build of no test, example or benchmark in BUILD.
file(REMOVE_RECURSE "${PREFIX}")
foreach(command IN ITEMS "-S;${SOURCE};-B;${BUILD};-DSKINCTL_BUILD_TESTS=OFF;-DSKINCTL_BUILD_EXAMPLES=OFF;-DSKINCTL_INSTALL_ADAPTERS=ON"
    "--install;${BUILD};--prefix;${PREFIX}")
  execute_process(COMMAND "${CMAKE_COMMAND}" ${command} RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "cmake ${command}: ${failed}")
  endif()
endforeach()
