#!/bin/sh
# stand_ins.sh OUT.cpp OBJECT…: a weak function for each symbol of homolog that the objects need.
out=$1
shift
nm -u "$@" | awk '/7homolog/ { print "extern \"C\" __attribute__((weak)) void " $NF "() { __builtin_trap(); }" }' | sort -u > "$out"
