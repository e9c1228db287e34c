#!/usr/bin/env bash
# Measures fits and baselines against experts' landmarks: scripts/benchmark-experts.sh FOLDER [OPTIONS of `study experts`]
set -euo pipefail

root=$(cd "$(dirname "$0")/.." && pwd)
homolog=${HOMOLOG:-$root/build/release/homolog}
out=${OUT:-benchmark-experts}
if [ $# -lt 1 ] || [ ! -d "$1" ]; then
  cat >&2 <<USAGE
usage: $0 FOLDER [--templates N] [--shown NAME,NAME] [--flip-mirrored] [--vertices N]

FOLDER holds a surface of each subject, NAME.ply (or .stl, .obj, .vtk, .vtp), and its landmarks, NAME.mrk.json
(or .fcsv, .json). Subjects without landmarks are left out. A file raters.csv with lines LANDMARK,MM may say how far
the raters lie from their consensus. The tables go to the screen and, with the fitted meshes and a picture of the
worst fit, into the folder OUT (else ./benchmark-experts). HOMOLOG names the program (else build/release/homolog).
USAGE
  exit 2
fi
folder=$1
shift

shapes=()
for mesh in "$folder"/*.{ply,stl,obj,vtk,vtp}; do
  name=${mesh%.*}
  if [ -e "$name.mrk.json" ] || [ -e "$name.fcsv" ] || [ -e "$name.json" ]; then shapes+=("$mesh"); fi
done
if [ ${#shapes[@]} -lt 2 ]; then
  echo "$folder: holds fewer than two surfaces NAME.ply with landmarks NAME.mrk.json, .fcsv or .json" >&2
  exit 1
fi
raters=()
if [ -e "$folder/raters.csv" ]; then raters=(--raters "$folder/raters.csv"); fi

report=$("$homolog" study experts "${shapes[@]}" --landmarks "$folder" "${raters[@]}" -o "$out" "$@" --json)
cat "$out/experts.md"

# The worst fit, and beside it point drift to the same subject: the same hue is the same vertex.
worst=$(printf '%s' "$report" | tr -d '\n' | sed -n 's/.*"worst": *{[^}]*"mesh": *"\([^"]*\)".*/\1/p')
if [ -n "$worst" ]; then
  echo
  if "$homolog" picture correspondence "$worst" "${worst%-fit.ply}-drift.ply" -o "$out/worst.png" > /dev/null; then
    echo "Worst fit: $worst, drawn in $out/worst.png (left the fit, right point drift)"
  else
    echo "Worst fit: $worst (no picture of it could be drawn)"
  fi
fi
