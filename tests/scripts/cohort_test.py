#!/usr/bin/env python3
"""The example of a cohort: from label maps to a report with Snakemake, past a case that fails, and on after a stop.

    cohort_test.py HOMOLOG

Prints SKIPPED and ends with 77 where there is no Snakemake.
"""

import csv
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

NAMES = {1: "it's one", 2: "k2", 3: "k3", 4: "k4", 5: "k5"}
WORKFLOW = Path(__file__).resolve().parents[2] / "docs/examples/cohort.smk"


def must(is_so, what):
    if not is_so:
        sys.exit(f"FAILED: {what}")


def main():
    homolog = Path(sys.argv[1]).resolve()
    if shutil.which("snakemake") is None:
        print("SKIPPED: no peer: snakemake is not installed")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as name:
        run_cohort(homolog, Path(name) / "a cohort")  # with a blank


def run_cohort(homolog, folder, how=("--cores", "2")):
    """`how`: the options of Snakemake that say where the steps run."""
    masks = folder / "masks"
    masks.mkdir(parents=True)
    subjects = range(1, 6)
    for subject in subjects:
        subprocess.run([homolog, "phantom", "kidney", "--subject", str(subject), "-o", "phantom", "--quiet"],
                       cwd=folder, check=True)
        shutil.copy(folder / f"phantom/kidney-{subject}-labels.nii.gz", masks / f"{NAMES[subject]}.nii.gz")
    (masks / "torn.nii.gz").write_bytes((masks / "k2.nii.gz").read_bytes()[:3000])
    ages = "".join(f"{NAMES[subject]},{30 + 7 * subject * subject % 40}\n" for subject in subjects)
    (folder / "cases.csv").write_text("name,age\n" + ages)
    (folder / "size.recipe.json").write_text(json.dumps(
        {"homolog_recipe": 1, "name": "Size", "measurements": [{"name": "volume", "kind": "volume"}]}))

    def snakemake():
        ran = subprocess.run(
            ["snakemake", "-s", WORKFLOW, *how, "--nolock", "--config", f"homolog={homolog}",
             "template=phantom/kidney-1-truth.ply", "masks=masks", "out=out", "recipe=size.recipe.json",
             "covariates=cases.csv", "formula=shape ~ age"],
            cwd=folder, capture_output=True, text=True, env=os.environ | {"HOME": str(folder)})
        must(ran.returncode == 0, "the workflow:\n" + ran.stderr)
        return ran.stderr

    snakemake()
    with open(folder / "out/agreement.csv") as file:
        rows = {row["case"]: row for row in csv.DictReader(file)}
    must(set(rows) == {*NAMES.values(), "torn"}, "every case has a row")
    must("torn.nii.gz" in rows["torn"]["failed"], "the case that failed is named with the reason")
    must(all(float(rows[NAMES[subject]]["dice"]) > 0.98 for subject in subjects), "the others are fitted")
    must(json.loads((folder / "out/model.json").read_text())["shapes"] == 5, "the model is of five shapes")
    must("generalization" in (folder / "out/measures.json").read_text(), "there are measures")
    must(json.loads((folder / "out/test.json").read_text())["terms"][0]["name"] == "age", "the test is of age")
    must((folder / "out/measurements.csv").read_text().count("k5") >= 1, "there are measurements")
    page = (folder / "out/report.html").read_text()
    must(len(page) > 100_000 and "<title>Cohort" in page, "there is a report with a title")
    must("torn" in page and "left out: " in page and ">Measurements<" in page, "the report has the case that failed, and measurements")
    must("Nothing to be done" in snakemake(), "a second run does nothing")

    before = (folder / "out/model.h5.json").read_bytes()
    for lost in ("fits/k3.json", "report.html"):  # as a machine that stopped would leave it
        (folder / "out" / lost).unlink()
    again = snakemake()
    must(set(re.findall(r"^fit +(\d+)", again, re.M)) == {"1"}, "only what is missing is fitted again")
    must((folder / "out/model.h5.json").read_bytes() == before, "the same cases give the same model")


if __name__ == "__main__":
    main()
