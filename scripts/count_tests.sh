# Sourced by test.sh.

# count_tests OUTPUT LOG: adds up what a ctest run says (its output, and its log with what each test printed) in the variables
# passed, failed and skipped. A process of doctest counts by its cases; one that ends badly without a case that failed, or
# that has no case, is one failure. A run without tests failed; so did a test that is skipped although the packages that
# test.sh installs hold all that it needs: only real data and the libraries of other programs (nibabel, …) may be missing.
count_tests() {
  local output=$1 log=$2 sums lacking
  sums=$(awk '
    function close_test() {
      if (number == "") return
      ++run
      bad = (number in failed_here)
      if (!cases_told) {
        skips = (number in skipped_here)
        if (bad) ++failed; else if (!skips) ++passed
      } else {
        if (cases_failed == 0 && (bad || cases_passed == 0)) ++cases_failed
        if (skips > cases_passed) skips = cases_passed
        passed += cases_passed - skips; failed += cases_failed
      }
      if (lacking > skips) lacking = skips
      failed += lacking; skipped += skips - lacking
      number = ""
    }
    FNR == NR {
      if (match($0, /Test +#[0-9]+:/)) {
        which = substr($0, RSTART, RLENGTH); gsub(/[^0-9]/, "", which)
        if (/\*\*\*Skipped/) skipped_here[which]
        else if (/\*\*\*/) failed_here[which]
      }
      next
    }
    /^[0-9]+\/[0-9]+ Testing: / { close_test(); number = $1; sub("/.*", "", number); skips = lacking = cases_told = 0 }
    /SKIPPED: / { ++skips; if (!/SKIPPED: no (real data|peer: )/) ++lacking }
    /^\[doctest\] test cases:/ { cases_told = 1; split($0, part, "|"); cases_passed = part[2] + 0; cases_failed = part[3] + 0 }
    END { close_test(); if (!run) failed = 1; print passed + 0, failed + 0, skipped + 0, run + 0 }' "$output" <(cat -v "$log"))
  set -- $sums
  [ "$4" -gt 0 ] || echo "FAILED: no test was run" >&2
  lacking=$(grep -a 'SKIPPED: ' "$log" | grep -avE 'SKIPPED: no (real data|peer: )')
  [ -z "$lacking" ] || printf 'FAILED: skipped, though its packages are installed:\n%s\n' "$lacking" >&2
  passed=$((passed + $1)) failed=$((failed + $2)) skipped=$((skipped + $3))
}
