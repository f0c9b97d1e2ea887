#!/usr/bin/env bash
# Does what examples/README.md tells its reader to do: writes the files, runs the commands, and compares what they print with what the
# page shows. Fails where a command fails or prints something else.
#
#     cmake/run_tutorial.sh [--install] FOLDER     FOLDER is emptied first
#
# A block belongs to the file named by the line above it, as **`my_arm/arm.hpp`**; several blocks of a file follow each other. Blocks of sh
# are commands; a block of text behind one is what it prints. Commands that install packages are left out without --install.
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
install=no
if [[ ${1:-} == --install ]]; then
  install=yes
  shift
fi
work=${1:?the folder to work in}
rm -rf "$work"
mkdir -p "$work"
cd "$work"
ln -s "$top" skinctl

file="" language="" block="" printed="" commands=0 files=0 compared=0
run() {
  if [[ $block == *apt-get* && $install == no ]]; then return; fi
  printf '%s' "$block" | sed 's/^/$ /'
  if ! printed=$(bash -euo pipefail -c "$block" 2>&1); then
    printf '%s\n' "$printed"
    echo "tutorial: this command failed" >&2
    exit 1
  fi
  printf '%s\n' "$printed"
  commands=$((commands + $(printf '%s' "$block" | grep -c .)))
}
end_of_block() {
  case $language in
    sh) run ;;
    text)
      if [[ $printed != "${block%$'\n'}" ]]; then
        echo "tutorial: the page shows" >&2
        printf '%s' "$block" >&2
        exit 1
      fi
      compared=$((compared + 1))
      ;;
    *)
      if [[ -z $file ]]; then
        echo "tutorial: a block of $language without the name of its file" >&2
        exit 1
      fi
      mkdir -p "$(dirname "$file")"
      printf '%s' "$block" >>"$file"
      files=$((files + 1))
      ;;
  esac
}
started=no
while IFS= read -r line; do
  if [[ $line == "<!-- tutorial -->" ]]; then started=yes; fi
  if [[ $line == "<!-- /tutorial -->" ]]; then started=no; fi
  if [[ $started == no ]]; then continue; fi
  if [[ -z $language ]]; then
    if [[ $line =~ ^\*\*\`([^\`]+)\`\*\* ]]; then file=${BASH_REMATCH[1]}; fi
    if [[ $line =~ ^\`\`\`([a-z]+)$ ]]; then language=${BASH_REMATCH[1]} block=""; fi
  elif [[ $line == '```' ]]; then
    end_of_block
    if [[ $language != sh && $language != text ]]; then file=""; fi
    language=""
  else
    block+=$line$'\n'
  fi
done <"$top/examples/README.md"
if [[ $started == yes || -n $language || $files -eq 0 || $commands -eq 0 || $compared -eq 0 ]]; then
  echo "tutorial: the page has no beginning, no end, no file, no command or no result" >&2
  exit 1
fi
echo "tutorial: $(cat my_*/* | wc -l) lines in $files blocks of files, $commands lines of commands, $compared results as the page shows them"
times >times  # not in a pipe: that would be another shell's
echo "tutorial: processor time, user and system: $(tail -n 1 times)"
