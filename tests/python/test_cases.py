"""Cases: actions, undo, automatic steps, and the file that they leave."""

import json
import os
import warnings

import numpy
import pytest
from conftest import command_line

import homolog
from homolog import _core


def test_every_action_of_the_list_is_a_method():
    names = {"points": "set_points", "moved": "move_points", "tool": "stroke", "frame": "show_frame"}
    for key, example, _ in _core.action_kinds():
        assert example in getattr(homolog.Case, names.get(key, key)).__doc__ or key in ("undo", "redo")


def test_strokes_are_on_the_disk_and_undo_takes_them_back(tmp_path):
    file = tmp_path / "a.homolog"
    with homolog.Case.create("built-in:kidney", "phantom:kidney:1", file) as case:
        before = case.points()
        at = before[0]
        assert case.grab(at, at + [0, 0, 6], sigma_mm=15)["moved_mm"] == pytest.approx(6, abs=0.5)
        after = case.points()
        assert numpy.linalg.norm(after[0] - before[0]) == pytest.approx(6, abs=0.5)
        assert case.strokes == 1 and case.can_undo and case.undo_names() != []
        case.undo()
        assert numpy.array_equal(case.points(), before) and case.can_redo
        case.redo()
        assert numpy.array_equal(case.points(), after)
        case.note("done by a script")
    assert json.loads(file.read_text().splitlines()[-1]) == {"note": "done by a script"}
    again = homolog.Case.open(file, read_only=True)
    assert numpy.array_equal(again.points(), after)
    command_line("replay", file, "-o", tmp_path / "theirs.ply")
    assert numpy.array_equal(homolog.read_mesh(tmp_path / "theirs.ply").points, after)


def test_a_fit_and_a_snap_are_edits(kidney):
    case = homolog.Case.create("built-in:kidney", kidney["image"])
    truth = kidney["truth"][0]
    start = homolog.compare(case.mesh(), other=truth)["dice"]
    case.fit(kidney["labels"])
    fitted = homolog.compare(case.mesh(), other=truth)["dice"]
    assert start < 0.9 < 0.98 < fitted
    case.snap(reach_mm=4)
    assert homolog.compare(case.mesh(), other=truth)["dice"] > 0.97
    case.undo()
    case.undo()
    assert homolog.compare(case.mesh(), other=truth)["dice"] == start


def test_a_fit_says_what_the_command_line_says_of_it(kidney):
    case = homolog.Case.create("built-in:kidney", kidney["image"])
    voxels = kidney["labels"].array.copy()
    middle = voxels.nonzero()[0].mean().astype(int)
    cut = homolog.LabelMap(voxels[:middle], affine=kidney["labels"].affine)
    with pytest.warns(homolog.HomologWarning, match="cut off by the border of the label map"):
        case.fit(cut)


def test_a_fit_and_a_snap_give_what_the_verb_reports(kidney):
    case = homolog.Case.create("built-in:kidney", kidney["image"])
    before = case.points()
    done = case.fit(kidney["labels"])
    assert done["doubtful"] is False and done["doubt"] == "" and done["dice"] > 0.98 and done["closing_why"]
    way = numpy.linalg.norm(case.points() - before, axis=1).mean()
    assert done["moved_mm"] == pytest.approx(way) and way > 1
    told = homolog.fit("built-in:kidney", kidney["labels"]).report
    assert set(told) <= set(done)
    assert done["dice"] == pytest.approx(told["dice"], abs=1e-3)
    assert done["doubt_mm"]["mean"] == pytest.approx(told["doubt_mm"]["mean"], rel=0.05)
    snapped = case.snap(reach_mm=4)
    assert 0 < snapped["confidence"] <= 1 and snapped["moved_mm"] > 0 and snapped["doubtful"] in (True, False)


def test_a_doubtful_fit_says_so(kidney):
    case = homolog.Case.create("built-in:kidney")
    voxels = numpy.zeros((40, 40, 40), numpy.uint8)
    voxels[18:22, 18:22, 2:38] = 1  # a rod is no kidney
    with pytest.warns(homolog.HomologWarning):
        done = case.fit(homolog.LabelMap(voxels, spacing_mm=(2, 2, 2)))
    assert done["doubtful"] is True and done["doubt"].endswith(".")


