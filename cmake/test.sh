#!/usr/bin/env bash
# The tests that a change has to pass: rooms, adapters and main jobs with GCC, the tests of what computes as users compile it, then
# rooms, parsers and protocols with Clang under the address and undefined-behaviour sanitizers. `--nightly`: every test, in these builds
# and in those for AVX-512 and with Clang's -O3, on bare metal as well, and every study and benchmark compiles; tests/README.md says what
# runs where. What fails does not keep the others from running; the last lines say what did. On a fresh Debian 12 it installs what is
# missing. SKINCTL_JOBS sets how many compilers run at once, SKINCTL_CXX_FLAGS adds flags for GCC, SKINCTL_SANITIZED (a regular
# expression) keeps the sanitizers to some of the tests.
set -euo pipefail
cd "$(dirname "$0")/.."
source cmake/install_packages.sh
jobs=${SKINCTL_JOBS:-2}
# Large pages for what compilers allocate: Clang takes a twentieth less time. C libraries that do not know it ignore it.
export GLIBC_TUNABLES=${GLIBC_TUNABLES:-glibc.malloc.hugetlb=1}

case "${1:-}" in
  "") nightly="" gate=ON ;;
  --nightly) nightly=yes gate=OFF ;;
  *)
    echo "usage: cmake/test.sh [--nightly]"
    exit 2
    ;;
esac
failed=()

build() {
  local preset=$1
  shift
  cmake --preset "$preset" "$@" && cmake --build --preset "$preset" -j "$jobs"
}

build_studies() {
  cmake --preset bench && cmake --build build/bench -j "$jobs" --target all studies
}

# configuration PRESET NAME OPTIONS...: builds it and runs its tests.
configuration() {
  local preset=$1 name=$2
  shift 2
  if ! phase "build, $name" build "$preset" -DSKINCTL_ROOMS_TOGETHER=ON "-DSKINCTL_GATE=$gate" "$@"; then
    failed+=("build, $name" "tests, $name: not run")
    return
  fi
  echo "== tests, $name"
  ctest --preset "$preset" -j "$jobs" --no-label-summary || failed+=("tests, $name")
}

install_packages build library tests peers benchmark examples dds python ros urdf camera docs ${nightly:+proofs bare_metal platforms playground}
# GCC frees memory only above 1 GB a file: an eighth less time, some 3 GB a compiler.
gcc_flags="-DCMAKE_CXX_FLAGS=${SKINCTL_CXX_FLAGS:-} --param=ggc-min-heapsize=1000000"
# The gate compiles each room once: with Clang's sanitizers what reads bytes, keeps lists or touches cells, the rest with GCC. What
# computes is compiled as users do as well.
by_gcc="" sanitized=${SKINCTL_SANITIZED:-}
if [[ -z $nightly ]]; then
  by_gcc="/tests/(control|cycle|dynamics|extremes|fusion|hardware|limits|oracles|passivity|repository|sensing|support|testing|tracking"
  by_gcc+="|trajectory)/"
  memory="calibration|clearance|core|frames|guard|io|kinematics|law|math|model|recording|resolver|robots?|semantics|skills|skin_network"
  sanitized=${sanitized:-"/tests/(($memory|support|tactile)/|cycle/(apart|cycle|input|start)_test)"}
fi
configuration release "GCC" "$gcc_flags" "-DSKINCTL_TEST_FILTER=$by_gcc"
if [[ -z $nightly ]]; then
  configuration users "GCC as users compile" "$gcc_flags"
else
  rooms="calibration|clearance|control|core|cycle|dynamics|extremes|frames|fusion|guard|hardware|kinematics|law|limits|math|model"
  rooms+="|passivity|resolver|robot|robots|semantics|sensing|skills|tactile|tracking|trajectory"
  every_room="-DSKINCTL_TEST_FILTER=/tests/($rooms)/"
  configuration users "GCC as users compile" "$gcc_flags" "$every_room"
  configuration avx512 "GCC for AVX-512" "$gcc_flags" "$every_room"
  configuration users-clang "Clang as users compile" "$every_room"
  phase "build, studies" build_studies || failed+=("build, studies")
fi
# Compiled once and run once: line numbers cost an eighth of this build. The preset without this flag has them, to look into a
# report.
configuration asan-clang "Clang with sanitizers" "-DSKINCTL_TEST_FILTER=$sanitized" "-DCMAKE_CXX_FLAGS_SANITIZED=-O1 -g0"

if [[ ${#failed[@]} -gt 0 ]]; then
  echo "== failed:"
  printf '%s\n' "${failed[@]}"
  exit 1
fi
