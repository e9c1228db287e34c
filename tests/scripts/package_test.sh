#!/bin/bash
# What is installed, and what the package says of itself: package_test.sh SOURCE_FOLDER BUILD_FOLDER. Exit status 77: skipped.
set -u
source=$1 build=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed() { echo "package_test: $1"; exit 1; }
cmake --install "$build" --prefix "$folder/usr" > "$folder/log" || failed "cannot be installed: $(cat "$folder/log")"
cd "$folder/usr" || exit 1

for file in bin/homolog libexec/homolog/homolog libexec/homolog/homolog-lab libexec/homolog/homolog_pictures.so share/applications/homolog.desktop \
  share/icons/hicolor/scalable/apps/homolog.svg share/mime/packages/homolog.xml share/thumbnailers/homolog.thumbnailer \
  share/man/man1/homolog.1.gz share/bash-completion/completions/homolog share/zsh/vendor-completions/_homolog \
  share/doc/homolog/copyright share/doc/homolog/README.md share/doc/homolog/docs/commands.md share/doc/homolog/homolog.spdx.json; do
  [ -s "$file" ] || failed "$file is missing"
done

# Every verb and every option that --help names is in the man page.
zcat share/man/man1/homolog.1.gz | sed 's/\\-/-/g' > "$folder/man"
verbs=$(bin/homolog --help | sed '1,/^Subcommands:/d' | awk '/^  [a-z]/ { print $1 }')
[ "$(wc -w <<< "$verbs")" -gt 20 ] || failed "--help names hardly any verbs"
for verb in $verbs; do grep -q "^\.SS homolog $verb\$" "$folder/man" || failed "$verb is not in the man page"; done
for option in $(bin/homolog fit --help | grep -oE '^  (-[a-z],)?--[a-z-]+' | sed 's/.*--/--/'); do
  sed -n '/^\.SS homolog fit$/,/^\.SS/p' "$folder/man" | grep -qe "^\.B .*$option" || failed "fit $option is not in the man page"
done
grep -q '^How far beyond the model' "$folder/man" || failed "a text behind a long name is not in the man page"

# completes EXPECTED WORD…: what bash offers for the last word.
. share/bash-completion/completions/homolog
completes() {
  local expected=$1
  shift
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
  _homolog
  [ "${COMPREPLY[*]}" = "$expected" ] || failed "'$*' is completed as '${COMPREPLY[*]}'"
}
completes "picture" homolog pic
completes "correspondence case" homolog picture c
completes "--ground" homolog picture case --gr
completes "light" homolog picture case --ground l
completes "" homolog fit scan
if command -v zsh > /dev/null; then zsh -n share/zsh/vendor-completions/_homolog || failed "zsh does not understand _homolog"; fi

# What is inside has its licence told, and none is the GPL.
bin/homolog --licences > "$folder/licences" || failed "--licences does not answer"
[ "$(grep -c 'SIL OPEN FONT LICENSE Version 1.1' "$folder/licences")" -ge 2 ] || failed "the fonts' licences are not told"
grep -q 'Permission is hereby granted' "$folder/licences" || failed "the program's licence is not told"
while IFS=$'\t' read -r _ name licence _ how; do
  case $licence in GPL* | *[" ("]GPL*) failed "$name is under the GPL" ;; esac
  [ "$how" = below ] || grep -q "^  $name  *$licence" "$folder/licences" || failed "$name has no line in --licences"
done < <(grep -v '^#' "$source/packaging/libraries.tsv")
bin/homolog --version | grep -qE '^libraries: .*HDF5 [0-9]' || failed "--version does not tell the libraries"
cat > "$folder/spdx.cmake" << END
file(READ share/doc/homolog/homolog.spdx.json text)
string(JSON version GET "\${text}" spdxVersion)
string(JSON count LENGTH "\${text}" packages)
if(NOT version STREQUAL SPDX-2.3 OR count LESS 20)
  message(FATAL_ERROR "\${version}, \${count} packages")
endif()
END
cmake -P "$folder/spdx.cmake" || failed "homolog.spdx.json is no SPDX document"

# The portable archive's stand-ins have every function that is asked of them, and its picture module needs no OpenImageIO.
# wanted LIBRARY PATTERN STAND_IN
wanted() {
  local library
  library=$(ldconfig -p | awk -v name="$1" '$1 == name { print $NF; exit }')
  [ -n "$library" ] || failed "$1 is not installed"
  comm -23 <(nm -D --undefined-only "$library" | awk '{ print $NF }' | sed 's/@.*//' | grep -E "$2" | sort) \
    <(nm -D --defined-only "$build/portable/$3" | awk '{ print $NF }' | sed 's/@.*//' | sort) > "$folder/lacking"
  [ ! -s "$folder/lacking" ] || failed "$3 lacks $(tr '\n' ' ' < "$folder/lacking")"
}
PATH=$PATH:/sbin:/usr/sbin
wanted libhdf5_serial.so.103 '^curl_' libcurl.so.4
wanted libtiff.so.6 '^jbg_' libjbig.so.0
objdump -p "$build/portable/homolog_pictures.so" | grep -q 'NEEDED.*OpenImageIO' && failed "the portable picture module needs OpenImageIO"

# What a package put into the menu is left as it is.
said=$(XDG_DATA_DIRS=$folder/usr/share XDG_DATA_HOME=$folder/data bin/homolog --integrate) || failed "--integrate ends with status $?"
case $said in *"$folder/usr/share/applications/homolog.desktop"*) ;; *) failed "--integrate says '$said'" ;; esac
[ ! -e "$folder/data" ] || failed "--integrate of the package wrote files"

# What the thumbnailer runs makes a picture of that size under a name without an ending, with a case in a folder with a blank.
mkdir "$folder/a case" && printf '%s\n' '{"homolog":1,"volume":"phantom:kidney:1","template":"built-in:kidney"}' > "$folder/a case/k.homolog"
line=$(sed -n 's/^Exec=//p' share/thumbnailers/homolog.thumbnailer)
line=${line//%i/\"$folder/a case/k.homolog\"} line=${line//%o/\"$folder/thumb.XYZ\"} line=${line//%s/128}
PATH=$folder/usr/bin:$PATH HOME=$folder bash -c "$line" > "$folder/log" 2>&1 || {
  grep -q OpenGL "$folder/log" && { echo "SKIPPED: $(cat "$folder/log")"; exit 77; }
  failed "no thumbnail: $(cat "$folder/log")"
}
[ "$(od -An -tx1 -j1 -N3 "$folder/thumb.XYZ") $(od -An -tu1 -j16 -N8 "$folder/thumb.XYZ")" = " 50 4e 47    0   0   0 128   0   0   0 128" ] ||
  failed "the thumbnail is no picture of 128 by 128"
[ "$(ls "$folder" | grep -c thumb)" = 1 ] || failed "the thumbnailer leaves files"
