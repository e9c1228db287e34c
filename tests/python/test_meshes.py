"""Meshes, templates and landmarks."""

import numpy
import pytest

import homolog


def test_points_are_a_view_and_files_keep_them_to_the_last_bit(tmp_path):
    template = homolog.load_template("built-in:kidney")
    assert template.points.shape == (len(template), 3) and template.points.dtype == numpy.float64
    with pytest.raises(ValueError):
        template.points[0, 0] = 1
    template.write(tmp_path / "t.ply")
    again = homolog.read_mesh(tmp_path / "t.ply")
    assert numpy.array_equal(again.points, template.points) and numpy.array_equal(again.triangles, template.triangles)
    assert again.landmarks == template.landmarks and numpy.allclose(again.stiffness, template.stiffness, rtol=1e-6)


def test_a_mesh_of_arrays_has_the_volume_of_its_shape():
    cube = homolog.Mesh(
        numpy.array([[x, y, z] for x in (0, 10) for y in (0, 10) for z in (0, 10)], dtype=float),
        [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]])
    assert cube.volume_ml == pytest.approx(1) and cube.area_mm2 == pytest.approx(600)
    assert cube.describe()["closed"] is True


def test_moved_points_move_the_label_map():
    subject = homolog.phantom("kidney", 1)
    truth = subject["truth"][0]
    here = truth.label_map(subject["labels"])
    spacing = subject["labels"].spacing_mm
    there = truth.with_points(truth.points + [2 * spacing[0], 0, 0]).label_map(subject["labels"], value=4)
    assert numpy.array_equal(there.array[2:], 4 * here.array[:-2])


def test_a_phantom_spine_has_named_labels_and_the_truth_of_each():
    spine = homolog.phantom("spine", 3)
    assert set(spine["truth"]) == set(spine["labels"].names.values())
    inside_ml = spine["labels"].mask("vertebrae_L3").sum() * numpy.prod(spine["labels"].spacing_mm) / 1000
    assert inside_ml == pytest.approx(spine["truth"]["vertebrae_L3"].volume_ml, rel=0.03)
    with pytest.raises(homolog.Error, match="no organ of the phantoms"):
        homolog.phantom("spleen", 1)


@pytest.mark.parametrize("points, triangles, sentence", [
    (numpy.zeros((3, 642)), None, r"points: has the shape \(3, 642\); give n×3.*transpose it"),
    (numpy.zeros((5, 2)), None, r"points: has the shape \(5, 2\)"),
    (numpy.zeros((0, 3)), None, "points: is empty"),
    (numpy.array([["a", "b", "c"]]), None, "points: has the dtype <U1"),
    (numpy.zeros((4, 3), dtype=complex), None, "points: has the dtype complex128"),
    (numpy.array([[0, 0, 0], [0, numpy.nan, 0]]), None, r"points: at \[1, 1\] is no finite number"),
    (numpy.full((4, 3), 1e12), None, r"points: at \[0, 0\] lies beyond"),
    (numpy.zeros((4, 3)), numpy.zeros((2, 4), int), r"triangles: have the shape \(2, 4\)"),
    (numpy.zeros((4, 3)), numpy.zeros((2, 3)), "triangles: have the dtype float64"),
    (numpy.zeros((4, 3)), [[0, 1, 4]], r"triangles: name vertex 4 at \[0, 2\]"),
])
def test_what_is_no_mesh_is_refused_with_a_sentence(points, triangles, sentence):
    with pytest.raises(homolog.Error, match=sentence):
        homolog.Mesh(points, triangles)


def test_landmarks_go_to_a_file_and_back(tmp_path):
    landmarks = {"hilum": (1.0, 2.0, 3.5), "pole": (-4.0, 0.25, 9.0)}
    homolog.write_landmarks(landmarks, tmp_path / "a.mrk.json")
    assert homolog.read_landmarks(tmp_path / "a.mrk.json") == landmarks


def test_a_mesh_stays_what_was_read_when_its_file_changes(tmp_path):
    truth = homolog.phantom("kidney", 1)["truth"][0]
    truth.write(tmp_path / "a.ply")
    mesh = homolog.read_mesh(tmp_path / "a.ply")
    truth.with_points(truth.points * 2).write(tmp_path / "a.ply")
    assert homolog.measure(mesh)["cases"][0]["volume_ml"] == homolog.measure(truth)["cases"][0]["volume_ml"]
    assert homolog.measure(homolog.load_template("built-in:kidney"))["cases"][0]["volume_ml"] > 50


def test_a_template_is_named_by_a_path_too(tmp_path):
    import pathlib

    template = homolog.load_template("built-in:kidney")
    template.write(tmp_path / "t.ply")
    assert numpy.array_equal(homolog.load_template(tmp_path / "t.ply").points, template.points)
    assert len(homolog.load_template(pathlib.Path("built-in:kidney"))) == len(template)
    assert len(homolog.Case.create(tmp_path / "t.ply").points()) == len(template)
    with pytest.raises(homolog.Error, match="source: is a int; give a file"):
        homolog.load_template(5)


def test_a_label_map_warns_where_the_mesh_lies_elsewhere():
    subject = homolog.phantom("kidney", 1)
    truth = subject["truth"][0]
    with pytest.warns(homolog.HomologWarning, match="lies outside"):
        away = truth.with_points(truth.points + [5000, 5000, 5000]).label_map(subject["labels"])
    assert away.array.max() == 0
    with pytest.warns(homolog.HomologWarning, match="metres"):
        truth.with_points(truth.points / 1000).label_map(subject["labels"])
