#!/usr/bin/env bash
# Wrong programs in one run of the compiler, each in a namespace of its own: 173 take GCC 8 s so, alone 0.8 s each.
# PROGRAMS: a file with their paths, a line each. OUTPUT: the folder for what the compiler says of each, FOLDER/NAME.txt. COMMAND...:
# compiler and flags. Of two programs that are wrong in the same template with the same arguments only the first is told: those of which
# nothing was told are compiled again, and check.cmake compiles alone what is left.
set -euo pipefail
output=$1 programs=$2
shift 2
rm -rf "$output"
mkdir -p "$output"
xargs dirname <"$programs" | xargs -n 1 basename | sort -u | (cd "$output" && xargs mkdir)

# Of a path, FOLDER/NAME.
name_of() {
  local folder=${1%/*}
  echo "${folder##*/}/$(basename "$1" .fail.cpp)"
}

compile_together() {
  local programs=$1 name
  shift
  {
    xargs grep -hE '^#include' <"$programs" | sort -u
    while read -r program; do
      name=$(name_of "$program")
      printf 'namespace %s {\n#line 1 "%s"\n' "${name/\//_}" "$program"
      cat "$program"
      printf '}\n'
    done <"$programs"
  } >"$output/all.cpp"
  LC_ALL=C "$@" "$output/all.cpp" >"$output/all.txt" 2>&1 || true
  # What leads to an error stands before it, its notes behind it; one of these lines names the program. How the library was included
  # GCC says where the file changes: each program's text says it once, as a program alone would.
  awk -v output="$output" '
    function end_of_error(  name) {
      if (match(error, /[^\/ ]+\/[^\/ ]+\.fail\.cpp/)) {
        name = substr(error, RSTART, RLENGTH - 9)
        if (!(name in told)) printf "%s", included > (output "/" name ".txt")
        told[name] = 1
        printf "%s", error > (output "/" name ".txt")
      }
      error = ""
    }
    /^In file included from / { next_included = next_included $0 "\n"; next }
    /^ +from / { next_included = next_included $0 "\n"; next }
    next_included && /: note: / { error = error next_included; next_included = "" }
    next_included { end_of_error(); included = next_included; next_included = "" }
    /: In |: At global scope:|:   (recursively )?required |:   in .constexpr. expansion of / { before = before $0 "\n"; next }
    /: (fatal error|error|warning): / { end_of_error() }
    { error = error before $0 "\n"; before = "" }
    END { end_of_error() }' "$output/all.txt"
}

cp "$programs" "$output/untold"
for _ in 1 2 3; do
  compile_together "$output/untold" "$@"
  before=$(wc -l <"$output/untold")
  while read -r program; do
    [[ -e $output/$(name_of "$program").txt ]] || echo "$program"
  done <"$output/untold" >"$output/still_untold"
  mv "$output/still_untold" "$output/untold"
  left=$(wc -l <"$output/untold")
  if ((left <= 1 || left == before)); then break; fi
done
