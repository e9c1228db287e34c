"""Methods of Case for its actions, made from the list of actions."""

from __future__ import annotations

import json

from . import _core

# Keys that are other words in Python.
_METHODS = {"points": "set_points", "moved": "move_points", "tool": "stroke", "frame": "show_frame"}


def _method(key, example, meaning):
    value = json.loads(example)[key]

    def within(self, of="", **members):
        return self.do({key: members}, of)

    def alone(self, value, of="", **more):
        return self.do({key: value, **more}, of)

    method = within if isinstance(value, dict) else alone
    method.__name__ = _METHODS.get(key, key)
    method.__qualname__ = f"Case.{method.__name__}"
    method.__doc__ = f"{meaning}.\n\nThe line of the case file: {example}"
    return method


def _stroke(tool):
    def stroke(self, at, to, sigma_mm, of="", **more):
        return self.do({"tool": tool, "at": at, "to": to, "sigma_mm": sigma_mm, **more}, of)

    stroke.__name__, stroke.__qualname__ = tool, f"Case.{tool}"
    stroke.__doc__ = f"A stroke of the tool {tool}: from `at`, on the surface, to `to` (LPS mm); it reaches sigma_mm far."
    return stroke


def add_to(case):
    for key, example, meaning in _core.action_kinds():
        if key not in ("undo", "redo"):
            name = _METHODS.get(key, key)
            setattr(case, name, _method(key, example, meaning))
    for tool in ("pull", "grab", "slide"):
        setattr(case, tool, _stroke(tool))