def test_what_is_no_stroke_says_how_far_vertices_went():
    case = homolog.Case.create("built-in:kidney")
    points = case.points()
    assert case.set_points(points + [0, 3, 4])["moved_mm"] == pytest.approx(5, abs=1e-3)
    assert case.undo()["moved_mm"] == pytest.approx(5, abs=1e-3)
    assert case.note("nothing moves")["moved_mm"] == 0
    case.placement(rotation=[1, 0, 0, 0], scale=1, translation=[0, 0, 0])
    assert case.placement(rotation=[1, 0, 0, 0], scale=1, translation=[6, 0, 8])["moved_mm"] == pytest.approx(10, abs=1e-3)


def test_a_label_map_is_taken_as_a_file_too(folder):
    case = homolog.Case.create("built-in:kidney", "phantom:kidney:1")
    case.fit(folder / "kidney-1-labels.nii.gz")
    apart = numpy.abs(case.points() - homolog.read_mesh(folder / "fit-1.ply").points).max()
    assert apart < 0.01  # a case keeps points in steps of 15 nm; the verb may close the label otherwise
    with pytest.raises(homolog.Error, match="kidney-1-labels.nii.gz: label 9 does not occur"):
        case.fit(folder / "kidney-1-labels.nii.gz", label="9")


def test_regions_stiffness_and_landmarks_are_set():
    case = homolog.Case.create("built-in:kidney")
    at = case.points()[10]
    case.stiffness(at=at, radius_mm=10, value=50, soft=0)
    assert case.mesh().stiffness[10] > 10 * case.mesh().stiffness.min()
    case.confirm(at=at, radius_mm=5, hold=True)
    held = case.points()[10].copy()
    case.grab(case.points()[200], case.points()[200] + [0, 0, 3], sigma_mm=10)
    assert numpy.array_equal(case.points()[10], held)
    case.stiffness_base(5)
    case.scheme("raw")
    case.spacing(0.5)


@pytest.mark.parametrize("action, sentence", [
    ({"tool": "push"}, "action: \"push\" is not one of pull"), ({"no_such": 1}, "action: is of no known kind"),
    ({}, "action: is of no known kind"),
    ({"frame": 3}, "frame"),
    ({"stiffness_base": float("nan")}, "action: \"stiffness_base\" holds a number that is not finite"),
    ({"tool": "pull", "at": [0, float("inf"), 0], "to": [0, 0, 1], "sigma_mm": 5}, "action: \"at\" holds a number that is not"),
    ({"tool": "pull", "at": [0, 0, 0], "sigma_mm": 5}, "action: lacks the key \"to\", which its kind of line needs"),
    ({"placement": {"rotation": [1, 0, 0, 0], "scale": 1}}, "action: lacks the key \"translation\""),
    ({"placement": {"rotation": [1, 0, 0, 0], "scale": "1", "translation": [0, 0, 0]}},
     "action: \"scale\" holds a value of the wrong kind"),
    ({"placement": 5}, "action: lacks the key \"rotation\""),
])
def test_a_wrong_action_is_refused_and_changes_nothing(action, sentence):
    case = homolog.Case.create("built-in:kidney")
    before = case.points()
    with pytest.raises(homolog.Error, match=sentence):
        case.do(action)
    assert numpy.array_equal(case.points(), before) and not case.can_undo


@pytest.mark.parametrize("action, kind", [([1], "list"), ("undo", "str"), (None, "NoneType")])
def test_what_is_no_action_is_refused_with_a_sentence(action, kind):
    with pytest.raises(homolog.Error, match=f"action: is a {kind}; give a dict, as "):
        homolog.Case.create("built-in:kidney").do(action)


def test_a_placement_that_lacks_a_key_is_told_which():
    with pytest.raises(homolog.Error, match="placement: lacks the key \"scale\""):
        homolog.Case.create("built-in:kidney", placement={"rotation": [1, 0, 0, 0], "translation": [0, 0, 0]})


def test_a_case_at_work_is_not_touched_by_other_calls(kidney):
    case = homolog.Case.create("built-in:kidney", kidney["image"])
    calls = [case.points, case.mesh, case.close, case.undo_names, case.undo, lambda: case.structures,
             lambda: case.image, lambda: case.can_undo, lambda: case.frames, lambda: homolog.picture_of_case(case)]
    refusals = []

    def progress(share, text):
        if share == 1:
            return  # the work has ended
        for call in calls:
            with pytest.raises(homolog.Error, match="case: is at work in another call"):
                call()
            refusals.append(call)

    before = case.points()
    case.fit(kidney["labels"], progress=progress)
    assert len(refusals) >= len(calls)
    assert not numpy.array_equal(case.points(), before) and case.can_undo


