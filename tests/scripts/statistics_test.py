#!/usr/bin/python3
"""Sums, F, R2, p and q of `homolog test` against numpy, which computes them another way, with the same permutations.

statistics_test.py PROGRAM. Exits with 77 where numpy is missing. With Rscript and vegan there, also against lm and adonis2.
"""
import csv, json, pathlib, shutil, subprocess, sys, tempfile

try:
    import numpy
except ImportError:
    print("skipped: numpy is not installed")
    sys.exit(77)

program = str(pathlib.Path(sys.argv[1]).resolve())
folder = pathlib.Path(tempfile.mkdtemp())
random = numpy.random.default_rng(42)
cases, vertices, orders = 24, 50, 199
bad = []


def same(what, ours, theirs, tolerance=1e-9):
    ours, theirs = numpy.asarray(ours, float), numpy.asarray(theirs, float)
    off = numpy.abs(ours - theirs) / numpy.maximum(1, numpy.abs(theirs))
    if ours.shape != theirs.shape or not numpy.all(off <= tolerance):
        bad.append(f"{what}: {ours.ravel()[:5]} where {theirs.ravel()[:5]} is right")


def run(*arguments):
    done = subprocess.run([program, "test", "shapes", "--covariates", "table.csv", "--permutation-file", "orders.txt",
                           "--no-align", "--json", *arguments], cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return json.loads(done.stdout)


# Points in correspondence; a table; permutations.
names = [f"c{k:02}" for k in range(cases)]
group = numpy.array(["a", "b", "c"])[numpy.arange(cases) % 3]
sex = numpy.array(["f", "m"])[random.integers(0, 2, cases)]
age = random.uniform(20, 80, cases).round(2)
shapes = random.normal(0, 1, (cases, vertices, 3)) + random.uniform(-40, 40, (vertices, 3))
shapes[group == "b", :10] += 0.8
shapes += age[:, None, None] / 100
(folder / "shapes").mkdir()
for name, points in zip(names, shapes):
    (folder / "shapes" / f"{name}.particles").write_text("".join("%.17g %.17g %.17g\n" % tuple(p) for p in points))
with open(folder / "table.csv", "w") as out:
    out.write("name,group,sex,age\n")
    out.writelines(f"{n},{g},{s},{a}\n" for n, g, s, a in zip(names, group, sex, age))
permutations = numpy.array([random.permutation(cases) for _ in range(orders)])
(folder / "orders.txt").write_text("".join(" ".join(map(str, row)) + "\n" for row in permutations))

# The same by least squares on the coordinates themselves.
flat = shapes.reshape(cases, -1)
size = numpy.sqrt(((shapes - shapes.mean(1, keepdims=True)) ** 2).sum((1, 2)))
columns = {"group": numpy.stack([group == "b", group == "c"], 1).astype(float), "sex": (sex == "m")[:, None].astype(float),
           "age": age[:, None], "log(size)": numpy.log(size)[:, None]}
columns["group:sex"] = columns["group"] * columns["sex"]


def left(y, terms):
    x = numpy.hstack([numpy.ones((cases, 1))] + [columns[t] for t in terms])
    fitted = x @ numpy.linalg.lstsq(x, y, rcond=None)[0]
    return fitted, y - fitted, x.shape[1]


def check(formula, y, terms, report, each=None):
    _, whole, parameters = left(y, terms)
    rss, free = (whole ** 2).sum(), cases - parameters
    total = ((y - y.mean(0)) ** 2).sum()
    same(f"{formula}: residual", [report["residual"]["df"], report["residual"]["ss"], report["total"]["ss"]], [free, rss, total])
    for term, got in zip(terms, report["terms"], strict=True):
        without = [t for t in terms if t != term and not set(term.split(":")) < set(t.split(":"))]
        fitted, residuals, _ = left(y, without)
        df = columns[term].shape[1]

        def f_of(values):
            added = left(values, without)[1] ** 2 - 0
            added_there = left(values, without + [term])[1] ** 2
            rest = left(values, terms)[1] ** 2
            every = (added.sum() - added_there.sum()) / df / (rest.sum() / free)
            at = lambda squares: squares.sum(0).reshape(-1, 3).sum(1) if each else None
            return every, ((at(added) - at(added_there)) / df / (at(rest) / free) if each else 0)

        f, f_at = f_of(y)
        ss = f * df * rss / free
        permuted = [f_of(fitted + residuals[row]) for row in permutations]
        larger = sum(one >= f - 1e-9 * max(1, f) for one, _ in permuted)
        same(f"{formula}: {term}", [got["df"], got["ss"], got["r2"], got["f"], got["p"]],
             [df, ss, ss / total, f, (larger + 1) / (orders + 1)])
        if not each:
            continue
        rows = [row for row in csv.DictReader(open(folder / each)) if row["term"] == term]
        p = (sum(one >= f_at - 1e-9 * numpy.maximum(1, f_at) for _, one in permuted) + 1) / (orders + 1)
        rank = numpy.argsort(p, kind="stable")
        q = numpy.empty(vertices)
        q[rank] = numpy.minimum.accumulate((p[rank] * vertices / numpy.arange(1, vertices + 1))[::-1])[::-1]
        same(f"{formula}: {term}: p", [float(row["p"]) for row in rows], p)
        same(f"{formula}: {term}: q", [float(row["q"]) for row in rows], q)
        x = numpy.hstack([numpy.ones((cases, 1))] + [columns[t] for t in without + [term]])
        b = numpy.linalg.lstsq(x, y, rcond=None)[0][-df:].reshape(df, vertices, 3)
        if term == "age":
            effect = numpy.linalg.norm(b[0], axis=1) * age.std(ddof=1)
        elif term == "sex":
            effect = numpy.linalg.norm(b[0], axis=1)
        elif term == "group":
            effect = numpy.max([numpy.linalg.norm(d, axis=1) for d in (b[0], b[1], b[1] - b[0])], axis=0)
        else:
            continue
        same(f"{formula}: {term}: effect", [float(row["effect_mm"]) for row in rows], effect)


formula = "shape ~ group + sex + age"
report = run("--formula", formula, "--csv", "out")
check(formula, flat, ["group", "sex", "age"], report, "out/landmarks.csv")
check("with an interaction", flat, ["group", "sex", "age", "group:sex"], run("--formula", "shape ~ group * sex + age"))
check("of size", size[:, None], ["group", "age"], run("--formula", "size ~ group + age"))


def check_sided(formula, y, terms, term, column, sign):
    """One-sided p: t is the root of F with the sign of the coefficient; `change` is the coefficient of `column`."""
    report = run("--formula", formula, "--sided", "greater" if sign > 0 else "less")
    got = next(one for one in report["terms"] if one["name"] == term)
    without = [t for t in terms if t != term]
    fitted, residuals, _ = left(y, without)

    def t_of(values):
        x = numpy.hstack([numpy.ones((cases, 1))] + [columns[t] for t in without] + [column])
        b = numpy.linalg.lstsq(x, values, rcond=None)[0][-1, 0]
        less, more = (left(values, without)[1] ** 2).sum(), (left(values, without + [term])[1] ** 2).sum()
        return b, numpy.sign(b) * numpy.sqrt(max(less - more, 0) / (more / (cases - x.shape[1])))

    b, t = t_of(y)
    larger = sum(sign * t_of(fitted + residuals[row])[1] >= sign * t - 1e-9 * max(1, sign * t) for row in permutations)
    same(f"{formula}: {term}, one side", [got["change"], got["p"]], [b, (larger + 1) / (orders + 1)])
    if got["sided"] != ("greater" if sign > 0 else "less"):
        bad.append(f"{formula}: {term} says that it is {got['sided']}")


one_sex, one_age = columns["sex"], (columns["age"] - age.mean()) / age.std(ddof=1)
for sign in (1, -1):
    check_sided("size ~ sex + age", size[:, None], ["sex", "age"], "sex", one_sex, sign)
    check_sided("size ~ sex + age", size[:, None], ["sex", "age"], "age", one_age, sign)


def check_weighted():
    """Cases in doubt weigh w = s² / (s² + d²), and in a permutation a residual takes its weight along."""
    doubts = random.uniform(0.2, 3, cases)
    (folder / "doubtful").mkdir()
    header = "ply\nformat ascii 1.0\nelement vertex %d\nproperty double x\nproperty double y\nproperty double z\n" \
             "property double doubt_mm\nelement face %d\nproperty list uchar int vertex_indices\nend_header\n"
    for name, points, doubt in zip(names, shapes, doubts):
        rows = ["%.17g %.17g %.17g %.17g" % (*p, doubt) for p in points]
        rows += [f"3 {k} {k + 1 + k % 2} {k + 2 - k % 2}" for k in range(vertices - 2)]
        (folder / "doubtful" / f"{name}.ply").write_text(header % (vertices, vertices - 2) + "\n".join(rows) + "\n")
    done = subprocess.run([program, "test", "doubtful", "--covariates", "table.csv", "--permutation-file", "orders.txt",
                           "--no-align", "--json", "--by-doubt", "--formula", "shape ~ group + age", "--csv", "weighted"],
                          cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)
    got = json.loads(done.stdout)
    design = lambda terms: numpy.hstack([numpy.ones((cases, 1))] + [columns[t] for t in terms])
    _, whole, parameters = left(flat, ["group", "age"])
    spread = (whole ** 2).sum() / (cases - parameters) / vertices
    w = spread / (spread + doubts ** 2)
    same("weights", [got["weights"][key] for key in ("min", "mean", "max", "cases")],
         [w.min(), w.mean(), w.max(), w.sum() ** 2 / (w ** 2).sum()])

    def squares(values, terms, weights):
        x, root = design(terms), numpy.sqrt(weights)[:, None]
        b = numpy.linalg.lstsq(x * root, values * root, rcond=None)[0]
        return x @ b, values - x @ b, (weights[:, None] * (values - x @ b) ** 2).sum(0).reshape(-1, 3).sum(1)

    for term in ("group", "age"):
        without = [t for t in ("group", "age") if t != term]
        df = columns[term].shape[1]
        fitted, residuals, _ = squares(flat, without, w)

        def f_of(values, weights):
            more, less = squares(values, without, weights)[2], squares(values, ["group", "age"], weights)[2]
            degrees = (cases - parameters) / df
            return (more.sum() / less.sum() - 1) * degrees, (more / less - 1) * degrees

        f, f_at = f_of(flat, w)
        all_permuted = [f_of(fitted + residuals[row], w[row]) for row in permutations]
        p = (sum(one >= f - 1e-9 * max(1, f) for one, _ in all_permuted) + 1) / (orders + 1)
        there = next(one for one in got["terms"] if one["name"] == term)
        same(f"by doubt: {term}", [there["f"], there["p"]], [f, p])
        rows = [row for row in csv.DictReader(open(folder / "weighted/landmarks.csv")) if row["term"] == term]
        p_at = (sum(one >= f_at - 1e-9 * numpy.maximum(1, f_at) for _, one in all_permuted) + 1) / (orders + 1)
        same(f"by doubt: {term}: p", [float(row["p"]) for row in rows], p_at)


check_weighted()
check("allometry", flat, ["log(size)", "sex"], run("--formula", "shape ~ log(size) + sex"))

# What R says, where it is there.
script = """
suppressMessages(library(vegan)); y <- as.matrix(read.csv("y.csv", header=FALSE)); t <- read.csv("r.csv", stringsAsFactors=TRUE)
orders <- as.matrix(read.table("orders.txt")) + 1
a <- adonis2(y ~ group + sex + age, t, method="euclidean", by="margin", permutations=orders)
b <- adonis2(y ~ group, t, method="euclidean", permutations=orders)
d <- drop1(lm(size ~ group + age, t), test="F")
cat(a$Df, a$SumOfSqs, a$R2, a$F[1:3], b$`Pr(>F)`[1], d$`Sum of Sq`[2:3], d$`F value`[2:3], sep="\\n")
"""
if shutil.which("Rscript") and subprocess.run(["Rscript", "-e", "library(vegan)"], capture_output=True).returncode == 0:
    numpy.savetxt(folder / "y.csv", flat, delimiter=",", fmt="%.17g")
    with open(folder / "r.csv", "w") as out:
        out.write("group,sex,age,size\n")
        out.writelines(f"{g},{s},{a},{z!r}\n" for g, s, a, z in zip(group, sex, age, map(float, size)))
    done = subprocess.run(["Rscript", "--vanilla", "-e", script.replace("cat(", "options(digits=15); cat(")], cwd=folder,
                          capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)
    theirs = [float(word) for word in done.stdout.split()]
    of = lambda key: [term[key] for term in report["terms"]]
    sums = of("ss") + [report["residual"]["ss"], report["total"]["ss"]]
    # Of one term alone; of several adonis2 permutes the cases and not what the other terms leave.
    alone = run("--formula", "shape ~ group")["terms"][0]
    sizes = run("--formula", "size ~ group + age")["terms"]
    same("adonis2 and lm", of("df") + [report["residual"]["df"], report["total"]["df"]] + sums +
         [one / report["total"]["ss"] for one in sums] + of("f") + [alone["p"]] + [t["ss"] for t in sizes] + [t["f"] for t in sizes],
         theirs)
    print("compared with R")

print("\n".join(bad))
shutil.rmtree(folder)
sys.exit(1 if bad else 0)
