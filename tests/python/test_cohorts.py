"""Sets, studies, tests, repairs and cines."""

import numpy
import pytest
from conftest import command_line

import homolog


def test_groups_that_differ_in_size_are_found():
    base = homolog.phantom("kidney", 0)["truth"][0]
    rng = numpy.random.default_rng(1)
    shapes, rows = {}, []
    for k in range(12):
        large = k % 2
        noise = rng.normal(0, 0.3, base.points.shape)
        shapes[f"case_{k}"] = base.with_points(base.points * [1, 1, 1 + 0.2 * large] + noise)
        rows.append({"name": f"case_{k}", "group": "long" if large else "short"})
    report = homolog.test(shapes, "shape ~ group", covariates=rows, permutations=199)
    group = next(term for term in report["terms"] if term["name"] == "group")
    assert group["p"] < 0.02 and group["r2"] > 0.5


def test_a_model_scores_its_own_shapes_as_near_and_others_as_far(folder):
    model = homolog.model([folder / f"fit-{k}.ply" for k in (1, 2, 3)])
    mesh = homolog.read_mesh(folder / "fit-1.ply")
    near, far = model.score(mesh), model.score(mesh.points * [1, 1, 1.5])
    assert near["residual_mm"] < 0.2 < 1 < far["residual_mm"]
    assert model.score(folder / "fit-1.ply")["distance"] == near["distance"]
    with pytest.raises(homolog.Error, match="^shape: has other faces"):
        model.score(homolog.Mesh(mesh.points, mesh.triangles[::-1]))
    assert numpy.allclose(model.shape([0, 0]).points, model.mean)
    assert numpy.allclose(model.coefficients(model.mode(0, 2)), [2, 0], atol=1e-4)
    assert model.modes.shape == (len(model), len(mesh), 3)
    assert numpy.allclose(model.mean + 2 * numpy.sqrt(model.variances[0]) * model.modes[0], model.mode(0, 2).points)


def test_a_cohort_is_fitted_into_a_study(folder, tmp_path):
    report = homolog.fit_all("built-in:kidney", [folder / f"kidney-{k}-labels.nii.gz" for k in (1, 2)], tmp_path / "fits")
    assert report["fitted"] == 2 and report["failed"] == 0
    study = homolog.read_study(report["study"])
    assert [case["name"] for case in study.cases] == ["kidney-1-labels", "kidney-2-labels"]
    assert homolog.model(study).report["shapes"] == 2
    paths = numpy.array([case["file"] for case in study.cases])
    assert homolog.model(paths).report["shapes"] == 2


def test_a_study_is_not_made_of_what_has_no_file(folder, kidney, tmp_path):
    file = folder / "kidney-1-labels.nii.gz"
    alone = homolog.Mesh(kidney["truth"][0].points, kidney["truth"][0].triangles)
    calls = [lambda: homolog.fit_all(alone, file, tmp_path / "a"),
             lambda: homolog.fit_all("built-in:kidney", [file, kidney["labels"]], tmp_path / "a"),
             lambda: homolog.fit_set("built-in:spine", [kidney["labels"]], tmp_path / "b"),
             lambda: homolog.make_study([kidney["labels"]], tmp_path / "a.study.json", template="built-in:kidney"),
             lambda: homolog.make_study([file], tmp_path / "a.study.json", template=alone)]
    for call in calls:
        with pytest.raises(homolog.Error, match="a study names its files, and this is in memory alone; write it to a file"):
            call()
    with pytest.raises(homolog.UsageError, match="output: is missing; give the folder for the meshes"):
        homolog.fit_all("built-in:kidney", file)
    assert list(tmp_path.iterdir()) == []
    template = homolog.load_template("built-in:kidney")
    study = homolog.make_study([homolog.read_label_map(file)], tmp_path / "a.study.json", template=template)
    assert len(study.cases) == 1


@pytest.mark.parametrize("name", ["../out", "a/b", "/out", ".hidden", ""])
def test_a_name_that_leads_out_of_the_folder_is_refused(kidney, name):
    with pytest.raises(homolog.Error, match="cannot name a shape; give a name without / that does not begin with a dot"):
        homolog.measure({name: kidney["truth"][0]})


