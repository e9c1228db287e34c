#!/usr/bin/env bash
# Installs what is missing, builds build/release/homolog and runs it with the arguments given (none: homolog demo).
# In a bare Debian 12, as root or with sudo; where the packages are there already, neither root nor the network is needed.
set -euo pipefail
here=$PWD
cd "$(dirname "$0")/.."
. scripts/packages.sh
install_missing $build_packages
build release homolog homolog_pictures >&2
program=$PWD/build/release/homolog
cd "$here"
[ $# -gt 0 ] || set -- demo
exec "$program" "$@"
