# A cohort from label maps to a report: template -> fit -> compare -> model -> measures -> measurements -> test -> report.
#
#   snakemake -s cohort.smk --cores all --config masks=masks out=out
#   snakemake -s cohort.smk --cores all --config template=kidney.ply masks=masks out=out recipe=kidney.recipe.json \
#     covariates=cases.csv formula="shape ~ group + age"
#
# Without a template, that of all subjects is made first (five or more). One case is one process that shares nothing with
# the others, so the same file runs on a cluster: see docs/cohorts.md. Every output is written under another name and
# renamed when it is whole. After a crash or kill -9 call it once with --unlock, then start it again: only what is
# missing is done. Where Snakemake names incomplete files, it was killed as a step ended: add --rerun-incomplete.
# A case that cannot be fitted does not stop the others. agreement.csv names it with the reason, and logs/ has its log.
import json
import os
from pathlib import Path

HOMOLOG = config.get("homolog", "homolog")
MASKS = Path(config["masks"])
OUT = config.get("out", "out")
TEMPLATE = config.get("template", f"{OUT}/template.ply")
RECIPE = config.get("recipe")
COVARIATES, FORMULA = config.get("covariates"), config.get("formula")
# Without a radius each fit takes the template's, and tries wider ones where it is doubtful.
CLOSING = f"--closing-mm {config['closing_mm']}" if "closing_mm" in config else ""
CASES = sorted(path.name[: -len(".nii.gz")] for path in MASKS.glob("*.nii.gz"))
REPORTS = expand(f"{OUT}/fits/{{case}}.json", case=CASES)


def mesh_of(case):
    return f"{OUT}/meshes/{case}.ply"


def report_of(path):
    """What a verb reported; None where it refused its case."""
    text = Path(path).read_text()
    return json.loads(text) if text else None


def fitted_meshes():
    """The meshes of the cases that were fitted, for a command line."""
    return " ".join(f"'{mesh_of(case)}'" for case, path in zip(CASES, REPORTS) if report_of(path))


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
    run:
        import csv

        with open(output[0] + ".part", "w", newline="") as file:
            table = csv.writer(file)
            table.writerow(["case", "doubtful", "assd_mm", "dice", "assd_raw_mm", "dice_raw", "failed"])
            for case, fit, compared in zip(CASES, input.fits, input.compared):
                fitted, raw = report_of(fit), report_of(compared)
                if fitted is None:
                    reason = Path(f"{OUT}/logs/{case}.txt").read_text().strip().splitlines()[-1:]
                    table.writerow([case] + [""] * 5 + reason)
                    continue
                figures = [fitted["assd_mm"], fitted["dice"], raw["assd_mm"], raw["dice"]]
                table.writerow([case, fitted["doubtful"]] + [f"{figure:.4f}" for figure in figures] + [""])
        os.replace(output[0] + ".part", output[0])


rule model:
    input:
        REPORTS,
    output:
        model=f"{OUT}/model.h5.json",
        report=f"{OUT}/model.json",
    run:
        meshes = fitted_meshes()
        shell("{HOMOLOG} model {meshes} -o {output.model:q} --json --jobs {threads} > {output.report:q}.part"
              " && mv {output.report:q}.part {output.report:q}")


rule measures:
    input:
        REPORTS,
    output:
        f"{OUT}/measures.json",
    run:
        meshes = fitted_meshes()
        shell("{HOMOLOG} evaluate {meshes} --json --jobs {threads} > {output:q}.part && mv {output:q}.part {output:q}")


rule measurements:
    input:
        reports=REPORTS,
        model=f"{OUT}/model.h5.json",
    output:
        f"{OUT}/measurements.csv",
    run:
        meshes = fitted_meshes()
        shell("{HOMOLOG} measure {meshes} --recipe {RECIPE:q} --template {TEMPLATE:q} --model {input.model:q}"
              " -o {output:q} --quiet")


rule test:
    input:
        REPORTS,
    output:
        f"{OUT}/test.json",
    run:
        meshes = fitted_meshes()
        shell("{HOMOLOG} test {meshes} --covariates {COVARIATES:q} --formula {FORMULA:q} --csv {OUT:q}/test --json"
              " --jobs {threads} > {output:q}.part && mv {output:q}.part {output:q}")


rule report:
    input:
        REPORTS,
    output:
        f"{OUT}/report.html",
    run:
        meshes = fitted_meshes()
        shell("{HOMOLOG} report {meshes} -o {output:q} --quiet")
