#!/usr/bin/env bash
# Every compiler and target of the table below that is installed compiles tests/exact/program.cpp as users of skinctl::exact do,
# without a note or warning, and prints, by qemu-user where the target is another machine, the hash that the first line prints.
# What is missing is skipped, loudly. On Debian 12: g++-11, g++-TARGET (aarch64-linux-gnu, arm-linux-gnueabihf, ...), qemu-user.
#
# Promise: the same bits on other machines, and not a line said; a compiler that is too old is told what is
# needed
# Tried: `skinctl::exact` by GCC and Clang (14, 16, 19) for x86-64, by GCC for i686, aarch64, armhf,
# riscv64, s390x under qemu-user; GCC 11: one error; what is not installed is skipped, loudly

set -euo pipefail
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# A folder of its own: -I/usr/include would show a cross compiler the headers of this machine's C library.
mkdir "$work/include"
ln -s "${EIGEN_INCLUDE:-/usr/include/eigen3}"/{Eigen,unsupported} "${BOOST_INCLUDE:-/usr/include}/boost" "$work/include/"

# compiler | flags | emulator; -Wno-psabi is what the CMake target gives GCC on ARM
table='
g++                     | -O2                             |
g++-12                  | -O3 -march=x86-64-v3            |
clang++-14              | -O2                             |
clang++-16              | -O2                             |
clang++-19              | -O2                             |
i686-linux-gnu-g++      | -O2 -msse2 -mfpmath=sse -static | qemu-i386
aarch64-linux-gnu-g++   | -O2 -static -Wno-psabi          | qemu-aarch64
arm-linux-gnueabihf-g++ | -O2 -static -Wno-psabi          | qemu-arm
riscv64-linux-gnu-g++   | -O2 -static                     | qemu-riscv64
s390x-linux-gnu-g++     | -O2 -static                     | qemu-s390x
'
failed=0 tried=0 expected=""
while IFS='|' read -r compiler flags emulator; do
  compiler=$(xargs <<<"$compiler") emulator=$(xargs <<<"$emulator")
  [[ -n $compiler ]] || continue
  if ! command -v "$compiler" >/dev/null || { [[ -n $emulator ]] && ! command -v "$emulator" >/dev/null; }; then
    echo "platforms: SKIPPED $compiler $emulator: not installed"
    continue
  fi
  exact="-ffp-contract=off"
  [[ $compiler == *clang* ]] || exact+=" -fno-tree-vectorize"
  tried=$((tried + 1))
  # shellcheck disable=SC2086
  if ! "$compiler" -std=c++20 -Wall -Wextra $flags $exact -DSKINCTL_NO_CONTRACT -Iinclude -I. -isystem "$work/include" \
    tests/exact/program.cpp -o "$work/program" >"$work/said" 2>&1; then
    echo "platforms: FAILED $compiler$flags"
    head -10 "$work/said"
    failed=1
    continue
  fi
  # shellcheck disable=SC2086
  hash=$($emulator "$work/program" | tr '\n' ' ')
  expected=${expected:-$hash}
  printf 'platforms: %-24s %-32s lines said: %-4d %s\n' "$compiler" "$(xargs <<<"$flags")" "$(wc -l <"$work/said")" "$hash"
  [[ $hash == "$expected" && ! -s $work/said ]] || { echo "platforms: FAILED $compiler: other bits, or notes"; failed=1; }
done <<<"$table"
if command -v g++-11 >/dev/null; then  # too old: one error says so
  tried=$((tried + 1))
  g++-11 -std=c++20 -Iinclude -isystem "$work/include" -fsyntax-only tests/exact/program.cpp >"$work/said" 2>&1 && failed=1
  grep -q 'needs GCC 12 or Clang 14' "$work/said" && [[ $(grep -c 'error:' "$work/said") -le 2 ]] ||
    { echo "platforms: FAILED g++-11 is not told what is needed"; head -10 "$work/said"; failed=1; }
fi
echo "platforms: $tried tried, $failed failed"
exit $failed
