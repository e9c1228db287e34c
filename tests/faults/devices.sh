#!/bin/bash
# Devices, pipes and links in circles as inputs and as results: devices.sh PROGRAM [all|sample]. In each verb that writes, each word that
# names a file is replaced by each of them in turn. Asked for: the program ends in a few seconds and in little memory, with
# status 1 and one line that names it (a batch may go on, and warns), and none of them is replaced.
set -u
program=$1 which=${2:-quick}
export LC_ALL=C
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export HOME=$work XDG_STATE_HOME=$work/state XDG_CONFIG_HOME=$work/config
unset DISPLAY WAYLAND_DISPLAY
cd "$(dirname "$0")" && . ./verbs.sh

jobs=("${quick[@]}")
[ "$which" = sample ] && jobs=("${quick[0]}" "${quick[5]}" "${quick[10]}")
[ "$which" = all ] && jobs+=("${slow[@]}")
tried=0 bad=0
# odd KIND NAME: makes $work/in/KIND… with the ending of NAME, and prints its name.
odd() {
  local base=${2##*/} ending=""
  case $base in *.*) ending=.${base#*.} ;; esac
  local made=odd-$1$ending
  rm -rf "$made"
  case $1 in
    pipe) mkfifo "$made" ;;
    loop) ln -s "$made" "$made" ;;
    *) ln -s "/dev/$1" "$made" ;;
  esac
  echo "$made"
}
kind_of() { stat -c '%F' "$1"; }
for job in "${jobs[@]}"; do
  verb=${job%%|*}
  read -ra words <<< "${job#*|}"
  for i in "${!words[@]}"; do
    word=${words[$i]}
    if [[ $word == old.* ]] || [[ $i -gt 0 && ${words[$((i - 1))]} =~ ^(-o|--csv|--aligned)$ ]]; then kinds="pipe loop full null"
    elif [ -f "$work/in/$word" ]; then kinds="pipe loop zero"
    else continue; fi
    for kind in $kinds; do
      cd "$work/in" || exit 1
      name=$(odd "$kind" "$word") asked=("${words[@]}")
      asked[i]=$name
      rm -rf old.*; before=$(kind_of "$name") tried=$((tried + 1))
      # shellcheck disable=SC2086
      (ulimit -v 6000000; timeout 120 "$program" $verb "${asked[@]}" > "$work/out" 2> "$work/err")
      status=$?
      say() { echo "devices: $verb ${asked[*]}: $1: $(head -c 300 "$work/err")" >&2; bad=$((bad + 1)); }
      [ $status = 1 ] || { [ $status = 0 ] && grep -qE "^homolog: warning: .*($name|/dev/$kind)" "$work/err"; } || say "status $status"
      [ $status != 1 ] || { [ "$(grep -vc '^homolog: warning: ' "$work/err")" = 1 ] && grep -qE "$name|/dev/$kind" "$work/err"; } || say "says something else"
      [ "$(kind_of "$name")" = "$before" ] || say "is a $(kind_of "$name") now"
      rm -rf "$name"
    done
  done
done
echo "$tried odd files, $bad wrong"
[ $bad = 0 ]
