#!/usr/bin/env bash
# Every header but those of io/, which need a parser, compiles alone. INCLUDE: the folder of skinctl/. SCRATCH: for a precompiled
# header. COMMAND...: compiler and flags.
#
# Most headers include core/joint.hpp, directly or through another, and reading that is half of their cost. So it is read once, and
# goes before each header that includes it anyway: what such a header lacks it lacks as before, since core/joint.hpp itself is
# compiled alone. (GCC: 71 processor seconds instead of 138.)
set -euo pipefail
include=$1 scratch=$2
shift 2
base=skinctl/core/joint.hpp
mkdir -p "$scratch"
cd "$include"

find skinctl -name '*.hpp' -not -path 'skinctl/io/*' | sort >"$scratch/all"
# Those above the base: whoever includes one that is above it is above it.
xargs grep -oE '^ *# *include *"[^"]+"' <"$scratch/all" | sed -E 's/ *# *include *"([^"]+)"/\1/' |
  awk -F: -v base="$base" '
    { from[NR] = $1; to[NR] = $2 }
    END {
      above[base] = 1
      do {
        found = 0
        for (k in from) if (to[k] in above && !(from[k] in above)) { above[from[k]] = 1; found = 1 }
      } while (found)
      delete above[base]
      for (header in above) print header
    }' | sort >"$scratch/above"

echo "#include \"$base\"" >"$scratch/base.hpp"
"$@" -I. -x c++-header "$scratch/base.hpp" -o "$scratch/base.hpp.gch"
check() {  # check <options before the header> -- <command> <header>
  local header=${!#}
  if ! echo "#include \"$header\"" | "${@:1:$#-1}" -I. -fsyntax-only -x c++ -; then
    echo "does not stand alone: $header"
    return 1
  fi
}
export -f check
compile() {  # compile <options>: the headers of stdin
  xargs -P "${SKINCTL_JOBS:-2}" -I{} bash -c 'check "$@"' check "${command[@]}" "$@" {}
}
command=("$@")
status=0
comm -23 "$scratch/all" "$scratch/above" | compile || status=1
comm -12 "$scratch/all" "$scratch/above" | compile -Winvalid-pch -include "$scratch/base.hpp" || status=1
echo "$(wc -l <"$scratch/all") headers, $(wc -l <"$scratch/above") of them above $base"
exit $status