def test_a_case_is_of_what_was_read_when_the_file_has_changed_since(kidney, tmp_path):
    one, other = kidney["truth"][0], kidney["truth"][0].with_points(kidney["truth"][0].points * 2)
    one.write(tmp_path / "t.ply")
    read = homolog.read_mesh(tmp_path / "t.ply")
    kidney["image"].write(tmp_path / "scan.nii.gz")
    image = homolog.read_volume(tmp_path / "scan.nii.gz")
    expected = homolog.Case.create(homolog.Mesh(read.points, read.triangles)).points()
    assert homolog.Case.create(read, image).image._file == str(tmp_path / "scan.nii.gz")
    other.write(tmp_path / "t.ply")
    homolog.Volume(image.array[:-1], affine=image.affine).write(tmp_path / "scan.nii.gz")
    assert numpy.array_equal(homolog.Case.create(read).points(), expected)
    assert homolog.Case.create(read, image).image.shape == image.shape
    with pytest.raises(homolog.Error, match="template: is in memory alone"):
        homolog.Case.create(read, path=tmp_path / "a.homolog")
    with pytest.raises(homolog.Error, match="image: is in memory alone"):
        homolog.Case.create("built-in:kidney", image, tmp_path / "a.homolog")


def test_an_array_alone_cannot_be_named_by_a_case_file(kidney, tmp_path):
    image = homolog.Volume(kidney["image"].array)
    with pytest.raises(homolog.Error, match="image: is in memory alone"):
        homolog.Case.create("built-in:kidney", image, tmp_path / "a.homolog")


def test_a_label_map_of_another_scan_is_refused(kidney):
    case = homolog.Case.create("built-in:kidney", kidney["image"])
    labels = kidney["labels"]
    affine = labels.affine.copy()
    affine[0, 3] += 2000
    with pytest.raises(homolog.Error, match="lies outside of .*; give the scan that it was drawn on"):
        case.fit(homolog.LabelMap(labels.array, affine=affine))
    assert not case.can_undo


def test_arrays_of_numpy_are_refused_with_what_to_make_of_them(kidney):
    array = kidney["labels"].array
    case = homolog.Case.create("built-in:kidney", kidney["image"])
    for call in (lambda: homolog.fit("built-in:kidney", array), lambda: homolog.compare(case.mesh(), labels=array),
                 lambda: case.fit(array), lambda: homolog.make_template(array, "never.ply")):
        with pytest.raises(homolog.Error, match=r"is an array of numpy.*; give homolog.LabelMap\("):
            call()
    for call in (lambda: homolog.snap(case.mesh(), array), lambda: homolog.Case.create("built-in:kidney", array)):
        with pytest.raises(homolog.Error, match=r"is an array of numpy.*; give homolog.Volume\("):
            call()
    with pytest.raises(homolog.Error, match=r"is an array of numpy.*; give homolog.Mesh\("):
        homolog.fit(case.points(), kidney["labels"])


def test_the_stubs_have_every_method_of_a_case():
    import pathlib
    stub = (pathlib.Path(homolog.__file__).parent / "_core.pyi").read_text().split("class Case:")[1].split("\nclass ")[0]
    for name in dir(homolog.Case):
        assert name.startswith("_") or f"def {name}(" in stub, name


def test_curves_of_a_wrong_kind_are_named_with_the_remedy():
    case = homolog.Case.create("built-in:kidney", "phantom:kidney:1")
    rows = numpy.arange(12.0).reshape(4, 3)
    good = {"points": rows.ravel()}
    for curves, words in (([good, {"points": rows[:, :2]}], "curve 1 of .* one list of numbers; give x, y, z"),
                          ([good, rows], "curve 1 of .* is no object; give"),
                          ([{"points": [1, 2, 3, 4]}], "curve 0 of .* give three for each")):
        with pytest.raises(homolog.Error, match=words):
            case.contours(id="c1", curves=curves)
    case.contours(id="c1", curves=[good])
    case.contours(id="c2", curves=[{"points": rows}, {"points": rows.tolist()}])
    assert case.can_undo


def test_points_are_set_as_rows(tmp_path):
    case = homolog.Case.create("built-in:kidney", path=tmp_path / "a.homolog")
    moved = case.points() + [0, 0, 5]
    case.set_points(moved)
    assert numpy.allclose(case.points(), moved, atol=1e-4)
    case.set_points((moved + 1).ravel())
    assert numpy.allclose(case.points(), moved + 1, atol=1e-4)


