# Installs this build into PREFIX, of which nothing of an earlier install is left.
file(REMOVE_RECURSE "${PREFIX}")
execute_process(COMMAND "${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${PREFIX}" RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "cmake --install: ${failed}")
endif()
include("${CMAKE_CURRENT_LIST_DIR}/eigen_versions.cmake")
