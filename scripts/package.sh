#!/usr/bin/env bash
# Makes both packages in build/release/packages from a bare Debian 12 on: homolog_VERSION_amd64.deb with cpack, and the portable
# archive homolog-VERSION-linux-x86_64.tar.gz, which needs no root and holds no library under the GPL. Two runs on one
# commit give the same bytes. --no-check leaves lintian out.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
install_missing $build_packages git dpkg-dev fakeroot file patchelf lintian
umask 022
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH LC_ALL=C.UTF-8
rm -rf build/release/debian  # else its files keep the date of the commit that was built before
build release homolog homolog-lab homolog_pictures homolog_pictures_portable stand_in_curl stand_in_jbig homolog_documents homolog_debian >&2
packages=$PWD/build/release/packages version=$(build/release/homolog --version | sed -n '1s/^homolog //p')
mkdir -p "$packages"

(cd build/release && cpack -G DEB >&2)

# --- The portable archive.
name=homolog-$version-linux-x86_64
stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
cmake --install build/release --prefix "$stage/installed" --component Unspecified >/dev/null
here=$stage/$name
mkdir -p "$here/lib/system" "$here/licences"
cp -r "$stage/installed/share" "$here/share"
rm -r "$here/share/lintian" "$here/share/doc/homolog/changelog.gz" "$here/share/doc/homolog/copyright"
cp packaging/launcher.sh "$here/homolog"
cp LICENSE README.md "$here/"
cp build/release/homolog build/release/homolog-lab build/release/portable/homolog_pictures.so "$here/lib/"
cp build/release/portable/lib{curl.so.4,jbig.so.0} "$here/lib/"

# What the system has: the C and C++ libraries, by all means; those that OpenGL's drivers use too, where it has them
# (packaging/launcher.sh).
from_system=' libc.so.6 libm.so.6 libdl.so.2 libpthread.so.0 librt.so.1 libresolv.so.2 libstdc++.so.6 libgcc_s.so.1 ld-linux-x86-64.so.2 '
shared_with_drivers=' libX11.so.6 libxcb.so.1 libXau.so.6 libXdmcp.so.6 libbsd.so.0 libmd.so.0 libexpat.so.1 libz.so.1 libzstd.so.1 liblzma.so.5 '
needed_by() { objdump -p "$1" | awk '$1 == "NEEDED" { print $2 }'; }
# licence_of LIBRARY_FILE: its row of libraries.tsv; fails where there is none, and for the GPL.
licence_of() {
  local package source row
  package=$(dpkg -S "$1" 2>/dev/null || dpkg -S "${1#/usr}" 2>/dev/null || dpkg -S "/usr$1")
  package=${package%%:*}
  source=$(dpkg-query -W -f '${source:Package}' "$package")
  row=$(awk -F '\t' -v source="$source" '$1 == source' packaging/libraries.tsv)
  [ -n "$row" ] || { echo "package: $1 ($source) has no line in packaging/libraries.tsv" >&2; return 1; }
  case $(cut -f 3 <<<"$row") in GPL* | *' GPL'*) echo "package: $1 is under the GPL" >&2; return 1 ;; esac
  cp -n "/usr/share/doc/$package/copyright" "$here/licences/$source.txt"
}
queue=("$here/lib/homolog" "$here/lib/homolog-lab" "$here/lib/homolog_pictures.so")
while [ ${#queue[@]} -gt 0 ]; do
  file=${queue[0]} queue=("${queue[@]:1}")
  for library in $(needed_by "$file"); do
    [[ $from_system == *" $library "* ]] && continue
    to=$here/lib
    [[ $shared_with_drivers == *" $library "* ]] && to=$here/lib/system
    [ -e "$to/$library" ] && continue
    path=$(readlink -f "$(ldconfig -p | awk -v name="$library" '$1 == name && /x86-64/ { print $NF; exit }')")
    licence_of "$path"
    cp "$path" "$to/$library"
    queue+=("$to/$library")
  done
done
for package in $(awk -F '\t' '!/^#/ && $5 == "inside" { print $4 }' packaging/libraries.tsv); do
  cp -n "/usr/share/doc/$package/copyright" "$here/licences/$package.txt"
done
for common in $(grep -rhoE '/usr/share/common-licenses/[A-Za-z0-9.-]*[A-Za-z0-9]' "$here/licences" | sort -u); do
  case $common in */GPL*) ;; *) [ ! -e "$common" ] || cp -nL "$common" "$here/licences/" ;; esac
done
packaging/spdx.sh . "$version" "$SOURCE_DATE_EPOCH" inside linked below > "$here/share/doc/homolog/homolog.spdx.json"
find "$here/lib" -type f -exec strip --strip-unneeded {} +
for file in "$here"/lib/*; do [ -d "$file" ] || patchelf --set-rpath '$ORIGIN' "$file"; done
chmod -R u=rwX,go=rX "$here"
chmod 644 "$here"/lib/*.so* "$here"/lib/system/*
tar -C "$stage" --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner --format=ustar -c "$name" |
  gzip -9n > "$packages/$name.tar.gz"

[ "${1:-}" = --no-check ] || lintian --fail-on error,warning --pedantic "$packages"/homolog_*.deb >&2
ls -l "$packages" | awk '/\.(deb|gz)$/ { printf "%6.1f MB  %s\n", $5 / 1e6, $9 }'
