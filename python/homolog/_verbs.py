"""What the command line does, with objects in place of files.

Each function calls the verb of its name in this process. An object that was read from a file stands for that file; one that
was made in memory is lent to the verb, or written to a folder that is removed afterwards.
"""

from __future__ import annotations

import json
import os
from typing import Any, Dict, Optional, Sequence

from . import _core
from ._call import Call, PathOrText, Progress, several, text_of
from ._results import Fit, Study


def run(*arguments: Any, progress: Progress = None, jobs: Optional[int] = None) -> Dict[str, Any]:
    """Does any verb: ``run("info", "ct.nii.gz")`` gives the dict that ``homolog info ct.nii.gz --json`` prints.

    Arguments are those of the command line; objects of homolog stand for their files.
    """
    with Call() as call:
        return call.add(*[text_of(one) if isinstance(one, (int, float)) else one for one in arguments]).run(progress, jobs)


def info(file: Any, *, series: Optional[str] = None, spacing: Optional[Sequence[float]] = None, resample: bool = False,
         labels: Any = None, label: Any = None, frame: Optional[int] = None,
         level: Optional[float] = None) -> Dict[str, Any]:
    """What a volume, mesh, template, case or model is.

    series: the UID of one where a DICOM folder holds several. spacing: x, y, z in mm of a stack of pictures. labels: a
    label map, to which the mesh's distance is measured, with label, frame and level as in compare.
    """
    with Call("info") as call:
        call.add(file).option("mask", labels, lend="labels").options(series=series, spacing=spacing, resample=resample)
        return call.options(label=label, frame=frame, level=level).run()


def _mesh_written(file: str, kept: bool) -> _core.Mesh:
    return _core.read_mesh(file) if kept else _core.loaded(file)


def fit(template: Any, labels: Any = None, *, label: Any = None, mesh: Any = None, image: Any = None,
        contours: Any = None, structure: Any = None, off_mm: Optional[float] = None, outside: bool = False,
        output: Optional[PathOrText] = None, closing_mm: Optional[float] = None, level: Optional[float] = None,
        frame: Optional[int] = None, parts: Optional[str] = None, placement: Any = None, landmarks: Any = None,
        orientation: Optional[str] = None, model: Any = None, beyond: Optional[float] = None, partial: bool = False,
        mirror: bool = False, reach_mm: Optional[float] = None, strength: Optional[float] = None,
        polarity: Optional[str] = None, done: Any = None, resample: bool = False, progress: Progress = None,
        jobs: Optional[int] = None) -> Fit:
    """Fits a template to a label map, a surface (``mesh``), an image (``image``) or contours; see docs/fit.md.

    template: a Mesh, a file or a built-in name. labels: a LabelMap, a file or an image of nibabel. label: a number, a name,
    or a list of them for their union. output: also written there, as ``homolog fit -o`` writes it. landmarks: a file, or
    {name: (x, y, z)} in LPS mm. placement: a file, or {"rotation": [w, x, y, z], "scale": s, "translation": [x, y, z]}.
    model: a Model or a file. contours: a file, or several; alone, or with labels or an image. structure: which of theirs,
    by number or name. off_mm: how far they may lie off the boundary. outside: the organ lies inside of them. done: of an
    image [(mesh, image)] of finished cases, to learn how the boundary looks there. resample: an image's DICOM slices that
    are tilted or uneven become a rectangular grid.
    """
    with Call("fit") as call:
        call.add(template, lend="template")
        call.option("mask", labels, lend="labels").option("mesh", mesh).option("image", image, lend=True)
        if contours is not None:
            call.arguments.append("--contours")
            call.add(*several(contours))
        landmarks, placement = call.landmarks(landmarks), call.json_file(placement, "placement")
        out = os.fspath(output) if output is not None else call.new_file(".ply")
        call.options(label=label, level=level, closing_mm=closing_mm, parts=parts, placement=placement,
                     landmarks=landmarks, orientation=orientation, model=model, beyond=beyond, frame=frame,
                     reach_mm=reach_mm, strength=strength, polarity=polarity, partial=partial, mirror=mirror,
                     structure=structure, off_mm=off_mm, outside=outside, resample=resample)
        call.done(done)
        call.arguments += ["-o", out]
        report = call.run(progress, jobs)
        return Fit(_mesh_written(out, output is not None), report)


