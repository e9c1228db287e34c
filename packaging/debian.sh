#!/bin/sh
# debian.sh SOURCE_FOLDER OUT_FOLDER VERSION: the files that a Debian package has in its folder of documents. Dates are those of
# the last commit, so that two builds give the same bytes.
set -eu
source=$1 out=$2 version=$3
mkdir -p "$out"
epoch=${SOURCE_DATE_EPOCH:-$(git -C "$source" log -1 --format=%ct 2>/dev/null || echo 0)}
{ printf 'homolog (%s) unstable; urgency=medium\n\n' "$version"
  printf '  * See the documents of this version.\n\n'
  printf ' -- Homolog maintainers <maintainers@users.noreply.h-seed-6b6bacb8.example>  %s\n' "$(LC_ALL=C date -u -R -d "@$epoch")"
} | gzip -9n > "$out/changelog.gz"
# A licence's text as a field of this format: each line behind a blank, empty ones as a dot.
field() { sed 's/^ *$/./; s/^/ /' "$1"; }
{ cat "$source/packaging/copyright"
  sed 1,4d "$source/LICENSE" | field /dev/stdin
  printf '\nFiles: fonts\nCopyright: The Inter Project Authors, The Fork Awesome authors\nLicense: OFL-1.1\n'
  printf 'Comment: Inter and Fork Awesome are compiled into the program.\n\nLicense: OFL-1.1\n'
  field "$source/assets/licences/Inter-OFL.txt"
  printf '\nFiles: assets/sample/*\nCopyright: Sunnybrook Health Sciences Centre\nLicense: CC0-1.0\nComment: the text is in /usr/share/common-licenses/CC0-1.0.\n'
  awk -F '\t' '!/^#/ && $5 == "inside" && $3 !~ /^OFL/ { printf "\nFiles: compiled-in/%s\nCopyright: the authors of %s\nLicense: %s\nComment: headers or a static library of the Debian package %s, where its text is.\n", $4, $2, $3, $4 }' \
    "$source/packaging/libraries.tsv"
} > "$out/copyright"
"$source/packaging/spdx.sh" "$source" "$version" "$epoch" inside linked pictures > "$out/homolog.spdx.json"
