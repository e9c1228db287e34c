#!/usr/bin/env bash
# Says whether two builds of the program give the same results, to the last byte:
#   same_bytes.sh record BINARY FOLDER     makes all results in a new folder, and the list FOLDER/HASHES of them
#   same_bytes.sh compare BINARY BINARY    makes them with both, and names those that differ
#   same_bytes.sh check BINARY HASHES      makes them, and names those that differ from such a list
# The exit status is 1 where results differ or a command went wrong. Results of `compare` and `check` that differ are kept.
# The cases and all that they need are in tests/cases/before. Hashes hold for one machine and one compiler: make the list
# before a change, on the machine on which it is checked. HOMOLOG_THREADS=1 has to give the same list.
set -euo pipefail
export LC_ALL=C
source_folder=$(cd "$(dirname "$0")/.." && pwd)

usage() {
  sed -n '2,4s/^# *//p' "$0" >&2
  exit 2
}

# note_run NAME STATUS: keeps what a command said in out/reports, without the seconds that it took, and its exit status.
note_run() {
  {
    sed '/"seconds":/d' "said.$lane"
    [ ! -s "warned.$lane" ] || sed 's/^/stderr: /' "warned.$lane"
    echo "exit status $2"
  } > "out/reports/$1.txt"
}

# run NAME VERB…: one command that has to succeed. Its report gets the name.
run() {
  local name=$1 status=0
  shift
  "$binary" "$@" --json > "said.$lane" 2> "warned.$lane" || status=$?
  [ $status = 0 ] || { echo "same_bytes: homolog $*: $(head -n 1 "warned.$lane")"; echo "$name" >> went_wrong; } >&2
  note_run "$name" $status
}

# refuse NAME VERB…: one command that has to fail. What it says is a result too.
refuse() {
  local name=$1 status=0
  shift
  "$binary" "$@" --json > "said.$lane" 2> "warned.$lane" || status=$?
  [ $status = 1 ] || { echo "same_bytes: homolog $*: exit status $status"; echo "$name" >> went_wrong; } >&2
  note_run "$name" $status
}

# probe CASE LINES NAME: a case of the first lines of another, with 512 steps more that change no shape. So its next edit writes
# a checkpoint, and that holds all that the document has.
probe() {
  { head -n "$2" "$1"; cat many_steps; } > "in/$3.homolog"
  run "$3" refine "in/$3.homolog"
  mv "in/$3.homolog" out/probes/
}

