# Builds and runs PROGRAM with nothing but a compiler and include paths. COMMAND PROGRAM BINARY, and PC_DIR with
# PKG_CONFIG for a compiler line that pkg-config gives.
if(PC_DIR)
  set(ENV{PKG_CONFIG_PATH} "${PC_DIR}")
  execute_process(COMMAND "${PKG_CONFIG}" --cflags skinctl
    OUTPUT_VARIABLE flags OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  separate_arguments(flags)
endif()
execute_process(COMMAND ${COMMAND} ${flags} "${PROGRAM}" -o "${BINARY}" COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND "${BINARY}" COMMAND_ERROR_IS_FATAL ANY)
