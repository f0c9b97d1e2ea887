#!/usr/bin/env bash
# cmake/test.sh with commands that build and test nothing: each phase runs whatever the others do, what failed stands in the last
# lines, and the command fails. `test_command.sh SOURCE SCRATCH`
set -euo pipefail
source=$1 scratch=$2
rm -rf "$scratch"
mkdir -p "$scratch"
for name in cmake ctest; do
  printf '#!/bin/sh\necho "%s $*" >>"$LOG"\ncase "%s $*" in $FAILS) exit 1;; esac\n' $name $name >"$scratch/$name"
done
printf '#!/bin/sh\necho installed\n' >"$scratch/dpkg-query"
chmod +x "$scratch"/*

# expect FAILS STATUS LINES STEPS OPTIONS...: the command line that fails (a pattern), how test.sh ends, its last lines, and how many
# steps it took.
expect() {
  local fails=$1 status=$2 lines=$3 steps=$4 ended=0
  shift 4
  : >"$scratch/log"
  PATH=$scratch:$PATH LOG=$scratch/log FAILS=$fails "$source/cmake/test.sh" "$@" >"$scratch/out" 2>&1 || ended=$?
  local last
  last=$(sed -n '/^== failed:/,$p' "$scratch/out")
  if [[ $ended -ne $status || $last != "$lines" || $(wc -l <"$scratch/log") -ne $steps ]]; then
    echo "'$fails' fails: exit $ended in place of $status, last lines:"
    echo "$last"
    cat "$scratch/log"
    exit 1
  fi
}
expect none 0 "" 9
expect "ctest --preset release*" 1 $'== failed:\ntests, GCC' 9
expect "ctest *" 1 $'== failed:\ntests, GCC\ntests, GCC as users compile\ntests, Clang with sanitizers' 9
expect "cmake --build --preset release*" 1 $'== failed:\nbuild, GCC\ntests, GCC: not run' 8
expect "cmake --preset users*" 1 $'== failed:\nbuild, GCC as users compile\ntests, GCC as users compile: not run' 7
expect "cmake --build *" 1 "$(printf '%s\n' '== failed:' 'build, GCC' 'tests, GCC: not run' 'build, GCC as users compile' \
  'tests, GCC as users compile: not run' 'build, Clang with sanitizers' 'tests, Clang with sanitizers: not run')" 6
expect none 2 "" 0 --nightli
expect none 0 "" 17 --nightly
expect "cmake --build build/bench*" 1 $'== failed:\nbuild, studies' 17 --nightly
expect "cmake --preset avx512*" 1 $'== failed:\nbuild, GCC for AVX-512\ntests, GCC for AVX-512: not run' 15 --nightly
# What the gate leaves out, the night does not.
grep -q -- "--preset release .*-DSKINCTL_GATE=OFF" "$scratch/log"
