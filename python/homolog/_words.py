"""What a sentence of the command line says in Python, where its options are keywords."""

from __future__ import annotations

import functools
import re
from typing import Any, Dict, Sequence

from . import _core

# Options that have another name here, by their verb.
_RENAMED: Dict[str, Dict[str, str]] = {
    "compare": {"mask": "labels", "mesh": "other"},
    "fit": {"mask": "labels"},
    "info": {"mask": "labels"},
}
# Options without a value.
_FLAGS = frozenset("""
    all all_frames best_of by_doubt capped complete consensus flip_mirrored free_landmarks from_ras keep_scale
    keep_vertices mirror no_align object_symmetry optimise outside partial resample tube without_doubtful
    without_names world
""".split())
# In front of an option these say whose it is.
_OWNERS = ("convert", "evaluate", "fit", "label-map", "measure", "model", "mris_convert", "repair-mesh", "set make",
           "study make", "template", "test")

_OUTPUT = re.compile(r"(?<![\w/.-])-o(?:, --output)?(?![\w-])")
_OPTION = re.compile(rf"(?P<owner>\b(?:{'|'.join(_OWNERS)}) )?(?<![\w/.-])--(?P<option>[a-z][a-z0-9-]*[a-z0-9])(?![\w-])")
_HELP = re.compile(r"; see homolog [a-z -]+ --help$")


def in_python(sentence: str, verb: Sequence[str] = ()) -> str:
    """The sentence of a verb with the keywords of its function: ``label`` for --label, ``resample=True`` for --resample.

    An option of another verb stays as it is written there, and so does what is no option, as the name of a file.
    """
    name = " ".join(verb)
    renamed = _RENAMED.get(name, {})

    def keyword(match: "re.Match[str]") -> str:
        owner = match["owner"] or ""
        if owner and owner.rstrip() != name:
            return match[0]
        option = renamed.get(match["option"], match["option"].replace("-", "_"))
        return owner + (option + "=True" if option in _FLAGS else option)

    return _OPTION.sub(keyword, _OUTPUT.sub("output", _HELP.sub("", sentence)))


def speak_python(kind: Any, *methods: str) -> None:
    """Gives the errors of these methods the keywords of Python."""
    for name in methods:
        setattr(kind, name, _speaking(getattr(kind, name)))


def _speaking(method: Any) -> Any:
    @functools.wraps(method)
    def spoken(*arguments: Any, **keywords: Any) -> Any:
        try:
            return method(*arguments, **keywords)
        except _core.Error as error:
            error.args = (in_python(str(error)),)
            raise

    return spoken
