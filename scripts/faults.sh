#!/usr/bin/env bash
# The long trials of docs/reliability.md, which take an hour: every verb and everything in the window that writes, on a disk that fails
# at up to N calls of each (default 32); every verb with devices and pipes; power that fails behind every call of a session; and
# K sessions that are killed (default 200): faults.sh [N [K]]. The tests do the same with a few; what is asked for is said in
# tests/faults.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
install_missing $build_packages
build release homolog homolog_pictures failing_disk disk_tests >&2
HOMOLOG_FAULTS=${1:-32} HOMOLOG_KILLS=${2:-200} build/release/tests/disk_tests --no-skip
tests/faults/devices.sh "$PWD/build/release/homolog" all
exec tests/faults/faults.sh "$PWD/build/release/homolog" "$PWD/build/release/tests/libfailing_disk.so" "${1:-32}" all