def test_keywords_that_an_action_does_not_have_are_refused(tmp_path):
    case = homolog.Case.create("built-in:kidney", "phantom:kidney:1")
    at = case.points()[0]
    for call, key in ((lambda: case.pull(at, at + 1, 10, sigma=3), "sigma"),
                      (lambda: case.confirm(at=at, radius=5), "radius"),
                      (lambda: case.note("a", off="s1"), "off"), (lambda: case.scheme("raw", event=3), "event")):
        with pytest.raises(homolog.UsageError, match=f"has no keyword {key}; it has"):
            call()
    with pytest.raises(homolog.Error, match="case: has no structure \"s9\""):
        case.note("a", of="s9")
    assert not case.can_undo


def test_the_keywords_of_actions_are_those_of_the_schema():
    import os

    from homolog import _actions
    schema = json.loads(open(os.path.join(os.environ["HOMOLOG_SOURCE"], "docs/schemas/case-line.schema.json")).read())
    for key, example, _ in _core.action_kinds():
        line = schema["$defs"]["stroke" if key == "tool" else key]["properties"]
        if key in _actions._WITHIN:
            within = line[key].get("properties") or schema["$defs"]["similarity"]["properties"]
            assert set(_actions._WITHIN[key]) == set(within), key
        elif key not in ("undo", "redo"):
            assert set(_actions._BESIDE.get(key, ())) == set(line) - {key, "joined"}, key


