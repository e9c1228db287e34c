#!/bin/bash
# Every verb that writes, on a disk that fails: faults.sh PROGRAM FAILING_DISK MOST [all|sample]. For each verb the disk fails at up to
# MOST of the calls by which it changes files, spread evenly, with each of three errors in turn. Afterwards every file is what
# it was or what the whole run makes of it, nothing else is left, and the program has said one line with status 1, or done
# its work with status 0. `all`: also the verbs that take seconds; `sample`: only a few. Closes with the number of faults.
set -u
program=$1 library=$2 most=$3 which=${4:-quick}
export LC_ALL=C
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export HOME=$work XDG_STATE_HOME=$work/state XDG_CONFIG_HOME=$work/config
unset DISPLAY WAYLAND_DISPLAY

. "$(dirname "${BASH_SOURCE[0]}")/verbs.sh"

# Every verb of --help is in one of the lists.
leaves() {
  local verb part parts
  for verb in $("$program" "$@" --help | sed '1,/^Subcommands:/d; /^Examples:/,$d' | awk '/^  [a-z]/ { print $1 }'); do
    parts=$("$program" "$@" "$verb" --help | grep -c '^Subcommands:')
    if [ "$parts" -gt 0 ]; then leaves "$@" "$verb"; else echo "${*:+$* }$verb"; fi
  done
}
while read -r verb; do
  printf '%s\n' "${quick[@]}" "${slow[@]}" | grep -q "^$verb|" || printf '%s\n' "${elsewhere[@]}" | grep -qx "$verb" || stop "the verb '$verb' is in no list of faults.sh"
done < <(leaves)

jobs=("${quick[@]}")
[ "$which" = sample ] && jobs=("${quick[0]}" "${quick[5]}" "${quick[10]}" "${quick[12]}" "${quick[14]}" "${quick[15]}" "${quick[17]}" "${quick[20]}")
[ "$which" = all ] && jobs+=("${slow[@]}")
errors=(28 5 13)  # ENOSPC, EIO, EACCES
tried=0 bad=0 turn=0
# fresh: the folder as it is before a run, with an older file in the place of each result.
fresh() {
  rm -rf "$work/now" && cp -r "$work/in" "$work/now" || exit 1
  for word in $1; do case $word in old.*) echo "an older file" > "$work/now/$word" ;; esac; done
}
for job in "${jobs[@]}"; do
  verb=${job%%|*} arguments=${job#*|}
  fresh "$arguments"
  cp -r "$work/now" "$work/before"
  # shellcheck disable=SC2086
  (cd "$work/now" && FAULT_FOLDER=$work/now FAULT_COUNT=$work/count LD_PRELOAD=$library "$program" $verb $arguments > "$work/out" 2> "$work/err")
  status=$?
  if [ $status != 0 ]; then
    grep -q OpenGL "$work/err" && { rm -rf "$work/before"; continue; }
    echo "faults: $verb $arguments does not work: $(cat "$work/err")" >&2; bad=$((bad + 1)); rm -rf "$work/before"; continue
  fi
  mv "$work/now" "$work/whole"
  count=$(cat "$work/count") steps=$most
  [ "$count" -gt 0 ] || stop "$verb $arguments writes nothing"
  [ "$steps" -le $((count * 3)) ] || steps=$((count * 3))
  for ((k = 0; k < steps; ++k)); do
    at=$((1 + (k * count / steps + turn) % count)) error=${errors[turn % 3]} stays=$((turn / 3 % 2))
    turn=$((turn + 1)) tried=$((tried + 1))
    fresh "$arguments"
    # shellcheck disable=SC2086
    (cd "$work/now" && FAULT_FOLDER=$work/now FAULT_AT=$at FAULT_ERRNO=$error FAULT_STAYS=$stays LD_PRELOAD=$library \
      timeout 600 "$program" $verb $arguments > "$work/out" 2> "$work/err")
    status=$?
    say() { echo "faults: $verb $arguments, call $at of $count fails with error $error (stays: $stays): $1" >&2; bad=$((bad + 1)); }
    said=$(grep -vc '^homolog: warning: ' "$work/err")
    [ $status = 0 ] || [ $status = 1 ] || say "status $status"
    [ $status != 1 ] || { [ "$said" = 1 ] && grep -q '^homolog: ' "$work/err"; } || say "says $said lines: $(head -c 300 "$work/err")"
    while IFS= read -r -d '' file; do
      file=${file#"$work/now/"}
      # A model's file holds the time at which it was made.
      case $file in *.h5 | *.h5.json) "$program" info "$work/now/$file" > /dev/null 2>&1 && continue ;; esac
      { [ -f "$work/before/$file" ] && cmp -s "$work/now/$file" "$work/before/$file"; } ||
        { [ -f "$work/whole/$file" ] && cmp -s "$work/now/$file" "$work/whole/$file"; } || say "leaves a part of $file"
    done < <(find "$work/now" -type f -print0)
    (cd "$work/before" && find . -type f) | while IFS= read -r file; do [ -e "$work/now/$file" ] || echo "$file"; done > "$work/gone"
    [ ! -s "$work/gone" ] || say "$(cat "$work/gone") is gone"
    # A batch goes on without the case that failed, and warns.
    [ $status = 1 ] || diff -rq -x "*.h5" -x "*.h5.json" "$work/now" "$work/whole" > "$work/diff" || grep -q '^homolog: warning: .*written' "$work/err" ||
      say "says nothing, but $(head -n 1 "$work/diff")"
  done
  rm -rf "$work/before" "$work/whole"
done
echo "$tried faults, $bad wrong"
[ $bad = 0 ]
