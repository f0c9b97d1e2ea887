#!/usr/bin/env bash
# Every compiler and target of the table below that is installed compiles tests/exact/program.cpp as users of skinctl::exact do,
# without a note or warning, and prints, by qemu-user where the target is another machine, the hash that the first line prints.
# What is missing is skipped, loudly. On Debian 12: g++-11, g++-TARGET (aarch64-linux-gnu, arm-linux-gnueabihf, ...), qemu-user, nodejs.
#
# Promise: the same bits on other machines, and not a line said; a compiler that is too old is told what is
# needed
# Tried: `skinctl::exact` by GCC and Clang (14, 16, 19) for x86-64, with libc++, for WebAssembly under Node, by GCC
# for i686, aarch64, armhf, riscv64, s390x under qemu-user; robot files read with libc++; all headers and three
# examples by GCC for Windows, a scene by Clang 16 and 19; GCC 11: one error; what is not installed is skipped, loudly

set -euo pipefail
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# A folder of its own: -I/usr/include would show a cross compiler the headers of this machine's C library.
mkdir "$work/include"
ln -s "${EIGEN_INCLUDE:-/usr/include/eigen3}"/{Eigen,unsupported} "${BOOST_INCLUDE:-/usr/include}/boost" "$work/include/"

# libc++ of Clang 14, unpacked beside the packages of this machine: to install it would remove those that Ceres needs.
cxx="$work/libcxx/usr/lib/llvm-14"
(cd "$work" && apt-get download -qq libc++-14-dev libc++abi-14-dev libc++1-14 libc++abi1-14 &&
  for package in ./*.deb; do dpkg -x "$package" libcxx; done) >/dev/null 2>&1 || true
libcxx="-nostdinc++ -nostdlib++ -isystem $cxx/include/c++/v1 $cxx/lib/libc++.a $cxx/lib/libc++abi.a -pthread"
cat >"$work/wasi.mjs" <<'END'
import { readFile } from 'node:fs/promises';
import { WASI } from 'node:wasi';
const wasi = new WASI({ version: 'preview1' });
const module = await WebAssembly.compile(await readFile(process.argv[2]));
process.exit(wasi.start(await WebAssembly.instantiate(module, { wasi_snapshot_preview1: wasi.wasiImport })));
END
failed=0 tried=0

# skipped COMPILER FLAGS [EMULATOR]: true, loudly, if one of them is missing, or the standard library of the compiler.
skipped() {
  # shellcheck disable=SC2086
  if command -v "$1" >/dev/null && { [[ -z ${3:-} ]] || command -v "${3%% *}" >/dev/null; } &&
    echo '#include <vector>' | "$1" -std=c++20 -x c++ -fsyntax-only - -x none $2 >/dev/null 2>&1; then return 1; fi
  echo "platforms: SKIPPED $1 ${3:-}: not installed"
}
# compiled COMPILER FLAGS ARGUMENTS...: without a note.
compiled() {
  local compiler=$1 flags=$2
  shift 2
  tried=$((tried + 1))
  # shellcheck disable=SC2086
  "$compiler" -std=c++20 -Wall -Wextra -Iinclude -Iexamples -I. -isystem "$work/include" "$@" $flags >"$work/said" 2>&1 &&
    [[ ! -s $work/said ]] && return
  echo "platforms: FAILED $compiler $flags"
  head -10 "$work/said"
  failed=1
  return 1
}

# compiler | flags | emulator; -Wno-psabi is what the CMake target gives GCC on ARM
table="
g++                     | -O2                             |
g++-12                  | -O3 -march=x86-64-v3            |
clang++-14              | -O2                             |
clang++-14              | -O2 $libcxx                     |
clang++-16              | -O2                             |
clang++-19              | -O2                             |
clang++-19              | -O2 --target=wasm32-wasi -fno-exceptions | node --no-warnings $work/wasi.mjs
i686-linux-gnu-g++      | -O2 -msse2 -mfpmath=sse -static | qemu-i386
aarch64-linux-gnu-g++   | -O2 -static -Wno-psabi          | qemu-aarch64
arm-linux-gnueabihf-g++ | -O2 -static -Wno-psabi          | qemu-arm
riscv64-linux-gnu-g++   | -O2 -static                     | qemu-riscv64
s390x-linux-gnu-g++     | -O2 -static                     | qemu-s390x
"
expected=""
while IFS='|' read -r compiler flags emulator; do
  compiler=$(xargs <<<"$compiler") flags=$(xargs <<<"$flags") emulator=$(xargs <<<"$emulator")
  [[ -n $compiler ]] && ! skipped "$compiler" "$flags" "$emulator" || continue
  exact="-ffp-contract=off"
  [[ $compiler == *clang* ]] || exact+=" -fno-tree-vectorize"
  # shellcheck disable=SC2086
  compiled "$compiler" "$flags" $exact -DSKINCTL_NO_CONTRACT tests/exact/program.cpp -o "$work/program" || continue
  # shellcheck disable=SC2086
  hash=$($emulator "$work/program" | tr '\n' ' ')
  expected=${expected:-$hash}
  printf 'platforms: %-24s %-32.32s %s\n' "$compiler" "$flags" "$hash"
  [[ $hash == "$expected" ]] || { echo "platforms: FAILED $compiler: other bits"; failed=1; }
done <<<"$table"

# All headers, and examples, where nothing runs them: Windows.
windows=x86_64-w64-mingw32-g++-posix
if ! skipped "$windows" ""; then
  echo '#include "skinctl/skinctl.hpp"' >"$work/all.cpp"
  for source in "$work/all.cpp" examples/01_*.cpp examples/05_*.cpp examples/24_*.cpp; do
    compiled "$windows" "" -fsyntax-only "$source" && echo "platforms: $windows compiles $(basename "$source")"
  done
fi

# A whole scene, which other versions of a compiler see differently than the hash: Clang 16 has errors of its own.
for compiler in clang++-16 clang++-19; do
  if ! skipped "$compiler" ""; then
    compiled "$compiler" "" -O1 -c examples/05_*.cpp -o "$work/scene.o" &&
      echo "platforms: $compiler compiles a scene"
  fi
done

# A robot file and its numbers, with a standard library that reads no floating-point numbers.
cat >"$work/file.cpp" <<'END'
#include <cstdio>
#include "skinctl/io/skin_file.hpp"
#include "skinctl/io/urdf.hpp"
int main(int, char** arguments) {
  const auto robot = skinctl::read_urdf(arguments[1]);
  for (const auto& joint : robot.joints) std::printf("%s %.17g %.17g\n", joint.name.c_str(), joint.lower, joint.upper);
}
END
read_by() {
  compiled "$1" "$2" -O1 "$work/file.cpp" -ltinyxml2 -o "$work/file" && "$work/file" examples/data/fr3.urdf
}
if [[ -e /usr/include/tinyxml2.h ]] && ! skipped clang++-14 "$libcxx"; then
  here=$(read_by g++ "") there=$(read_by clang++-14 "$libcxx -lstdc++")
  [[ -n $here && $here == "$there" ]] && echo "platforms: clang++-14 with libc++ reads a robot file as g++ does" ||
    { echo "platforms: FAILED a robot file read with libc++: $there"; failed=1; }
fi
if command -v g++-11 >/dev/null; then  # too old: one error says so
  tried=$((tried + 1))
  g++-11 -std=c++20 -Iinclude -isystem "$work/include" -fsyntax-only tests/exact/program.cpp >"$work/said" 2>&1 && failed=1
  grep -q 'needs GCC 12 or Clang 14' "$work/said" && [[ $(grep -c 'error:' "$work/said") -le 2 ]] ||
    { echo "platforms: FAILED g++-11 is not told what is needed"; head -10 "$work/said"; failed=1; }
fi
echo "platforms: $tried tried, $failed failed"
exit $failed
