# A cohort from label maps to a report: template -> fit -> compare -> model -> measures -> measurements -> test -> report.
#
#   snakemake -s cohort.smk --cores all --config masks=masks out=out
#   snakemake -s cohort.smk --cores all --config template=kidney.ply masks=masks out=out recipe=kidney.recipe.json \
#     covariates=cases.csv formula="shape ~ group + age" title="Kidneys"
#
# Without a template, that of all subjects is made first (five or more). One case is one process that shares nothing with
# the others, so the same file runs on a cluster: see docs/cohorts.md. Every output is written under another name and
# renamed when it is whole. After a crash or kill -9 call it once with --unlock, then start it again: only what is
# missing is done. Where Snakemake names incomplete files, it was killed as a step ended: add --rerun-incomplete.
# A case that cannot be fitted does not stop the others. agreement.csv and the report name it with the reason, and logs/
# has its log. Names of files and folders may have blanks and apostrophes (on a cluster not the working folder).
import sys
from pathlib import Path

HOMOLOG, PYTHON = config.get("homolog", "homolog"), sys.executable
MASKS = Path(config["masks"])
OUT = config.get("out", "out")
TEMPLATE = config.get("template", f"{OUT}/template.ply")
RECIPE = config.get("recipe")
COVARIATES, FORMULA = config.get("covariates"), config.get("formula")
TITLE = config.get("title", "Cohort")
# Without a radius each fit takes the template's, and tries wider ones where it is doubtful.
CLOSING = f"--closing-mm {config['closing_mm']}" if "closing_mm" in config else ""
CASES = sorted(path.name[: -len(".nii.gz")] for path in MASKS.glob("*.nii.gz"))
REPORTS = expand(f"{OUT}/fits/{{case}}.json", case=CASES)


def mesh_of(case):
    return f"{OUT}/meshes/{case}.ply"


# Puts the meshes of the cases that were fitted into "$@". Of a case that was refused the report is empty.
FITTED = (
    "set --; for fit in {input.fits:q}; do if [ -s \"$fit\" ]; then"
    " set -- \"$@\" {OUT:q}/meshes/\"$(basename \"$fit\" .json)\".ply; fi; done; "
)

# Takes the table to write and the folder of all, then the reports of the fits.
AGREEMENT = """
import csv, json, os, sys
from pathlib import Path

def report_of(path):
    text = path.read_text()
    return json.loads(text) if text else None

written, out = sys.argv[1], Path(sys.argv[2])
with open(written + ".part", "w", newline="") as file:
    table = csv.writer(file)
    table.writerow(["case", "doubtful", "assd_mm", "dice", "assd_raw_mm", "dice_raw", "failed"])
    for fit in map(Path, sys.argv[3:]):
        case = fit.name[:-len(".json")]
        fitted, raw = report_of(fit), report_of(out / "compared" / fit.name)
        if fitted is None:
            reason = (out / "logs" / (case + ".txt")).read_text().strip().splitlines()[-1:]
            table.writerow([case] + [""] * 5 + reason)
            continue
        figures = [fitted["assd_mm"], fitted["dice"], raw["assd_mm"], raw["dice"]]
        table.writerow([case, fitted["doubtful"]] + [format(figure, ".4f") for figure in figures] + [""])
os.replace(written + ".part", written)
"""


rule all:
    input:
        f"{OUT}/agreement.csv",
        f"{OUT}/measures.json",
        f"{OUT}/report.html",
        [f"{OUT}/measurements.csv"] if RECIPE else [],
        [f"{OUT}/test.json"] if FORMULA else [],


if "template" not in config:

    rule template:
        input:
            expand(str(MASKS / "{case}.nii.gz"), case=CASES),
        output:
            TEMPLATE,
        log:
            f"{OUT}/logs/template.txt",
        shell:
            "{HOMOLOG} template --consensus {input:q} -o {output:q} --jobs {threads} > {log:q} 2>&1"


rule fit:
    input:
        template=TEMPLATE,
        mask=MASKS / "{case}.nii.gz",
    output:
        f"{OUT}/fits/{{case}}.json",
    params:
        mesh=lambda wildcards: mesh_of(wildcards.case),
    log:
        f"{OUT}/logs/{{case}}.txt",
    threads: 1
    # Status 1: the case is refused, with the reason in its log. Its report is empty then.
    shell:
        "mkdir -p {OUT:q}/meshes; status=0; {HOMOLOG} fit {input.template:q} --mask {input.mask:q} {CLOSING}"
        " -o {params.mesh:q} --json --jobs {threads} > {output:q}.part 2> {log:q} || status=$?;"
        " [ $status -le 1 ] || exit $status; mv {output:q}.part {output:q}"


rule compare:
    input:
        fit=f"{OUT}/fits/{{case}}.json",
        mask=MASKS / "{case}.nii.gz",
    output:
        f"{OUT}/compared/{{case}}.json",
    params:
        mesh=lambda wildcards: mesh_of(wildcards.case),
    threads: 1
    shell:
        "if [ -s {input.fit:q} ]; then {HOMOLOG} compare {params.mesh:q} --mask {input.mask:q} --json"
        " > {output:q}.part; else : > {output:q}.part; fi; mv {output:q}.part {output:q}"


rule agreement:
    input:
        fits=REPORTS,
        compared=expand(f"{OUT}/compared/{{case}}.json", case=CASES),
    output:
        f"{OUT}/agreement.csv",
    shell:
        "{PYTHON:q} -c {AGREEMENT:q} {output:q} {OUT:q} {input.fits:q}"


rule model:
    input:
        fits=REPORTS,
    output:
        model=f"{OUT}/model.h5.json",
        report=f"{OUT}/model.json",
    shell:
        FITTED + "{HOMOLOG} model \"$@\" -o {output.model:q} --json --jobs {threads} > {output.report:q}.part"
        " && mv {output.report:q}.part {output.report:q}"


rule measures:
    input:
        fits=REPORTS,
    output:
        f"{OUT}/measures.json",
    shell:
        FITTED + "{HOMOLOG} evaluate \"$@\" --json --jobs {threads} > {output:q}.part && mv {output:q}.part {output:q}"


rule measurements:
    input:
        fits=REPORTS,
        model=f"{OUT}/model.h5.json",
    output:
        f"{OUT}/measurements.csv",
    shell:
        FITTED + "{HOMOLOG} measure \"$@\" --recipe {RECIPE:q} --template {TEMPLATE:q} --model {input.model:q}"
        " -o {output:q} --quiet"


rule test:
    input:
        fits=REPORTS,
    output:
        f"{OUT}/test.json",
    shell:
        FITTED + "{HOMOLOG} test \"$@\" --covariates {COVARIATES:q} --formula {FORMULA:q} --csv {OUT:q}/test --json"
        " --jobs {threads} > {output:q}.part && mv {output:q}.part {output:q}"


rule report:
    input:
        fits=REPORTS,
        agreement=f"{OUT}/agreement.csv",
    output:
        f"{OUT}/report.html",
    params:
        recipe=["--recipe", RECIPE, "--template", TEMPLATE] if RECIPE else [],
    shell:
        FITTED + "{HOMOLOG} report \"$@\" -o {output:q} --title {TITLE:q} --left-out {input.agreement:q}"
        " {params.recipe:q} --quiet"
