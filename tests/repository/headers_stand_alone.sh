#!/usr/bin/env bash
# Every header but those of io/, which need a parser, compiles alone. INCLUDE: the folder of skinctl/. SCRATCH: for precompiled
# headers. COMMAND...: compiler and flags.
#
# Most headers include one of `bases`, directly or through another, and reading it is most of their cost. So these are read once,
# and go before each header that includes them anyway: what such a header lacks it lacks as before, since a base itself is compiled
# alone. A header takes the last of the list that it includes.
set -euo pipefail
include=$1 scratch=$2
shift 2
bases=(
  skinctl/core/contract.hpp
  skinctl/core/time.hpp
  skinctl/frames/rotation.hpp
  skinctl/robot/robot_description.hpp
  skinctl/dynamics/inverse_dynamics.hpp
  skinctl/testing/random.hpp
  skinctl/calibration/detail/symmetric.hpp
)
mkdir -p "$scratch"
cd "$include"

find skinctl -name '*.hpp' -not -path 'skinctl/io/*' | sort >"$scratch/all"
# A line for each header: it, and its base or `-`.
xargs grep -oE '^ *# *include *"[^"]+"' <"$scratch/all" | sed -E 's/ *# *include *"([^"]+)"/\1/' |
  awk -F: -v bases="${bases[*]}" -v all="$scratch/all" '
    { from[NR] = $1; to[NR] = $2 }
    END {
      count = split(bases, base, " ")
      for (b = 1; b <= count; ++b) {  # who includes one that is above it is above it
        delete above
        above[base[b]] = 1
        do {
          found = 0
          for (k in from) if (to[k] in above && !(from[k] in above)) { above[from[k]] = 1; found = 1 }
        } while (found)
        for (header in above) if (header != base[b]) chosen[header] = b
      }
      while ((getline header < all) > 0) print header, (header in chosen ? chosen[header] : "-")
    }' >"$scratch/chosen"

check() {  # check <command> <header> <number of its base>
  local header=${*: -2:1} base=${*: -1}
  local options=()
  if [[ $base != - ]]; then options=(-Winvalid-pch -include "$scratch/$base.hpp"); fi
  if ! echo "#include \"$header\"" | "${@:1:$#-2}" "${options[@]}" -I. -fsyntax-only -x c++ -; then
    echo "does not stand alone: $header"
    return 1
  fi
}
precompile() {  # precompile <command> <header> <number>
  echo "#include \"${*: -2:1}\"" >"$scratch/${*: -1}.hpp"
  "${@:1:$#-2}" -I. -x c++-header "$scratch/${*: -1}.hpp" -o "$scratch/${*: -1}.hpp.gch"
}
export scratch
export -f check precompile
for k in "${!bases[@]}"; do echo "${bases[k]} $((k + 1))"; done |
  xargs -P "${SKINCTL_JOBS:-2}" -L1 bash -c 'precompile "$@"' precompile "$@"
status=0
xargs -P "${SKINCTL_JOBS:-2}" -L1 bash -c 'check "$@"' check "$@" <"$scratch/chosen" || status=1
echo "$(wc -l <"$scratch/all") headers, $(grep -vc ' -$' "$scratch/chosen") of them above one of ${#bases[@]}"
exit $status
