"""Pickles and copies: what goes from one process to another."""

import copy
import multiprocessing
import pickle
from concurrent.futures import ProcessPoolExecutor

import numpy
import pytest

import homolog


def again(value):
    return pickle.loads(pickle.dumps(value))


def tilted(kind, **more):
    turned = numpy.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]]) @ [[1, 0, 0], [0, 0.28, -0.96], [0, 0.96, 0.28]]
    voxels = numpy.arange(24, dtype=numpy.uint8).reshape(2, 3, 4)
    return kind(voxels, direction=turned, spacing_mm=(0.7, 0.8, 2.5), origin_mm=(-31.1, 4.7, 500.3), **more)


@pytest.mark.parametrize("make", [
    lambda: tilted(homolog.Volume, modality="CT"),
    lambda: homolog.Volume(numpy.arange(48.0).reshape(2, 3, 4, 2) / 7, frame_seconds=0.04),
])
def test_a_volume_goes_through_a_pickle_to_the_last_bit(make):
    volume = make()
    other = again(volume)
    assert type(other) is homolog.Volume and other.source == ""
    assert numpy.array_equal(other.array, volume.array) and other.array.dtype == volume.array.dtype
    assert numpy.array_equal(other.affine, volume.affine) and other.spacing_mm == volume.spacing_mm
    assert (other.frame_seconds, other.modality) == (volume.frame_seconds, volume.modality)


@pytest.mark.parametrize("names", [None, {1: "left kidney", 2: "tumour, or cyst"}])
def test_a_label_map_keeps_its_names(names):
    labels = tilted(homolog.LabelMap, names=names)
    other = again(labels)
    assert type(other) is homolog.LabelMap and other.source == "" and other.names == labels.names
    assert numpy.array_equal(other.array, labels.array) and numpy.allclose(other.affine, labels.affine, atol=1e-12)
    cine = homolog.LabelMap(numpy.stack([labels.array] * 2, axis=3), names=names)
    assert numpy.array_equal(again(cine).array, cine.array) and again(cine).names == cine.names


def test_layers_of_a_label_map_are_kept(tmp_path):
    one, two = numpy.zeros((2, 6, 5, 4), numpy.uint8)
    one[1:4], two[2:5] = 1, 1
    segments = "".join(f"Segment{k}_ID:=s{k}\nSegment{k}_Name:={name}\nSegment{k}_LabelValue:=1\nSegment{k}_Layer:={k}\n"
                       for k, name in enumerate(("liver", "tumour")))
    header = ("NRRD0004\ntype: unsigned char\ndimension: 4\nspace: left-posterior-superior\nsizes: 2 6 5 4\n"
              "space directions: none (1,0,0) (0,1,0) (0,0,1)\nkinds: list domain domain domain\nendian: little\n"
              f"encoding: raw\nspace origin: (0,0,0)\n{segments}\n")
    (tmp_path / "a.seg.nrrd").write_bytes(header.encode() + numpy.stack([one, two]).tobytes(order="F"))
    other = again(homolog.read_label_map(tmp_path / "a.seg.nrrd"))
    assert [layer.names for layer in other.layers] == [{1: "liver"}, {1: "tumour"}]
    assert numpy.array_equal(other.mask("tumour"), two == 1)


def test_a_mesh_and_a_fit_keep_all_values(tmp_path):
    template = homolog.load_template("built-in:kidney")
    assert again(template).source == "built-in:kidney" and numpy.array_equal(again(template).points, template.points)
    rng = numpy.random.default_rng(1)
    mesh = homolog.Mesh(template.points * 1.1, template.triangles, stiffness=rng.uniform(1, 2, len(template)),
                        doubt_mm=rng.uniform(0, 1, len(template)), landmarks={"hilum": (1 / 3, 2, -4.5)})
    fit = again(homolog.Fit(mesh, {"doubtful": True, "dice": 0.5}))
    assert fit.doubtful and fit.report["dice"] == 0.5 and fit.mesh.source == ""
    for key in ("points", "triangles", "stiffness", "doubt_mm"):
        assert numpy.array_equal(getattr(fit.mesh, key), getattr(mesh, key)), key
    assert fit.mesh.landmarks == mesh.landmarks
    points = again(homolog.Mesh(template.points))
    assert numpy.array_equal(points.points, template.points) and len(points.triangles) == 0


def test_a_mesh_keeps_what_else_its_file_has(tmp_path):
    (tmp_path / "a.vtk").write_text(
        "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 3 double\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n"
        "3 0 1 2\nPOINT_DATA 3\nSCALARS thickness double 1\nLOOKUP_TABLE default\n0.1 0.2 0.3\n")
    mesh = homolog.read_mesh(tmp_path / "a.vtk")
    assert list(mesh.arrays) == ["thickness"]
    assert numpy.array_equal(again(mesh).arrays["thickness"], mesh.arrays["thickness"])


def test_a_model_keeps_its_numbers_and_its_report(folder):
    model = homolog.model([folder / f"fit-{k}.ply" for k in (1, 2, 3)])
    for other in (again(model), copy.copy(model), copy.deepcopy(model)):
        for key in ("mean", "modes", "variances", "scores"):
            assert numpy.array_equal(getattr(other, key), getattr(model, key)), key
        assert other.names == model.names and other.report == model.report and other.source == ""


def test_copies_of_what_never_changes_are_the_same_object():
    for value in (tilted(homolog.Volume), tilted(homolog.LabelMap), homolog.load_template("built-in:kidney")):
        assert copy.copy(value) is value and copy.deepcopy(value) is value
    fit = homolog.Fit(homolog.load_template("built-in:kidney"), {"dice": 0.5})
    assert copy.deepcopy(fit).mesh is fit.mesh and copy.deepcopy(fit).report is not fit.report


def test_a_case_is_neither_pickled_nor_copied():
    case = homolog.Case.create("built-in:kidney")
    for call in (pickle.dumps, copy.copy, copy.deepcopy):
        with pytest.raises(homolog.Error, match="case: cannot be pickled or copied.*by homolog.Case.open"):
            call(case)


def moved(mesh):
    return mesh.with_points(mesh.points + [1, 2, 3])


def test_a_pool_of_processes_takes_meshes_and_gives_them():
    template = homolog.load_template("built-in:kidney")
    meshes = [homolog.Mesh(template.points * k, template.triangles) for k in (1, 2)]
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
        done = list(pool.map(moved, meshes, timeout=300))
    for mesh, other in zip(meshes, done):
        assert numpy.array_equal(other.points, mesh.points + [1, 2, 3])