def test_a_mesh_goes_through_a_cine():
    heart = homolog.phantom("ventricle", 1)
    report = homolog.propagate(heart["truth"][0], heart["image"], 0)
    assert len(report["meshes"]) == heart["image"].frames == 20
    for k in (5, 10):
        assert homolog.compare(report["meshes"][k], other=heart["truth"][k])["assd_mm"] < 1.5
    assert report["end_systolic_volume_ml"] < 0.8 * report["end_diastolic_volume_ml"]


def test_a_template_is_made_of_an_array(kidney, tmp_path):
    labels = homolog.LabelMap(kidney["labels"].array, affine=kidney["labels"].affine)
    template = homolog.make_template(labels, tmp_path / "t.ply", vertices=800)
    assert abs(len(template) - 800) < 100
    assert homolog.compare(template, labels=labels)["dice"] > 0.97


def test_shares_in_an_array_are_told_what_they_become(kidney):
    shares = kidney["labels"].array * 0.8
    with pytest.raises(homolog.Error, match="are a soft mask"):
        homolog.fit("built-in:kidney", shares)
    fit = homolog.fit("built-in:kidney", homolog.Volume(shares, affine=kidney["labels"].affine))
    assert fit.report["dice"] > 0.9


def test_a_label_map_in_memory_is_scored(kidney, folder):
    model = homolog.model([folder / f"fit-{k}.ply" for k in (1, 2, 3)])
    subject = homolog.score(kidney["labels"], model)["subjects"][0]
    assert subject["distance"] < 3 and len(subject["modes"]) == len(model)


def test_a_model_says_which_part_of_a_label_it_is_of(folder, tmp_path):
    whole = homolog.model([folder / f"fit-{k}.ply" for k in (1, 2, 3)])
    assert whole.facing is None and whole.open_at is None
    for k in (1, 2, 3):
        header, rest = (folder / f"fit-{k}.ply").read_bytes().split(b"end_header", 1)
        comment = b"comment homolog.ends_at aorta,left atrium\n"
        (tmp_path / f"{k}.ply").write_bytes(header + comment + b"end_header" + rest)
    part = homolog.model([tmp_path / f"{k}.ply" for k in (1, 2, 3)])
    assert part.facing is None and part.open_at == "aorta,left atrium"
    part.write(tmp_path / "part.h5")
    assert homolog.read_model(tmp_path / "part.h5").open_at == part.open_at


def test_a_map_is_repaired_in_memory_as_on_the_command_line(tmp_path):
    command_line("phantom", "spine", "--subject", 4, "-o", tmp_path)
    whole = homolog.read_label_map(tmp_path / "spine-4-labels.nii.gz")
    # Every other voxel: the figures need not be good here, only the same both ways.
    labels = homolog.LabelMap(whole.array[::2, ::2, ::2], affine=whole.affine @ numpy.diag([2, 2, 2, 1]), names=whole.names)
    two = [one["name"] for one in labels.labels[:2]]
    made = homolog.make_set(labels, tmp_path / "two.set.json", labels=two)
    assert [one["name"] for one in made["structures"]] == two
    damaged = labels.array.copy()
    damaged[damaged > 2] = 0
    damaged[1:4, 1:4, 1:4] = 1  # an island
    island = homolog.LabelMap(damaged, affine=labels.affine, names=labels.names)
    report = homolog.repair(island, tmp_path / "two.set.json", tmp_path / "mended")
    first = report["cases"][0]["structures"][0]
    assert "island" in [defect["kind"] for defect in first["defects"]] and first["changed_voxels"] >= 27
    mended = homolog.read_label_map(report["cases"][0]["file"])
    assert mended.array[1:4, 1:4, 1:4].max() == 0 and mended.names[1] == two[0]
    damaged_file = tmp_path / "damaged.seg.nrrd"
    island.write(damaged_file)
    theirs = command_line("repair", damaged_file, "--templates", tmp_path / "two.set.json", "-o", tmp_path / "theirs")
    assert theirs["cases"][0]["structures"] == report["cases"][0]["structures"]


def test_the_built_in_set_says_its_structures():
    assert "vertebrae_L3" in [one["name"] for one in homolog.read_set("built-in:spine")["structures"]]


