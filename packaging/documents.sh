#!/bin/sh
# documents.sh PROGRAM OUT_FOLDER: makes the man page (homolog.1) and the completions for bash (homolog.bash) and zsh
# (_homolog) from what --help of every verb says.
set -eu
program=$1 out=$2
mkdir -p "$out"
here=$(cd "$(dirname "$0")" && pwd)
table=$out/help.tsv

# help_of VERB…: the help page as lines "VERB… <tab> kind <tab> name <tab> text", then those of its own verbs. A name of 28
# characters or more stands on a line of its own, with its text in column 30 of the next.
help_of() {
  "$program" "$@" --help | awk -v verb="$*" '
    function trimmed(s) { sub(/^ +/, "", s); sub(/ +$/, "", s); return s }
    function flush() { if (name != "") print verb "\t" kind "\t" name "\t" text; name = text = "" }
    # The line that is held, now that the one behind it is known: a text that goes on there belongs to a long name.
    function settle(next_line) {
      if (held == "") return
      flush()
      name = trimmed(held)
      if (substr(held, 29, 2) == "  " || (substr(held, 30, 1) == " " && next_line !~ /^ {30}[^ ]/)) {
        name = trimmed(substr(held, 1, 30)); text = substr(held, 31)
      }
      held = ""
    }
    { settle($0) }
    /^Usage:/ { print verb "\tabout\t" trimmed(about) "\t" trimmed(substr($0, 7)); seen = 1; next }
    !seen { about = about " " $0; next }
    /^[A-Z][a-z]+:$/ { flush(); kind = tolower(substr($0, 1, length($0) - 1)); next }
    /^  [^ ]/ { held = $0; next }
    /^   / { text = text (text == "" ? "" : " ") trimmed($0) }
    END { settle(""); flush() }'
}
walk() {
  help_of "$@" > "$out/page.tsv"
  cat "$out/page.tsv" >> "$table"
  for verb in $(awk -F '\t' '$2 == "subcommands" { print $3 }' "$out/page.tsv"); do walk "$@" "$verb"; done
}
: > "$table"
walk
rm -f "$out/page.tsv"
version=$("$program" --version | sed -n '1s/^homolog //p')

awk -F '\t' -v version="$version" -f "$here/man.awk" "$table" > "$out/homolog.1"
awk -F '\t' -v shell=bash -f "$here/completions.awk" "$table" > "$out/homolog.bash"
awk -F '\t' -v shell=zsh -f "$here/completions.awk" "$table" > "$out/_homolog"
rm -f "$table"