def fit_all(template: Any, labels: Any = None, output: PathOrText = "", *, mesh: Any = None, label: Any = None,
            by_others: Optional[int] = None, progress: Progress = None, jobs: Optional[int] = None,
            **options: Any) -> Dict[str, Any]:
    """Fits a template to many label maps, or surfaces (``mesh``), or a folder of them, into the folder ``output``.

    It gets for each case its mesh and a case, and a study of all. options: those of ``homolog fit``. Gives its report.
    Errors: a template, label map or surface that is in memory alone, since the study names its file.
    """
    if not os.fspath(output):
        raise _core.UsageError("output: is missing; give the folder for the meshes")
    with Call("fit") as call:
        call.add_files(template, lend="template")
        for name, values in (("--mask", labels), ("--mesh", mesh)):
            if values is not None:
                call.arguments.append(name)
                call.add_files(*several(values))
        call.options(label=label, by_others=by_others, **options)
        call.arguments += ["-o", os.path.join(os.fspath(output), "")]
        return call.run(progress, jobs)


def snap(mesh: Any, image: Any = None, *, output: Optional[PathOrText] = None, at: Optional[Sequence[float]] = None,
         sigma_mm: Optional[float] = None, frame: Optional[int] = None, reach_mm: Optional[float] = None,
         strength: Optional[float] = None, polarity: Optional[str] = None, done: Any = None, progress: Progress = None,
         jobs: Optional[int] = None) -> Fit:
    """Draws a mesh to the boundary that an image shows; see docs/assistance.md.

    at: LPS mm, only the part around it. done: [(mesh, image)] of finished cases, to learn how the boundary looks there.
    """
    with Call("snap") as call:
        out = os.fspath(output) if output is not None else call.new_file(".ply")
        call.add(mesh, lend="template").option("image", image, lend=True)
        call.options(at=at, sigma_mm=sigma_mm, frame=frame, reach_mm=reach_mm, strength=strength, polarity=polarity)
        call.done(done)
        call.arguments += ["-o", out]
        report = call.run(progress, jobs)
        return Fit(_mesh_written(out, output is not None), report)


def propagate(mesh: Any, image: Any, frame: int, *, output: Optional[PathOrText] = None,
              reach_mm: Optional[float] = None, progress: Progress = None,
              jobs: Optional[int] = None) -> Dict[str, Any]:
    """Carries the mesh of one frame through a cine.

    Gives the report of ``homolog propagate --json``, in which ``meshes`` are the Meshes of all frames. output: the folder
    for meshes, case, study and volumes.
    """
    with Call("propagate") as call:
        out = os.fspath(output) if output is not None else call.folder()
        call.add(mesh, lend="template").option("image", image, lend=True).options(frame=frame, reach_mm=reach_mm)
        call.arguments += ["-o", out]
        report = call.run(progress, jobs)
        report["meshes"] = [_mesh_written(one["mesh"], output is not None) for one in report["frames"]]
        if output is None:
            for one in report["frames"]:
                del one["mesh"]
            del report["case"], report["study"]
        return report


def model(shapes: Any, *, output: Optional[PathOrText] = None, variance: Optional[float] = None,
          modes: Optional[int] = None, keep_scale: bool = False, no_align: bool = False,
          structures: Optional[Sequence[str]] = None, without_doubtful: bool = False, flip_mirrored: bool = False,
          group: Optional[str] = None, optimise: bool = False, csv: Optional[PathOrText] = None,
          aligned: Optional[PathOrText] = None, progress: Progress = None, jobs: Optional[int] = None, **options: Any):
    """A statistical shape model of shapes in correspondence; see docs/models.md.

    shapes: Meshes, Fits, files, cases, a folder or a study. output: also written there (.h5, .h5.json). Gives a Model,
    whose ``report`` is the dict that ``homolog model --json`` prints.
    """
    with Call("model") as call:
        out = os.fspath(output) if output is not None else call.new_file(".h5.json")
        call.add_shapes(shapes)
        call.options(variance=variance, modes=modes, keep_scale=keep_scale, no_align=no_align, structures=structures,
                     without_doubtful=without_doubtful, flip_mirrored=flip_mirrored, group=group, optimise=optimise,
                     csv=csv, aligned=aligned, **options)
        call.arguments += ["-o", out]
        report = call.run(progress, jobs)
        made = _core.read_model(out) if output is not None else _core.loaded_model(out)
        made.report = report
        return made


def evaluate(shapes: Any, *, modes: Optional[str] = None, samples: Optional[int] = None, seed: Optional[int] = None,
             progress: Progress = None, jobs: Optional[int] = None, **options: Any) -> Dict[str, Any]:
    """Compactness, generalisation and specificity of a training set."""
    with Call("evaluate") as call:
        call.add_shapes(shapes).options(modes=modes, samples=samples, seed=seed, **options)
        return call.run(progress, jobs)


