# Drivers of devices and the live page, of an installation with SKINCTL_INSTALL_ADAPTERS: sources of the program that links them, PRIVATE,
# compiled with its flags. `#include "examples/adapters/ur5/driver.hpp"`, as the programs of examples/ do.

set(skinctl_adapters_dir "${skinctl_adapters_include}/examples")
find_package(Threads REQUIRED)
find_package(nlohmann_json QUIET)

# skinctl_adapter(<name> SOURCES <pattern>... [LINK <library>...]): the target skinctl::adapters::<name>.
function(skinctl_adapter name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LINK")
  set(library skinctl::adapters::${name})
  add_library(${library} INTERFACE IMPORTED)
  list(TRANSFORM arg_SOURCES PREPEND "${skinctl_adapters_dir}/")
  file(GLOB sources ${arg_SOURCES})
  target_sources(${library} INTERFACE ${sources})
  target_include_directories(${library} INTERFACE "${skinctl_adapters_include}")
  target_link_libraries(${library} INTERFACE skinctl::skinctl Threads::Threads ${arg_LINK})
endfunction()

# skinctl_adapter_option(<name> <header> <library>): compiled in where it is found; else what needs it is refused with its name.
function(skinctl_adapter_option name header library)
  find_path(SKINCTL_${name}_INCLUDE ${header})
  find_library(SKINCTL_${name}_LIBRARY ${library})
  if(SKINCTL_${name}_INCLUDE AND SKINCTL_${name}_LIBRARY)
    target_compile_definitions(skinctl::adapters::skin INTERFACE SKINCTL_HAS_${name}=1)
    target_include_directories(skinctl::adapters::skin SYSTEM INTERFACE "${SKINCTL_${name}_INCLUDE}")
    target_link_libraries(skinctl::adapters::skin INTERFACE "${SKINCTL_${name}_LIBRARY}")
  else()
    target_compile_definitions(skinctl::adapters::skin INTERFACE SKINCTL_HAS_${name}=0)
  endif()
endfunction()

skinctl_adapter(wire SOURCES adapters/*.cpp adapters/can/*.cpp)  # sockets, serial lines and CAN, beneath the others
skinctl_adapter(ur5 SOURCES adapters/ur5/*.cpp LINK skinctl::adapters::wire)
skinctl_adapter(clocked SOURCES adapters/egm/*.cpp adapters/franka/*.cpp adapters/fri/*.cpp adapters/rsi/*.cpp adapters/stream_motion/*.cpp
  LINK skinctl::adapters::wire)  # arms that are the clock
skinctl_adapter(allegro SOURCES adapters/allegro/*.cpp LINK skinctl::adapters::wire)
skinctl_adapter(gripper SOURCES adapters/gripper/*.cpp LINK skinctl::adapters::wire)
skinctl_adapter(skin SOURCES adapters/skin/[!x]*.cpp adapters/ros1/*.cpp LINK skinctl::adapters::wire)
skinctl_adapter_option(SODIUM sodium.h sodium)
skinctl_adapter_option(BZIP2 bzlib.h bz2)
skinctl_adapter_option(LZ4 lz4frame.h lz4)
if(nlohmann_json_FOUND)  # else a program that links one of these is told that there is no such target
  skinctl_adapter(xela SOURCES adapters/skin/xela.cpp LINK skinctl::adapters::skin nlohmann_json::nlohmann_json)
  skinctl_adapter(live SOURCES adapters/live/*.cpp live_page/page.cpp LINK nlohmann_json::nlohmann_json)
  target_compile_definitions(skinctl::adapters::live INTERFACE "LIVE_PAGE_FOLDER=\"${skinctl_live_page}\"")
endif()
