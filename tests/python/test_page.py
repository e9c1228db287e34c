"""The examples of docs/python.md run, each with the files and arrays that it speaks of.

Sets and repair take minutes, and measurements and pictures need more than two kidneys: scripts and other tests have them.
"""

import os
import pathlib
import re
import shutil
import sys
import warnings

import numpy
import pytest

import homolog
from conftest import command_line

source = pathlib.Path(os.environ["HOMOLOG_SOURCE"])
examples = [(heading.strip(), code) for section in re.split(r"^## ", (source / "docs" / "python.md").read_text(), flags=re.M)[1:]
            for heading, code in [(section.split("\n", 1)[0], block) for block in re.findall(r"```python\n(.*?)```", section, re.S)]]


@pytest.fixture(scope="module")
def fits(folder):
    return [homolog.read_mesh(folder / f"fit-{k}.ply") for k in (1, 2, 3)]


def put_scan(folder):
    """A CT of a kidney as ct.nii.gz and as the DICOM series ct/, with its label map."""
    phantom = homolog.phantom("kidney", 1)
    image, labels = phantom["image"], phantom["labels"]
    image.write("ct.nii.gz")
    named = homolog.LabelMap(labels.array, affine=labels.affine, names={1: "left kidney"})
    named.write("labels.seg.nrrd")
    return image, named


def dicom_maker():
    pytest.importorskip("pydicom")
    sys.path.insert(0, str(source / "tests" / "dicom"))
    import make_dicom_objects

    return make_dicom_objects


def put_contours(points):
    """The structure "left kidney" in rt.dcm: an ellipse around the organ in each of five planes."""
    make = dicom_maker()
    turns = numpy.linspace(0, 2 * numpy.pi, 24, endpoint=False)
    drawn = []
    for z in numpy.linspace(points[:, 2].min(), points[:, 2].max(), 7)[1:-1]:
        there = points[numpy.abs(points[:, 2] - z) < 3][:, :2]
        middle, half = (there.max(0) + there.min(0)) / 2, (there.max(0) - there.min(0)) / 2
        drawn.append(("CLOSED_PLANAR", [(*(middle + half * (numpy.cos(u), numpy.sin(u))), z) for u in turns]))
    make.save(make.rtstruct({1: ("left kidney", drawn)}), pathlib.Path("rt.dcm"))


def put_series(image):
    """The scan as a DICOM series."""
    make = dicom_maker()
    array, affine = image.array, image.affine
    spacing = numpy.linalg.norm(affine[:3, :3], axis=0)
    axes = (affine[:3, :3] / spacing).T
    pathlib.Path("ct").mkdir()
    for k in range(array.shape[2]):
        ds = make.basis(make.CT, "CT", f"{make.SERIES}.{k + 1}")
        ds.SeriesInstanceUID, ds.InstanceNumber = make.SERIES, k + 1
        ds.ImagePositionPatient = [make.number(v) for v in affine[:3, :3] @ (0, 0, k) + affine[:3, 3]]
        ds.ImageOrientationPatient = [make.number(v) for v in axes[:2].ravel()]
        ds.PixelSpacing, ds.SliceThickness = [make.number(spacing[1]), make.number(spacing[0])], make.number(spacing[2])
        ds.Columns, ds.Rows, ds.SamplesPerPixel, ds.PhotometricInterpretation = *array.shape[:2], 1, "MONOCHROME2"
        ds.BitsAllocated, ds.BitsStored, ds.HighBit, ds.PixelRepresentation = 16, 16, 15, 1
        ds.PixelData = array[:, :, k].T.astype("<i2").tobytes()
        make.save(ds, pathlib.Path("ct") / f"{k:03}.dcm")


def volumes(fits):
    nibabel = pytest.importorskip("nibabel")
    image, labels = put_scan(pathlib.Path())
    put_series(image)
    labels.write("mask.nii.gz")
    return {"array": labels.array, "affine_lps": labels.affine, "image": nibabel.load("mask.nii.gz")}


def meshes(fits):
    scan, labels = put_scan(pathlib.Path())
    maps = [homolog.phantom("kidney", k)["labels"] for k in (1, 2)]
    return {"scan": scan, "labels": labels, "maps": maps, "points": fits[0].points, "triangles": fits[0].triangles}


def fitting(fits):
    scan, labels = put_scan(pathlib.Path())
    pathlib.Path("labels").mkdir()
    for k in (1, 2):
        homolog.phantom("kidney", k)["labels"].write(f"labels/case_{k}.nii.gz")
    command_line("phantom", "ventricle", "--subject", 1, "-o", ".", cwd=os.getcwd())
    cine = homolog.read_volume(next(pathlib.Path().glob("ventricle-1-image*")))
    return {"template": "built-in:kidney", "labels": labels, "scan": scan, "mesh_1": fits[0], "scan_1": scan, "cine": cine,
            "mesh": homolog.read_mesh(sorted(pathlib.Path().glob("ventricle-1-truth*.ply"))[0])}


def case(fits):
    scan, labels = put_scan(pathlib.Path())
    put_contours(fits[0].points)
    at = fits[0].points[0]
    return {"labels": labels, "at": at, "to": at + 2}


def models(fits):
    put_scan(pathlib.Path())
    shutil.copy("ct.nii.gz", "new.nii.gz")
    kidney = homolog.load_template("built-in:kidney")
    kidney.write("kidney.ply")
    placed = homolog.phantom("kidney", 1)["truth"][0].landmarks
    homolog.write_landmarks({name: at for name, at in placed.items() if name in kidney.landmarks}, "placed.mrk.json")
    rows = ["name,file,group"]
    for k, mesh in enumerate(fits):
        mesh.write(f"c{k}.ply")
        rows.append(f"c{k},c{k}.ply,{'ill' if k == 0 else 'healthy'}")
    fits[0].write("new.ply")
    pathlib.Path("cases.csv").write_text("\n".join(rows))
    homolog.make_study("cases.csv", "kidneys.study.json", template="built-in:kidney")
    return {"meshes": fits, "new": "new.ply"}


setups = {"From label maps to a model": lambda fits: {}, "Volumes and label maps": volumes, "Meshes and templates": meshes,
          "Fit, snap, propagate": fitting, "Cases": case, "Models, scores, studies": models}


@pytest.mark.parametrize("heading, code", [one for one in examples if one[0] in setups], ids=lambda one: one[:24])
def test_an_example_of_the_page_runs(heading, code, fits, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    known = setups[heading](fits)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", homolog.HomologWarning)
        exec(compile(code, f"docs/python.md, {heading}", "exec"), {"homolog": homolog, **known})