def test_real_kidneys_give_what_the_command_line_gives(data, tmp_path):
    masks = sorted((data / "kidney_masks").rglob("*.nii.gz"))[:1]
    if not masks:
        pytest.skip("no kidney masks there")
    label = homolog.read_label_map(masks[0]).labels[0]["value"]
    theirs = command_line("fit", "built-in:kidney", "--mask", masks[0], "--label", label, "-o", tmp_path / "theirs.ply")
    fit = homolog.fit("built-in:kidney", masks[0], label=label, output=tmp_path / "ours.ply")
    assert (tmp_path / "ours.ply").read_bytes() == (tmp_path / "theirs.ply").read_bytes()
    assert fit.report["dice_raw"] == theirs["dice_raw"]


@pytest.mark.parametrize("numbers, sentence", [
    ([1e300], "coefficients: lead to a point that lies beyond"), ([1j], "coefficients: has the dtype complex128"),
    (["1"], "coefficients: has the dtype <U1"), (numpy.ma.masked_equal([1.0, 2.0], 2), "coefficients: hides values"),
    ([numpy.nan], "coefficients: hold a number that is not finite"), ([1, 2, 3, 4], "coefficients: are no list"),
])
def test_coefficients_are_finite_numbers_in_reach(folder, numbers, sentence):
    model = homolog.model([folder / f"fit-{k}.ply" for k in (1, 2, 3)])
    with pytest.raises(homolog.Error, match=sentence):
        model.shape(numbers)
    assert numpy.allclose(model.shape([]).points, model.mean)
    for deviations, words in ((numpy.nan, "are no finite number"), (1e300, "lead to a point that lies beyond")):
        with pytest.raises(homolog.Error, match=f"deviations: {words}"):
            model.mode(0, deviations)


def test_a_seed_is_a_whole_number(folder):
    model = homolog.model([folder / f"fit-{k}.ply" for k in (1, 2, 3)])
    assert numpy.array_equal(model.sample(numpy.int16(7)).points, model.sample(seed=7).points)
    model.sample(2**64 - 1)
    for seed in (-1, 2**64, 1.5, "1", None, True):
        with pytest.raises(homolog.Error, match="seed: is no whole number from 0 to 18446744073709551615; give one"):
            model.sample(seed)


def test_covariates_are_rows_or_columns():
    base = homolog.phantom("kidney", 0)["truth"][0]
    rng = numpy.random.default_rng(1)
    shapes = {f"case_{k}": base.with_points(base.points + rng.normal(0, 0.3, base.points.shape)) for k in range(8)}
    rows = [{"name": name, "age": 30 + 5 * k} for k, name in enumerate(shapes)]
    rows[3]["remark"] = "a further key"
    columns = {"name": list(shapes), "age": [row["age"] for row in rows]}
    results = [homolog.test(shapes, "shape ~ age", covariates=table, permutations=99) for table in (rows, columns)]
    assert results[0]["terms"] == results[1]["terms"]
    for table, words in (({"name": ["a"], "age": []}, "covariates: has columns of several lengths"),
                         ({"name": "a"}, "covariates: is a dict that holds something else"),
                         (5, "covariates: is no table"), ([], "covariates: is no table")):
        with pytest.raises(homolog.Error, match=words):
            homolog.test(shapes, "shape ~ age", covariates=table)


def test_shapes_in_memory_are_called_by_their_position(folder):
    files = [homolog.read_mesh(folder / f"fit-{k}.ply") for k in (1, 2, 3)]
    meshes = [homolog.Mesh(one.points, one.triangles) for one in files]
    assert homolog.model(meshes).names == ["1", "2", "3"]
    assert homolog.model([meshes[0], files[1], homolog.Fit(meshes[2], {})]).names == ["1", "fit-2", "3"]
    assert [one["case"] for one in homolog.measure(meshes)["cases"]] == ["1", "2", "3"]
    other = homolog.Mesh(meshes[0].points[:3], [[0, 1, 2]])
    for wrong in ([*meshes[:2], other], {"anna": meshes[0], "ben": other}):
        with pytest.raises(homolog.Error) as raised:
            homolog.model(wrong)
        words = ("shape 3: has ", " where shape 1 has ") if isinstance(wrong, list) else ("ben: has ", " where anna has ")
        assert all(one in str(raised.value) for one in words) and "/" not in str(raised.value)
    with pytest.warns(homolog.HomologWarning, match="^shape 1: is itself a shape of the model"):
        homolog.score(meshes, homolog.model(meshes))
