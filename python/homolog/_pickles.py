"""How objects are pickled and copied.

A pickle holds what an object holds, and not the name of a file: what comes out of it is in memory alone.
"""

from __future__ import annotations

import json
import os
import tempfile
import warnings
from typing import Any, Dict

from . import _core


def _bytes_of(value: Any, ending: str) -> bytes:
    """What a file of an object holds."""
    with tempfile.TemporaryDirectory(prefix="homolog-") as folder:
        file = os.path.join(folder, "a" + ending)
        value.write(file)
        with open(file, "rb") as content:
            return content.read()


def _read(read: Any, content: bytes, ending: str) -> Any:
    """What a reader makes of a file with this content; its warnings were given when the object was made."""
    with tempfile.TemporaryDirectory(prefix="homolog-") as folder:
        file = os.path.join(folder, "a" + ending)
        with open(file, "wb") as out:
            out.write(content)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", _core.HomologWarning)
            return read(file)


def template_of(name: str) -> _core.Mesh:
    return _core.load_template(name)


def mesh_of(content: bytes, exact: Dict[str, Any]) -> _core.Mesh:
    return _read(_core.loaded, content, ".ply")._with_values(exact)


def bare_mesh_of(points: Any, landmarks: Dict[str, Any], exact: Dict[str, Any]) -> _core.Mesh:
    return _core.Mesh(points, landmarks=landmarks)._with_values(exact)


def model_of(content: bytes) -> _core.Model:
    return _read(_core.loaded_model, content, ".h5")


def layers_of(content: bytes) -> _core.LabelMap:
    return _read(_core.loaded_label_map, content, ".seg.nrrd")


def volume_of(voxels: Any, place: Dict[str, Any], more: Dict[str, Any]) -> _core.Volume:
    return _core.volume_as_it_was(voxels, **place, **more)


def label_map_of(voxels: Any, place: Dict[str, Any], names: Dict[int, str]) -> _core.LabelMap:
    return _core.LabelMap(voxels, **place, names=names)


def _place_of(volume: _core.Volume) -> Dict[str, Any]:
    return {"spacing_mm": volume.spacing_mm, "origin_mm": volume.origin_mm, "direction": volume.direction}


def _reduced_mesh(mesh: _core.Mesh, protocol: Any = None):
    if mesh._built_in:
        return template_of, (mesh._built_in,)
    # PLY keeps all but these, of which it has fewer digits or nothing.
    exact = {**mesh.arrays, "stiffness": mesh.stiffness, "doubt_mm": mesh.doubt_mm}
    exact = {name: values for name, values in exact.items() if values is not None}
    if len(mesh.triangles) == 0:  # as of a file .particles, and PLY needs faces
        return bare_mesh_of, (mesh.points, mesh.landmarks, exact)
    return mesh_of, (_bytes_of(mesh, ".ply"), exact)


def _reduced_model(model: _core.Model, protocol: Any = None):
    return model_of, (_bytes_of(model, ".h5"),), {"report": model.report}


def _reduced_volume(volume: _core.Volume, protocol: Any = None):
    space = json.loads(volume._beside_voxels or "{}").get("frame_of_reference", "")
    more = {"frame_seconds": volume.frame_seconds, "modality": volume.modality, "frame_of_reference": space}
    return volume_of, (volume.array, _place_of(volume), more)


def _reduced_label_map(labels: _core.LabelMap, protocol: Any = None):
    if labels._layer_count > 1:
        return layers_of, (_bytes_of(labels, ".seg.nrrd"),)
    return label_map_of, (labels.array, _place_of(labels), labels.names)


def _refused_case(case: _core.Case, protocol: Any = None):
    raise _core.Error("case: cannot be pickled or copied, since its edits go to one file; give the path of the file, and "
                      "open it there by homolog.Case.open")


def _itself(value: Any, memo: Any = None) -> Any:
    """A copy of what never changes."""
    return value


def add_to_classes() -> None:
    for kind, reduced in ((_core.Mesh, _reduced_mesh), (_core.Model, _reduced_model), (_core.Volume, _reduced_volume),
                          (_core.LabelMap, _reduced_label_map), (_core.Case, _refused_case)):
        setattr(kind, "__reduce_ex__", reduced)
    for kind in (_core.Mesh, _core.Volume):  # a LabelMap is a Volume
        setattr(kind, "__copy__", _itself)
        setattr(kind, "__deepcopy__", _itself)
