# `docs`: the reference of include/skinctl, by Doxygen, in build/<preset>/docs/html. A warning is an error.
find_program(SKINCTL_DOXYGEN doxygen)
if(SKINCTL_DOXYGEN)
  configure_file("${PROJECT_SOURCE_DIR}/cmake/Doxyfile.in" "${PROJECT_BINARY_DIR}/docs/Doxyfile" @ONLY)
  add_custom_target(docs COMMAND "${SKINCTL_DOXYGEN}" "${PROJECT_BINARY_DIR}/docs/Doxyfile"
    WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}" COMMENT "docs: ${PROJECT_BINARY_DIR}/docs/html/index.html" VERBATIM)
else()
  add_custom_target(docs COMMAND "${CMAKE_COMMAND}" -E echo
    "skinctl: no doxygen. On Debian 12: sudo apt-get install doxygen" COMMAND "${CMAKE_COMMAND}" -E false VERBATIM)
endif()
