#!/usr/bin/env bash
# Makes the packages in build/release/packages from a bare Debian 12 on: homolog_VERSION_amd64.deb and
# python3-homolog_VERSION_amd64.deb with cpack; the portable archive homolog-VERSION-linux-x86_64.tar.gz, which needs no root
# and holds no library under the GPL; and the wheel of the Python module. Two runs on one commit give the same bytes.
# --no-check leaves lintian out.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/packages.sh
install_missing $build_packages git dpkg-dev fakeroot file lintian
umask 022
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH LC_ALL=C.UTF-8
rm -rf build/release/debian  # else its files keep the date of the commit that was built before
build release homolog homolog-lab homolog_pictures homolog_pictures_portable stand_in_curl stand_in_jbig homolog_documents homolog_debian homolog_python homolog_reader homolog_wheel >&2
packages=$PWD/build/release/packages version=$(build/release/homolog --version | sed -n '1s/^homolog //p')
mkdir -p "$packages"

(cd build/release && cpack -G DEB >&2)
(cd build/release && cpack -G DEB -D CPACK_PACKAGE_NAME=python3-homolog -D CPACK_DEBIAN_PACKAGE_NAME=python3-homolog \
  -D CPACK_INSTALL_CMAKE_PROJECTS="$PWD;homolog;python;/" -D CPACK_DEBIAN_PACKAGE_SECTION=python \
  -D CPACK_DEBIAN_PACKAGE_DEPENDS="python3 (>= 3.11), python3 (<< 3.12), python3-numpy, libegl1, libgl1" \
  -D CPACK_PACKAGE_DESCRIPTION_SUMMARY="statistical shape models in Python" >&2)

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

. packaging/bundle.sh
bundle "$here/lib" "$here/lib/system" "$here/licences" "$here/lib/homolog" "$here/lib/homolog-lab" "$here/lib/homolog_pictures.so"
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

[ "${1:-}" = --no-check ] || lintian --fail-on error,warning --pedantic "$packages"/homolog_*.deb "$packages"/python3-homolog_*.deb >&2
python/check_wheel.py "$packages"/homolog-*.whl >&2
ls -l "$packages" | awk '/\.(deb|gz|whl)$/ { printf "%6.1f MB  %s\n", $5 / 1e6, $9 }'
