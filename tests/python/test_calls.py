"""Long calls: the interpreter's lock, progress, Ctrl-C, threads; and how fast it is."""

import _thread
import os
import signal
import subprocess
import sys
import threading
import time

import numpy
import pytest
from conftest import command_line

import homolog


def test_other_threads_go_on_and_progress_is_told(kidney):
    told, turns, stop = [], [0], threading.Event()

    def count():
        while not stop.is_set():
            turns[0] += 1
            time.sleep(0.005)

    thread = threading.Thread(target=count)
    thread.start()
    homolog.fit("built-in:kidney", kidney["labels"], jobs=1, progress=lambda share, text: told.append(share))
    stop.set()
    thread.join()
    assert turns[0] > 20
    assert told == sorted(told) and told[-1] == 1 and len(told) > 2


def test_ctrl_c_stops_a_call_and_the_next_one_works(kidney):
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have started this with it ignored
    timer = threading.Timer(0.3, _thread.interrupt_main)
    timer.start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        for _ in range(100):
            homolog.fit("built-in:kidney", kidney["labels"], jobs=1)
    assert time.monotonic() - start < 10
    assert not homolog.fit("built-in:kidney", kidney["labels"]).doubtful


def test_ctrl_c_stops_a_phantom():
    signal.signal(signal.SIGINT, signal.default_int_handler)
    homolog.phantom("ventricle", 1)  # what is made once for all subjects
    timer = threading.Timer(0.2, _thread.interrupt_main)
    timer.start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        for k in range(2, 100):
            homolog.phantom("ventricle", k)
    assert time.monotonic() - start < 10


def test_what_progress_raises_stops_the_call(kidney):
    class Enough(Exception):
        pass

    def progress(share, text):
        raise Enough

    with pytest.raises(Enough):
        homolog.fit("built-in:kidney", kidney["labels"], progress=progress)


def test_jobs_hold_for_one_call_and_wrong_ones_are_refused(kidney):
    before = homolog.thread_limit()
    one = homolog.fit("built-in:kidney", kidney["labels"], jobs=1).mesh.points
    assert homolog.thread_limit() == before
    assert numpy.array_equal(one, homolog.fit("built-in:kidney", kidney["labels"], jobs=3).mesh.points)
    with pytest.raises(homolog.Error, match="jobs: is 0"):
        homolog.fit("built-in:kidney", kidney["labels"], jobs=0)


def test_the_limit_is_as_before_once_two_calls_with_jobs_have_ended(kidney):
    before = homolog.thread_limit()
    first_began, second_began, first_ended = (threading.Event() for _ in range(3))
    limits = []

    def first_told(share, text):
        first_began.set()
        second_began.wait(60)

    def second_told(share, text):
        second_began.set()
        first_ended.wait(60)

    def work(jobs, told):
        homolog.fit("built-in:kidney", kidney["labels"], jobs=jobs, progress=told)

    first = threading.Thread(target=work, args=(1, first_told))
    second = threading.Thread(target=work, args=(before + 1, second_told))
    first.start()
    first_began.wait(60)
    second.start()
    second_began.wait(60)
    first.join()
    limits.append(homolog.thread_limit())
    first_ended.set()
    second.join()
    assert limits == [before + 1] and homolog.thread_limit() == before


