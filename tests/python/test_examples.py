"""The scripts of docs/examples/python run."""

import os
import pathlib
import subprocess
import sys

import pytest

scripts = sorted((pathlib.Path(os.environ["HOMOLOG_SOURCE"]) / "docs" / "examples" / "python").glob("*.py"))


@pytest.mark.parametrize("script", scripts, ids=lambda script: script.stem)
def test_an_example_runs(script, tmp_path):
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_the_page_shows_the_script():
    page = (scripts[0].parents[2] / "python.md").read_text()
    script = next(one for one in scripts if one.stem == "labels_to_model").read_text()
    code = script.split('"""')[-1].strip()  # what stands behind its first words
    assert f"```python\n{code}\n```" in page


def test_there_are_four():
    assert len(scripts) == 4
