# Sourced by test.sh.

# count_tests OUTPUT LOG: adds up what a ctest run says (its output, and its log with what each test printed) in the variables
# passed, failed and skipped. A run without tests failed; so did a test that is skipped although the packages that test.sh
# installs hold all that it needs: only real data and the libraries of other programs (nibabel, …) may be missing.
count_tests() {
  local output=$1 log=$2 of bad left_out lacking
  of=$(sed -n 's/.*tests failed out of \([0-9]*\).*/\1/p' "$output")
  bad=$(sed -n 's/.*, \([0-9]*\) tests failed out of.*/\1/p' "$output")
  [ "${of:-0}" -gt 0 ] || { of=1 bad=1; echo "FAILED: no test was run" >&2; }
  left_out=$(grep -c '\*\*\*Skipped' "$output")
  lacking=$(grep -a 'SKIPPED: ' "$log" | grep -avcE 'SKIPPED: no (real data|peer: )')
  if [ "$lacking" -gt 0 ]; then
    echo "FAILED: skipped, though its packages are installed:" >&2
    grep -a 'SKIPPED: ' "$log" | grep -avE 'SKIPPED: no (real data|peer: )' >&2
  fi
  [ "$lacking" -le "$left_out" ] || lacking=$left_out
  passed=$((passed + of - bad - left_out)) failed=$((failed + bad + lacking)) skipped=$((skipped + left_out - lacking))
}