def test_a_case_is_measured_as_it_is(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    case = homolog.Case.create("built-in:kidney", path="a.homolog")
    assert case.source == str(tmp_path / "a.homolog")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    case.placement(rotation=[1, 0, 0, 0], scale=2, translation=[0, 0, 0])
    volume = case.mesh().volume_ml
    assert homolog.measure(case)["cases"][0]["volume_ml"] == pytest.approx(volume, rel=1e-6)
    case.close()
    seen = homolog.Case.open(tmp_path / "a.homolog", read_only=True)
    assert homolog.measure(seen)["cases"][0]["volume_ml"] == pytest.approx(volume, rel=1e-6)
    seen.placement(rotation=[1, 0, 0, 0], scale=1, translation=[0, 0, 0])
    with pytest.raises(homolog.Error, match="case: has edits that are not in its file; save it by save_as first"):
        homolog.measure(seen)
    seen.save_as("b.homolog")
    assert homolog.measure(seen)["cases"][0]["volume_ml"] == pytest.approx(volume / 8, rel=1e-6)


def test_a_closed_case_takes_no_edits(kidney, tmp_path):
    with homolog.Case.create("built-in:kidney", "phantom:kidney:1", tmp_path / "a.homolog") as case:
        case.note("an edit")
    text = (tmp_path / "a.homolog").read_text()
    for call in (lambda: case.note("another"), case.undo, lambda: case.fit(kidney["labels"]), case.refine):
        with pytest.raises(homolog.Error, match="case: is closed; open it again"):
            call()
    assert len(case.points()) > 0 and (tmp_path / "a.homolog").read_text() == text
    case.save_as(tmp_path / "b.homolog")
    case.note("another")
    assert json.loads((tmp_path / "b.homolog").read_text().splitlines()[-1]) == {"note": "another"}


def test_numbers_and_dicts_that_json_lacks():
    case = homolog.Case.create("built-in:kidney")
    case.do({"stiffness_base": numpy.longdouble(5)})
    case.stiffness_base(numpy.int16(4))
    case.placement(rotation=numpy.array([1, 0, 0, 0], dtype=numpy.longdouble), scale=1, translation=[0, 0, 0])
    circle = {"note": "a"}
    circle["fit"] = circle
    for action, words in ((circle, "value: holds itself"), ({"frame": 2**70}, "whole number above those of 64 bits"),
                          ({"frame": -2**70}, "below those of 64 bits"), ({"spacing": 1j}, "has no place in JSON")):
        with pytest.raises(homolog.Error, match=words):
            case.do(action)


def test_an_image_is_read_with_progress_and_held_once(folder, kidney):
    told = []
    file = folder / "kidney-1-image.nii.gz"
    case = homolog.Case.create("built-in:kidney", file, progress=lambda share, text: told.append(share))
    assert told[-1] == 1
    assert numpy.shares_memory(case.image.array, case.image.array)
    assert numpy.array_equal(case.image.array, homolog.read_volume(file).array)
    held = homolog.Case.create("built-in:kidney", kidney["image"])
    assert numpy.shares_memory(held.image.array, kidney["image"].array)


def test_a_label_is_a_number_or_a_name(kidney):
    case = homolog.Case.create("built-in:kidney", kidney["image"])
    case.fit(kidney["labels"], label=1)
    points = case.points()
    case.undo()
    case.fit(kidney["labels"], label=["1"])
    assert numpy.array_equal(case.points(), points)
    for label in (1.5, True, [[1]]):
        with pytest.raises(homolog.Error, match="^label: "):
            case.fit(kidney["labels"], label=label)
    with pytest.raises(homolog.Error, match="labels: is a int; give a LabelMap"):
        case.fit(5)


def test_a_case_is_fitted_to_contours_of_a_file_as_one_edit(tmp_path):
    angles = numpy.arange(16) * numpy.pi / 8
    markups = []
    for z in (-24, -12, 0, 12, 24):
        across = numpy.sqrt(1 - z * z / 900)
        points = [{"id": str(n), "position": [20 * across * numpy.cos(a), 26 * across * numpy.sin(a), z]} for n, a in enumerate(angles)]
        markups.append({"type": "ClosedCurve", "coordinateSystem": "LPS", "controlPoints": points})
    file = tmp_path / "drawn.mrk.json"
    file.write_text(json.dumps({"markups": markups}))
    case = homolog.Case.create("built-in:kidney")
    before = case.points()
    done = case.fit_to_contours(file)
    after = case.points()
    assert done["contours"] == 5 and done["contours_mm"]["mean"] < 1 and done["moved_mm"] > 0
    assert done["doubtful"] in (True, False) and (done["doubt"] == "") == (not done["doubtful"])
    assert numpy.abs(after.min(axis=0) + [20, 26, 30]).max() < 4 and numpy.abs(after.max(axis=0) - [20, 26, 30]).max() < 4
    case.undo()
    assert numpy.array_equal(case.points(), before)
    with pytest.raises(homolog.Error, match="spleen"):
        case.fit_to_contours(file, structure="spleen")
    with pytest.raises(homolog.Error, match="no image"):
        case.fit_to_contours([file], with_image=True)


def test_a_case_that_is_there_is_replaced_only_where_one_says_so(tmp_path):
    file, other = tmp_path / "a.homolog", tmp_path / "b.homolog"
    with homolog.Case.create("built-in:kidney", path=file) as case:
        case.note("an hour of work")
    text = file.read_text()
    refusal = "a.homolog: is there already; give overwrite=True to replace it, or go on with a case by homolog.Case.open"
    with pytest.raises(homolog.Error, match=refusal):
        homolog.Case.create("built-in:kidney", path=file)
    case = homolog.Case.create("built-in:kidney", path=other)
    case.note("another")
    with pytest.raises(homolog.Error, match=refusal):
        case.save_as(file)
    assert file.read_text() == text and case.source == str(other)
    case.save_as(other)  # its own file
    case.note("and on")
    assert json.loads(other.read_text().splitlines()[-1]) == {"note": "and on"}
    case.save_as(file, overwrite=True)
    assert json.loads(file.read_text().splitlines()[-1]) == {"note": "and on"}
    case.close()
    homolog.Case.create("built-in:kidney", path=file, overwrite=True)
    assert len(file.read_text().splitlines()) == 1


def test_a_case_that_a_forked_process_edited_goes_on_elsewhere_and_says_so(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "home"))
    file = tmp_path / "a.homolog"
    case = homolog.Case.create("built-in:kidney", "phantom:kidney:1", file)
    at = case.points()
    case.grab(at[0], at[0] + [0, 0, 2], sigma_mm=15)
    child = os.fork()
    if child == 0:
        case.grab(at[1], at[1] + [0, 0, 2], sigma_mm=15)
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0
    theirs = file.read_bytes()
    with pytest.warns(homolog.HomologWarning, match="was changed by another program.*The edits are in ") as told:
        case.grab(at[2], at[2] + [0, 0, 2], sigma_mm=15)
    assert file.read_bytes() == theirs
    kept = str(told[0].message).split("The edits are in ")[1].rstrip(".")
    again = homolog.Case.open(kept, read_only=True)
    assert numpy.array_equal(again.points(), case.points())


def test_what_another_call_did_while_a_step_was_at_work_is_not_taken_back(monkeypatch):
    case = homolog.Case.create("built-in:kidney")
    voxels = numpy.zeros((40, 40, 40), numpy.uint8)
    voxels[18:22, 18:22, 2:38] = 1  # a rod is no kidney
    edited = []

    def edit(*_, **__):
        if not edited:
            at = case.points()[0]
            case.grab(at, at + [0, 0, 3], sigma_mm=10)
            edited.append(case.points())

    monkeypatch.setattr(warnings, "warn", edit)  # a warning is said before the step is applied
    with pytest.raises(homolog.Error, match="case: was edited by another call while this one was at work"):
        case.fit(homolog.LabelMap(voxels, spacing_mm=(2, 2, 2)))
    assert edited and numpy.array_equal(case.points(), edited[0])
