#!/bin/bash
# What CMake says where packages are missing: missing_packages_test.sh SOURCE_FOLDER CMAKE. Two packages
# are hidden from it, and all that pkg-config knows.
set -u
source=$1 cmake=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failed() { echo "missing_packages_test: $1"; [ ! -e "$folder/log" ] || cat "$folder/log"; exit 1; }

mkdir "$folder/pkgconfig"
PKG_CONFIG_LIBDIR=$folder/pkgconfig "$cmake" -S "$source" -B "$folder/build" -DCMAKE_DISABLE_FIND_PACKAGE_pugixml=ON \
  -DCMAKE_DISABLE_FIND_PACKAGE_CLI11=ON > "$folder/log" 2>&1 && failed "it was configured"
[ "$(grep -c '^CMake Error' "$folder/log")" = 1 ] || failed "not one message"
line=$(grep -E '^ *sudo apt install ' "$folder/log") || failed "no line to install all"
for package in libpugixml-dev libcli11-dev libhdf5-dev libpng-dev libimgui-dev; do
  grep -q "($package)" "$folder/log" || failed "$package is not named"
  case " $line " in *" $package "*) ;; *) failed "$package is not in the line to install all" ;; esac
done
case " $line " in *" libeigen3-dev "*) failed "libeigen3-dev is there, and is named" ;; esac

# What the message may name is what scripts/run.sh installs.
. "$source/scripts/packages.sh"
for package in $(grep -E '^ *need' "$source/cmake/dependencies.cmake" | grep -oE '[a-z0-9-]+(-dev|-config)|fonts-[a-z-]+|libjs-[a-z]+' | sort -u); do
  case " $(echo $build_packages) " in *" $package "*) ;; *) failed "scripts/packages.sh does not install $package" ;; esac
done
