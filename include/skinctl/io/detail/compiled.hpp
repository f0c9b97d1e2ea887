// SPDX-License-Identifier: BSD-3-Clause
// Bodies that each file of a program may hold, or one source of it: CMake's `skinctl::io` compiles that
// source.
#pragma once

#ifdef SKINCTL_COMPILED_IO
#define SKINCTL_IO
#else
#define SKINCTL_IO inline
#endif
