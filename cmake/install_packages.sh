# Sourced by test.sh and demo.sh: installs the Debian packages of the named groups of packages.txt that are missing.
install_packages() {
  local group name packages missing=()
  if ! command -v apt-get >/dev/null; then
    echo "skinctl: no apt-get here, so nothing is installed; cmake/packages.txt lists what is needed"
    return
  fi
  while read -r group packages; do
    [[ " $* " == *" $group "* ]] || continue
    for name in $packages; do
      if [[ $(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null) != installed ]]; then missing+=("$name"); fi
    done
  done <cmake/packages.txt
  if [[ ${#missing[@]} -eq 0 ]]; then return; fi

  local as_root=()
  if [[ $(id -u) -ne 0 ]]; then as_root=(sudo); fi
  echo "skinctl: installing ${missing[*]}"
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
}

# phase NAME COMMAND...: runs it, says how long it took, and returns what it returned.
phase() {
  local name=$1 start=$SECONDS status=0
  shift
  echo "== $name"
  "$@" || status=$?
  echo "== $name: $((SECONDS - start)) s"
  return $status
}
