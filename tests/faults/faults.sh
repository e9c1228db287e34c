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
stop() { echo "faults: $1" >&2; exit 1; }

# Inputs: two fitted kidneys and their model, a case with a stroke, a study, a cine of two frames.
mkdir "$work/in" && cd "$work/in" || exit 1
for k in 1 2 3; do "$program" phantom kidney --subject $k -o . > /dev/null || stop "no phantom"; done
ln kidney-1-truth.ply a.ply; ln kidney-2-truth.ply b.ply; ln kidney-3-truth.ply c.ply
ln kidney-1-image.nii.gz image.nii.gz; ln kidney-1-labels.nii.gz mask.nii.gz
"$program" study user built-in:kidney --mask mask.nii.gz --pulls 2 -o case.homolog > /dev/null || stop "no case"
"$program" model a.ply b.ply c.ply -o m.h5 > /dev/null || stop "no model"
printf '%s\n' '{"homolog":1,"volume":"image.nii.gz","template":"a.ply","placement":{"rotation":[1,0,0,0],"scale":1,"translation":[0,0,0]}}' \
  '{"tool":"pull","at":[-21,20,-9],"to":[-20,19,-9],"sigma_mm":10}' > imaged.homolog
printf '{"homolog_study":1,"cases":[{"file":"a.ply"},{"file":"b.ply"},{"file":"c.ply"}]}\n' > s.study.json

if [ "$which" = all ]; then
  "$program" phantom ventricle --subject 1 -o . > /dev/null || stop "no cine"
  mv ventricle-1-image.nii.gz cine.nii.gz; mv ventricle-1-truth-00.ply ventricle.ply; rm ventricle-1-*
fi

# A verb, and what it is given. Verbs that take seconds stand behind "slow".
quick=(
  "convert|a.ply old.ply" "convert|a.ply old.vtk" "convert|a.ply old.vtp" "convert|a.ply old.stl" "convert|image.nii.gz old.nrrd"
  "convert|image.nii.gz old.nii.gz" "convert|image.nii.gz old.mha"
  "mirror|a.ply -o old.ply" "label-map|a.ply --like image.nii.gz -o old.nii.gz" "repair-mesh|a.ply -o old.obj"
  "replay|case.homolog -o old.ply" "measure|a.ply b.ply --csv old.csv" "landmarks|a.ply b.ply --vertices -o old.tps"
  "observers|a.ply b.ply --csv old.csv" "model|a.ply b.ply c.ply -o old.h5" "model|a.ply b.ply c.ply -o old.h5.json --csv tables --aligned aligned"
  "evaluate|a.ply b.ply c.ply --samples 2 --csv old.csv" "phantom|kidney --subject 1 -o phantom" "fit|built-in:kidney --mask mask.nii.gz -o old.ply"
  "snap|a.ply --image image.nii.gz -o old.ply" "snap|imaged.homolog -o old.ply" "refine|case.homolog -o old.ply" "sample|-o sample"
)
slow=(
  "template|mask.nii.gz -o old.ply --vertices 300" "study user|built-in:kidney --mask mask.nii.gz --pulls 2 -o old.homolog"
  "fit|built-in:kidney --mask kidney-1-labels.nii.gz kidney-2-labels.nii.gz -o fitted"
  "demo|--headless -o demo" "picture correspondence|a.ply b.ply -o old.png" "picture modes|m.h5 -o old.png"
  "picture case|case.homolog -o old.png" "picture window|case.homolog -o old.png" "picture study|s.study.json -o old.png"
  "propagate|ventricle.ply --image cine.nii.gz --frame 0 -o cine" "study schemes|built-in:kidney --mask mask.nii.gz --schemes anchored --pulls 2 -o tables"
  "model|a.ply b.ply c.ply --optimise -o old.h5.json"
)
# What cannot work on these inputs, or writes nothing: said here, so that a new verb is not forgotten.
elsewhere=(info compare bench edit "study bias" "study experts")

# Every verb of --help is in one of the lists.
leaves() {
  local verb part parts
  for verb in $("$program" "$@" --help | sed '1,/^Subcommands:/d' | awk '/^  [a-z]/ { print $1 }'); do
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
      timeout 120 "$program" $verb $arguments > "$work/out" 2> "$work/err")
    status=$?
    say() { echo "faults: $verb $arguments, call $at of $count fails with error $error (stays: $stays): $1" >&2; bad=$((bad + 1)); }
    said=$(grep -vc '^homolog: warning: ' "$work/err")
    [ $status = 0 ] || [ $status = 1 ] || say "status $status"
    [ $status != 1 ] || { [ "$said" = 1 ] && grep -q '^homolog: ' "$work/err"; } || say "says $said lines: $(head -c 300 "$work/err")"
    while IFS= read -r -d '' file; do
      file=${file#"$work/now/"}
      { [ -f "$work/before/$file" ] && cmp -s "$work/now/$file" "$work/before/$file"; } ||
        { [ -f "$work/whole/$file" ] && cmp -s "$work/now/$file" "$work/whole/$file"; } || say "leaves a part of $file"
    done < <(find "$work/now" -type f -print0)
    (cd "$work/before" && find . -type f) | while IFS= read -r file; do [ -e "$work/now/$file" ] || echo "$file"; done > "$work/gone"
    [ ! -s "$work/gone" ] || say "$(cat "$work/gone") is gone"
    # A batch goes on without the case that failed, and warns.
    [ $status = 1 ] || diff -rq "$work/now" "$work/whole" > "$work/diff" || grep -q '^homolog: warning: .*written' "$work/err" ||
      say "says nothing, but $(head -n 1 "$work/diff")"
  done
  rm -rf "$work/before" "$work/whole"
done
echo "$tried faults, $bad wrong"
[ $bad = 0 ]
