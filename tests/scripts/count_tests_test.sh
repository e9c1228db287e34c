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
# says NUMBER [LINE…]: a test in the log, and what it printed.
says() {
  printf '%s/5 Testing: a test\n%s/5 Test: a test\nOutput:\n' "$1" "$1"
  [ $# = 1 ] || printf '%s\n' "${@:2}"
  printf '<end of output>\n'
}

cat > "$folder/output" << END
1/5 Test #1: one ......   Passed    0.10 sec
2/5 Test #2: two ......***Failed    0.10 sec
3/5 Test #3: three ....***Skipped   0.10 sec
4/5 Test #4: four .....   Passed    0.10 sec
5/5 Test #5: five .....   Passed    0.10 sec

75% tests passed, 1 tests failed out of 5
END
whole='[doctest] test cases: 12 | 11 passed | 1 failed | 821 skipped'
good='[doctest] test cases: 4 | 4 passed | 0 failed | 829 skipped'
data='SKIPPED: no real data at ../shared/data (set HOMOLOG_DATA)'
{ says 1; says 2 "$whole"; says 3 "$data"; says 4 "$data" "$good"; says 5; } > "$folder/log"
counts "16 1 2"
[ ! -s "$folder/errors" ] || { cat "$folder/errors"; exit 1; }

# A process that crashes, and one that has no case.
{ says 1; says 2 "$good"; says 3 "$data"; says 4 '[doctest] test cases: 0 | 0 passed | 0 failed | 833 skipped'; says 5; } > "$folder/log"
counts "6 2 1"
{ says 1; says 2; says 3 'SKIPPED: no peer: python3-vtk is not installed'; says 4; says 5; } > "$folder/log"
counts "3 1 1"
[ ! -s "$folder/errors" ] || { cat "$folder/errors"; exit 1; }
{ says 1; says 2; says 3 'SKIPPED: xdotool is not installed'; says 4 'SKIPPED: no OpenGL' "$good"; says 5; } > "$folder/log"
counts "5 3 0"
grep -q xdotool "$folder/errors" || { echo "the reason is not told"; exit 1; }
echo "No tests were found!!!" > "$folder/output"
: > "$folder/log"
counts "0 1 0"
grep -q "no test was run" "$folder/errors" || { echo "it is not told that nothing was run"; exit 1; }