# Every case: what it is, the mesh of each frame, the mesh after every third line, and a checkpoint in the middle and at the end.
cases() {
  local file name lines frame every frames
  for file in in/*.homolog; do
    name=$(basename "$file" .homolog)
    run "$name-info" info "$file"
    frames=$(tr -d ' \n' < "out/reports/$name-info.txt" | sed 's/.*"frames_with_mesh":\[\([0-9,]*\)\].*/\1/; s/,/ /g')
    for frame in $frames; do
      run "$name-frame-$frame" replay "$file" --frame "$frame" -o "out/cases/$name-frame-$frame.ply"
    done
    lines=$(wc -l < "$file") every=3
    case $name in
      torn) continue ;;
      built-in | checkpoint*) every=$lines ;;  # slow to open, or long
    esac
    for ((k = 2; k < lines && every < lines; k += every)); do
      head -n "$k" "$file" > in/begun.case.homolog
      run "$name-line-$k" replay in/begun.case.homolog -o "out/cases/$name-line-$k.ply"
    done
    rm -f in/begun.case.homolog
    [ "$name" = built-in ] || probe "$file" "$lines" "$name-at-end"
    [ "$every" = "$lines" ] || probe "$file" $((lines / 2)) "$name-half-way"
  done
  for file in in/refused/*.homolog; do
    refuse "refused-$(basename "$file" .homolog)" replay "$file" -o out/cases/refused.ply
  done
}

# What else is done with cases: options of replay, snaps, models, measures, pictures.
with_cases() {
  local name
  run strokes-paper replay in/strokes.homolog --scheme paper --events 3 -o out/verbs/strokes-paper.ply
  run strokes-raw replay in/strokes.homolog --scheme raw --spacing 1 -o out/verbs/strokes-raw.ply
  run cine-anchored replay in/cine.homolog --scheme anchored --spacing 0.5 --frame 2 -o out/verbs/cine-anchored.vtp
  for name in cine tube-cine snapped confirmed user; do
    cp in/$name.homolog in/$name.snap.homolog
    run "snap-$name" snap in/$name.snap.homolog --reach-mm 6 -o "out/verbs/snap-$name.vtk"
    mv in/$name.snap.homolog "out/verbs/snap-$name.homolog"
  done
  cp in/cine.homolog in/cine.part.homolog
  run snap-part snap in/cine.part.homolog --at 15,0,4 --sigma-mm 8 --strength 0.7 --polarity bright-inside
  mv in/cine.part.homolog out/verbs/snap-part.homolog
  local shapes=(in/strokes.homolog in/stiffness.homolog in/regions.homolog in/landmarks.homolog in/confirmed.homolog
    in/points.homolog in/partial.homolog in/snapped.homolog in/user.homolog in/checkpoint.homolog in/checkpoint-told.homolog)
  run model-of-cases model "${shapes[@]}" -o out/verbs/cases.h5.json --csv out/verbs/cases-csv/ --aligned out/verbs/aligned/
  run model-of-mirrored model "${shapes[@]}" in/mirrored.homolog --flip-mirrored --without-doubtful -o out/verbs/flipped.h5.json
  run model-of-cine model in/cine.homolog --all-frames --keep-scale -o out/verbs/cine.h5.json
  run optimised model "${shapes[@]:0:6}" --optimise --optimised out/verbs/optimised/ -o out/verbs/optimised.h5.json
  run evaluate-cases evaluate "${shapes[@]}" --samples 50 --csv out/verbs/evaluate.csv
  run evaluate-cine evaluate in/cine.homolog --all-frames --no-align --samples 50 --modes all
  run measure measure "${shapes[@]}" --csv out/verbs/measure.csv
  run measure-cine measure in/tube-cine.homolog --all-frames
  run landmarks-tps landmarks "${shapes[@]:0:4}" -o out/verbs/landmarks.tps
  run landmarks-csv landmarks in/cine.homolog --all-frames --vertices -o out/verbs/vertices.csv
  run compare-cases compare in/strokes.homolog --mesh in/stiffness.homolog
  run compare-mask compare in/partial.homolog --mask in/organ-2-cut.nii.gz
  run info-mask info in/organ.ply --mask in/organs/organ-1.nii.gz
  run label-map label-map in/tube.ply --like in/heart.nii.gz -o out/verbs/tube.nii.gz
  run mirror mirror in/organ.ply -o out/verbs/mirrored.ply
  run study-user study user in/organ.ply --mask in/organs/organ-3.nii.gz --landmarks in/landmarks/organ-3.mrk.json --pulls 15 \
    --scheme anchored+warp+refine -o out/verbs/study-user.homolog
  run study-make study make in/organs --template in/organ.ply -o out/verbs/made.study.json
  run picture-case picture case in/cine.homolog --size 400x300 --captions -o out/verbs/picture-case.png
  run picture-partial picture case in/partial.homolog --size 400x300 --view left -o out/verbs/picture-partial.png
  run picture-window picture window in/confirmed.homolog --size 800x600 -o out/verbs/picture-window.png
  run picture-told picture window in/checkpoint-told.homolog --size 800x600 -o out/verbs/picture-told.png
  run picture-coronal picture window in/tube-cine.homolog --only coronal --captions --size 300x300 -o out/verbs/picture-coronal.png
  run picture-shapes picture correspondence "${shapes[@]:0:4}" --size 500x300 -o out/verbs/picture-shapes.png
  run picture-modes picture modes out/verbs/cases.h5.json --size 500x300 --ground light -o out/verbs/picture-modes.png
}

# Phantoms, fits, templates, a propagated cine.
fits() {
  local phantoms=out/phantoms
  run phantom-1 phantom kidney --subject 1 -o $phantoms
  run phantom-2 phantom kidney --subject 2 -o $phantoms
  run phantom-3 phantom vertebra --subject 1 -o $phantoms
  run phantom-4 phantom ventricle --subject 1 -o $phantoms
  run fit-kidneys fit built-in:kidney --mask $phantoms/kidney-1-labels.nii.gz $phantoms/kidney-2-labels.nii.gz -o out/fits/kidneys/
  run fit-closing fit in/organ.ply --mask in/organs/organ-3.nii.gz --closing-mm 3 -o out/fits/closing.ply
  run fit-landmarks fit built-in:kidney --mask $phantoms/kidney-2-labels.nii.gz --landmarks $phantoms/kidney-2-landmarks.mrk.json \
    -o out/fits/landmarks.ply
  run model-kidneys model out/fits/kidneys -o out/fits/kidneys.h5.json
  run model-h5 model out/fits/kidneys -o out/fits/kidneys.h5
  run info-h5 info out/fits/kidneys.h5
  run fit-model fit built-in:kidney --mask $phantoms/kidney-1-labels.nii.gz --model out/fits/kidneys.h5.json --beyond 0.5 \
    -o out/fits/model.ply
  run fit-image fit built-in:kidney --image $phantoms/kidney-1-image.nii.gz --landmarks $phantoms/kidney-1-landmarks.mrk.json \
    -o out/fits/image.ply
  run fit-surface fit built-in:vertebra --mesh $phantoms/vertebra-1-truth.ply -o out/fits/surface.ply
  run fit-ventricle fit built-in:ventricle --mask $phantoms/ventricle-1-labels.nii.gz --label 1 --frame 3 -o out/fits/ventricle.ply
  run fit-mirror fit in/organ.ply --mask in/organ-3-mirrored.nii.gz --mirror -o out/fits/mirror.ply
  run fit-other-side fit in/organ.ply --mask in/organ-3-mirrored.nii.gz --landmarks in/landmarks/organ-3-mirrored.mrk.json \
    -o out/fits/other-side.ply
  run fit-partial fit in/organ.ply --mask in/organ-2-cut.nii.gz in/organs/organ-4.nii.gz --landmarks in/landmarks --partial \
    -o out/fits/partial/
  run fit-any fit in/organ.ply --mask in/organs/organ-4.nii.gz --orientation any -o out/fits/any.ply
  run fit-cohort fit in/organ.ply --mask in/organs --by-others 1 -o out/fits/cohort/
  run fit-two-sheets fit in/tube.ply --mask in/heart-labels.nii.gz --label 1,2 --frame 2 -o out/fits/two-sheets.ply
  run fit-cine fit in/cavity.ply --mask in/heart-labels.nii.gz --label 1 --frame 3 -o out/fits/cine/
  run evaluate-study evaluate out/fits/cohort/cohort.study.json --samples 50
  run model-study model out/fits/cohort/cohort.study.json --optimise --optimised out/fits/slid/ -o out/fits/slid.h5.json
  run observers observers out/fits/cohort out/fits/slid --csv out/fits/observers.csv
  run picture-study picture study out/fits/cohort/cohort.study.json --size 800x600 -o out/fits/picture-study.png
  run template template in/organs/organ-2.nii.gz --vertices 400 --closing-mm 1 --landmarks in/landmarks/organ-2.mrk.json -o out/templates/organ.ply
  run template-tube template in/heart-labels.nii.gz --tube --rings 9 --sectors 16 --label 1 --outer-label 2 --frame 1 \
    -o out/templates/tube.ply
  run template-surface template $phantoms/vertebra-1-truth.ply --vertices 500 -o out/templates/surface.ply
  run consensus template --consensus in/organs/organ-1.nii.gz in/organs/organ-2.nii.gz --vertices 200 \
    -o out/templates/consensus.ply
  run propagate propagate in/cavity.ply --image in/heart.nii.gz --frame 0 -o out/fits/beat/
  run propagate-tube propagate in/tube.ply --image in/heart.nii.gz --frame 2 --reach-mm 8 -o out/fits/tube-beat/
  run snap-mesh snap out/fits/kidneys/kidney-2-labels.ply --image $phantoms/kidney-2-image.nii.gz -o out/fits/snapped.ply
}

# record BINARY FOLDER
record() {
  binary=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
  [ -f "$binary" ] || { echo "same_bytes: $1 is no program" >&2; exit 2; }
  mkdir -p "$2"
  [ -z "$(ls -A "$2")" ] || { echo "same_bytes: $2 is not empty" >&2; exit 2; }
  cd "$2"
  mkdir -p home out/reports out/cases out/probes out/verbs out/phantoms out/fits out/templates
  cp -R "$source_folder/tests/cases/before" in
  for ((k = 0; k < 512; ++k)); do echo '{"spacing":0.25}'; done > many_steps
  # Nothing of the user's, no display, no clock.
  export HOME=$PWD/home XDG_STATE_HOME=$PWD/home XDG_CONFIG_HOME=$PWD/home XDG_CACHE_HOME=$PWD/home TZ=UTC
  unset DISPLAY WAYLAND_DISPLAY SOURCE_DATE_EPOCH HOMOLOG_DATA
  # Two at a time: most of it is one thread's work. They read the same files and write different ones.
  { lane=cases; cases; with_cases; } &
  local other=$!
  lane=fits; fits
  wait $other
  (cd out && find . -type f | sed 's#^\./##' | sort | xargs sha256sum) > HASHES
  [ ! -e went_wrong ] || { echo "same_bytes: $(wc -l < went_wrong) commands went wrong" >&2; return 1; }
}

# differences HASHES HASHES: names what differs; false where anything does.
differences() {
  local found
  found=$(awk 'NR == FNR { before[substr($0, 67)] = $1; next }
    { name = substr($0, 67) }
    !(name in before) { print "new:     " name; next }
    before[name] != $1 { print "differs: " name }
    { delete before[name] }
    END { for (name in before) print "missing: " name }' "$1" "$2" | sort)
  [ -z "$found" ] || { echo "$found"; return 1; }
  echo "the same bytes: $(wc -l < "$2") results"
}

case ${1:-} in
  record)
    [ $# = 3 ] || usage
    record "$2" "$3"
    echo "$(wc -l < HASHES) results in $3"
    ;;
  compare | check)
    [ $# = 3 ] || usage
    folder=$(mktemp -d)
    status=0
    if [ "$1" = compare ]; then
      (record "$2" "$folder/a") || status=1
      (record "$3" "$folder/b") || status=1
      differences "$folder/a/HASHES" "$folder/b/HASHES" || status=1
    else
      (record "$2" "$folder/a") || status=1
      differences "$3" "$folder/a/HASHES" || status=1
    fi
    if [ $status = 0 ]; then rm -rf "$folder"; else echo "same_bytes: the results are in $folder" >&2; fi
    exit $status
    ;;
  *) usage ;;
esac
