#!/usr/bin/env bash
# Every header but those of io/, which need a parser, compiles alone; and all compile in one file: no two give one name to two things.
# INCLUDE: the folder of skinctl/. SCRATCH: for precompiled headers. COMMAND...: compiler and flags.
#
# What headers include is most of their cost, and much of it is the same. What goes before a header proves it as well as nothing does
# if it includes that anyway, directly or through another: what it lacks it lacks as before. So
# - some `bases` are read once, each alone, and go before the headers that include them: the largest that a header includes;
# - one run of the compiler reads a chain of headers, of which each includes the one before it.
#
# Clang is the better choice: it keeps what a base instantiates, which GCC does again for each chain. 445 headers take it 99 processor
# seconds so, and 147 with bases alone.
set -euo pipefail
include=$1 scratch=$2
shift 2
bases=(
  skinctl/core/contract.hpp
  skinctl/core/lane.hpp
  skinctl/core/time.hpp
  skinctl/frames/rotation.hpp
  skinctl/robot/robot_description.hpp
  skinctl/dynamics/inverse_dynamics.hpp
  skinctl/cycle/cycle.hpp
  skinctl/sensing/cell_sample.hpp
  skinctl/testing/random.hpp
  skinctl/calibration/detail/symmetric.hpp
)
precompiled=gch use=-include instantiated=()
if "$1" --version | grep -q clang; then
  precompiled=pch use=-include-pch instantiated=(-fpch-instantiate-templates)
fi
mkdir -p "$scratch"
cd "$include"

find skinctl -name '*.hpp' -not -path 'skinctl/io/*' | sort >"$scratch/all"
# A line for each pair of headers of which the second includes the first: what it saves to read them in one run, and they; and for each
# header what it costs and the number of its base or `-`. Costs are roughly in headers of this library.
xargs grep -HoE '^ *# *include *["<][^">]+' <"$scratch/all" | sed -E 's/ *# *include *["<]//' |
  awk -F: -v bases="${bases[*]}" -v all="$scratch/all" -v chosen="$scratch/chosen" '
    function collect(header, k, name) {  # what it includes goes into `seen`
      for (k = 1; k <= count[header]; ++k) {
        name = included[header, k]
        if (!(name in seen)) { seen[name] = 1; collect(name) }
      }
    }
    function cost(name) { return name ~ /^skinctl\// ? 1 : name ~ /^Eigen\// ? 40 : name ~ /^boost\// ? 20 : 5 }
    { included[$1, ++count[$1]] = $2 }
    END {
      while ((getline header < all) > 0) {
        headers[++number] = header
        split("", seen)
        collect(header)
        for (name in seen) { size[header] += cost(name); if (name ~ /^skinctl\//) includes[header, name] = 1 }
      }
      bases_count = split(bases, base, " ")
      for (h = 1; h <= number; ++h) {
        best = 0
        for (b = 1; b <= bases_count; ++b)
          if ((headers[h], base[b]) in includes && size[base[b]] > size[base[best]]) best = b
        saved[headers[h]] = size[base[best]]
        print headers[h], best ? best : "-" > chosen
      }
      for (pair in includes) {
        split(pair, p, SUBSEP)
        if (!((p[2], p[1]) in includes)) print size[p[2]] - saved[p[1]] + 10, p[2], p[1]
      }
    }' | sort -k1,1nr -k2 >"$scratch/pairs"
# Chains: the pairs that save most, each header once below and once above another. A line: the number of the base, and the headers.
awk -v chosen="$scratch/chosen" '
  $1 > 0 && !($2 in above) && !($3 in below) { above[$2] = $3; below[$3] = $2 }
  END {
    while ((getline < chosen) > 0) {
      if ($1 in below) continue
      line = $2
      for (header = $1; header != ""; header = above[header]) line = line " " header
      print line
    }
  }' "$scratch/pairs" >"$scratch/chains"

check() {  # check <number of the base> <header>... -- <command>
  local base=$1 headers=() options=()
  for ((shift_by = 2; shift_by <= $#; ++shift_by)); do
    if [[ ${!shift_by} == -- ]]; then break; fi
    headers+=("${!shift_by}")
  done
  if [[ $base != - ]]; then options=(-Winvalid-pch $use "$scratch/$base.hpp$suffix"); fi
  if ! printf '#include "%s"\n' "${headers[@]}" | "${@:shift_by+1}" "${options[@]}" -I. -fsyntax-only -x c++ -; then
    echo "does not stand alone: ${headers[*]}"
    return 1
  fi
}
precompile() {  # precompile <header> <number> -- <command>
  echo "#include \"$1\"" >"$scratch/$2.hpp"
  "${@:4}" -I. -x c++-header "$scratch/$2.hpp" -o "$scratch/$2.hpp.$precompiled"
}
suffix=
if [[ $precompiled == pch ]]; then suffix=.pch; fi  # GCC finds its own beside the header
export scratch use suffix precompiled
export -f check precompile
command="-- $(printf '%q ' "$@")"
for k in "${!bases[@]}"; do echo "${bases[k]} $((k + 1))"; done |
  xargs -P "${SKINCTL_JOBS:-2}" -I{} bash -c "precompile {} $command ${instantiated[*]-}"
status=0
xargs -P "${SKINCTL_JOBS:-2}" -I{} bash -c "check {} $command" <"$scratch/chains" || status=1
if echo '#include <tinyxml2.h>' | "$@" -fsyntax-only -x c++ - 2>/dev/null; then
  find skinctl -name '*.hpp' | sort >"$scratch/together"
else
  echo "without io/: no tinyxml2.h"
  cp "$scratch/all" "$scratch/together"
fi
if ! sed 's/.*/#include "&"/' "$scratch/together" | "$@" -I. -fsyntax-only -x c++ -; then
  echo "not all in one file"
  status=1
fi
echo "$(wc -l <"$scratch/all") headers in $(wc -l <"$scratch/chains") chains, above ${#bases[@]} bases"
exit $status
