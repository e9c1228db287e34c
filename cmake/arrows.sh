#!/bin/sh
# arrows.sh SOURCE_FOLDER FOLDER USED…: fails where a file of FOLDER includes one of the project that is neither of FOLDER
# nor among the USED: folders, or single headers.
cd "$1" || exit 1
folder=$2
shift
allowed=$(printf '%s|' "$@")
bad=$(grep -rnoE '#include "(core|render|app)/[^"]*' --include=*.h --include=*.cpp "$folder" |
  grep -vE "\"(${allowed%|})(/|\$)" | sed "s|\$|\": $folder does not use it|")
[ -z "$bad" ] || { echo "$bad" >&2; exit 1; }
