#!/usr/bin/env bash
# Do the tests see? Puts small faults (tests/mutants/mutants.txt: a sign, an order, a constant, a comparison) into a copy of
# the sources under build/mutants, each behind a switch, builds that once, and runs the quick tests under each fault: those near
# it first, then the rest, until one fails. mutants.sh [--only N,M] [--group NAME] [--list] [--jobs N] [--built]. Prints a line
# for each fault and counts by group; the exit status is 1 where a fault was not seen. Tests on real data are not run.
set -euo pipefail
cd "$(dirname "$0")/.."
exec python3 tests/mutants/mutants.py "$@"
