# The man page from the lines that documents.sh makes: VERB, kind, name, text.
function plain(s) { gsub(/\\/, "\\e", s); gsub(/-/, "\\-", s); sub(/^[.']/, "\\\\\\&&", s); return s }
function sentence(s) { return s ~ /[.!?)]$/ || s == "" ? s : s "." }
BEGIN {
  print ".TH HOMOLOG 1 \"\" \"homolog " version "\" \"User Commands\""
  print ".SH NAME"
  print "homolog \\- segment organs and put their meshes in correspondence"
}
$2 == "about" && $1 == "" {
  print ".SH SYNOPSIS\n.B homolog\n[\\fIOPTIONS\\fR] [\\fIFILES\\fR...]\n.br\n.B homolog\n\\fIVERB\\fR [\\fIOPTIONS\\fR] ..."
  print ".SH DESCRIPTION\n" plain(sentence($3)); next
}
$2 == "about" {
  if (!verbs++) print ".SH VERBS"
  print ".SS homolog " plain($1) "\n" plain(sentence($3)) "\n.PP\n.B " plain($4); next
}
$1 == "" && $2 == "options" && !options++ { print ".SH OPTIONS" }
$2 == "subcommands" { if ($1 == "") next; print ".TP\n.B " plain($3) "\n" plain(sentence($4)); next }
$2 == "examples" { if ($1 != "") print ".PP\n.B " plain($3 ($4 == "" ? "" : " " $4)); next }
{
  bold = $3; rest = ""
  if (match($3, / /)) { bold = substr($3, 1, RSTART - 1); rest = substr($3, RSTART) }
  print ".TP\n.B " plain(bold) "\\fR" plain(rest) "\n" plain(sentence($4))
}
END {
  print ".SH EXIT STATUS\n.TP\n.B 0\nDone.\n.TP\n.B 1\nThe data or the system refused. One line on standard error says why, and nothing half\\-written is left."
  print ".TP\n.B 2\nThe command line is wrong.\n.TP\n.B 130\nCancelled by Ctrl\\-C or SIGTERM. What is finished stays."
  print ".SH ENVIRONMENT\n.TP\n.B HOMOLOG_THREADS\nHow many threads to use at most, as \\-\\-jobs."
  print ".SH FILES\n.TP\n.I ~/.local/state/homolog\nCases that were never saved, and studies without a place.\n.TP\n.I ~/.config/homolog\nSettings."
  print ".SH SEE ALSO\nThe documents in \\fI/usr/share/doc/homolog\\fR."
}
