#!/usr/bin/env bash
# Wrong programs in one run of the compiler, each in a namespace of its own: 36 of cycle/ take GCC 1.4 s so, one after the other 23 s.
# PROGRAMS: a file with their paths, a line each. OUTPUT: the folder for what the compiler says of each, NAME.txt. COMMAND...: compiler
# and flags. Of two programs that are wrong in the same template with the same arguments only the first is told: check.cmake compiles
# the other alone.
set -euo pipefail
output=$1 programs=$2
shift 2
rm -rf "$output"
mkdir -p "$output"
{
  xargs grep -hE '^#include' <"$programs" | sort -u
  while read -r program; do
    printf 'namespace %s {\n#line 1 "%s"\n' "$(basename "$program" .fail.cpp)" "$program"
    cat "$program"
    printf '}\n'
  done <"$programs"
} >"$output/all.cpp"
LC_ALL=C "$@" "$output/all.cpp" >"$output/all.txt" 2>&1 || true
# What leads to an error stands before it, its notes behind it; one of these lines names the program. How the library was included is
# left out: GCC says it again where the file changes.
awk -v output="$output" '
  function end_of_error() {
    if (match(error, /[^\/ ]+\.fail\.cpp/)) printf "%s", error > (output "/" substr(error, RSTART, RLENGTH - 9) ".txt")
    error = ""
  }
  /^In file included from |^ +from / { next }
  /: In |: At global scope:|:   (recursively )?required / { before = before $0 "\n"; next }
  /: (fatal error|error|warning): / { end_of_error() }
  { error = error before $0 "\n"; before = "" }
  END { end_of_error() }' "$output/all.txt"
