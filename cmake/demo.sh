#!/usr/bin/env bash
# The main job: a stiff arm gives way to a touch. On a fresh Debian 12 it installs what is missing. Without arguments: the scripted
# minute as fast as the machine can, then eight seconds of it at real-time pace. With --live a page shows the run. Arguments go to the program; `./cmake/demo.sh --help`
# lists them.
set -euo pipefail
cd "$(dirname "$0")/.."
source cmake/install_packages.sh

install_packages build library examples urdf
cmake --preset release -B build/demo -DSKINCTL_BUILD_TESTS=OFF
cmake --build build/demo -j "${SKINCTL_JOBS:-2}" --target compliant_ur5
program=build/demo/bin/compliant_ur5
if [[ $# -gt 0 ]]; then exec "$program" "$@"; fi
"$program"
echo
echo "== eight seconds at real-time pace"
exec "$program" --speed 1 --cycles 1000 --report ""
