#!/usr/bin/env bash
# outside.sh SOURCE BUILD: installs the library into a folder of its own, builds the examples against it and runs them.
# Then looks whether the installed libraries define a function of the C library, which would change the programs that
# link them.
set -euo pipefail
source=$1 build=$2
# Each line of the page's examples is one of the programs'.
awk '/^```cpp/ { inside = 1; next } /^```/ { inside = 0 } inside && NF' "$source/docs/library.md" |
  while IFS= read -r line; do
    grep -qF -- "$line" "$source"/examples/*.cpp || { echo "examples/ lack: $line"; exit 1; }
  done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/prefix" --component development >"$work/log" || { cat "$work/log"; exit 1; }
for part in "include/homolog/core/case/document.h" "lib/cmake/homolog/homologConfig.cmake"; do
  [ -f "$work/prefix/$part" ] || { echo "$part was not installed"; exit 1; }
done
if nm --defined-only "$work"/prefix/lib/homolog/*.a | grep -wE 'T (s?rand|random|srandom|malloc|free)'; then
  echo "The libraries define functions of the C library."
  exit 1
fi
cmake -S "$source/examples" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_CXX_FLAGS=-O1 >"$work/log" 2>&1 &&
  cmake --build "$work/build" -j2 >>"$work/log" 2>&1 || { tail -40 "$work/log"; exit 1; }
ctest --test-dir "$work/build" --output-on-failure
