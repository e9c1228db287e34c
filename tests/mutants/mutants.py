#!/usr/bin/env python3
"""Puts small faults into a copy of the sources, all at once and each behind a switch, and asks which of them the quick
tests see. Called by scripts/mutants.sh, whose head says how it is used; the faults are in mutants.txt."""

import argparse
import concurrent.futures
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KINDS = ("sign", "order", "constant", "comparison", "other")
PROGRAMS = ("core_tests", "thread_tests", "editor_state_tests")
# The tests that count as quick: s of a case without a fault, in the files near the fault and elsewhere.
NEAR_SECONDS, QUICK_SECONDS = 15, 2
SWITCH_HEADER = "core/base/mutant_switch.h"
SWITCH = """#pragma once
#include <cstdlib>
#pragma GCC diagnostic ignored "-Wdangling-else"
#pragma GCC diagnostic ignored "-Wparentheses"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wextra"
/// Whether the fault of this number is on: that of HOMOLOG_MUTANT, read once.
inline bool homolog_mutant(int number) {
  static const int on = std::getenv("HOMOLOG_MUTANT") != nullptr ? std::atoi(std::getenv("HOMOLOG_MUTANT")) : 0;
  return on == number;
}
"""


@dataclass
class Mutant:
    number: int
    group: str
    kind: str
    file: str
    sentence: str = ""
    near: list = field(default_factory=list)
    old: list = field(default_factory=list)
    new: list = field(default_factory=list)

    def pattern(self):
        """The old text; how it is broken into lines does not matter."""
        return re.compile(r"\s+".join(re.escape(word) for word in " ".join(self.old).split()))

    def count(self):
        """How often the old text is in the source."""
        source = ROOT / self.file
        return len(self.pattern().findall(source.read_text())) if source.is_file() else 0

    def place(self, text):
        """Begin and end of the old text, which is there once."""
        return self.pattern().search(text).span()

    def switched(self, old):
        """The source with the fault behind its switch."""
        on, new = f"homolog_mutant({self.number})", " ".join(self.new)
        if "@" in new:
            return new.replace("@", on)
        if old.rstrip().endswith(";"):
            return f"if ({on}) {{ {new} }} else {{ {old} }}"
        return f"({on} ? ({new}) : ({old}))"


def read_mutants(path):
    mutants = []
    for line in path.read_text().splitlines():
        if line.startswith("#") or not line.strip():
            continue
        if head := re.fullmatch(r"\[(\d+)\] (\S+) (\S+) (\S+)", line):
            mutants.append(Mutant(int(head[1]), head[2], head[3], head[4]))
        elif line.startswith("- "):
            mutants[-1].old.append(line[2:])
        elif line.startswith("+ "):
            mutants[-1].new.append(line[2:])
        elif line.startswith("~ "):
            mutants[-1].near += line[2:].replace(" ", "").split(",")
        else:
            mutants[-1].sentence += (" " if mutants[-1].sentence else "") + line
    return mutants


def check(mutants):
    """Stops at a list that is not as scripts/mutants.sh promises."""
    numbers = Counter(one.number for one in mutants)
    wrong = [f"[{number}] is there twice" for number, count in numbers.items() if count > 1]
    for one in mutants:
        if one.kind not in KINDS:
            wrong.append(f"[{one.number}] is of kind {one.kind}; there are {', '.join(KINDS)}")
        if not (one.sentence and one.old and one.new):
            wrong.append(f"[{one.number}] lacks its sentence, its old text or its new one")
    wrong += [f"the group {group} has {count}, fewer than four"
              for group, count in Counter(one.group for one in mutants).items() if count < 4]
    told = sum(one.kind != "other" for one in mutants)
    if len(mutants) < 80 or told < 0.4 * len(mutants):
        wrong.append(f"{len(mutants)} faults, {told} of them of a named kind: at least 80, and 40 %")
    if wrong:
        raise SystemExit("mutants: " + "\nmutants: ".join(wrong))
    lost = [one for one in mutants if one.count() != 1]
    if lost:
        raise SystemExit("\n".join(f"mutants: [{one.number}] occurs {one.count()} times in {one.file}, not once: "
                                   f"{' '.join(one.old)}" for one in lost) +
                         "\nmutants: bring their lines in tests/mutants/mutants.txt up to date")
    for file in {one.file for one in mutants}:
        text = (ROOT / file).read_text()
        ends = sorted((one.place(text), one.number) for one in mutants if one.file == file)
        for ((_, end), first), ((begin, _), second) in zip(ends, ends[1:]):
            if begin < end:
                raise SystemExit(f"mutants: [{first}] and [{second}] change the same text of {file}")


