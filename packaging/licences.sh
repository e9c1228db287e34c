#!/bin/sh
# licences.sh SOURCE_FOLDER OUT_FOLDER COMPILER: writes what `homolog --version` and `homolog --licences` print, from
# libraries.tsv and the packages that are installed here. Versions are "unknown" where dpkg is not the one who knows.
set -eu
source=$1 out=$2 compiler=$3
mkdir -p "$out"
# The library's own version; Debian's marks of repacked sources are left out.
version_of() {
  version=$(dpkg-query -W -f '${source:Upstream-Version}' "$1" 2>/dev/null) || version=unknown
  echo "$version" | sed -E 's/[.+~](ds|dfsg|repack)[0-9]*$//'
}
# Takes a file's place only where it differs, so that nothing is linked anew.
replace() { cmp -s "$1.new" "$1" && rm "$1.new" || mv "$1.new" "$1"; }
rows() { awk -F '\t' -v how="$1" '!/^#/ && index(how, $5)' "$source/packaging/libraries.tsv"; }
tab=$(printf '\t')

{ printf 'built with %s\nlibraries:' "$compiler"
  comma=
  rows "inside linked pictures" | while IFS=$tab read -r _ name _ package _; do
    printf '%s %s %s' "$comma" "$name" "$(version_of "$package")"
    comma=,
  done
  printf '\n'; } > "$out/built_with.txt.new"
replace "$out/built_with.txt"

{ printf 'Homolog is under the MIT licence:\n\n'
  cat "$source/LICENSE"
  printf '\nInside the program or the picture module:\n\n'
  { rows inside | sed 's/inside$/compiled in/'; rows "linked pictures" | sed 's/linked$/library/; s/pictures$/library, not in the portable archive/'; } |
    awk -F '\t' '{ printf "  %-18s %-24s %s\n", $2, $3, $5 }'
  printf '  %-18s %-24s %s\n' 'Sunnybrook heart' CC0-1.0 'compiled in (homolog sample)'
  printf '\nThe licences of libraries lie in /usr/share/doc/PACKAGE/copyright, those of the portable archive in its folder licences.\n'
  for font in "$source"/assets/licences/*; do
    printf '\n======== %s\n\n' "$(basename "$font" .txt)"
    cat "$font"
  done
  rows inside | while IFS=$tab read -r _ name _ package _; do
    case $package in fonts-*) continue ;; esac
    printf '\n======== %s\n\n' "$name"
    cat "/usr/share/doc/$package/copyright" 2>/dev/null || echo "(its text was not installed where this program was built)"
  done; } > "$out/licences.txt.new"
replace "$out/licences.txt"
