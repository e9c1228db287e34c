#!/bin/bash
# What scripts/test.sh makes of a run of ctest: count_tests_test.sh SOURCE_FOLDER
cd "$1" || exit 1
. scripts/count_tests.sh
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# counts "PASSED FAILED SKIPPED" as the files output and log of the folder say.
counts() {
  passed=0 failed=0 skipped=0
  count_tests "$folder/output" "$folder/log" 2> "$folder/errors"
  [ "$passed $failed $skipped" = "$1" ] || { echo "expected $1, got $passed $failed $skipped"; exit 1; }
}

cat > "$folder/output" << END
1/4 Test #1: one ......   Passed    0.10 sec
2/4 Test #2: two ......***Failed    0.10 sec
3/4 Test #3: three ....***Skipped   0.10 sec
4/4 Test #4: four .....   Passed    0.10 sec

75% tests passed, 1 tests failed out of 4
END
echo "SKIPPED: no real data at ../shared/data (set HOMOLOG_DATA)" > "$folder/log"
counts "2 1 1"
[ ! -s "$folder/errors" ] || { cat "$folder/errors"; exit 1; }
echo "SKIPPED: no peer: python3-vtk is not installed" > "$folder/log"
counts "2 1 1"
[ ! -s "$folder/errors" ] || { cat "$folder/errors"; exit 1; }
echo "SKIPPED: xdotool is not installed" > "$folder/log"
counts "2 2 0"
grep -q xdotool "$folder/errors" || { echo "the reason is not told"; exit 1; }
echo "No tests were found!!!" > "$folder/output"
: > "$folder/log"
counts "0 1 0"
