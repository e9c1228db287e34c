#!/usr/bin/env bash
# Looks for mistakes with clang-tidy (its checks: .clang-tidy) in core, render and app; fails where it finds one. Takes all
# sources of a folder at a time, since headers cost most of the time. Folders in which nothing changed since they were clean
# are passed over; --all looks at them too. The few sources that include ITK are left out: its headers refuse clang.
set -uo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
install_missing $build_packages clang-tidy || exit 1
[ "${1:-}" != --all ] || rm -rf build/tidy/clean

mkdir -p build/tidy/clean
cmake --preset release -B build/tidy -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=0 >build/tidy.log 2>&1 ||
  { cat build/tidy.log >&2; exit 1; }

# tidy UNIT: a source that includes all of a folder. What it was clean with: a hash of every file of ours that it includes.
tidy() {
  local unit=$1 clean state
  clean=build/tidy/clean/$(basename "$(dirname "$(dirname "$unit")")" .dir)
  state=$({ cat .clang-tidy; clang-tidy --version
            g++ -MM -MG -std=c++20 -I . "$unit" | tr -s ' \\' '\n' | grep -E '^(/.*/)?(core|render|app)/' | sort -u | xargs cat; } 2>/dev/null | sha256sum)
  [ "$(cat "$clean" 2>/dev/null)" != "$state" ] || return 0
  clang-tidy -p build/tidy --quiet --header-filter='/(core|render|app)/' --extra-arg=-Wno-unknown-warning-option \
    --extra-arg=-Wno-sign-conversion "$unit" 2>/dev/null || return 1
  echo "$state" >"$clean"
}
export -f tidy

grep -o '"file": "[^"]*/Unity/unity_[0-9]*_cxx.cxx"' build/tidy/compile_commands.json | cut -d'"' -f4 |
  grep -E '/tidy/(core|render|app)/' | sort -u | xargs ls -S | xargs -P "$(nproc)" -I{} bash -c 'tidy "$1"' tidy {}
