"""Images of nibabel, both ways."""

from __future__ import annotations

import warnings
from typing import Any, Optional, Tuple

import numpy

from . import _core

_RAS_TO_LPS = numpy.diag([-1.0, -1.0, 1.0, 1.0])

read_volume = _core.read_volume
read_label_map = _core.read_label_map


def is_nibabel(value: Any) -> bool:
    """Whether a value is an image as nibabel has them."""
    return hasattr(value, "dataobj") and hasattr(value, "affine")


def _is_freesurfer(header: Any) -> bool:
    """Whether a header is that of .mgh and .mgz: it always says where the image lies, and times in ms."""
    return hasattr(header, "keys") and "goodRASFlag" in header.keys()


def _units(header: Any) -> Tuple[float, float]:
    """How many mm and seconds a header's units have, as those of a file: what is no unit of time gives 0."""
    if _is_freesurfer(header):
        return 1.0, 1e-3
    try:
        code = int(header["xyzt_units"])
    except (KeyError, TypeError, ValueError):  # a header that has none
        return 1.0, 1.0 if hasattr(header, "get_base_affine") else 0.0
    meter, micron, unknown, sec, msec, usec = 1, 3, 0, 8, 16, 24  # nifti1.h
    return ({meter: 1e3, micron: 1e-3}.get(code & 7, 1.0),
            {unknown: 1.0, sec: 1.0, msec: 1e-3, usec: 1e-6}.get(code & 56, 0.0))


def _says_no_place(image: Any) -> bool:
    """Whether the affine is one that nibabel made up, since the header has none."""
    header = getattr(image, "header", None)
    # Without pixdim it is none of NIfTI, SPM and Analyze, and its affine is its own.
    if not hasattr(header, "get_base_affine") or not hasattr(header, "keys") or "pixdim" not in header.keys():
        return False
    codes = [int(header[key]) for key in ("sform_code", "qform_code") if key in header.keys()]
    # Analyze has no codes, and nibabel's own reader of SPM's files has a matrix beside them.
    return not any(codes) and numpy.allclose(image.affine, header.get_best_affine(), equal_nan=True)


def _is_sheared(affine: Any) -> bool:
    """Whether axes are not at right angles, as read_volume sees it: a thousandth is rounding."""
    axes = numpy.asarray(affine, dtype=float)[:3, :3]
    lengths = numpy.linalg.norm(axes, axis=0)
    if not numpy.isfinite(axes).all() or not lengths.all():
        return True
    return numpy.abs((axes / lengths).T @ (axes / lengths) - numpy.eye(3)).max() > 1e-3


def _sound_affine(image: Any) -> Any:
    """The image's affine; where that is a sheared sform and the qform is sound, that, with a warning as read_volume has."""
    header = getattr(image, "header", None)
    if not hasattr(header, "get_qform") or not _is_sheared(image.affine):
        return image.affine
    qform = header.get_qform(coded=True)[0]
    sform = header.get_sform(coded=True)[0]
    if qform is None or sform is None or _is_sheared(qform) or not numpy.allclose(image.affine, sform, equal_nan=True):
        return image.affine
    warnings.warn("image: its sform is sheared or damaged, so its qform was used", _core.HomologWarning, stacklevel=5)
    return qform


def _affine_of(image: Any, mm_per_unit: float) -> numpy.ndarray:
    """From voxel index to LPS mm, as read_volume has it of the same file; it warns likewise."""
    if not _says_no_place(image):
        turned = _RAS_TO_LPS @ numpy.asarray(_sound_affine(image), dtype=float)
        turned[:3] *= mm_per_unit
        return turned
    sizes = numpy.ones(3)
    zooms = numpy.abs(numpy.asarray(image.header["pixdim"], dtype=float)[1:4])
    known = numpy.isfinite(zooms) & (zooms > 0)
    sizes[known] = zooms[known]
    shape = (tuple(image.shape) + (1, 1, 1))[:3]
    if any(not is_known and length > 1 for is_known, length in zip(known, shape)):
        warnings.warn("image: does not say how large a voxel is; 1 mm is assumed", _core.HomologWarning, stacklevel=4)
    warnings.warn("image: does not give the patient's orientation; its axes are assumed to run to the left, back and "
                  "head", _core.HomologWarning, stacklevel=4)
    return numpy.diag([*(mm_per_unit * sizes), 1.0])


