"""Long calls: the interpreter's lock, progress, Ctrl-C, threads; and how fast it is."""

import _thread
import os
import subprocess
import sys
import threading
import time

import numpy
import pytest

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
    timer = threading.Timer(0.3, _thread.interrupt_main)
    timer.start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        for _ in range(100):
            homolog.fit("built-in:kidney", kidney["labels"], jobs=1)
    assert time.monotonic() - start < 10
    assert not homolog.fit("built-in:kidney", kidney["labels"]).doubtful


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
