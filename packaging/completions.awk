# Completions for one shell (bash or zsh) from the lines that documents.sh makes: VERB, kind, name, text.
function add(list, key, word) { list[key] = list[key] (list[key] == "" ? "" : " ") word }
$2 == "about" { verbs[++count] = $1 }
$2 == "subcommands" { add(subs, $1, $3) }
$2 == "options" {
  split($3, part, " ")
  of = split(part[1], names, ",")
  for (i = 1; i <= of; ++i) add(options, $1, names[i])
  if (match($3, /\{[^}]*\}/)) {
    values = substr($3, RSTART + 1, RLENGTH - 2)
    gsub(/,/, " ", values)
    for (i = 1; i <= of; ++i) { ++choices; choice_key[choices] = $1 " " names[i]; choice[choices] = values }
  }
}
END {
  if (shell == "zsh") print "#compdef homolog"
  print "# Made from homolog --help by packaging/documents.sh."
  print "_homolog() {"
  print "  local word path= verbs= options= values="
  if (shell == "bash") {
    print "  local cur=${COMP_WORDS[COMP_CWORD]} prev= i"
    print "  COMPREPLY=()"
    print "  for ((i = 1; i < COMP_CWORD; ++i)); do"
    print "    word=${COMP_WORDS[i]} prev=${COMP_WORDS[i]}"
  } else {
    print "  local prev=${words[CURRENT-1]}"
    print "  for word in ${words[2,CURRENT-1]}; do"
  }
  print "    case \"$path/$word\" in"
  for (v = 1; v <= count; ++v) if (verbs[v] != "") {
    n = split(verbs[v], part, " ")
    above = n == 1 ? "" : part[1]
    printf "      '%s/%s') path='%s' ;;\n", above, part[n], verbs[v]
  }
  print "    esac\n  done\n  case \"$path\" in"
  for (v = 1; v <= count; ++v) printf "    '%s') verbs='%s' options='%s' ;;\n", verbs[v], subs[verbs[v]], options[verbs[v]]
  print "  esac\n  case \"$path $prev\" in"
  for (c = 1; c <= choices; ++c) printf "    '%s') values='%s' ;;\n", choice_key[c], choice[c]
  print "  esac"
  if (shell == "bash") {
    print "  if [[ -n $values ]]; then"
    print "    COMPREPLY=($(compgen -W \"$values\" -- \"$cur\"))"
    print "  elif [[ $cur == -* ]]; then"
    print "    COMPREPLY=($(compgen -W \"$options\" -- \"$cur\"))"
    print "  elif [[ -n $verbs ]]; then"
    print "    COMPREPLY=($(compgen -W \"$verbs\" -- \"$cur\"))"
    print "  fi\n}\ncomplete -o bashdefault -o default -F _homolog homolog"
  } else {
    print "  if [[ -n $values ]]; then\n    compadd -- ${=values}"
    print "  elif [[ $PREFIX == -* ]]; then\n    compadd -- ${=options}"
    print "  else\n    [[ -n $verbs ]] && compadd -- ${=verbs}\n    _files\n  fi\n}\n_homolog \"$@\""
  }
}
