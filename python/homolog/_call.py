"""How a function becomes a verb's command line."""

from __future__ import annotations

import hashlib
import os
import tempfile
from typing import Any, Callable, Dict, Iterable, List, Optional, Union

import numpy

from . import _core, _images
from ._results import Fit, Study

Progress = Optional[Callable[[float, str], Any]]
PathOrText = Union[str, "os.PathLike[str]"]


class Call:
    """One call of a verb: its command line, what is lent, and the folder for what is needed for a while."""

    def __init__(self, *verb: str):
        self.arguments: List[str] = list(verb)
        self.lent: List[Any] = []
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
        """
        if isinstance(value, str):
            return value
        if hasattr(value, "__fspath__"):
            return os.fspath(value)
        if _images.is_nibabel(value):
            value = _images.from_nibabel(value, labels=lend == "labels")
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
            raise _core.Error("array: " + _of_array(lend))
        raise _core.Error(f"{type(value).__name__}: is nothing that can be given here; give a file or an object of homolog")

    def add_shapes(self, shapes: Any, lend: Any = False) -> "Call":
        """One shape, several, or {name: shape}, by which names a report calls them."""
        if not isinstance(shapes, dict):
            return self.add(*several(shapes), lend=lend)
        for name, shape in shapes.items():
            mesh = shape.mesh if isinstance(shape, Fit) else shape
            if not isinstance(mesh, _core.Mesh):
                raise _core.Error(f"{name}: is no mesh; give {{name: Mesh}}")
            name = str(name)
            if not name or name.startswith(".") or "/" in name or "\0" in name:
                raise _core.Error(f"{name!r}: cannot name a shape; give a name without / that does not begin with a dot")
            file = os.path.join(self.folder(), f"{name}.ply")
            mesh.write(file)
            self.arguments.append(file)
        return self

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
        if value is None or value is False:
            return self
        self.arguments.append("--" + name.replace("_", "-"))
        if value is True:
            return self
        if isinstance(value, numpy.ndarray) and (lend or value.ndim > 1):
            raise _core.Error(f"{name}: {_of_array(lend)}")
        if isinstance(value, (list, tuple, numpy.ndarray)):
            self.arguments.append(",".join(text_of(one) for one in value))
        elif isinstance(value, (int, float, numpy.number)):
            self.arguments.append(text_of(value))
        else:
            self.arguments.append(self.name_of(value, lend))
        return self

    def options(self, **values: Any) -> "Call":
        for name, value in values.items():
            self.option(name, value)
        return self

    def table(self, name: str, value: Any) -> "Call":
        """A table: a file, a pandas DataFrame, or a list of dicts."""
        if value is None or isinstance(value, str) or hasattr(value, "__fspath__"):
            return self.option(name, value)
        file = self.new_file(".csv")
        if hasattr(value, "to_csv"):
            value.to_csv(file, index=False)
        else:
            import csv

            rows = list(value)
            with open(file, "w", newline="", encoding="utf-8") as out:
                writer = csv.DictWriter(out, fieldnames=list(rows[0]) if rows else [])
                writer.writeheader()
                writer.writerows(rows)
        return self.option(name, file)

    def run(self, progress: Progress = None, jobs: Optional[int] = None) -> Dict[str, Any]:
        return _core.run(self.arguments, self.lent, progress, jobs)


def _of_array(lend: Any) -> str:
    """What is wrong with an array where an object is wanted."""
    wanted = {"labels": "homolog.LabelMap(array, affine=...)", "template": "homolog.Mesh(points, triangles)",
              True: "homolog.Volume(array, affine=...)"}.get(lend, "homolog.Volume, LabelMap or Mesh of it")
    return f"is an array of numpy, which does not say where it lies; give {wanted}"


def _name_of_array(volume: _core.Volume) -> str:
    """The same name for the same voxels at the same place, since files say what they were made of."""
    digest = hashlib.blake2b(volume.array.ravel(order="F").data, digest_size=6)
    digest.update(repr((volume.shape, volume.origin_mm, volume.spacing_mm, volume.direction.tolist())).encode())
    return f"array-{digest.hexdigest()}.nrrd"


def text_of(value: Any) -> str:
    """A number as one writes it on the command line: 2 and not 2.0."""
    if isinstance(value, (bool, str)):
        return str(value)
    number = float(value) if not isinstance(value, (int, numpy.integer)) else int(value)
    text = repr(number)
    return text[:-2] if text.endswith(".0") else text


def several(value: Any) -> List[Any]:
    """A list of what may be one."""
    is_image = isinstance(value, numpy.ndarray) and value.dtype.kind in "biufc"  # others hold paths or objects
    if is_image or isinstance(value, (str, _core.Mesh, _core.Volume, _core.Case, Study, Fit)) or hasattr(value, "__fspath__"):
        return [value]
    return list(value) if isinstance(value, Iterable) else [value]
