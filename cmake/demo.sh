#!/usr/bin/env bash
# The main job: a stiff arm gives way to a touch. On a fresh Debian 12 it installs what is missing. Arguments go to the
# program; `./cmake/demo.sh --help` lists them.
set -euo pipefail
cd "$(dirname "$0")/.."
source cmake/install_packages.sh

install_packages build library examples
cmake --preset release -B build/demo -DSKINCTL_BUILD_TESTS=OFF

# Until the main job exists, the last of the numbered examples shows most.
program=compliant_ur5
if ! cmake --build build/demo --target help | grep -q "^$program:"; then
  last=$(find examples -maxdepth 1 -name '[0-9][0-9]_*.cpp' | sort | tail -n 1)
  program=$(basename "${last%.cpp}")
fi
if [[ -z $program ]]; then
  echo "skinctl: no example to run" >&2
  exit 1
fi
cmake --build build/demo -j "${SKINCTL_JOBS:-2}" --target "$program"
exec "build/demo/bin/$program" "$@"
