# Sourced by the scripts of this folder: installs the Debian packages that are missing, and only those.

build_packages="g++ cmake ninja-build pkg-config
  libglfw3-dev libimgui-dev libstb-dev libfreetype-dev libglm-dev libepoxy-dev libegl-dev libgl-dev
  libeigen3-dev libspectra-dev libmetis-dev libopenmesh-dev libopenimageio-dev libgif-dev libpng-dev libtiff-dev libinsighttoolkit5-dev libgdcm-dev libnifti2-dev libznz-dev
  libbz2-dev zlib1g-dev libssl-dev libpugixml-dev libhdf5-dev libcli11-dev nlohmann-json3-dev libexpected-dev doctest-dev
  fonts-inter fonts-fork-awesome fonts-droid-fallback libjs-three libegl1 libgl1-mesa-dri
  pybind11-dev python3-dev patchelf"

# install_missing PACKAGE…: needs neither root nor the network where everything is there already.
install_missing() {
  local missing="" package as_root=""
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || { echo "These Debian packages are missing; install them as root:$missing" >&2; return 1; }
    as_root=sudo
  fi
  echo "Installing:$missing" >&2
  $as_root apt-get update -qq &&
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
}

# build PRESET [TARGET…]: with ccache where it is installed.
build() {
  local preset=$1 launcher=""; shift
  command -v ccache >/dev/null && launcher=-DCMAKE_CXX_COMPILER_LAUNCHER=ccache
  export CCACHE_SLOPPINESS=pch_defines,time_macros
  cmake --preset "$preset" $launcher >"build-$preset.log" 2>&1 || { cat "build-$preset.log" >&2; return 1; }
  rm -f "build-$preset.log"
  cmake --build --preset "$preset" ${1:+--target "$@"}
}
