# A cohort from label maps to a shape model: fit -> compare -> model.
#
#   snakemake -s cohort.smk --cores all --config template=kidney.ply masks=masks out=out
#
# Of five subjects or more, make the template of all of them: homolog template --consensus masks/ -o kidney.ply
#
# One case is one process that shares nothing with the others, so the same file runs on a cluster. Every output is written under
# another name and renamed when it is whole. After a crash or kill -9 call it once with --unlock, then start it again: only what is
# missing is done. Where Snakemake names incomplete files, it was killed as a step ended: add --rerun-incomplete. A case that fails stops the model;
# leave it out by moving its mask away, or go on with the others by --keep-going and look at its log.
from pathlib import Path

HOMOLOG = config.get("homolog", "homolog")
TEMPLATE = config["template"]
MASKS = Path(config["masks"])
OUT = config.get("out", "out")
# Without a radius each fit takes the template's, and tries wider ones where it is doubtful.
CLOSING = f"--closing-mm {config['closing_mm']}" if "closing_mm" in config else ""
CASES = sorted(path.name[: -len(".nii.gz")] for path in MASKS.glob("*.nii.gz"))


rule all:
    input:
        f"{OUT}/model.h5.json",
        f"{OUT}/agreement.csv",


rule fit:
    input:
        template=TEMPLATE,
        mask=MASKS / "{case}.nii.gz",
    output:
        mesh=f"{OUT}/meshes/{{case}}.ply",
        report=f"{OUT}/fits/{{case}}.json",
    log:
        f"{OUT}/logs/{{case}}.txt",
    threads: 1
    shell:
        "{HOMOLOG} fit {input.template:q} --mask {input.mask:q} {CLOSING} -o {output.mesh:q} --json"
        " > {output.report:q}.part 2> {log:q} && mv {output.report:q}.part {output.report:q}"


rule compare:
    input:
        mesh=f"{OUT}/meshes/{{case}}.ply",
        mask=MASKS / "{case}.nii.gz",
    output:
        f"{OUT}/compared/{{case}}.json",
    threads: 1
    shell:
        "{HOMOLOG} compare {input.mesh:q} --mask {input.mask:q} --json > {output:q}.part"
        " && mv {output:q}.part {output:q}"


rule agreement:
    input:
        fits=expand(f"{OUT}/fits/{{case}}.json", case=CASES),
        compared=expand(f"{OUT}/compared/{{case}}.json", case=CASES),
    output:
        f"{OUT}/agreement.csv",
    run:
        import json

        import os

        with open(output[0] + ".part", "w") as table:
            print("case,doubtful,assd_mm,dice,assd_raw_mm,dice_raw", file=table)
            for case, fit, compared in zip(CASES, input.fits, input.compared):
                fitted, raw = json.loads(Path(fit).read_text()), json.loads(Path(compared).read_text())
                figures = [fitted["assd_mm"], fitted["dice"], raw["assd_mm"], raw["dice"]]
                print(case, fitted["doubtful"], *(f"{figure:.4f}" for figure in figures), sep=",", file=table)
        os.replace(output[0] + ".part", output[0])


rule model:
    input:
        expand(f"{OUT}/meshes/{{case}}.ply", case=CASES),
    output:
        model=f"{OUT}/model.h5.json",
        report=f"{OUT}/model.json",
    shell:
        "{HOMOLOG} model {input:q} -o {output.model:q} --json > {output.report:q}.part"
        " && mv {output.report:q}.part {output.report:q}"
