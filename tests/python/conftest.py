import json
import os
import pathlib
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
    path = tmp_path_factory.mktemp("kidneys")
    for k in (1, 2, 3):
        command_line("phantom", "kidney", "--subject", k, "-o", path)
    for k in (1, 2, 3):
        command_line("fit", "built-in:kidney", "--mask", f"kidney-{k}-labels.nii.gz", "-o", f"fit-{k}.ply", cwd=path)
    return path


@pytest.fixture(scope="session")
def kidney():
    return homolog.phantom("kidney", 1)


@pytest.fixture(scope="session")
def data():
    path = pathlib.Path(os.environ.get("HOMOLOG_DATA", ""))
    if not os.environ.get("HOMOLOG_DATA") or not path.is_dir():
        pytest.skip("HOMOLOG_DATA is not there")
    return path