def mutated(file, mutants):
    text = (ROOT / file).read_text()
    places = sorted(((one.place(text), one) for one in mutants), key=lambda found: found[0], reverse=True)
    for (begin, end), one in places:
        text = text[:begin] + one.switched(text[begin:end]) + text[end:]
    return f'#include "{SWITCH_HEADER}"\n' + text


def copy_tree(tree, mutants):
    """Brings the copy up to date; what is unchanged keeps its time, so that only the rest is compiled again."""
    listed = subprocess.run(["git", "ls-files", "-z", "-c", "-o", "--exclude-standard"], cwd=ROOT, check=True,
                            capture_output=True).stdout.decode().split("\0")
    wanted = {name for name in listed if name and (ROOT / name).is_file()}
    by_file = {}
    for one in mutants:
        by_file.setdefault(one.file, []).append(one)
    for name in sorted(wanted):
        there = tree / name
        if name in by_file:
            text = mutated(name, by_file[name]).encode()
        elif there.is_file() and there.read_bytes() == (ROOT / name).read_bytes():
            continue
        else:
            there.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, there)
            continue
        there.parent.mkdir(parents=True, exist_ok=True)
        if not there.is_file() or there.read_bytes() != text:
            there.write_bytes(text)
    switch = tree / SWITCH_HEADER
    if not switch.is_file() or switch.read_text() != SWITCH:
        switch.write_text(SWITCH)
    for folder in ("core", "render", "app", "tests", "shaders", "assets"):
        for path in (tree / folder).rglob("*"):
            if path.is_file() and path != switch and str(path.relative_to(tree)) not in wanted:
                path.unlink()


