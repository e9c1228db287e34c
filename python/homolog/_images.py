"""Images of nibabel, both ways."""

from __future__ import annotations

from typing import Any, Optional

import numpy

from . import _core

_RAS_TO_LPS = numpy.diag([-1.0, -1.0, 1.0, 1.0])

read_volume = _core.read_volume
read_label_map = _core.read_label_map


def is_nibabel(value: Any) -> bool:
    """Whether a value is an image as nibabel has them."""
    return hasattr(value, "dataobj") and hasattr(value, "affine")


def from_nibabel(image: Any, *, labels: bool = False, names: Optional[dict] = None):
    """A Volume, or with ``labels`` a LabelMap, of an image of nibabel.

    Its affine, which leads to RAS mm, is turned to LPS mm; voxels keep their indices. names: {value: name}.
    Errors: an affine that is missing or sheared; labels that are no whole numbers.
    """
    if not is_nibabel(image):
        raise _core.Error(f"image: is a {type(image).__name__}; give an image of nibabel")
    if image.affine is None:
        raise _core.Error("image: has no affine, so nobody knows where it lies; give it one")
    voxels = numpy.asanyarray(image.dataobj)
    affine = _RAS_TO_LPS @ numpy.asarray(image.affine, dtype=float)
    if not labels:
        seconds = 0.0
        zooms = image.header.get_zooms() if hasattr(image, "header") else ()
        if voxels.ndim == 4 and len(zooms) > 3:
            unit = image.header.get_xyzt_units()[1] if hasattr(image.header, "get_xyzt_units") else "sec"
            seconds = float(zooms[3]) * {"msec": 1e-3, "usec": 1e-6}.get(unit, 1.0)
        return _core.Volume(voxels, affine=affine, frame_seconds=seconds)
    if voxels.dtype.kind == "f":
        whole = numpy.rint(voxels)
        if numpy.array_equal(whole, voxels) and whole.size and 0 <= whole.min() and whole.max() <= 65535:
            voxels = whole.astype(numpy.uint16)  # get_fdata() and scaled files give whole numbers as floats
    return _core.LabelMap(voxels, affine=affine, names=names)


def to_nibabel(volume: _core.Volume) -> Any:
    """An image of nibabel with the same voxels, place and time between frames. Needs nibabel."""
    import nibabel  # type: ignore[import]

    image = nibabel.Nifti1Image(numpy.array(volume.array), volume.affine_ras)
    image.header.set_xyzt_units("mm", "sec")
    if volume.frames > 1:
        image.header.set_zooms((*image.header.get_zooms()[:3], volume.frame_seconds))
    return image
