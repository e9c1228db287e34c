#!/usr/bin/env bash
# Every verb that writes, on a disk that fails at up to N calls of each (default 32, which is about a thousand faults and takes
# half an hour): faults.sh [N]. The tests do the same with a few (tests/faults/faults.sh says what is asked for).
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
install_missing $build_packages
build release homolog homolog_pictures failing_disk >&2
exec tests/faults/faults.sh "$PWD/build/release/homolog" "$PWD/build/release/tests/libfailing_disk.so" "${1:-32}" all