def score(new: Any, model: Any, *, label: Any = None, frame: Optional[int] = None, landmarks: Any = None,
          template: Any = None, flip_mirrored: bool = False,
          output: Optional[PathOrText] = None, progress: Progress = None, jobs: Optional[int] = None) -> Dict[str, Any]:
    """How far subjects are from a model, which stays as it is: ``subjects`` [{name, distance, residual_mm, …}].

    new: meshes in the model's numbering, cases, studies, or label maps to which the model's mean is fitted. Or images,
    with landmarks that were placed in one ({name: (x, y, z)} in LPS mm, a file, or a folder with a file of each one's
    name) and the model's template, a Mesh or a file. flip_mirrored: mirror images of the mean are flipped.
    """
    with Call("score") as call:
        call.add_shapes(new, lend="labels" if landmarks is None else True).option("model", model)
        call.options(label=label, frame=frame, landmarks=call.landmarks(landmarks))
        call.option("template", template, lend="template").options(flip_mirrored=flip_mirrored, output=output)
        return call.run(progress, jobs)


def test(shapes: Any, formula: str, *, covariates: Any = None, permutations: Optional[int] = None,
         seed: Optional[int] = None, by_doubt: bool = False, templates: Any = None, without_direction: Any = None,
         csv: Optional[PathOrText] = None, progress: Progress = None, jobs: Optional[int] = None,
         **options: Any) -> Dict[str, Any]:
    """Tests what shapes have to do with what is known of their cases; see docs/statistics.md.

    formula: "shape ~ group + age". covariates: a .csv, a DataFrame of pandas, a list of dicts, a row a case, or a dict
    of lists, a column each. A case's name is in the column name; what a row lacks is empty. templates: folders or studies
    of the same cases in other templates. without_direction: two shapes; what the cases differ along the way from one to
    the other is taken out.
    """
    with Call("test") as call:
        call.add_shapes(shapes).option("formula", formula).table("covariates", covariates)
        call.words("templates", templates).words("without_direction", without_direction)
        call.options(permutations=permutations, seed=seed, by_doubt=by_doubt, csv=csv, **options)
        return call.run(progress, jobs)


def measure(shapes: Any, *, recipe: Any = None, model: Any = None, modes: Optional[int] = None,
            csv: Optional[PathOrText] = None, progress: Progress = None, jobs: Optional[int] = None,
            **options: Any) -> Dict[str, Any]:
    """Volume, area and distances between named landmarks, or the measurements of a recipe; see docs/recipes.md.

    recipe: a file, a shipped name ("femur", "vertebra", "ventricle"), or a dict. model: also along its modes.
    """
    with Call("measure") as call:
        recipe = call.json_file(recipe, "recipe", ".recipe.json")
        call.add_shapes(shapes).option("recipe", recipe).option("model", model)
        call.options(modes=modes, csv=csv, **options)
        return call.run(progress, jobs)


def compare(mesh: Any, *, labels: Any = None, label: Any = None, other: Any = None, frame: Optional[int] = None,
            level: Optional[float] = None, progress: Progress = None) -> Dict[str, Any]:
    """How well a mesh agrees with a label map (``labels``) or another mesh (``other``): dice, assd_mm, hd95_mm, …

    level: of a mask with soft edges the value at its surface.
    """
    with Call("compare") as call:
        call.add(mesh).option("mask", labels, lend="labels").option("mesh", other)
        call.options(label=label, frame=frame, level=level)
        return call.run(progress)


def make_template(source: Any, output: PathOrText, *, label: Any = None, vertices: Optional[int] = None,
                  landmarks: Any = None, consensus: bool = False, best_of: bool = False, progress: Progress = None,
                  jobs: Optional[int] = None, **options: Any):
    """A template of a label map or a surface; see docs/templates.md. Gives the Mesh that was written to ``output``.

    source: a LabelMap, a Mesh or a file. With consensus or best_of several subjects, or a folder of them: the template
    is their mean shape, or the one that fits the others best. options: those of ``homolog template``, as ``tube=True,
    rings=40``.
    """
    sources = several(source)
    if len(sources) > 1 and not consensus and not best_of:
        raise _core.UsageError("source: is several subjects; say consensus=True or best_of=True, or give one of them")
    with Call("template") as call:
        if consensus:
            call.words("consensus", sources)
        if best_of:
            call.words("best_of", sources)
        if not consensus and not best_of:
            call.add(*sources, lend="labels")
        call.options(label=label, vertices=vertices, landmarks=call.landmarks(landmarks), **options)
        call.arguments += ["-o", os.fspath(output)]
        call.run(progress, jobs)
        return _core.read_mesh(os.fspath(output))


