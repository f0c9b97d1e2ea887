// The source that CMake's `skinctl::io` compiles in a program: the bodies of what it calls of recording/, and
// of io/urdf.hpp where the program has found tinyxml2.
#ifndef SKINCTL_COMPILED_IO
#error "link skinctl::io, which defines this for all files of the program"
#endif
#include "skinctl/recording/detail/run_file_body.hpp"
#ifdef SKINCTL_HAS_TINYXML2
#include "skinctl/io/detail/parse_urdf_body.hpp"
#endif
