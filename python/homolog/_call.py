"""How a function becomes a verb's command line."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from typing import Any, Callable, Dict, Iterable, List, Optional, Union

import numpy

from . import _core, _images
from ._results import Fit, Study
from ._words import in_python

Progress = Optional[Callable[[float, str], Any]]
PathOrText = Union[str, "os.PathLike[str]"]


class Call:
    """One call of a verb: its command line, what is lent, and the folder for what is needed for a while."""

    def __init__(self, *verb: str):
        self.verb = verb  # none: whoever calls writes the words of the command line
        self.arguments: List[str] = list(verb)
        self.lent: List[Any] = []
        self.called: Dict[str, str] = {}  # what sentences call files of this call
        self._folder: Optional[tempfile.TemporaryDirectory] = None
        self._files = 0

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._folder is not None:
            self._folder.cleanup()

    def folder(self) -> str:
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="homolog-")
        return self._folder.name

    def new_file(self, ending: str) -> str:
        self._files += 1
        return os.path.join(self.folder(), f"{self._files}{ending}")

    def name_of(self, value: Any, lend: Any = False) -> str:
        """The name by which the verb gets a value.

        lend: the verb takes volumes that are in memory; "labels": as label maps; "template": it takes built-in names.
        Errors: a case whose file lacks some of its edits.
        """
        if isinstance(value, str):
            return value
        if hasattr(value, "__fspath__"):
            return os.fspath(value)
        if _images.is_nibabel(value):
            value = _images.mask_of(value) if lend == "labels" else _images.from_nibabel(value)
        if isinstance(value, Fit):
            value = value.mesh
        if isinstance(value, _core.Volume):
            if lend:
                # As it was read, whatever became of the file; a record names the file while it is the same.
                name = value._file or _name_of_array(value)
                self.lent.append((name, value))
                return name
            if value._file:
                return value._file
            file = self.new_file(".seg.nrrd" if isinstance(value, _core.LabelMap) else ".nrrd")
            value.write(file)
            return file
        if isinstance(value, _core.Case):
            if not value.source:
                raise _core.Error("case: is in memory alone; save it by save_as first")
            if not value._is_in_file:
                raise _core.Error("case: has edits that are not in its file; save it by save_as first")
            return value.source
        if isinstance(value, (_core.Mesh, _core.Model)):
            if value._file:
                return value._file
            if lend == "template" and isinstance(value, _core.Mesh) and value._built_in:
                return value._built_in
            file = self.new_file(".ply" if isinstance(value, _core.Mesh) else ".h5")
            value.write(file)
            return file
        if isinstance(value, Study):
            return value.source
        if isinstance(value, numpy.ndarray):
            raise _core.Error("array: " + _of_array(value, lend))
        raise _core.Error(f"{type(value).__name__}: is nothing that can be given here; give a file or an object of homolog")

    def add_shapes(self, shapes: Any, lend: Any = False) -> "Call":
        """One shape, several, or {name: shape}, by which names a report calls them.

        A mesh that is in memory alone is called by its position, counted from 1.
        """
        if not isinstance(shapes, dict):
            for position, shape in enumerate(several(shapes), 1):
                mesh = shape.mesh if isinstance(shape, Fit) else shape
                if isinstance(mesh, _core.Mesh) and not mesh._file:
                    self._add_shape(mesh, str(position), f"shape {position}")
                else:
                    self.add(shape, lend=lend)
            return self
        for name, shape in shapes.items():
            mesh = shape.mesh if isinstance(shape, Fit) else shape
            if not isinstance(mesh, _core.Mesh):
                raise _core.Error(f"{name}: is no mesh; give {{name: Mesh}}")
            name = str(name)
            if not name or name.startswith(".") or "/" in name or "\0" in name:
                raise _core.Error(f"{name!r}: cannot name a shape; give a name without / that does not begin with a dot")
            self._add_shape(mesh, name, name)
        return self

    def _add_shape(self, mesh: _core.Mesh, name: str, called: str) -> None:
        folder = os.path.join(self.folder(), "shapes")  # apart from other files, whose names are numbers too
        os.makedirs(folder, exist_ok=True)
        file = os.path.join(folder, f"{name}.ply")
        mesh.write(file)
        self.arguments.append(file)
        self.called[file] = called

    def add_files(self, *values: Any, lend: Any = False) -> "Call":
        """What a study will name. Errors: a value that has no file."""
        for value in values:
            self.add(value, lend=lend)
            if self._folder is not None:
                raise _core.Error(f"{type(value).__name__}: a study names its files, and this is in memory alone; write it "
                                  "to a file and read that")
        return self

    def add(self, *values: Any, lend: Any = False) -> "Call":
        self.arguments += [self.name_of(value, lend) for value in values]
        return self

    def option(self, name: str, value: Any, lend: Any = False) -> "Call":
        """--name VALUE; nothing for None and False, a flag for True, values with commas between them for a list."""
        if isinstance(value, numpy.bool_):
            value = bool(value)
        if value is None or value is False:
            return self
        self.arguments.append("--" + name.replace("_", "-"))
        if value is True:
            return self
        if isinstance(value, numpy.ndarray) and (lend or value.ndim > 1):
            raise _core.Error(f"{name}: {_of_array(value, lend)}")
        if isinstance(value, numpy.ndarray) and value.ndim == 0:
            value = value[()]
        if isinstance(value, (list, tuple, numpy.ndarray)):
            self.arguments.append(",".join(text_of(one) for one in value))
        elif isinstance(value, (int, float, numpy.number)):
            self.arguments.append(text_of(value))
        else:
            self.arguments.append(self.name_of(value, lend))
        return self

    def words(self, name: str, values: Any, lend: Any = False) -> "Call":
        """--name and each of several values as a word of its own; nothing for None."""
        if values is None:
            return self
        self.arguments.append("--" + name.replace("_", "-"))
        return self.add(*several(values), lend=lend)

    def done(self, pairs: Any) -> "Call":
        """--done MESH IMAGE for each of [(mesh, image)], or for one pair."""
        if pairs is None:
            return self
        if isinstance(pairs, tuple):
            pairs = [pairs]
        for pair in pairs:
            if not isinstance(pair, (list, tuple)) or len(pair) != 2:
                raise _core.Error("done: is no list of pairs; give [(mesh, image), …]")
            self.arguments.append("--done")
            self.add(pair[0]).add(pair[1], lend=True)
        return self

    def landmarks(self, value: Any) -> Any:
        """A file of {name: (x, y, z)}; whatever else as it is."""
        if not isinstance(value, dict):
            return value
        file = self.new_file(".mrk.json")
        _core.write_landmarks(value, file)
        return file

    def json_file(self, value: Any, name: str, ending: str = ".json") -> Any:
        """A file of a dict, numbers and arrays of numpy in it too; whatever else as it is. Errors: what JSON lacks."""
        if not isinstance(value, dict):
            return value

        def plain(one):
            whole = one.tolist() if hasattr(one, "tolist") else one
            if whole is one or hasattr(whole, "tolist"):
                raise _core.Error(f"{name}: holds a {type(one).__name__}; give numbers, text, lists and dicts")
            return whole

        file = self.new_file(ending)
        try:
            text = json.dumps(value, default=plain)
        except _core.Error:
            raise
        except (TypeError, ValueError, RecursionError):
            raise _core.Error(f"{name}: cannot be written as JSON; give numbers, text, lists and dicts") from None
        with open(file, "w", encoding="utf-8") as out:
            out.write(text)
        return file

    def options(self, **values: Any) -> "Call":
        for name, value in values.items():
            self.option(name, value)
        return self

    def table(self, name: str, value: Any) -> "Call":
        """A table: a file, a pandas DataFrame, a list of dicts, a row each, or a dict of lists, a column each."""
        if value is None or isinstance(value, str) or hasattr(value, "__fspath__"):
            return self.option(name, value)
        file = self.new_file(".csv")
        if hasattr(value, "to_csv"):
            value.to_csv(file, index=False)
        else:
            import csv

            rows = _rows_of(name, value)
            columns = list(dict.fromkeys(key for row in rows for key in row))
            with open(file, "w", newline="", encoding="utf-8") as out:
                writer = csv.DictWriter(out, fieldnames=columns)
                writer.writeheader()
                writer.writerows(rows)
        return self.option(name, file)

    def run(self, progress: Progress = None, jobs: Optional[int] = None) -> Dict[str, Any]:
        try:
            # Names of files need not be UTF-8: they are as the system has them.
            words = [word.encode("utf-8", "surrogateescape") for word in self.arguments]
            lent = [(name.encode("utf-8", "surrogateescape"), volume) for name, volume in self.lent]
            return _core.run(words, lent, progress, jobs, self.called, self.verb)
        except _core.Error as error:
            if self.verb:
                error.args = (in_python(str(error), self.verb),)
            raise


def _rows_of(name: str, table: Any) -> List[Dict[str, Any]]:
    """A dict for each row. Errors: no table, columns that differ in length."""
    if isinstance(table, dict):
        columns = {key: list(column) for key, column in table.items()
                   if isinstance(column, Iterable) and not isinstance(column, (str, bytes, dict))}
        if len(columns) != len(table):
            raise _core.Error(f"{name}: is a dict that holds something else than columns; give {{name: list}}")
        lengths = {key: len(column) for key, column in columns.items()}
        if len(set(lengths.values())) > 1:
            each = ", ".join(f"{key}: {length}" for key, length in lengths.items())
            raise _core.Error(f"{name}: has columns of several lengths ({each}); give a value for each case")
        return [dict(zip(columns, row)) for row in zip(*columns.values())]
    rows = list(table) if isinstance(table, Iterable) else []
    if not rows or not all(isinstance(row, dict) for row in rows):
        raise _core.Error(f"{name}: is no table; give a .csv, a DataFrame, a list of dicts or a dict of lists")
    return rows


def _of_array(array: numpy.ndarray, lend: Any) -> str:
    """What is wrong with an array where an object is wanted."""
    if lend == "labels" and array.dtype.kind == "f":
        return ("is an array of numpy, which does not say where it lies; give homolog.Volume(array, affine=...), whose shares "
                "are a soft mask, or of whole numbers homolog.LabelMap")
    wanted = {"labels": "homolog.LabelMap(array, affine=...)", "template": "homolog.Mesh(points, triangles)",
              True: "homolog.Volume(array, affine=...)"}.get(lend, "homolog.Volume, LabelMap or Mesh of it")
    return f"is an array of numpy, which does not say where it lies; give {wanted}"


def _name_of_array(volume: _core.Volume) -> str:
    """The same name for the same voxels, names and frames at the same place, since files say what they were made of.

    Other volumes get other names: calls of several threads lend theirs at a time.
    """
    digest = hashlib.blake2b(digest_size=6)
    for layer in volume.layers if isinstance(volume, _core.LabelMap) else (volume,):
        digest.update(layer.array.ravel(order="F").data)
        digest.update(repr((layer.shape, layer.origin_mm, layer.spacing_mm, layer.direction.tolist())).encode())
    digest.update(volume._beside_voxels.encode())
    return f"array-{digest.hexdigest()}.nrrd"


def text_of(value: Any) -> str:
    """A number as one writes it on the command line: 2 and not 2.0."""
    if isinstance(value, (bool, str)):
        return str(value)
    if hasattr(value, "__fspath__"):
        return os.fspath(value)
    try:
        number = float(value) if not isinstance(value, (int, numpy.integer)) else int(value)
    except (TypeError, ValueError, OverflowError):
        raise _core.Error(f"{type(value).__name__}: is no number; give numbers or text") from None
    text = repr(number)
    return text[:-2] if text.endswith(".0") else text


def several(value: Any) -> List[Any]:
    """A list of what may be one."""
    is_image = isinstance(value, numpy.ndarray) and value.dtype.kind in "biufc"  # others hold paths or objects
    if is_image or isinstance(value, (str, _core.Mesh, _core.Volume, _core.Case, Study, Fit)) or hasattr(value, "__fspath__"):
        return [value]
    return list(value) if isinstance(value, Iterable) else [value]
