#!/usr/bin/env python3
"""A unity build joins sources of one target, and with them their anonymous namespaces. Functions of one name with other
parameters overload each other there: a call may mean another source's function, or none of them once a batch changes.
So a name belongs to one source of a target: same_names_test.py LIST. A line of the list is a target and its sources,
parted by tabs."""

import re
import sys
from collections import defaultdict
from pathlib import Path

# What says nothing here: comments, texts, characters, lines of the preprocessor.
SILENT = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|^#(?:\\\n|[^\n])*',
                    re.S | re.M)
NO_FUNCTION = re.compile(r"^\s*(?:template\s*<.*>\s*)?(?:struct|class|union|enum|namespace)\b|\boperator\b|=", re.S)


def end_of_block(text, begin):
    """Where the block that opens at `begin` has its closing brace."""
    depth = 0
    for at in range(begin, len(text)):
        depth += (text[at] == "{") - (text[at] == "}")
        if depth == 0:
            return at
    return len(text)


def functions(block):
    """The names of the functions that are defined in a namespace."""
    names, begin, at, depth = set(), 0, 0, 0
    while at < len(block):
        sign = block[at]
        depth += (sign == "(") - (sign == ")")
        if depth == 0 and sign == ";":
            begin = at + 1
        elif depth == 0 and sign == "{":
            head = re.split(r"\(", block[begin:at], maxsplit=1)
            name = re.search(r"(\w+)\s*$", head[0])
            if len(head) == 2 and name and not NO_FUNCTION.search(head[0]):
                names.add(name[1])
            at = begin = end_of_block(block, at)
            begin += 1
        at += 1
    return names


def hidden_functions(source):
    """The names of the functions in the anonymous namespaces of a source."""
    text = SILENT.sub(" ", Path(source).read_text(encoding="utf-8"))
    opened = [match.end() - 1 for match in re.finditer(r"\bnamespace\s*\{", text)]
    return set().union(*(functions(text[begin + 1:end_of_block(text, begin)]) for begin in opened))


found, seen = [], 0
for line in Path(sys.argv[1]).read_text(encoding="utf-8").splitlines():
    target, *sources = line.split("\t")
    where = defaultdict(list)
    for source in sources:
        for name in hidden_functions(source):
            where[name].append(source)
    seen += len(where)
    found += [f"{target}: {name} is a function of {' and '.join(where[name])}"
              for name in sorted(where) if len(where[name]) > 1]
if found or seen == 0:
    sys.exit("\n".join(found) or "no function was found in any source")
