#!/usr/bin/env bash
# The one test command, from a bare Debian 12 on: builds the release, then runs the unit tests, the command-line contract, the
# pictures and the real window, checks the formatting, and looks for mistakes with clang-tidy. With --sanitizers also core and
# the editor's state under AddressSanitizer, UndefinedBehaviorSanitizer and ThreadSanitizer, which takes several times as
# long, and fuzzes the readers. With --peers the programs of others that read what Homolog writes are installed too, a browser
# and a Slurm among them.
# Closes with "N passed, N failed, N skipped". Tests on real data are skipped where there is none (HOMOLOG_DATA, else
# ../shared/data); any other test that is skipped counts as failed, since its packages are installed here.
set -uo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
. scripts/count_tests.sh
install_missing $build_packages git xvfb xdotool imagemagick desktop-file-utils xdg-utils clang-format clang-tidy python3-jsonschema python3-numpy python3-pydicom python3-venv python3-pytest || exit 1
[ "${1:-}" != --peers ] || install_missing python3-nibabel python3-h5py python3-vtk9 r-base-core r-cran-vegan chromium snakemake slurmctld slurmd slurm-client munge || exit 1

passed=0 failed=0 skipped=0
# step NAME COMMAND…: one check that passes or fails as a whole.
step() {
  local name=$1 start=$SECONDS good=1; shift
  if "$@"; then passed=$((passed + 1)); else good=0 failed=$((failed + 1)); echo "FAILED: $name" >&2; fi
  echo "-- $name: $((SECONDS - start)) s"
  [ $good = 1 ]
}
# suite PRESET: the preset's ctest, counted test by test.
suite() {
  local preset=$1 start=$SECONDS output
  output=$(mktemp)
  ctest --test-dir "build/$preset" --output-on-failure -j"$(nproc)" 2>&1 | tee "$output" |
    grep -vE '^ *(Start|[0-9]+/[0-9]+ Test .*Passed)'
  count_tests "$output" "build/$preset/Testing/Temporary/LastTest.log"
  rm -f "$output"
  echo "-- tests of $preset: $((SECONDS - start)) s"
}

step "release build" build release && suite release
step "formatting" bash -c 'git ls-files "*.cpp" "*.h" | xargs -r clang-format --dry-run -Werror'
step "clang-tidy" scripts/tidy.sh
if [ "${1:-}" = --sanitizers ]; then
  step "sanitized build (address, undefined)" build debug && suite debug
  step "sanitized build (thread)" build tsan && suite tsan
  step "readers, fuzzed for five seconds each" scripts/fuzz.sh --seconds 5
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" = 0 ]
