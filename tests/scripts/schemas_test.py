#!/usr/bin/python3
"""What the program writes is what docs/schemas say: schemas_test.py PROGRAM SOURCE_FOLDER. Exit status 77: skipped."""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

try:
    import jsonschema
except ImportError:
    print("SKIPPED: python3-jsonschema is not installed")
    sys.exit(77)

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
folder = pathlib.Path(tempfile.mkdtemp())
faults = []


def strict(schema):
    """The same schema, which also refuses keys that it does not name: what is written must be described."""
    if isinstance(schema, list):
        return [strict(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    made = {key: strict(value) for key, value in schema.items()}
    if isinstance(schema.get("properties"), dict) and schema.get("type") == "object":
        made.setdefault("additionalProperties", False)
    return made


schemas = {}
for name in ("case-line", "study", "set", "recipe", "template-comment", "reports"):
    schema = json.loads((source / "docs/schemas" / f"{name}.schema.json").read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    schemas[name] = schema


def check(value, name, what, part=None, valid=True):
    schema = strict(schemas[name])
    if part is not None:
        if part not in schema["$defs"]:
            return faults.append(f"{part} has no schema")
        schema = {"$defs": schema["$defs"], "$ref": f"#/$defs/{part}"}
    error = jsonschema.exceptions.best_match(jsonschema.Draft202012Validator(schema).iter_errors(value))
    if valid and error is not None:
        faults.append(f"{what}: {error.message[:300]}")
    if not valid and error is None:
        faults.append(f"{what} should be refused")


def run(verb, *arguments):
    """Runs a verb; its report is checked against the schema of its name."""
    words = [program, *verb.split(), *arguments, "--json"]
    ran = subprocess.run(words, cwd=folder, capture_output=True, text=True)
    if ran.returncode == 1 and "OpenGL" in ran.stderr:
        return
    if ran.returncode != 0:
        return faults.append(f"{verb}: {ran.stderr[:300]}")
    check(json.loads(ran.stdout), "reports", " ".join(words[1:]), verb.replace(" ", "_"))


# Every line that the page on case files shows, every kind of line that the sources name, and a case that is written.
page = (source / "docs/case-file.md").read_text()
lines = re.findall(r"`(\{\".*?\})`", page) + re.findall(r"^(\{\".*\})$", page, re.M)
lines = [line for line in lines if "…" not in line]
if len(lines) < 25:
    faults.append(f"docs/case-file.md shows {len(lines)} lines only")
for line in lines:
    check(json.loads(line), "case-line", f"docs/case-file.md, {line[:100]}")
kinds = {key for path in (source / "core/case/actions").glob("*.cpp") for key in re.findall(r'\.key = "(\w+)"', path.read_text())}
known = {key for part in schemas["case-line"]["$defs"].values() for key in part.get("required", [])}
for key in sorted(kinds - known):
    faults.append(f"a line of the kind '{key}' has no schema")
for line in ('{"tool":"pull"}', '{"undo":1}', '{"landmark":{"at":[1,2,3]}}', '{"tool":"pull","at":[1,2],"sigma_mm":3}',
             '{"placement":{"scale":1}}', '{"something":1}'):
    check(json.loads(line), "case-line", line, valid=False)

for subject in "12":
    run("phantom", "kidney", "--subject", subject, "-o", ".")
image, mask, one, two = "kidney-1-image.nii.gz", "kidney-1-labels.nii.gz", "kidney-1-truth.ply", "kidney-2-truth.ply"
(folder / "hand.homolog").write_text(json.dumps({"homolog": 1, "volume": image, "template": one}) + "\n")
run("study user", "built-in:kidney", "--mask", mask, "--pulls", "2", "-o", "case.homolog")
run("snap", one, "--image", image, "-o", "snapped.ply")
run("fit", "built-in:kidney", "--mask", mask, "-o", "fitted.ply")
run("fit", "built-in:kidney", "--mask", mask, "-o", "cohort")
check(json.loads((folder / "cohort/cohort.study.json").read_text()), "study", "the study of a cohort")
(folder / "cases.csv").write_text(f"name,mask,label,group,age\nA,{mask},1,healthy,63\n")
run("study make", "cases.csv", "--template", "built-in:kidney", "-o", "made.study.json")
check(json.loads((folder / "made.study.json").read_text()), "study", "a study that was made")
run("set make", mask, "--all", "-o", "body.set.json")
run("set info", "body.set.json")
(folder / "two.set.json").write_text(json.dumps({"homolog_set": 1, "structures": [
    {"name": "A", "value": 1, "template": one}, {"name": "B", "value": 2, "template": one}]}))
run("set share", "two.set.json", "A", "B")
run("set rename", "two.set.json", "B", "C")
check(json.loads((folder / "two.set.json").read_text()), "set", "a template set whose structure has another name")
check(json.loads((folder / "body.set.json").read_text()), "set", "a template set")
run("info", mask)
run("refine", "case.homolog")
for file in (image, one, "case.homolog", "kidney-1-landmarks.mrk.json"):
    run("info", file)
run("sample", "-o", "sample")
run("replay", "case.homolog", "-o", "replayed.ply")
run("compare", one, "--mesh", two)
run("measure", one, two)
for file in (source / "assets/recipes").glob("*.json"):
    check(json.loads(file.read_text()), "recipe", file.name)
for recipe in re.findall(r"^```json\n(.*?)^```", (source / "docs/recipes.md").read_text(), re.M | re.S):
    check(json.loads(recipe), "recipe", "a recipe of docs/recipes.md")
check({"homolog_recipe": 1, "measurements": [{"name": "a", "kind": "lenght"}]}, "recipe", "a kind that is none", valid=False)
(folder / "r.json").write_text('{"homolog_recipe": 1, "measurements": [{"name": "volume", "kind": "volume"}]}')
run("landmarks", one, two, "-o", "all.tps")
run("observers", one, one)
(folder / "tested").mkdir()
for number in range(6):
    lines = (f"{x + number * y} {y * 7 + number ** 2} {x * y + number % 3}" for x in range(3) for y in range(4))
    (folder / "tested" / f"c{number}.particles").write_text("\n".join(lines) + "\n")
(folder / "tested.csv").write_text("name,group\n" + "".join(f"c{k},{'ab'[k % 2]}\n" for k in range(7)))
run("test", "tested", "--covariates", "tested.csv", "--formula", "shape ~ group + size", "--permutations", "19", "--csv", "tables")
run("label-map", one, "--like", image, "-o", "map.nii.gz")
run("mirror", one, "-o", "mirrored.ply")
run("verify", "mirrored.ply")
run("convert", image, "out.nrrd")
run("convert", one, "out.vtp")
run("repair-mesh", one, "-o", "out.obj")
run("template", one, "-o", "template.ply", "--vertices", "500")
run("model", one, two, "fitted.ply", "-o", "model.h5")
run("info", "model.h5")
run("measure", one, two, "--recipe", "r.json", "--model", "model.h5", "--modes", "1", "-o", "table.csv")
run("evaluate", one, two, "fitted.ply", "--samples", "2")
run("report", "model.h5", "-o", "page.html")
for subject, file in ("1", one), ("2", two), ("3", "fitted.ply"):
    (folder / "joint" / subject).mkdir(parents=True)
    for structure in "AB":
        shutil.copy(folder / file, folder / "joint" / subject / f"{structure}.ply")
shutil.copytree(folder / "joint" / "1", folder / "joint" / "4")
(folder / "joint" / "4" / "B.ply").unlink()
run("model", "joint", "--structures", "A,B", "--complete", "-o", "joint.h5")
run("info", "joint.h5")
run("evaluate", "joint", "--structures", "A,B", "--structure", "A", "--samples", "2")
run("convert", "joint.h5", "mean.ply")
run("report", "joint", "--structures", "A,B", "-o", "joint.html")
run("picture correspondence", one, two, "-o", "both.png", "--size", "200x200")
for line in (folder / "case.homolog").read_text().splitlines():
    check(json.loads(line), "case-line", f"a case that was written, {line[:100]}")

# Every verb's report has a schema, those that take too long to be run here too.
def leaves(*verb):
    text = subprocess.run([program, *verb, "--help"], capture_output=True, text=True).stdout
    parts = re.findall(r"^  ([a-z][a-z-]*) ", text.partition("\nSubcommands:")[2].partition("\nExamples:")[0], re.M)
    return [leaf for part in parts for leaf in leaves(*verb, part)] or ["_".join(verb)]


for leaf in leaves():
    if leaf != "edit" and leaf not in schemas["reports"]["$defs"]:
        faults.append(f"the report of '{leaf}' has no schema")

# Comments of templates, and studies.
for file in (one, "template.ply"):
    head = (folder / file).read_bytes().split(b"end_header")[0].decode()
    comments = re.findall(r"^comment homolog\.(\w+) (.*)$", head, re.M)
    if not comments:
        faults.append(f"{file} has no comments")
    record = "".join(text for key, text in comments if key == "record")
    comments = [(key, text) for key, text in comments if key != "record"] + ([("record", record)] if record else [])
    for key, text in comments:
        check({key: text if key == "units" else json.loads(text)}, "template-comment", f"{file}: {key}")
check({"region": {"name": "hilum"}}, "template-comment", "a region without a factor", valid=False)
made = subprocess.run([program, "phantom", "ventricle", "--subject", "1", "-o", "."], cwd=folder, capture_output=True, text=True)
run("propagate", "ventricle-1-truth-00.ply", "--image", "ventricle-1-image.nii.gz", "--frame", "0", "-o", "cine")
for file in folder.glob("cine/*.study.json"):
    check(json.loads(file.read_text()), "study", file.name)
check({"cases": []}, "study", "a study without its stamp", valid=False)
check({"homolog_study": 1, "cases": [{"file": "a", "state": "maybe"}]}, "study", "a case of no known state", valid=False)

subprocess.run(["rm", "-rf", str(folder)])
for fault in faults:
    print("schemas_test:", fault)
sys.exit(1 if faults else 0)
