"""What Python gives is what the command line gives, to the last bit."""

import json

import numpy
import pytest
from conftest import command_line, refusal_of_command_line

import homolog

without = {"seconds"}


def same(ours, theirs):
    return {k: v for k, v in ours.items() if k not in without} == {k: v for k, v in theirs.items() if k not in without}


def test_a_fit_of_files_gives_the_same_bytes(folder, tmp_path):
    theirs = folder / "fit-1.ply"
    fit = homolog.fit("built-in:kidney", folder / "kidney-1-labels.nii.gz", output=tmp_path / "a.ply")
    assert (tmp_path / "a.ply").read_bytes() == theirs.read_bytes()
    assert not fit.doubtful and fit.report["dice"] > 0.98
    assert same(fit.report, command_line("fit", "built-in:kidney", "--mask", folder / "kidney-1-labels.nii.gz", "-o", tmp_path / "b.ply"))


def test_a_fit_of_what_was_read_is_written_with_the_same_bytes(folder, tmp_path):
    labels = homolog.read_label_map(folder / "kidney-1-labels.nii.gz")
    fit = homolog.fit(homolog.load_template("built-in:kidney"), labels, jobs=1)
    fit.mesh.write(tmp_path / "a.ply")
    assert (tmp_path / "a.ply").read_bytes() == (folder / "fit-1.ply").read_bytes()


def test_a_fit_of_an_array_gives_the_same_points(folder):
    read = homolog.read_label_map(folder / "kidney-1-labels.nii.gz")
    labels = homolog.LabelMap(numpy.ascontiguousarray(read.array), spacing_mm=read.spacing_mm, origin_mm=read.origin_mm,
                              direction=read.direction)
    fit = homolog.fit("built-in:kidney", labels)
    assert numpy.array_equal(fit.mesh.points, homolog.read_mesh(folder / "fit-1.ply").points)


def test_a_model_gives_the_same_bytes_from_files_and_from_meshes(folder, tmp_path):
    files = [folder / f"fit-{k}.ply" for k in (1, 2, 3)]
    report = command_line("model", *files, "-o", tmp_path / "theirs.h5.json")
    ours = homolog.model(files, output=tmp_path / "ours.h5.json")
    assert (tmp_path / "ours.h5.json").read_bytes() == (tmp_path / "theirs.h5.json").read_bytes()
    assert ours.report == report
    homolog.model([homolog.read_mesh(file) for file in files]).write(tmp_path / "again.h5.json")
    assert (tmp_path / "again.h5.json").read_bytes() == (tmp_path / "theirs.h5.json").read_bytes()
    in_memory = [homolog.Mesh(m.points, m.triangles) for m in map(homolog.read_mesh, files)]
    assert numpy.array_equal(homolog.model(in_memory).mean, ours.mean)


def test_reports_of_verbs_are_those_of_the_command_line(folder, tmp_path):
    files = [folder / f"fit-{k}.ply" for k in (1, 2, 3)]
    command_line("model", *files, "-o", tmp_path / "m.h5")
    assert homolog.measure(files) == command_line("measure", *files)
    assert homolog.evaluate(files, samples=50) == command_line("evaluate", *files, "--samples", 50)
    assert homolog.score(files[0], tmp_path / "m.h5") == command_line("score", files[0], "--model", tmp_path / "m.h5")
    assert homolog.compare(files[0], other=files[1]) == command_line("compare", files[0], "--mesh", files[1])
    assert homolog.info(files[0]) == command_line("info", files[0])


def test_a_snap_gives_the_same_bytes(folder, tmp_path):
    mesh, image = folder / "fit-1.ply", folder / "kidney-1-image.nii.gz"
    command_line("snap", mesh, "--image", image, "-o", tmp_path / "theirs.ply")
    snapped = homolog.snap(homolog.read_mesh(mesh), homolog.read_volume(image))
    snapped.mesh.write(tmp_path / "ours.ply")
    assert (tmp_path / "ours.ply").read_bytes() == (tmp_path / "theirs.ply").read_bytes()


@pytest.mark.parametrize("call, line", [
    (lambda f: homolog.fit("built-in:kidney", f / "kidney-1-labels.nii.gz", label=7),
     lambda f: ("fit", "built-in:kidney", "--mask", f / "kidney-1-labels.nii.gz", "--label", 7, "-o", f / "none.ply")),
    (lambda f: homolog.fit("built-in:kidny", f / "kidney-1-labels.nii.gz"),
     lambda f: ("fit", "built-in:kidny", "--mask", f / "kidney-1-labels.nii.gz", "-o", f / "none.ply")),
    (lambda f: homolog.model([f / "fit-1.ply"]), lambda f: ("model", f / "fit-1.ply", "-o", f / "none.h5")),
    (lambda f: homolog.run("compare", f / "fit-1.ply"), lambda f: ("compare", f / "fit-1.ply")),
])
def test_errors_have_the_sentence_of_the_command_line(folder, call, line):
    with pytest.raises(homolog.Error) as raised:
        call(folder)
    assert str(raised.value) == refusal_of_command_line(*line(folder))


def closed_curve(mesh, z):
    """Where a mesh meets the plane at z, round its middle, as 3D Slicer has curves."""
    edges = mesh.points[numpy.vstack([mesh.triangles[:, [k, (k + 1) % 3]] for k in range(3)])]
    edges = edges[(edges[:, 0, 2] < z) & (edges[:, 1, 2] >= z)]
    share = (z - edges[:, 0, 2]) / (edges[:, 1, 2] - edges[:, 0, 2])
    points = edges[:, 0] + share[:, None] * (edges[:, 1] - edges[:, 0])
    aside = points - points.mean(axis=0)
    points = points[numpy.argsort(numpy.arctan2(aside[:, 1], aside[:, 0]))]
    return {"type": "ClosedCurve", "coordinateSystem": "LPS",
            "controlPoints": [{"label": str(k), "position": list(p)} for k, p in enumerate(points.tolist())]}


def test_a_fit_to_contours_gives_the_same_bytes(folder, kidney, tmp_path):
    truth = kidney["truth"][0]
    low, high = truth.points[:, 2].min(), truth.points[:, 2].max()
    planes = low + (high - low) * numpy.array([1, 2, 3, 6, 7, 8]) / 9  # not where the hilum dents the outline
    drawn = tmp_path / "drawn.mrk.json"
    drawn.write_text(json.dumps({"markups": [closed_curve(truth, z) for z in planes]}))
    theirs = command_line("fit", "built-in:kidney", "--contours", drawn, "--off-mm", 1, "-o", tmp_path / "theirs.ply")
    fit = homolog.fit("built-in:kidney", contours=drawn, off_mm=1, output=tmp_path / "ours.ply")
    assert (tmp_path / "ours.ply").read_bytes() == (tmp_path / "theirs.ply").read_bytes()
    assert fit.report["contours_mm"] == theirs["contours_mm"]
    assert homolog.compare(fit.mesh, other=truth)["assd_mm"] < 1
    with pytest.raises(homolog.UsageError, match="^outside=True requires contours$"):
        homolog.fit("built-in:kidney", kidney["labels"], outside=True)


def test_a_wrong_command_is_a_usage_error():
    with pytest.raises(homolog.UsageError, match="see homolog fit --help"):
        homolog.run("fit", "--no-such-option")
