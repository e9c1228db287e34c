"""Homolog: statistical shape models of organs, from label maps to a model.

Lengths are mm, points LPS (x to the patient's left, y to the back, z to the head), arrays of points n×3. Voxel arrays are
[i, j, k], or [i, j, k, frame]: the first index runs along the grid's first axis, as in nibabel. Nothing is turned, shifted
or filled unless you ask. Results are those of the command line, to the last bit, whatever the number of threads.

What can take long takes ``progress``, which is called with the share done (0 to 1) and what is in work, and can be
stopped by Ctrl-C. Errors are homolog.Error with the sentence that the command line prints.
"""

import os as _os

from . import _core

_core.use_picture_module(_os.path.join(_os.path.dirname(__file__), "homolog_pictures.so"))
_core.use_reader(_os.path.join(_os.path.dirname(__file__), "homolog_reader"))

from ._core import (Case, Error, HomologWarning, LabelMap, Mesh, Model, Picture, UsageError, Volume, load_template,
                    picture_of_case, picture_of_meshes, picture_of_modes, read_landmarks, read_mesh, read_model, phantom,
                    set_thread_limit, thread_limit, write_landmarks)
from ._core import __version__
from ._images import from_nibabel, read_label_map, read_volume, to_nibabel
from ._results import Fit, Study
from ._verbs import (compare, convert, evaluate, fit, fit_all, fit_set, info, make_set, make_study, make_template,
                     measure, mirror, model, propagate, read_set, read_study, repair, repair_mesh, report, run, score,
                     snap, test, verify)
from . import _actions, _pickles, _words

_actions.add_to(Case)
_pickles.add_to_classes()
_words.speak_python(Case, "fit", "fit_to_contours", "snap")


class _Report:
    """The report of an object that was given none: an empty dict of its own."""

    def __get__(self, of, kind=None):
        return self if of is None else of.__dict__.setdefault("report", {})


setattr(Error, "report", _Report())
setattr(Model, "report", _Report())


def _shown(draw):
    """What a notebook shows of an object; nothing where there is no OpenGL."""
    def _repr_png_(self):
        try:
            return draw(self)._repr_png_()
        except Error:
            return None
    return _repr_png_


setattr(Mesh, "_repr_png_", _shown(lambda mesh: picture_of_meshes([mesh], size=(640, 480))))
setattr(Model, "_repr_png_", _shown(lambda model: picture_of_modes(model, modes=min(2, len(model)), size=(960, 640))))
setattr(Case, "_repr_png_", _shown(lambda case: picture_of_case(case, size=(960, 720))))

__all__ = [
    "Case", "Error", "Fit", "HomologWarning", "LabelMap", "Mesh", "Model", "Picture", "Study", "UsageError", "Volume",
    "__version__", "compare", "convert", "evaluate", "fit", "fit_all", "fit_set", "from_nibabel", "info",
    "load_template", "make_set", "make_study", "make_template", "measure", "mirror", "model", "phantom",
    "picture_of_case", "picture_of_meshes", "picture_of_modes", "propagate", "read_label_map", "read_landmarks",
    "read_mesh", "read_model", "read_set", "read_study", "read_volume", "repair", "repair_mesh", "report", "run",
    "score", "set_thread_limit", "snap", "test", "thread_limit", "to_nibabel", "verify", "write_landmarks",
]
