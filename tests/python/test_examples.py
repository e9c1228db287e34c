"""The scripts of docs/examples/python run."""

import os
import pathlib
import subprocess
import sys

import pytest

scripts = sorted((pathlib.Path(os.environ["HOMOLOG_SOURCE"]) / "docs" / "examples" / "python").glob("*.py"))


def run(script, folder):
    done = subprocess.run([sys.executable, script], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("script", [one for one in scripts if one.stem != "heart"], ids=lambda script: script.stem)
def test_an_example_runs(script, tmp_path):
    run(script, tmp_path)


def page_and_script(page, stem):
    script = next(one for one in scripts if one.stem == stem)
    return (script.parents[2] / page).read_text(), script


@pytest.mark.parametrize("page, stem", [("python.md", "labels_to_model"), ("heart.md", "heart")])
def test_the_page_shows_the_script(page, stem):
    text, script = page_and_script(page, stem)
    code = script.read_text().split('"""')[-1].strip()  # what stands behind its first words
    assert f"```python\n{code}\n```" in text


def test_the_page_of_the_heart_says_what_the_script_prints(tmp_path):
    text, script = page_and_script("heart.md", "heart")
    assert f"```text\n{run(script, tmp_path)}```" in text
    assert (tmp_path / "beat.png").stat().st_size < 150_000


def test_there_are_five():
    assert len(scripts) == 5