def build(tree):
    subprocess.run(["cmake", "--preset", "release"], cwd=tree, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", "--preset", "release", "--target", *PROGRAMS], cwd=tree, check=True)


def test_programs():
    """Of each test's source the program it is in."""
    cmake = (ROOT / "tests/CMakeLists.txt").read_text()
    programs = {}
    for name, sources in re.findall(r"homolog_tests\((\w+)\s([^)]*)\)", cmake):
        for source in sources.split():
            if name in PROGRAMS:
                programs[source] = name
    return programs


def pattern_of(case):
    return case.replace("\\", "?").replace(",", "?")


class Runner:
    def __init__(self, tree):
        self.folder, self.tree = tree / "build/release/tests", tree
        self.sources = test_programs()
        self.environment = dict(os.environ, HOMOLOG_DATA="/nonexistent", LC_ALL="C.UTF-8")

    def run(self, program, arguments, number, limit):
        """The exit status, None where the time is over, and what was printed."""
        job = subprocess.Popen([self.folder / program, *arguments], cwd=self.tree, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, start_new_session=True, errors="replace",
                               env=dict(self.environment, HOMOLOG_MUTANT=str(number)))
        try:
            output, _ = job.communicate(timeout=limit)
            return job.returncode, output
        except subprocess.TimeoutExpired:
            os.killpg(job.pid, signal.SIGKILL)
            return None, job.communicate()[0]

    def measure(self):
        """Runs all tests without a fault: {program: {case: [its source, s]}}. Errors: one fails."""
        kept = self.tree / "build/mutants_seconds.json"
        newest = max((self.folder / program).stat().st_mtime for program in PROGRAMS)
        if kept.is_file() and kept.stat().st_mtime > newest:
            return json.loads(kept.read_text())
        seconds = {}
        for program in PROGRAMS:
            cases = seconds[program] = {}
            for source in sorted(s for s, p in self.sources.items() if p == program):
                status, output = self.run(program, ["--duration=true", f"-sf=*/{source}"], 0, 1800)
                if status != 0:
                    raise SystemExit(f"mutants: without a fault {source} fails:\n{output[-3000:]}")
                for time_s, case in re.findall(r"^(\d+\.\d+) s: (.*)$", output, re.M):
                    cases[case] = [source, float(time_s)]
        kept.write_text(json.dumps(seconds, indent=1))
        return seconds

    def near(self, one):
        """The programs and sources of the tests near a fault."""
        if one.near:
            return [(p, s) for s, p in self.sources.items() if Path(s).stem in one.near]
        folder = str(Path(one.file).parent)
        while folder and not any(Path(s).parent == Path(folder) for s in self.sources):
            folder = str(Path(folder).parent) if "/" in folder else ""
        return [(p, s) for s, p in self.sources.items() if folder and Path(s).parent == Path(folder)]

    def caught_by(self, one, seconds):
        """The first case that fails under a fault; None where all pass."""
        near = self.near(one)
        stages = []
        for program in PROGRAMS:
            sources = [s for p, s in near if p == program]
            slow = [case for case, (_, s) in seconds[program].items() if s > NEAR_SECONDS]
            used = sum(s for source, s in seconds[program].values() if source in sources)
            if sources:
                stages.append((program, [f"-sf={','.join('*/' + s for s in sources)}"], slow, used))
        for program in PROGRAMS:
            slow = [case for case, (_, s) in seconds[program].items() if s > QUICK_SECONDS]
            used = sum(s for _, s in seconds[program].values() if s <= QUICK_SECONDS)
            stages.append((program, [], slow, used))
        for program, chosen, slow, used in stages:
            arguments = ["--abort-after=1", *chosen]
            if slow:
                arguments.append(f"-tce={','.join(map(pattern_of, slow))}")
            status, output = self.run(program, arguments, one.number, 60 + 8 * used)
            if status == 0:
                continue
            cases = re.findall(r"^TEST CASE: +(.*)$", output, re.M)
            why = "does not end" if status is None else cases[-1] if cases else f"ends with status {status}"
            return f"{program}: {why}"
        return None


def print_counts(mutants, caught):
    print(f"\n{'group':<12}{'faults':>7}{'seen':>7}{'not seen':>10}")
    for group in dict.fromkeys(one.group for one in mutants):
        there = [one for one in mutants if one.group == group]
        seen = sum(caught[one.number] is not None for one in there)
        print(f"{group:<12}{len(there):>7}{seen:>7}{len(there) - seen:>10}")
    seen = sum(found is not None for found in caught.values())
    print(f"{'all':<12}{len(mutants):>7}{seen:>7}{len(mutants) - seen:>10}")


def main():
    parser = argparse.ArgumentParser(prog="scripts/mutants.sh", description=__doc__)
    parser.add_argument("--only", metavar="N,M", help="these faults alone")
    parser.add_argument("--group", metavar="NAME", help="those of a group alone")
    parser.add_argument("--list", action="store_true", help="prints the faults and their counts, and runs nothing")
    parser.add_argument("--check", action="store_true", help="looks whether the list is in order, and runs nothing")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="so many at a time (1)")
    parser.add_argument("--tree", type=Path, default=ROOT / "build/mutants", metavar="FOLDER",
                        help="where the copy of the sources is (build/mutants)")
    parser.add_argument("--built", action="store_true", help="takes the copy as it was built before")
    options = parser.parse_args()
    mutants = read_mutants(ROOT / "tests/mutants/mutants.txt")
    check(mutants)
    chosen = mutants
    if options.only:
        chosen = [one for one in mutants if str(one.number) in options.only.split(",")]
    if options.group:
        chosen = [one for one in chosen if one.group == options.group]
    if options.check:
        return 0
    if options.list:
        for one in chosen:
            print(f"{one.number:>4} {one.group:<10} {one.kind:<10} {one.file}: {one.sentence}")
        kinds = Counter(one.kind for one in chosen)
        print(f"{len(chosen)} faults: " + ", ".join(f"{kinds[kind]} {kind}" for kind in KINDS))
        return 0
    if not chosen:
        raise SystemExit("mutants: there is no such fault; --list shows all")
    tree = options.tree.resolve()
    if not options.built:
        copy_tree(tree, mutants)
        build(tree)
    runner = Runner(tree)
    seconds = runner.measure()

    def work(one):
        start = time.monotonic()
        found = runner.caught_by(one, seconds)
        print(f"{one.number:>4} {one.group:<10} {one.kind:<10} {'seen    ' if found else 'NOT SEEN'} "
              f"{time.monotonic() - start:4.0f} s  {found or one.file + ': ' + one.sentence}", flush=True)
        return one.number, found

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        caught = dict(pool.map(work, chosen))
    print_counts(chosen, caught)
    return 1 if None in caught.values() else 0


if __name__ == "__main__":
    sys.exit(main())
