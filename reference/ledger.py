"""The ledger of cost: `python reference/ledger.py PROGRAM`, or `--short PROGRAM` for five quick cases of a build for tests.

The cases are the lines of `tests/ledger.csv`: whole commands, with the millions of instructions and the peak of memory in MB that
each build took. The commands run again, and old stands beside new. The exit code is 1 if a case fails or takes more than it may.
valgrind counts the instructions, on one thread. It shows every program the same processor with AVX2, so that the counts depend
neither on the load nor on the speed of the machine. They do depend on the compiler, the C library and valgrind: if one of them
is another than that of the table, nothing is compared, and the exit code is 0.

`--write` renews the numbers of a build, `--page` prints the table of `docs/performance.md`. A new case is a new line with a command;
any numbers under `dev` make it one of the short form.
"""

import argparse
import csv
import ctypes
import datetime
import json
import operator
import os
import platform
import random
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
TABLE = ROOT / "tests" / "ledger.csv"

CASE_GROWTH = 0.02
"""Instructions of a case may grow by this share."""

MEAN_GROWTH = 0.005
"""The geometric mean of the instructions may grow by this share."""

PEAK_GROWTH = 0.2
"""The peak of a case may grow by this share: matrix products pack blocks by the sizes of the caches, which are not those of every machine."""

PEAK_NOISE = 2.0
"""MB by which a peak may differ: it counts pages of the program's file, as the system finds them in memory."""

PEAK_RUNS = 3
"""Runs of which the least peak counts."""

BUILDS = ("release", "dev", "0.2.0")

SOLVING = ("solve", "sweep", "sensitivity")
"""Commands that have threads, and a limit of memory that would else be that of the machine."""

FIXED = ("--threads", "1", "--max-memory", "4GB")

SUBREAPER = 36
"""`PR_SET_CHILD_SUBREAPER` of Linux: orphans become children of this process."""


class Cost(NamedTuple):
    """What one run takes."""

    instructions: float
    """In millions."""
    peak: float
    """Largest resident memory in MB."""


# The inputs of the cases.


def block(counts: list[int], size: list[float], element: str, depth: float = 0.01, **changes) -> dict:
    """Returns the scene of a rectangle or box, clamped below, with a parabola or sphere of radius 1 pressed into its top."""
    axes = "xyz"[: len(size)]
    kind, shape, model = ("box", "sphere", "space") if len(size) == 3 else ("rectangle", "parabola", "plane-strain")
    lines = {axis: {"points": [0, end], "divisions": [count]} for axis, end, count in zip(axes, size, counts)}
    apex = [end / 2 for end in size[:-1]] + [size[-1] - depth]
    return {
        "model": model,
        "body": {kind: {**lines, "element": element}},
        "material": {"young": 1e7, "poisson": 0.3},
        "supports": [{"on": {"boundary": "bottom"}, **dict.fromkeys(axes, 0)}],
        "obstacles": [{"boundary": "top", "approach": f"+{axes[-1]}", "shape": {shape: {"apex": apex, "radius": 1}}}],
        **changes,
    }


def about_axis() -> dict:
    """Returns the scene of a ball that is pressed into a cylinder."""
    scene = block([4, 4], [0.5, 0.5], "q4", model="axisymmetric")
    scene["obstacles"][0]["shape"]["parabola"]["apex"][0] = 0
    return scene


def motion() -> dict:
    """Returns the scene of a free block that hits a parabola."""
    dynamic = {"duration": 0.1, "initial": [{"velocity": {"value": [0, 10]}}]}
    material = {"young": 900, "poisson": 0.3, "density": 1}
    return block([12, 12], [1, 1], "q4", -0.1, material=material, supports=[], analysis={"dynamic": dynamic})


