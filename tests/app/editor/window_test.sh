#!/bin/bash
# The window on a display of its own, used as a user would: window_test.sh PROGRAM. Exit status 77: skipped.
set -u
program=$1
for tool in Xvfb xdotool import identify; do
  command -v "$tool" > /dev/null || { echo "SKIPPED: $tool is not installed"; exit 77; }
done

folder=$(mktemp -d)
leave() {
  kill "${window_pid:-}" "${display_pid:-}" 2> /dev/null
  wait 2> /dev/null
  rm -rf "$folder"
}
trap leave EXIT
export HOME=$folder XDG_CONFIG_HOME=$folder/config XDG_STATE_HOME=$folder/state XDG_DATA_HOME=$folder/data
export LIBGL_ALWAYS_SOFTWARE=1

failed() {
  echo "window_test: $1"
  cat "$folder/stderr" 2> /dev/null
  exit 1
}
# eventually "what is expected" COMMAND…: waits until the command is true.
eventually() {
  local expected=$1
  shift
  for _ in $(seq 300); do
    "$@" && return
    sleep 0.1
  done
  failed "after 30 s still not: $expected"
}
case_file() { ls "$XDG_STATE_HOME"/homolog/*.homolog 2> /dev/null | head -n 1; }
exists() { [ -s "$1" ]; }
has_case() { [ -n "$(case_file)" ]; }
no_case() { [ -z "$(case_file)" ]; }
# in_case COUNT PATTERN: that many lines of the case match.
in_case() { [ "$(grep -c "$2" "$case")" -eq "$1" ]; }
gone() { ! kill -0 "$1" 2> /dev/null; }
colours() { import -window root "$folder/now.png" && identify -format %k "$folder/now.png"; }
shows_images() { [ "$(colours)" -gt 2000 ]; }
view() { import -window root -crop "$1" "$folder/view.png" && identify -format '%#' "$folder/view.png"; }
differs() { [ "$(view "$1")" != "$2" ]; }
# drag FROM TO: x,y of the window, in steps, as a hand does.
drag() {
  local x0=${1%,*} y0=${1#*,} x1=${2%,*} y1=${2#*,}
  xdotool mousemove "$x0" "$y0" mousedown 1
  for step in 1 2 3 4 5 6 7 8; do
    xdotool mousemove $((x0 + (x1 - x0) * step / 8)) $((y0 + (y1 - y0) * step / 8)) sleep 0.02
  done
  xdotool mouseup 1
}

Xvfb -displayfd 3 -screen 0 1280x800x24 -nolisten tcp 3> "$folder/display" 2> /dev/null &
display_pid=$!
eventually "a display" exists "$folder/display"
DISPLAY=:$(cat "$folder/display")
export DISPLAY

"$program" 2> "$folder/stderr" &
window_pid=$!
eventually "the demo case is open" has_case
case=$(case_file)
eventually "four views with an image" shows_images

axial=440x320+52+76
drag 287,541 281,517  # as the guide says
eventually "the drag is in the case" in_case 1 '"tool":"pull"'

before=$(view $axial)
xdotool mousemove 400 200 click --repeat 4 --delay 30 4
eventually "the wheel shows another slice" differs $axial "$before"
xdotool click --repeat 4 --delay 30 5

xdotool key 1
drag 260,682 263,698
eventually "a smaller reach after the key 1" in_case 1 '"sigma_mm":3\.'

xdotool key ctrl+z
eventually "undo is in the case" in_case 1 '"undo"'

# Typed faster than the window draws: nothing is lost, and nothing gets ahead of the dialog.
saved() { exists "$folder/saved.homolog"; }
xdotool key ctrl+shift+s key ctrl+a type --delay 2 "$folder/saved"
xdotool key Return
eventually "the case is saved" saved
eventually "the unsaved case is gone" no_case  # it goes a moment after the saved one is there

xdotool key ctrl+q
eventually "the window is closed" gone "$window_pid"
wait "$window_pid" || failed "the window closed with status $?"

"$program" replay "$folder/saved.homolog" -o "$folder/shape.ply" --json > "$folder/replay.json" ||
  failed "the saved case is not replayed"
exists "$folder/shape.ply" || failed "replay wrote no mesh"
grep -q '"strokes": 1' "$folder/replay.json" || failed "not one stroke: $(cat "$folder/replay.json")"
grep -q '"turned_triangles": 0' "$folder/replay.json" || failed "triangles turned: $(cat "$folder/replay.json")"
