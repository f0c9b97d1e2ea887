#!/usr/bin/env bash
# Gathers the promises that stand atop their tests into tests/promises.md: comments that begin with "Promise: ", up to the line
# "Tried: " or the end of the comment. With --check it writes nothing and fails if the page is not up to date.
set -euo pipefail
cd "$(dirname "$0")/.."
page=tests/promises.md

gather() {
  echo "# Promises"
  echo
  echo "Gathered from the first lines of the tests by \`cmake/promises.sh\`; there stands over which range each was tried."
  find tests examples cmake -type f \( -name '*.cpp' -o -name '*.hpp' -o -name '*.cmake' -o -name '*.sh' \) | LC_ALL=C sort |
    xargs awk '
      function end() {
        if (promise == "") return
        folder = file; sub(/\/[^\/]*$/, "", folder); sub(/\/tests$/, "", folder)
        if (folder != last) printf "\n## `%s`\n\n| promise | test |\n|---|---|\n", folder
        last = folder
        name = file; sub(/.*\//, "", name)
        printf "| %s | [`%s`](../%s) |\n", promise, name, file
        promise = ""
      }
      FNR == 1 { end(); file = FILENAME }
      !/^(\/\/|#) / { end(); next }
      { text = $0; sub(/^(\/\/|#) +/, "", text) }
      text ~ /^Promise: / { end(); promise = substr(text, 10); next }
      text ~ /^Tried: / { end(); next }
      promise != "" { promise = promise " " text }
      END { end() }'
}

if [[ ${1:-} == --check ]]; then
  gather | diff -u "$page" - || { echo "$page is not up to date: run cmake/promises.sh"; exit 1; }
else
  gather >"$page"
fi
