import json
import os
import pathlib
import shutil
import subprocess

import pytest

import homolog


def command_line(*arguments, cwd=None):
    """What the program reports; it must succeed."""
    done = subprocess.run([os.environ["HOMOLOG_PROGRAM"], *map(str, arguments), "--json"], cwd=cwd, capture_output=True,
                          text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def refusal_of_command_line(*arguments):
    """The sentence with which the program refuses, without what stands before it."""
    done = subprocess.run([os.environ["HOMOLOG_PROGRAM"], *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode in (1, 2)
    return done.stderr.strip().splitlines()[-1].removeprefix("homolog: ")


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """A folder with three phantom kidneys, their label maps, and fits of the built-in template by the command line."""
    return shutil.copytree(os.environ["HOMOLOG_KIDNEYS"], tmp_path_factory.mktemp("kidneys") / "made")


@pytest.fixture(scope="session")
def kidney():
    return homolog.phantom("kidney", 1)


@pytest.fixture(scope="session")
def data():
    path = pathlib.Path(os.environ.get("HOMOLOG_DATA", ""))
    if not os.environ.get("HOMOLOG_DATA") or not path.is_dir():
        pytest.skip("HOMOLOG_DATA is not there")
    return path
