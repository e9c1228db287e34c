#!/bin/sh
# Starts the portable Homolog from wherever it was unpacked. Libraries that OpenGL's drivers use too are taken from the system,
# so that both see the same one; where the system lacks any of them (a server without a desktop), all come from lib/system.
here=$(dirname "$(readlink -f "$0")")
for library in "$here"/lib/system/*; do
  name=${library##*/}
  for folder in /lib/x86_64-linux-gnu /usr/lib/x86_64-linux-gnu /lib64 /usr/lib64 /usr/lib; do
    [ -e "$folder/$name" ] && continue 2
  done
  LD_LIBRARY_PATH=$here/lib/system${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
  export LD_LIBRARY_PATH
  break
done
exec "$here/lib/homolog" "$@"
