#!/usr/bin/env python3
"""A unity build joins sources of one target, and with them their anonymous namespaces. Functions of one name with other
parameters overload each other there: a call may mean another source's function, or none of them once a batch changes.
So a name belongs to one source of a target: same_names_test.py LIST FOLDER... A line of the list is a target and its
sources, parted by tabs. And a program may include any two headers of the FOLDERs, which are installed: a type's name
belongs to one of them."""

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


# What opens a namespace or a type; `enum class Name : int {` is one too.
SCOPE = re.compile(r"\b(?P<space>namespace)\b(?P<path>[\s\w:]*)$"
                   r"|\b(?:struct|class|union|enum(?:\s+(?:class|struct))?)\s+(?:alignas\([^)]*\)\s*)?(?P<type>\w+)"
                   r"(?:\s+final)?\s*(?::(?!:)[^;{}]*)?$")


def types(text, outer=""):
    """The types that a header defines, but not those inside of other types, with their namespaces."""
    names, begin, at = set(), 0, 0
    while at < len(text):
        if text[at] == ";":
            begin = at + 1
        elif text[at] == "{":
            end, opened = end_of_block(text, at), SCOPE.search(text[begin:at])
            if opened and opened["space"]:
                names |= types(text[at + 1:end], outer + opened["path"].strip() + "::")
            elif opened:
                names.add(outer + opened["type"])
            at = end
            begin = at + 1
        at += 1
    return names


found, seen = [], 0
of_type = defaultdict(list)
for header in sorted(header for folder in sys.argv[2:] for header in Path(folder).rglob("*.h")):
    for name in types(SILENT.sub(" ", header.read_text(encoding="utf-8"))):
        of_type[name].append(str(header))
found += [f"{name} is a type of {' and '.join(headers)}" for name, headers in sorted(of_type.items()) if len(headers) > 1]
if len(sys.argv) > 2 and not of_type:
    sys.exit("no type was found in any header")
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
