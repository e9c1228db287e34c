"""How long Python takes against the program: timing.py PROGRAM [REPEATS]. It prints a table and asserts nothing.

Both do the same in turns; the least of each counts, since other work shares the machine.
"""

import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time


def timed(work):
    """Seconds by the clock and of the processor, those of children included."""
    def used():
        return sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))

    clock, core = time.perf_counter(), used()
    work()
    return time.perf_counter() - clock, used() - core


def least(pairs):
    return [min(column) for column in zip(*pairs)]


def main(program, repeats=5):
    def command(*arguments):
        subprocess.run([program, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def python(text):
        return timed(lambda: subprocess.run([sys.executable, "-c", text], check=True))

    rows = [("import numpy", None, least(python("import numpy") for _ in range(repeats))),
            ("import homolog", None, least(python("import homolog") for _ in range(repeats)))]
    import homolog

    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for k in (1, 2, 3):
            command("phantom", "kidney", "--subject", k, "-o", folder)
        mask = folder / "kidney-1-labels.nii.gz"
        fits = [folder / f"{k}.ply" for k in (1, 2, 3)]
        for k, fit in enumerate(fits, 1):
            command("fit", "built-in:kidney", "--mask", folder / f"kidney-{k}-labels.nii.gz", "-o", fit)
        image = folder / "kidney-1-image.nii.gz"
        labels, mesh, scan = homolog.read_label_map(mask), homolog.read_mesh(fits[0]), homolog.read_volume(image)
        jobs = [
            ("fit", lambda: command("fit", "built-in:kidney", "--mask", mask, "-o", folder / "a.ply"),
             lambda: homolog.fit("built-in:kidney", mask, output=folder / "b.ply")),
            ("fit of what was read", lambda: command("fit", "built-in:kidney", "--mask", mask, "-o", folder / "a.ply"),
             lambda: homolog.fit("built-in:kidney", labels)),
            ("snap", lambda: command("snap", fits[0], "--image", image, "-o", folder / "c.ply"),
             lambda: homolog.snap(mesh, scan)),
            ("model", lambda: command("model", *fits, "-o", folder / "a.h5.json"), lambda: homolog.model(fits)),
            ("measure", lambda: command("measure", *fits), lambda: homolog.measure(fits)),
        ]
        for title, theirs, ours in jobs:
            pairs = [(timed(theirs), timed(ours)) for _ in range(repeats)]
            rows.append((title, least(pair[0] for pair in pairs), least(pair[1] for pair in pairs)))
    print("| work | program: s, s of the processor | Python: s, s of the processor |\n|---|---|---|")
    for title, theirs, ours in rows:
        print(f"| {title} | {'' if theirs is None else '%.2f, %.2f' % tuple(theirs)} | {'%.2f, %.2f' % tuple(ours)} |")


if __name__ == "__main__":
    main(os.path.abspath(sys.argv[1]), *map(int, sys.argv[2:]))
