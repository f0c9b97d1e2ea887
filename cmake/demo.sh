#!/usr/bin/env bash
# The main job: a stiff arm gives way to a touch. On a fresh Debian 12 it installs what is missing. Without arguments: the scripted
# minute as fast as the machine can, then eight seconds of it at real-time pace. With --live a page shows the run; with --playground (alone)
# it builds a page on which the arm is pressed, and opens it. Arguments go to the program; `./cmake/demo.sh --help`
# lists them.
set -euo pipefail
cd "$(dirname "$0")/.."
source cmake/install_packages.sh

if [[ "${1:-}" == --playground ]]; then
  install_packages build library examples urdf playground
  cmake --preset release -B build/demo -DSKINCTL_BUILD_TESTS=OFF
  cmake --build build/demo -j "${SKINCTL_JOBS:-2}" --target playground
  page=$PWD/build/demo/examples/playground/page/playground.html
  echo "the playground, one file that needs nothing else: $page ($(stat -c %s "$page") bytes, $(gzip -9c "$page" | wc -c) by gzip)"
  if [[ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]] && command -v xdg-open >/dev/null; then exec xdg-open "$page"; fi
  exit 0
fi
install_packages build library examples urdf
cmake --preset release -B build/demo -DSKINCTL_BUILD_TESTS=OFF
cmake --build build/demo -j "${SKINCTL_JOBS:-2}" --target compliant_ur5
program=build/demo/bin/compliant_ur5
if [[ $# -gt 0 ]]; then exec "$program" "$@"; fi
"$program"
echo
echo "== eight seconds at real-time pace"
exec "$program" --speed 1 --cycles 1000 --report ""
