#!/usr/bin/env bash
# Looks for mistakes with clang-tidy (its checks: .clang-tidy) in core, render and app. Takes the sources as the release
# build compiles them, several at a time, which is several times faster than one by one. The few that include ITK are
# left out: its headers refuse clang.
set -uo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
install_missing $build_packages clang-tidy || exit 1

mkdir -p build
cmake --preset release -B build/tidy -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON >build/tidy.log 2>&1 || { cat build/tidy.log >&2; exit 1; }
grep -o '"file": "[^"]*/Unity/unity_[0-9]*_cxx.cxx"' build/tidy/compile_commands.json | cut -d'"' -f4 |
  grep -E '/tidy/(core|render|app)/' | sort -u |
  xargs -P "$(nproc)" -n 1 clang-tidy -p build/tidy --quiet --header-filter='/(core|render|app)/' \
    --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-sign-conversion 2>/dev/null
