#!/usr/bin/env bash
# Every test: a release build with GCC, the tests of what computes as users compile it, then Clang under the address and
# undefined-behaviour sanitizers. What fails does not keep the others from running; the last lines say what did. On a fresh Debian 12 it
# installs what is missing. SKINCTL_JOBS sets how many compilers run at once, SKINCTL_CXX_FLAGS adds flags for GCC,
# SKINCTL_SANITIZED (a regular expression) keeps the sanitizers to some of the tests.
set -euo pipefail
cd "$(dirname "$0")/.."
source cmake/install_packages.sh
jobs=${SKINCTL_JOBS:-2}
# Large pages for what compilers allocate: Clang takes a twentieth less time. C libraries that do not know it ignore it.
export GLIBC_TUNABLES=${GLIBC_TUNABLES:-glibc.malloc.hugetlb=1}

failed=()

build() {
  local preset=$1
  shift
  cmake --preset "$preset" "$@" && cmake --build --preset "$preset" -j "$jobs"
}

# configuration PRESET NAME OPTIONS...: builds it and runs its tests.
configuration() {
  local preset=$1 name=$2
  shift 2
  if ! phase "build, $name" build "$preset" -DSKINCTL_ROOMS_TOGETHER=ON "$@"; then
    failed+=("build, $name" "tests, $name: not run")
    return
  fi
  echo "== tests, $name"
  ctest --preset "$preset" -j "$jobs" --no-label-summary || failed+=("tests, $name")
}

install_packages build library tests peers benchmark examples dds python ros urdf camera docs
# GCC frees memory only above 1 GB a file: an eighth less time, at most 3 GB a compiler.
gcc_flags="-DCMAKE_CXX_FLAGS=${SKINCTL_CXX_FLAGS:-} --param=ggc-min-heapsize=1000000"
configuration release "GCC" "$gcc_flags"
configuration users "GCC as users compile" "$gcc_flags"
# Compiled once and run once: line numbers cost an eighth of this build. The preset without this flag has them, to look into a
# report.
configuration asan-clang "Clang with sanitizers" "-DSKINCTL_TEST_FILTER=${SKINCTL_SANITIZED:-}" "-DCMAKE_CXX_FLAGS_SANITIZED=-O1 -g0"

if [[ ${#failed[@]} -gt 0 ]]; then
  echo "== failed:"
  printf '%s\n' "${failed[@]}"
  exit 1
fi
