#!/bin/sh
# arrows.sh SOURCE_FOLDER FOLDER USED…: fails where a file of FOLDER includes one of a folder of the project that is
# neither itself nor among the USED.
cd "$1" || exit 1
folder=$2
shift 2
allowed="^$folder(/|$)"
for used in "$@"; do allowed="$allowed|^$used(/|$)"; done
bad=$(grep -rnoE '#include "(core|render|app)/[^"]*/' --include=*.h --include=*.cpp "$folder" | while IFS= read -r line; do
  included=${line##*\"}
  echo "${included%/}" | grep -qE "$allowed" || echo "$line\": $folder does not use ${included%/}"
done)
[ -z "$bad" ] || { echo "$bad" >&2; exit 1; }
