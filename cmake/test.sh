#!/usr/bin/env bash
# Every test: a release build with GCC, then with Clang under the address and undefined-behaviour sanitizers. On a fresh Debian 12 it
# installs what is missing. SKINCTL_JOBS sets how many compilers run at once, SKINCTL_CXX_FLAGS adds flags for GCC,
# SKINCTL_SANITIZED (a regular expression) keeps the sanitizers to some of the tests.
set -euo pipefail
cd "$(dirname "$0")/.."
source cmake/install_packages.sh
jobs=${SKINCTL_JOBS:-2}
# Large pages for what compilers allocate: Clang takes a twentieth less time. C libraries that do not know it ignore it.
export GLIBC_TUNABLES=${GLIBC_TUNABLES:-glibc.malloc.hugetlb=1}

build() {
  local preset=$1
  shift
  cmake --preset "$preset" "$@"
  cmake --build --preset "$preset" -j "$jobs"
}

install_packages build library tests peers benchmark examples dds python ros urdf camera docs
together=-DSKINCTL_ROOMS_TOGETHER=ON
# GCC frees memory only above 1 GB a file: an eighth less time, at most 3 GB a compiler.
phase "build, GCC" build release $together "-DCMAKE_CXX_FLAGS=${SKINCTL_CXX_FLAGS:-} --param=ggc-min-heapsize=1000000"
# Compiled once and run once: line numbers cost an eighth of this build. The preset without this flag has them, to look into a
# report.
phase "build, Clang with sanitizers" build asan-clang $together "-DSKINCTL_TEST_FILTER=${SKINCTL_SANITIZED:-}" \
  "-DCMAKE_CXX_FLAGS_SANITIZED=-O1 -g0"
phase "tests, GCC" ctest --preset release -j "$jobs"
ctest --preset asan-clang -j "$jobs" --no-label-summary
