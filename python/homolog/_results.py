"""What long calls give."""

from __future__ import annotations

import os
from typing import Any, Dict, List, Optional

from . import _core


class Fit:
    """A fitted mesh and what is to be said of it.

    mesh: Mesh in the template's numbering, LPS mm, with doubt_mm. report: the dict that ``homolog fit --json`` prints.
    """

    def __init__(self, mesh: _core.Mesh, report: Dict[str, Any]):
        self.mesh, self.report = mesh, report

    @property
    def doubtful(self) -> bool:
        """Whether a person has to look at it."""
        return bool(self.report.get("doubtful", False))

    @property
    def placement(self) -> Dict[str, Any]:
        """The similarity nearest to the fit: rotation [w, x, y, z], scale, translation (LPS mm)."""
        return self.report["placement"]

    def __repr__(self) -> str:
        return f"<homolog.Fit of {len(self.mesh)} vertices, {'doubtful' if self.doubtful else 'sound'}>"

    def _repr_png_(self) -> Optional[bytes]:
        return self.mesh._repr_png_()


class Study:
    """A study, NAME.study.json: its cases as dicts of the file, with absolute paths under ``file``."""

    def __init__(self, source: str, content: Dict[str, Any]):
        self.source, self._content = source, content

    @property
    def template(self) -> str:
        """The template's file, or a built-in name; empty where there is none."""
        return self._absolute(self._content.get("template", ""))

    @property
    def cases(self) -> List[Dict[str, Any]]:
        """A dict for each case: name, file, group, covariates and what else the file says."""
        return [{**one, "file": self._absolute(one["file"])} for one in self._content["cases"]]

    def _absolute(self, name: str) -> str:
        is_file = name and not name.startswith("built-in:")
        return os.path.join(os.path.dirname(os.path.abspath(self.source)), name) if is_file else name

    def __len__(self) -> int:
        return len(self._content["cases"])

    def __repr__(self) -> str:
        return f"<homolog.Study {self.source!r} of {len(self)} cases>"
