#!/usr/bin/env bash
# Fuzzes the readers of files: fuzz.sh [--minutes N | --seconds N] [READER…]. Without READER all, one after the other, each for
# that much of the processor's time (default: one minute). Prints how many files each reader was given, and in how many
# seconds of the processor. A file that makes one crash, hang for a minute or take 2 GB is left in
# build/fuzz/findings/READER; the exit status is 1 then. What is new and sound stays in build/fuzz/corpus/READER, so that the
# next run goes on from there.
set -uo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
seconds=60
while [ $# -gt 0 ]; do
  case $1 in
    --minutes) seconds=$((60 * $2)); shift 2 ;;
    --seconds) seconds=$2; shift 2 ;;
    *) break ;;
  esac
done
install_missing $build_packages clang lld || exit 1
build fuzz fuzz_readers >&2 || exit 1
# Each file is written before it is read: in memory that is five times as fast.
[ -n "${TMPDIR:-}" ] || [ ! -w /dev/shm ] || export TMPDIR=/dev/shm
all=$(ls tests/fuzz/seeds)
status=0
TIMEFORMAT='%U %S'
# run_once READER SECONDS: one run, by the clock. Adds to `files` and `spent`, which is in thousandths of a second.
run_once() {
  local reader=$1 times
  times=$({ time UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1 ASAN_OPTIONS=allocator_may_return_null=1 \
    "build/fuzz/fuzz_$reader" -max_total_time="$2" -timeout=60 -rss_limit_mb=2048 -max_len=65536 -print_final_stats=1 \
    -dict=tests/fuzz/words.dict -artifact_prefix="$findings/" "$corpus" "tests/fuzz/seeds/$reader" > "$log" 2>&1; } 2>&1)
  code=$?
  spent=$((spent + $(awk '{ print int(1000 * ($1 + $2)) }' <<<"$times")))
  files=$((files + $(sed -n 's/^stat::number_of_executed_units: *//p' "$log" | grep . || echo 0)))
  peak=$(sed -n 's/^stat::peak_rss_mb: *//p' "$log")
}
for reader in ${*:-$all}; do
  [ -d "tests/fuzz/seeds/$reader" ] || { echo "fuzz: no reader is called $reader; there are" $all >&2; exit 2; }
  corpus=build/fuzz/corpus/$reader findings=build/fuzz/findings/$reader log=build/fuzz/$reader.log
  mkdir -p "$corpus" "$findings"
  ln -sf fuzz_readers "build/fuzz/fuzz_$reader"
  spent=0 files=0 code=0
  # Where others use the processor too, time by the clock is not time of the processor: so until it has had 98 % of its share,
  # since a further run begins with reading all that was kept.
  while [ $code = 0 ] && [ $spent -lt $((980 * seconds)) ]; do run_once "$reader" $((seconds + 1 - spent / 1000)); done
  printf '%-10s %9d files in %4d s  %5s MB at most\n' "$reader" "$files" $((spent / 1000)) "${peak:-?}"
  if [ $code != 0 ]; then
    status=1
    echo "FINDING in $reader: $(ls "$findings" | tail -n 1)" >&2
    grep -m 3 -E 'ERROR|runtime error|SUMMARY' "$log" >&2
  fi
done
exit $status
