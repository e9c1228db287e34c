"""Methods of Case for its actions, made from the list of actions."""

from __future__ import annotations

import json

from . import _core

# Keys that are other words in Python.
_METHODS = {"points": "set_points", "moved": "move_points", "tool": "stroke", "frame": "show_frame"}


# What a line of each action may hold beside its key, or where the key's value is an object, what that may hold
# [docs/schemas/case-line.schema.json]; "joined" may stand beside every key.
_BESIDE = {
    "tool": ("at", "to", "on", "sigma_mm", "through_space", "strength"),
    "points": ("by", "placement", "of_frame", "doubt", "doubt_mm", "outlier"),
    "scheme": ("events",), "mirror": ("keeps",), "frame": ("look",),
    "note": ("window", "template_file", "fit", "looks", "map_fit"),
}
_WITHIN = {
    "moved": ("landmarks", "steps"), "placement": ("rotation", "scale", "translation"),
    "stiffness": ("at", "radius_mm", "value", "soft"), "smooth_stiffness": ("at", "radius_mm", "strength"),
    "paint_region": ("name", "at", "radius_mm", "soft"), "fill_region": ("name", "at", "by", "tolerance_per_mm"),
    "region": ("name", "factor", "colour"), "rename_region": ("name", "to"), "template_landmark": ("name", "at"),
    "confirm": ("at", "radius_mm", "hold"), "landmark": ("name", "at", "held"),
    "structure": ("id", "name", "label", "layer", "colour", "side", "partner", "confidence", "doubt", "shared", "template",
                  "placement", "template_mark"),
    "contours": ("id", "name", "off_mm", "side", "curve", "curves"),
}


def _check(method, given, known):
    """Errors: a keyword that the action does not have."""
    for key in given:
        if key not in known:
            has = f"it has {', '.join(known)}" if known else "it has none"
            raise _core.UsageError(f"{method}: has no keyword {key}; {has}")


def _method(key, example, meaning):
    value = json.loads(example)[key]
    name = _METHODS.get(key, key)

    def within(self, of="", **members):
        _check(name, members, _WITHIN[key])
        return self.do({key: members}, of)

    def alone(self, value, of="", **more):
        _check(name, more, (*_BESIDE.get(key, ()), "joined"))
        return self.do({key: value, **more}, of)

    method = within if isinstance(value, dict) else alone
    method.__name__ = name
    method.__qualname__ = f"Case.{method.__name__}"
    method.__doc__ = f"{meaning}.\n\nThe line of the case file: {example}"
    return method


def _stroke(tool):
    def stroke(self, at, to, sigma_mm, of="", **more):
        _check(tool, more, ("on", "through_space", "strength", "joined"))
        return self.do({"tool": tool, "at": at, "to": to, "sigma_mm": sigma_mm, **more}, of)

    stroke.__name__, stroke.__qualname__ = tool, f"Case.{tool}"
    stroke.__doc__ = f"A stroke of the tool {tool}: from `at`, on the surface, to `to` (LPS mm); it reaches sigma_mm far."
    return stroke


def add_to(case):
    for key, example, meaning in _core.action_kinds():
        if key not in ("undo", "redo"):
            name = _METHODS.get(key, key)
            setattr(case, name, _method(key, example, meaning))
    for tool in _core.drag_tools():
        setattr(case, tool, _stroke(tool))