def test_two_calls_at_a_time_give_what_one_gives(kidney):
    alone = homolog.fit("built-in:kidney", kidney["labels"]).mesh.points
    found = [None, None]

    def work(k):
        found[k] = homolog.fit("built-in:kidney", kidney["labels"]).mesh.points

    threads = [threading.Thread(target=work, args=(k,)) for k in (0, 1)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert numpy.array_equal(found[0], alone) and numpy.array_equal(found[1], alone)


def test_homolog_threads_is_read_at_import():
    def limit(value):
        return subprocess.run([sys.executable, "-c", "import homolog; print(homolog.thread_limit())"],
                              env={**os.environ, "HOMOLOG_THREADS": value}, capture_output=True, text=True)

    assert limit("3").stdout.strip() == "3"
    assert "give a whole number from 1 to 1024" in limit("many").stderr


def test_import_needs_no_display_and_says_its_version():
    done = subprocess.run([sys.executable, "-c", "import homolog; print(homolog.__version__)"], capture_output=True,
                          text=True, env={"PATH": os.environ["PATH"]})
    program = subprocess.run([os.environ["HOMOLOG_PROGRAM"], "--version"], capture_output=True, text=True).stdout
    assert program.startswith(f"homolog {done.stdout.strip()}\n")


def test_a_picture_is_an_array_and_png(kidney):
    try:
        picture = homolog.picture_of_meshes([kidney["truth"][0]], size=(320, 240))
    except homolog.Error as error:
        pytest.skip(str(error))
    assert picture.array.shape == (240, 320, 4) and picture.array.std() > 5
    assert picture._repr_png_().startswith(b"\x89PNG")


def test_reading_is_a_small_part_of_the_progress_and_no_case_of_an_earlier_call_is_named(folder, tmp_path):
    maps = [folder / f"kidney-{k}-labels.nii.gz" for k in (1, 2)]
    homolog.fit_all("built-in:kidney", maps, tmp_path / "fits")
    told = []
    homolog.fit("built-in:kidney", maps[0], progress=lambda share, text: told.append((share, text)))
    assert all(text == "" for _, text in told)
    assert told[-1][0] == 1 and (len(told) < 3 or told[0][0] < 0.9)


def test_calls_at_a_time_keep_apart_maps_of_the_same_voxels_with_other_names(kidney):
    read = kidney["labels"]
    array = read.array.copy()
    array[:3, :3, :3] = 2
    ours = homolog.LabelMap(array, affine=read.affine, names={1: "kidney", 2: "corner"})
    theirs = homolog.LabelMap(array, affine=read.affine, names={1: "corner", 2: "kidney"})
    found = []

    def progress(share, text):
        if not found:  # while our map is lent
            found.append(homolog.compare(kidney["truth"][0], labels=theirs, label="corner")["dice"])

    homolog.fit("built-in:kidney", ours, label="kidney", jobs=1, progress=progress)
    assert found[0] > 0.9
    assert homolog.compare(kidney["truth"][0], labels=ours, label="kidney")["dice"] == found[0]


def test_an_error_and_a_model_without_a_report_have_an_empty_one(folder):
    with pytest.raises(homolog.Error) as raised:
        homolog.read_volume("no-such-file.nrrd")
    assert raised.value.report == {}
    raised.value.report["mine"] = 1
    assert homolog.Error("another").report == {}
    homolog.model([folder / f"fit-{k}.ply" for k in (1, 2, 3)]).write(folder / "reported.h5")
    assert homolog.read_model(folder / "reported.h5").report == {}


@pytest.mark.parametrize("sentence, verb, said", [
    ("a.nii.gz: holds several labels (1, 2); name one of them by --label", ("fit",),
     "a.nii.gz: holds several labels (1, 2); name one of them by label"),
    ("--label requires --mask; see homolog compare --help", ("compare",), "label requires labels"),
    ("exactly one of --mask and --mesh is required", ("compare",), "exactly one of labels and other is required"),
    ("3 of 4 are in doubt; repair some, or leave --without-doubtful out", ("model",),
     "3 of 4 are in doubt; repair some, or leave without_doubtful=True out"),
    ("spine: stays as it is; give the changed set a name with -o", ("set", "make"),
     "spine: stays as it is; give the changed set a name with output"),
    ("-o, --output is required; see homolog set make --help", ("set", "make"), "output is required"),
    ("is far larger; turn it by convert --from-ras", ("model",), "is far larger; turn it by convert --from-ras"),
    ("a--label.ply and x/--label: do not exist", ("fit",), "a--label.ply and x/--label: do not exist"),
])
def test_a_sentence_has_the_keywords_of_python(sentence, verb, said):
    from homolog._words import in_python

    assert in_python(sentence, verb) == said


def test_warnings_too_have_the_keywords_of_python(folder):
    image = folder / "warned.nii.gz"
    homolog.Volume(numpy.zeros((4, 4, 4), numpy.uint8)).write(image)
    with pytest.warns(homolog.HomologWarning, match="has a spacing of its own, so spacing has no effect"):
        homolog.info(image, spacing=(1, 1, 2))


def test_errors_name_keywords_and_run_names_options(kidney, tmp_path):
    two = homolog.LabelMap(numpy.kron(numpy.array([[[1, 2]]], numpy.uint8), numpy.ones((6, 6, 6), numpy.uint8)),
                           affine=numpy.eye(4))
    with pytest.raises(homolog.Error, match="name one of them by label$"):
        homolog.fit("built-in:kidney", two)
    with pytest.raises(homolog.Error, match="name one of them by label$"):
        homolog.Case.create("built-in:kidney").fit(two)
    with pytest.raises(homolog.Error, match="so all_frames=True has no effect"):
        homolog.model([kidney["truth"][0]] * 2, all_frames=True)
    with pytest.raises(homolog.UsageError, match="^keep_scale=True excludes no_align=True$|^no_align=True excludes"):
        homolog.model([kidney["truth"][0]] * 2, no_align=True, keep_scale=True)
    kidney["truth"][0].write(tmp_path / "truth.ply")
    with pytest.raises(homolog.Error, match="so --all-frames has no effect"):
        homolog.run("model", tmp_path / "truth.ply", "--all-frames", "-o", tmp_path / "m.h5")


@pytest.mark.parametrize("call, words", [
    (lambda h: h.score("new.nii.gz", "m.h5", landmarks="l.mrk.json", template="t.ply", flip_mirrored=True),
     ["--landmarks", "l.mrk.json", "--template", "t.ply", "--flip-mirrored"]),
    (lambda h: h.fit_set("s.set.json", ["a.nrrd"], "out", frame=2), ["--frame", "2"]),
    (lambda h: h.compare("a.ply", labels="b.nrrd", level=0.4), ["--mask", "b.nrrd", "--level", "0.4"]),
    (lambda h: h.info("dicom", series="1.2.3"), ["--series", "1.2.3"]),
    (lambda h: h.test("fits", "shape ~ age", templates=["a.study.json", "b"], without_direction=("open.ply", "shut.ply")),
     ["--templates", "a.study.json", "b", "--without-direction", "open.ply", "shut.ply"]),
])
def test_options_have_the_words_of_the_command_line(monkeypatch, call, words):
    from homolog import _call

    given = []
    monkeypatch.setattr(_call.Call, "run", lambda self, *_: given.extend(self.arguments) or {})
    call(homolog)
    start = given.index(words[0])
    assert given[start:start + len(words)] == words


def test_a_mesh_learns_from_cases_that_are_done(folder, tmp_path):
    mesh, image = folder / "fit-1.ply", folder / "kidney-1-image.nii.gz"
    command_line("snap", mesh, "--image", image, "--done", mesh, image, "-o", tmp_path / "theirs.ply")
    ours = homolog.snap(mesh, image, done=[(mesh, homolog.read_volume(image))], output=tmp_path / "ours.ply")
    assert numpy.array_equal(ours.mesh.points, homolog.read_mesh(tmp_path / "theirs.ply").points)
    with pytest.raises(homolog.Error, match="done: is no list of pairs"):
        homolog.snap(mesh, image, done=[mesh, image])


def test_several_subjects_become_one_template(folder, tmp_path):
    maps = [folder / f"kidney-{k}-labels.nii.gz" for k in (1, 2)]
    command_line("template", "--consensus", *maps, "--vertices", 200, "-o", tmp_path / "theirs.ply")
    made = homolog.make_template(maps, tmp_path / "ours.ply", consensus=True, vertices=200)
    assert numpy.array_equal(made.points, homolog.read_mesh(tmp_path / "theirs.ply").points)
    with pytest.raises(homolog.UsageError, match="say consensus=True or best_of=True"):
        homolog.make_template(maps, tmp_path / "ours.ply")


def test_numbers_of_numpy_are_taken_within_dicts_and_as_flags(folder, kidney):
    placement = {"rotation": numpy.array([1.0, 0, 0, 0]), "scale": numpy.float32(1), "translation": numpy.zeros(3)}
    homolog.fit("built-in:kidney", kidney["labels"], placement=placement)
    with pytest.raises(homolog.Error, match="placement: holds a object; give numbers"):
        homolog.fit("built-in:kidney", kidney["labels"], placement={"rotation": object()})
    files = [folder / f"fit-{k}.ply" for k in (1, 2, 3)]
    assert numpy.array_equal(homolog.model(files, keep_scale=numpy.bool_(True)).mean,
                             homolog.model(files, keep_scale=True).mean)
    assert homolog.model(files, keep_scale=numpy.bool_(False)).report == homolog.model(files).report


def test_fits_are_taken_where_meshes_are(folder):
    fits = [homolog.Fit(homolog.read_mesh(folder / f"fit-{k}.ply"), {}) for k in (1, 2, 3)]
    model = homolog.model(fits)
    assert model.score(fits[0])["distance"] == model.score(fits[0].mesh)["distance"]
    assert numpy.array_equal(model.coefficients(fits[0]), model.coefficients(fits[0].mesh))
    assert len(homolog.Case.create(fits[0]).points()) == len(fits[0].mesh)
    try:
        homolog.picture_of_meshes(fits[:2], size=(64, 48))
    except homolog.Error as error:
        assert "OpenGL" in str(error) or "EGL" in str(error), error
    with pytest.raises(homolog.Error, match="mesh 0: is a str; give a Mesh or a Fit"):
        homolog.picture_of_meshes(["a.ply"])
    with pytest.raises(homolog.Error, match="template: is a int; give a Mesh"):
        homolog.Case.create(7)
    with pytest.raises(homolog.Error, match="image: is a list; give a Volume"):
        homolog.Case.create("built-in:kidney", [])


def test_a_file_written_anew_while_it_is_lent_is_not_taken_for_what_it_held(tmp_path):
    i, j, k = numpy.indices((24, 24, 24))
    ball = lambda radius: homolog.LabelMap(((i - 12) ** 2 + (j - 12) ** 2 + (k - 12) ** 2 < radius ** 2).astype("uint8"))  # noqa: E731
    file = tmp_path / "a.nrrd"
    ball(6).write(file)
    first, refused = homolog.read_label_map(file), []

    def meanwhile(*_):
        if refused:
            return
        ball(9).write(file)
        try:
            homolog.make_template(homolog.read_label_map(file), tmp_path / "b.ply", vertices=300)
            refused.append("")
        except homolog.Error as error:
            refused.append(str(error))

    homolog.make_template(first, tmp_path / "c.ply", vertices=300, progress=meanwhile)
    assert "written anew while another call" in refused[0]
    homolog.make_template(homolog.read_label_map(file), tmp_path / "b.ply", vertices=300)


def test_names_of_files_need_not_be_utf_8(tmp_path):
    missing = os.fsdecode(bytes(tmp_path) + b"/no\xff.nii")
    with pytest.raises(homolog.Error) as refused:
        homolog.read_volume(missing)
    assert missing in str(refused.value)
    with pytest.raises(homolog.Error) as refused:
        homolog.info(missing)
    assert missing in str(refused.value)
    there = os.fsdecode(bytes(tmp_path) + b"/ball\xff.ply")
    homolog.Case.create("built-in:kidney", "phantom:kidney:1").mesh().write(there)
    mesh = homolog.read_mesh(there)
    assert mesh.source == there
    assert homolog.info(there)["vertices"] == len(mesh.points)
    assert homolog.info(mesh)["vertices"] == len(mesh.points)
