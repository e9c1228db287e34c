# Sourced by scripts/package.sh and by python/make_wheel.py, in the source folder: what the portable archive and the wheel
# bring with them.

# What the system has: the C and C++ libraries, by all means; those that OpenGL's drivers use too, where it has them
# (packaging/launcher.sh).
from_system=' libc.so.6 libm.so.6 libdl.so.2 libpthread.so.0 librt.so.1 libresolv.so.2 libstdc++.so.6 libgcc_s.so.1 ld-linux-x86-64.so.2 '
shared_with_drivers=' libX11.so.6 libxcb.so.1 libXau.so.6 libXdmcp.so.6 libbsd.so.0 libmd.so.0 libexpat.so.1 libz.so.1 libzstd.so.1 liblzma.so.5 '
needed_by() { objdump -p "$1" | awk '$1 == "NEEDED" { print $2 }'; }

# licence_of LIBRARY_FILE FOLDER: copies its licence there; fails where it has no row of libraries.tsv, and for the GPL.
licence_of() {
  local package source row
  # As dpkg -S, which takes a quarter of a second for each.
  package=$(grep -lxF -e "$1" -e "${1#/usr}" -e "/usr$1" /var/lib/dpkg/info/*.list | head -1)
  package=${package##*/} package=${package%.list}
  package=${package%%:*}
  source=$(dpkg-query -W -f '${source:Package}' "$package")
  row=$(awk -F '\t' -v source="$source" '$1 == source' packaging/libraries.tsv)
  [ -n "$row" ] || { echo "package: $1 ($source) has no line in packaging/libraries.tsv" >&2; return 1; }
  case $(cut -f 3 <<<"$row") in GPL* | *' GPL'*) echo "package: $1 is under the GPL" >&2; return 1 ;; esac
  cp -n "/usr/share/doc/$package/copyright" "$2/$source.txt"
}

# bundle FOLDER SYSTEM_FOLDER LICENCES FILE…: copies the libraries that the files need, and those that these need, into
# FOLDER; those that drivers use too into SYSTEM_FOLDER. What lies there already is taken as it is.
bundle() {
  local folder=$1 system=$2 licences=$3 file library to path
  shift 3
  local queue=("$@")
  while [ ${#queue[@]} -gt 0 ]; do
    file=${queue[0]} queue=("${queue[@]:1}")
    for library in $(needed_by "$file"); do
      [[ $from_system == *" $library "* ]] && continue
      to=$folder
      [[ $shared_with_drivers == *" $library "* ]] && to=$system
      [ -e "$to/$library" ] && continue
      path=$(readlink -f "$(PATH=$PATH:/sbin:/usr/sbin ldconfig -p | awk -v name="$library" '$1 == name && /x86-64/ { print $NF; exit }')")
      licence_of "$path" "$licences" || return 1
      cp "$path" "$to/$library" || return 1
      queue+=("$to/$library")
    done
  done
}