def mortar() -> dict:
    """Returns the scene of a box on a softer one, whose meshes do not match."""
    scene = block([10, 10, 5], [1, 1, 0.5], "hex8")
    below = block([7, 7, 4], [1, 1, 0.5], "hex8")["body"]
    below["box"]["z"]["points"] = [-0.5, 0]
    scene["further-bodies"] = [{"name": "base", "body": below, "material": {"young": 5e6, "poisson": 0.3}}]
    scene["supports"] = [{"on": {"boundary": side}, "x": 0, "y": 0, "z": 0} for side in ("base.bottom", "left")]
    scene["loads"] = [{"traction": {"boundary": "top", "value": [0, 0, -1e5]}}]
    other = {"body": {"boundary": "base.top", "rows": "mortar"}}
    scene["obstacles"] = [{"boundary": "bottom", "approach": "-z", "shape": other}]
    return scene


def deck(count: int) -> str:
    """Returns a deck of CalculiX: two stacked boxes of count x count x 2 bricks with a contact pair."""
    nodes, bricks = [], []
    number = lambda body, i, j, k: 1 + i + (count + 1) * (j + (count + 1) * (k + 3 * body))
    for body in range(2):
        places = [(i, j, k) for k in range(3) for j in range(count + 1) for i in range(count + 1)]
        nodes += [f"{number(body, *place)}, {place[0]}., {place[1]}., {place[2] + 2 * body}." for place in places]
        bricks.append(f"*ELEMENT, TYPE=C3D8, ELSET=BODY{body}")
        for i, j, k in (place for place in places if place[0] < count and place[1] < count and place[2] < 2):
            corners = [number(body, i + a, j + b, k + c) for c in range(2) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
            bricks.append(", ".join(map(str, [len(bricks) - body, *corners])))
    layer, half = count * count, 2 * count * count
    base, top = (count + 1) ** 2, number(1, 0, 0, 2)
    lines = ["*NODE, NSET=ALL", *nodes, *bricks]
    for name, first in (("BOTTOM", layer + 1), ("MIDDLE", half + 1)):
        lines += [f"*ELSET, ELSET={name}, GENERATE", f"{first}, {first + layer - 1}"]
    lines += ["*SURFACE, NAME=MASTER", "BOTTOM, S2", "*SURFACE, NAME=SLAVE", "MIDDLE, S1"]
    lines += ["*NSET, NSET=BASE, GENERATE", f"1, {base}", "*NSET, NSET=TOP, GENERATE", f"{top}, {top + base - 1}"]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.3"]
    lines += [f"*SOLID SECTION, ELSET=BODY{body}, MATERIAL=STEEL" for body in range(2)]
    lines += ["*SURFACE INTERACTION, NAME=HARD", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD"]
    lines += ["*CONTACT PAIR, INTERACTION=HARD, TYPE=SURFACE TO SURFACE", "SLAVE, MASTER", "*BOUNDARY", "BASE, 1, 3"]
    corners = [f"{top}, 3, 3, -0.01", f"{top + base - 1}, 3, 3, 0.001"]
    lines += ["*STEP", "*STATIC", "*BOUNDARY", "TOP, 1, 2", *corners, "*END STEP"]
    return "\n".join(lines) + "\n"


def write_matrix(path: Path, rows: int, columns: int, entries: list[tuple[int, int, float]], form: str) -> None:
    head = f"%%MatrixMarket matrix coordinate real {form}\n{rows} {columns} {len(entries)}\n"
    path.write_text(head + "".join(f"{row + 1} {column + 1} {value!r}\n" for row, column, value in entries))


def write_vector(path: Path, values: list[float]) -> None:
    head = f"%%MatrixMarket matrix array real general\n{len(values)} 1\n"
    path.write_text(head + "".join(f"{value!r}\n" for value in values))


def write_problem(folder: Path, stiffness: list, load: list[float], contact: list, gap: list[float]) -> None:
    """Writes a problem directory; the stiffness is given by its lower triangle."""
    folder.mkdir()
    write_matrix(folder / "K.mtx", len(load), len(load), stiffness, "symmetric")
    write_matrix(folder / "B.mtx", len(gap), len(load), contact, "general")
    write_vector(folder / "f.mtx", load)
    write_vector(folder / "g.mtx", gap)


def write_dense(folder: Path, n: int) -> None:
    """Writes a problem with K = A A' / n + 0.1 I and n / 2 dense rows, and the opposite gaps as the other end of a path."""
    draw = random.Random(n)
    a = [[draw.uniform(-2, 2) for _ in range(n)] for _ in range(n)]
    entry = lambda i, j: sum(map(operator.mul, a[i], a[j])) / n + 0.1 * (i == j)
    stiffness = [(i, j, entry(i, j)) for j in range(n) for i in range(j, n)]
    load = [draw.uniform(-2, 2) for _ in range(n)]
    contact = [(row, dof, draw.uniform(-2, 2)) for row in range(n // 2) for dof in range(n)]
    gap = [draw.uniform(0.1, 0.6) for _ in range(n // 2)]
    write_problem(folder, stiffness, load, contact, gap)
    write_vector(folder / "g1.mtx", [-value for value in gap])


def write_membrane(folder: Path, n: int) -> None:
    """Writes step-41 of deal.II: bilinear cells on (-1, 1)^2, n x n unknowns, each above a staircase, under a load of -10."""
    h = 2 / (n + 1)
    before = ((-1, -1), (0, -1), (1, -1), (-1, 0))
    stiffness = []
    for j in range(n):
        for i in range(n):
            near = [(i + di, j + dj) for di, dj in before if 0 <= i + di < n and 0 <= j + dj]
            stiffness += [(j * n + i, l * n + k, -1 / 3) for k, l in near] + [(j * n + i, j * n + i, 8 / 3)]
    stair = lambda x: 0.2 if x < -0.5 else 0.4 if x < 0 else 0.6 if x < 0.5 else 0.8
    gap = [stair((i + 1) * h - 1) for _ in range(n) for i in range(n)]
    write_problem(folder, stiffness, [-10 * h * h] * (n * n), [(dof, dof, -1.0) for dof in range(n * n)], gap)


def scene(make: Callable[..., dict], *arguments) -> Callable[[Path], object]:
    return lambda path: path.write_text(json.dumps(make(*arguments)))


INPUTS: dict[str, Callable[[Path], object]] = {
    "plane-16k.json": scene(block, [90, 90], [1, 1], "q4"),
    "plane-131k.json": scene(block, [256, 256], [1, 1], "q4"),
    "space-4k.json": scene(block, [10, 10, 10], [1, 1, 1], "hex8"),
    "space-14k.json": scene(block, [16, 16, 16], [1, 1, 1], "hex8"),
    "space-104k.json": scene(block, [32, 32, 32], [1, 1, 1], "hex8"),
    "coarse-plane.json": scene(block, [8, 4], [1, 0.5], "q4"),
    "coarse-axis.json": scene(about_axis),
    "coarse-space.json": scene(block, [4, 4, 2], [1, 1, 0.5], "tet4"),
    "mortar.json": scene(mortar),
    "motion.json": scene(motion),
    "deck.inp": lambda path: path.write_text(deck(8)),
    **{f"dense-{n}": lambda folder, n=n: write_dense(folder, n) for n in (10, 30, 100, 200)},
    **{f"membrane-{n}": lambda folder, n=n: write_membrane(folder, n) for n in (31, 127, 255)},
}


# One run.


def ran(words: list[str], desk: Path) -> subprocess.CompletedProcess:
    """Runs a command in a small environment, so that nothing of this one enters the counts."""
    environment = {"PATH": "/usr/bin:/bin", "RAYON_NUM_THREADS": "1"}
    return subprocess.run(words, cwd=desk, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True)


def instructions(words: list[str], desk: Path) -> float:
    """Counts the instructions of a command in millions. Raises `RuntimeError` if it fails."""
    # The same count as that of callgrind in a third of the time: without caches, and without a graph of calls.
    counting = ["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"]
    done = ran(counting + words, desk)
    counted = re.search(r"I\s+refs:\s+([\d,]+)", done.stderr)
    if done.returncode or not counted:
        said = [line for line in done.stderr.splitlines() if not line.startswith(("==", "--"))]
        raise RuntimeError(f"{' '.join(words)}: exit code {done.returncode}: {' '.join(said)[:200]}")
    return int(counted[1].replace(",", "")) / 1e6


def peak(words: list[str], desk: Path) -> float:
    """Returns the largest resident memory of a command in MB."""
    # A child of this process would start with the memory of python. So a shell starts the command, and leaves it to this process.
    ctypes.CDLL(None).prctl(SUBREAPER, 1)
    left = ran(["sh", "-c", '"$@" >/dev/null 2>&1 & exec echo $!', "sh", *words], desk)
    return os.wait4(int(left.stdout), 0)[2].ru_maxrss * 1024 / 1e6


def measured(command: str, desk: Path) -> Cost | None:
    """Returns what a command costs, or `None` if it fails; then its message is on standard error."""
    words = ["./signorini", *command.split()]
    words += FIXED if words[1] in SOLVING else ()
    try:
        return Cost(round(instructions(words, desk), 3), round(min(peak(words, desk) for _ in range(PEAK_RUNS)), 1))
    except RuntimeError as error:
        print(error, file=sys.stderr)
        return None


def counted(program: Path, commands: dict[str, str]) -> Iterator[tuple[str, Cost | None]]:
    """Runs the commands of cases, as many at a time as there are processors, and returns them in order."""
    # The path has the same length in every run, because it enters the counts.
    with tempfile.TemporaryDirectory(prefix="ledger-", dir="/tmp") as folder, ThreadPoolExecutor(os.cpu_count()) as lanes:
        desk = Path(folder)
        for name, target in (("signorini", program), ("examples", ROOT / "examples"), ("tests", ROOT / "tests")):
            (desk / name).symlink_to(target.resolve())
        for name in INPUTS.keys() & {word for command in commands.values() for word in command.split()}:
            INPUTS[name](desk / name)
        yield from zip(commands, lanes.map(lambda command: measured(command, desk), commands.values()))


# The table.


class Table:
    """The lines of the ledger, and what is said of each build: date, commit, and what its counts depend on."""

    def __init__(self, path: Path):
        lines = path.read_text().splitlines()
        heads = [line[2:].split(": ", 1) for line in lines if line.startswith("# ")]
        self.heads = {build: head.split(", ", 2) for build, head in heads}
        self.rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))

    def costs(self, build: str) -> dict[str, Cost]:
        """Returns the cases that have numbers of a build."""
        numbers = {row["case"]: (row[f"{build} M"], row[f"{build} MB"]) for row in self.rows}
        return {case: Cost(*map(float, pair)) for case, pair in numbers.items() if all(pair)}

    def renew(self, build: str, costs: dict[str, Cost | None], here: str) -> None:
        commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=ROOT, capture_output=True, text=True)
        self.heads[build] = [datetime.date.today().isoformat(), f"commit {commit.stdout.strip()}", here]
        for row in self.rows:
            if row["case"] in costs:
                row[f"{build} M"], row[f"{build} MB"] = costs[row["case"]] or ("", "")

    def write(self, path: Path) -> None:
        with path.open("w", newline="") as file:
            file.writelines(f"# {build}: {', '.join(head)}\n" for build, head in self.heads.items())
            lines = csv.DictWriter(file, self.rows[0].keys(), lineterminator="\n")
            lines.writeheader()
            lines.writerows(self.rows)

    def page(self) -> str:
        """Returns version 0.2.0 beside the release build, as a table of Markdown."""
        old, new = self.costs("0.2.0"), self.costs("release")
        lines = ["| case | 0.2.0, M | now, M | ratio | 0.2.0, MB | now, MB | ratio |", "|---|---|---|---|---|---|---|"]
        for case, now in new.items():
            pairs = zip(old.get(case, (None, None)), now)
            cells = [f"{was:,.1f} | {now:,.1f} | {now / was:.2f}" if was else f"- | {now:,.1f} | -" for was, now in pairs]
            lines.append(f"| {case} | {' | '.join(cells)} |")
        return "\n".join(lines)


def conditions() -> str:
    """Returns what the counts depend on beside the program."""
    versions = []
    for tool in ("rustc", "valgrind"):
        found = shutil.which(tool) and subprocess.run([tool, "--version"], cwd=ROOT, capture_output=True, text=True)
        versions.append(found.stdout.strip() if found else f"no {tool}")
    processor = Path("/proc/cpuinfo")
    has_avx2 = processor.exists() and "avx2" in processor.read_text().split()
    return ", ".join([*versions, " ".join(platform.libc_ver()), "AVX2" if has_avx2 else "no AVX2"])


def faults(old: dict[str, Cost], new: dict[str, Cost | None]) -> list[str]:
    """Returns a sentence for each case that fails or takes more than it may, and for the mean."""
    found, growths = [], []
    for case, was in old.items():
        now = new.get(case)
        if not now:
            found.append(f"{case}: no result")
            continue
        growths.append(now.instructions / was.instructions)
        if growths[-1] > 1 + CASE_GROWTH:
            found.append(f"{case}: {growths[-1]:.3f} times the instructions of the table; {1 + CASE_GROWTH} is allowed")
        if now.peak > max((1 + PEAK_GROWTH) * was.peak, was.peak + PEAK_NOISE):
            found.append(f"{case}: {now.peak / was.peak:.3f} times the peak of the table; {1 + PEAK_GROWTH} is allowed")
    mean = statistics.geometric_mean(growths) if growths else 1
    if mean > 1 + MEAN_GROWTH:
        found.append(f"geometric mean: {mean:.4f} times the instructions of the table; {1 + MEAN_GROWTH} is allowed")
    return found


def line(case: str, was: Cost | None, now: Cost | None) -> str:
    """Returns a case with its old numbers, its new ones and their ratio."""
    pairs = zip(was or ("-", "-"), now or ("-", "-"))
    ratio = lambda pair: f"{pair[1] / pair[0]:.3f}" if was and now else "-"
    return f"{case:20}" + "".join(f"{pair[0]:>12} {pair[1]:>12} {ratio(pair):>7}" for pair in pairs)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("program", nargs="?", type=Path, help="the program whose cost is counted")
    parser.add_argument("--short", action="store_true", help="only the cases of the build for tests (target/debug/signorini)")
    parser.add_argument("--build", choices=BUILDS, help="columns of the table [default: release; with --short: dev]")
    parser.add_argument("--cases", metavar="CASE,CASE", help="only these cases")
    parser.add_argument("--write", action="store_true", help="renew the table")
    parser.add_argument("--page", action="store_true", help="print the table of the documents, and run nothing")
    options = parser.parse_args()
    table = Table(TABLE)
    if options.page:
        print(table.page())
        return 0
    if not options.program:
        parser.error("a program is needed")
    if options.write and options.cases:
        parser.error("--write renews all cases of a build, so that one date stands for all")
    build = options.build or ("dev" if options.short else "release")
    here = conditions()
    if not options.write and here != table.heads[build][2]:
        print(f"ledger: not comparable: here {here}; the table has {table.heads[build][2]}")
        return 0
    old = table.costs(build)
    is_asked = lambda case: case in options.cases.split(",") if options.cases else not options.short or case in old
    commands = {row["case"]: row["command"] for row in table.rows if is_asked(row["case"])}
    new = {}
    print("{:20}{:>12} {:>12} {:>7}{:>12} {:>12} {:>7}".format("case", "M old", "M new", "ratio", "MB old", "MB new", "ratio"))
    for case, cost in counted(options.program, commands):
        new[case] = cost
        print(line(case, old.get(case), cost), flush=True)
    if options.write:
        table.renew(build, new, here)
        table.write(TABLE)
        return 1 if None in new.values() else 0
    found = faults({case: old[case] for case in commands if case in old}, new)
    print("\n".join(found) or "ledger: nothing takes more than the table allows")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
