#!/bin/sh
# The list of faults that scripts/mutants.sh tries is in order: each text to change is in the sources once, none changes what
# another one does, and groups and kinds are as many as promised: mutants_test.sh SOURCE_FOLDER
cd "$1" || exit 1
python3 tests/mutants/mutants.py --check || exit 1
groups=$(python3 tests/mutants/mutants.py --list | awk '$1 ~ /^[0-9]+$/ && $2 != "faults:" { print $2 }' | sort -u | tr '\n' ' ')
wanted="colours doubt energy fit gestures journal landmarks measures model propagate readers snap undo window "
[ "$groups" = "$wanted" ] || { echo "the groups are $groups, not $wanted"; exit 1; }
# What does not fit is refused by name.
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir -p "$folder/tests" "$folder/core/solve"
cp -r tests/mutants "$folder/tests/"
{ sed '/^\[/,$d' tests/mutants/mutants.txt
  for n in $(seq 80); do printf '[%s] energy sign core/solve/energy.cpp\nA sentence.\n- word%s;\n+ other;\n\n' "$n" "$n"; done
} > "$folder/tests/mutants/mutants.txt"
seq 79 | sed 's/.*/word&;/' > "$folder/core/solve/energy.cpp"
said=$(python3 "$folder/tests/mutants/mutants.py" --check 2>&1) && { echo "a text that is not there is accepted"; exit 1; }
case $said in *"[80] occurs 0 times in core/solve/energy.cpp"*) ;; *) echo "$said"; exit 1 ;; esac
seq 80 | sed 's/.*/word&;/' > "$folder/core/solve/energy.cpp"
python3 "$folder/tests/mutants/mutants.py" --check || exit 1
