#!/bin/sh
# JSON is read by core/base/encoding/json.cpp alone, which bounds its depth, and files are written by
# core/base/files/system_files.cpp alone, which leaves the old file or the whole new one. (What grows line by line is not: a
# case's journal, core/session/journal.cpp, and the log of commands.) The names of built-in templates and phantoms are
# spelled by core/catalogue alone. What only POSIX systems have is called by the system_*.cpp of core/base alone.
cd "$1" && [ -d core ] && [ -d app ] || exit 1
bad=$(grep -rnE '(json|Json)::(parse|accept|sax_parse|from_[a-z]*son|from_cbor|from_msgpack)\b' core render app | grep -v '^core/base/encoding/json\.cpp:'
      grep -rnE '\b(ofstream|fopen|freopen|O_CREAT|mkstemp|fs::rename|filesystem::rename|::rename|copy_file|IOFile)\b' core render app |
        grep -vE '^core/base/files/system_files\.cpp:|^app/editor/update/command_log\.h:|"/proc/self/|"rb"'
      grep -rnE '"(built-in|phantom):' core render app | grep -v '^core/catalogue/catalogue\.'
      grep -rnE '<(sys/[a-z]+|unistd|fcntl|dirent|dlfcn|poll|pthread|sched|signal|spawn|termios)\.h>|"/proc/' core render app |
        grep -v '^core/base/[a-z]*/system_[a-z_]*\.cpp:')
[ -z "$bad" ] || { echo "$bad"; exit 1; }