def make_set(maps: Any, output: PathOrText, *, labels: Optional[Sequence[str]] = None, like: Any = None,
             consensus: bool = False, vertices: Optional[int] = None, progress: Progress = None,
             jobs: Optional[int] = None) -> Dict[str, Any]:
    """A template of each structure of label maps, NAME.set.json; see docs/structures.md. Without labels: of all."""
    with Call("set", "make") as call:
        call.add(*several(maps)).options(labels=labels, all=labels is None, like=like, consensus=consensus,
                                          vertices=vertices)
        call.arguments += ["-o", os.fspath(output)]
        return call.run(progress, jobs)


def read_set(source: PathOrText) -> Dict[str, Any]:
    """What a template set holds: a file, or "built-in:spine"."""
    with Call("set", "info") as call:
        return call.add(source).run()


def fit_set(templates: PathOrText, maps: Any, output: PathOrText, *, gap_mm: Optional[float] = None,
            frame: Optional[int] = None, progress: Progress = None, jobs: Optional[int] = None) -> Dict[str, Any]:
    """Fits a template set to label maps, into the folder ``output``: CASE/STRUCTURE.ply, CASE.seg.nrrd. Gives the report.

    gap_mm: how far neighbours are kept apart. frame: of label maps with several, from 0.

    Errors: a label map that is in memory alone, since the study beside the cases names its file.
    """
    with Call("fit") as call:
        call.add(templates)
        call.arguments.append("--mask")
        call.add_files(*several(maps)).options(gap_mm=gap_mm, frame=frame)
        call.arguments += ["-o", os.fspath(output)]
        return call.run(progress, jobs)


def repair(maps: Any, templates: PathOrText, output: PathOrText, *, model: Any = None, image: Any = None,
           frame: Optional[int] = None, progress: Progress = None, jobs: Optional[int] = None) -> Dict[str, Any]:
    """Finds what is wrong with the structures of label maps and writes mended maps into ``output``; see docs/repair.md."""
    with Call("repair") as call:
        call.add(*several(maps)).option("templates", templates).option("model", model).option("image", image)
        call.options(frame=frame)
        call.arguments += ["-o", os.fspath(output)]
        return call.run(progress, jobs)


def repair_mesh(mesh: Any, output: PathOrText, **options: Any) -> Dict[str, Any]:
    """Makes a manifold mesh of a broken one. Gives the report, which says what was mended."""
    with Call("repair-mesh") as call:
        call.add(mesh).options(**options)
        call.arguments += ["-o", os.fspath(output)]
        return call.run()


def mirror(template: Any, output: PathOrText, *, plane: Optional[str] = None):
    """The template of the other side, with the same numbering, written to ``output``. Gives the Mesh."""
    with Call("mirror") as call:
        call.add(template).options(plane=plane)
        call.arguments += ["-o", os.fspath(output)]
        call.run()
        return _core.read_mesh(os.fspath(output))


def convert(source: Any, output: PathOrText, **options: Any) -> Dict[str, Any]:
    """Any readable volume or mesh to any writable format. options: those of ``homolog convert``."""
    with Call("convert") as call:
        return call.add(source, output).options(**options).run()


def report(source: Any, output: PathOrText, *, progress: Progress = None, **options: Any) -> Dict[str, Any]:
    """Writes a study or a model as one page for a browser; see docs/report.md."""
    with Call("report") as call:
        call.add(*several(source)).options(**options)
        call.arguments += ["-o", os.fspath(output)]
        return call.run(progress)


def verify(file: PathOrText, *, inputs: Optional[PathOrText] = None, progress: Progress = None) -> Dict[str, Any]:
    """Makes a file anew as its record says and compares; see docs/verify.md.

    Where it is not the same homolog.Error is raised, whose ``report`` is the dict.
    """
    with Call("verify") as call:
        return call.add(file).options(inputs=inputs).run(progress)


def read_study(path: PathOrText) -> Study:
    """Reads a study. Errors: it is none; files that are missing are warnings."""
    name = os.fspath(path)
    _core.check_study(name)
    with open(name, encoding="utf-8") as file:
        return Study(name, json.load(file))


def make_study(maps: Any, output: PathOrText, *, template: Any = None, progress: Progress = None,
               **options: Any) -> Study:
    """A study of label maps, or of a table of cases, with its scans, groups and covariates; see docs/models.md.

    Errors: a template or label map that is in memory alone, since the study names its file.
    """
    with Call("study", "make") as call:
        call.add_files(*several(maps))
        if template is not None:
            call.arguments.append("--template")
            call.add_files(template, lend="template")
        call.options(**options)
        call.arguments += ["-o", os.fspath(output)]
        call.run(progress)
        return read_study(output)