def from_nibabel(image: Any, *, labels: bool = False, names: Optional[dict] = None):
    """A Volume, or with ``labels`` a LabelMap, of an image of nibabel.

    Its affine, which leads to RAS, is turned to LPS mm; voxels keep their indices. An image without a place, since it has
    neither sform nor qform, lies as read_volume has it, with the same warning. names, with labels: {value: name}.
    Errors: an affine that is missing or sheared; labels that are no whole numbers.
    """
    if not is_nibabel(image):
        raise _core.Error(f"image: is a {type(image).__name__}; give an image of nibabel")
    if names is not None and not labels:
        raise _core.Error("names: are of labels; say labels=True too, or leave them out")
    if image.affine is None:
        raise _core.Error("image: has no affine, so nobody knows where it lies; give it one")
    voxels = numpy.asanyarray(image.dataobj)
    if labels:
        voxels = _as_labels(voxels)
        if voxels is None:
            raise _core.Error("image: has values that are no whole numbers from 0 to 65535, as a soft mask has; leave "
                              "out labels=True, or round them")
    return _made_of(image, voxels, labels, names)


def mask_of(image: Any) -> _core.Volume:
    """A LabelMap of an image of nibabel, or where its values are no whole numbers a Volume: a soft mask."""
    if image.affine is None:
        return from_nibabel(image)
    voxels = numpy.asanyarray(image.dataobj)
    labels = _as_labels(voxels)
    return _made_of(image, voxels if labels is None else labels, labels is not None, None)


def _of_volume(voxels: numpy.ndarray) -> numpy.ndarray:
    """With three axes at least, and without further ones of length 1 behind the frames, as read_volume has the file."""
    while voxels.ndim > 4 and voxels.shape[-1] == 1:
        voxels = voxels[..., 0]
    return voxels.reshape(voxels.shape + (1,) * (3 - voxels.ndim)) if 0 < voxels.ndim < 3 else voxels


def _made_of(image: Any, voxels: numpy.ndarray, labels: bool, names: Optional[dict]):
    header = getattr(image, "header", None)
    mm_per_unit, seconds_per_unit = _units(header)
    affine = _affine_of(image, mm_per_unit)
    voxels = _of_volume(voxels)
    if labels:
        return _core.LabelMap(voxels, affine=affine, names=names)
    zooms = header.get_zooms() if hasattr(header, "get_zooms") else ()
    seconds = float(zooms[3]) * seconds_per_unit if voxels.ndim == 4 and len(zooms) > 3 else 0.0
    return _core.Volume(voxels, affine=affine, frame_seconds=seconds)


def _as_labels(voxels: numpy.ndarray) -> Optional[numpy.ndarray]:
    """Whole numbers of floats, as get_fdata() and scaled files have them; None where they are none."""
    if voxels.dtype.kind != "f":
        return voxels
    whole = numpy.rint(voxels)
    if numpy.array_equal(whole, voxels) and whole.size and 0 <= whole.min() and whole.max() <= 65535:
        return whole.astype(numpy.uint16)
    return None


def to_nibabel(volume: _core.Volume) -> Any:
    """An image of nibabel with the same voxels, place and time between frames. Needs nibabel.

    Errors: a label map whose segments lie in several layers, which NIfTI does not hold.
    """
    import nibabel  # type: ignore[import]

    if isinstance(volume, _core.LabelMap) and volume._layer_count > 1:
        raise _core.Error(f"labels: hold segments in {volume._layer_count} layers, which an image of nibabel cannot; "
                          "give one of layers, or take a segment by mask(name)")
    image = nibabel.Nifti1Image(numpy.array(volume.array), volume.affine_ras)
    image.header.set_xyzt_units("mm", "sec")
    if volume.frames > 1:
        image.header.set_zooms((*image.header.get_zooms()[:3], volume.frame_seconds))
    return image
