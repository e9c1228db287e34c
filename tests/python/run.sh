#!/bin/bash
# Installs the wheel into an environment of its own, without the network, and runs the tests of this folder in it:
# run.sh WHEEL PROGRAM SOURCE_FOLDER. Exit status 77: skipped.
set -u
wheel=$1 program=$2 source=$3
python=/usr/bin/python3
for module in venv numpy pytest; do
  $python -c "import $module" 2>/dev/null || { echo "SKIPPED: python3-$module is not installed"; exit 77; }
done
$python -c "import ensurepip" 2>/dev/null || { echo "SKIPPED: python3-venv is not installed"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
$python "$source/python/check_wheel.py" "$wheel" || exit 1
$python -m venv --system-site-packages "$folder/venv" || exit 1
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --no-index "$wheel" || exit 1
cd "$folder" || exit 1
export HOMOLOG_PROGRAM=$program HOMOLOG_SOURCE=$source HOMOLOG_DATA=${HOMOLOG_DATA:-$source/../shared/data}
# Three phantom kidneys with fits, made once for all files.
mkdir kidneys && cd kidneys || exit 1
for k in 1 2 3; do
  "$program" phantom kidney --subject $k -o . > /dev/null || exit 1
  "$program" fit built-in:kidney --mask kidney-$k-labels.nii.gz -o fit-$k.ply > /dev/null || exit 1
done
cd "$folder" || exit 1
export HOMOLOG_KIDNEYS=$folder/kidneys
# Each file in a process of its own, as many at a time as there are cores.
test_file() { "$1/venv/bin/python" -m pytest -q -rs -p no:cacheprovider "$2" > "$1/$(basename "$2").log" 2>&1; }
export -f test_file
printf '%s\n' "$source"/tests/python/test_*.py | xargs -P "$(nproc)" -I{} bash -c 'test_file "$@"' test_file "$folder" {}
status=$?
cat "$folder"/*.log
exit $status
