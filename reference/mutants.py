"""Measures how many faults in the certificate or in the guarantee the tests detect.

`python reference/mutants.py [--of certificate|guarantee] [--count N] [--seed S] [--again] [--long]`

cargo-mutants (`cargo install cargo-mutants --locked`) lists the mutants of the certificate (conditions, bound, proof, infeasible rows,
claims) or of the guarantee against the continuum: an exchanged operator, a negated condition, a function that returns a constant. This
command draws some of them, by a digest of the seed and of the change, so that an edit of the code does not move other mutants into or
out of the draw. It puts them into a copy of the repository in `target/mutants`, each behind a number that the environment gives, and
builds them together; a mutant that does not build beside others is built alone. For each it runs stages of fast tests until one fails.
Survivors that are not faults are listed in `tests/mutants.toml`, each with its reason. The exit code is 1 if more than 2 % of the mutants
that build survive without a reason. With `--again`, mutants that earlier runs killed count as killed. With `--long`, the tests run in
their long form: `--again --long` tells which survivors of the short form it kills.
"""

import argparse
import hashlib
import json
import math
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
import tomllib
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
OWN = ROOT / "target" / "mutants"
REASONS = ROOT / "tests" / "mutants.toml"

SEED = 20
COUNT = 60
"""Number of mutants of a draw."""

ALLOWED = 0.02
"""Largest share of the mutants that build which may survive without a reason."""

BUILD_SECONDS = 3600
"""Time limit of a build. The first one compiles all dependencies."""

WAITING = 10
"""A test program that waits, or shares the machine, takes at most this many times its limit of processor time."""

MEMORY = 6 << 30
"""Limit of the address space of a test program in bytes, which ends a loop that fills a vector."""

SLOW = ("contact_sets_of_three_hundred_rows", "the_bound_of_the_pieces_of_a_loose_answer_equals_that_of_the_whole")
"""Tests of the modules below that are left out: they take 4 s or more, and check methods rather than the certificate."""


@dataclass(frozen=True)
class Stage:
    """The test programs of a stage, given by the arguments that build them, and the tests that run."""

    name: str
    programs: tuple[str, ...]
    tests: tuple[str, ...]
    seconds: float = 120
    """Limit of the processor time of a process, a few times what the tests take. A mutant that takes longer is in an endless loop and
    counts as detected."""


@dataclass(frozen=True)
class Area:
    """The mutated files, and the stages. Fast tests run first; the others run only for mutants that survive them."""

    files: tuple[str, ...]
    stages: tuple[Stage, ...]


AREAS = {
    "certificate": Area(
        ("crates/qp/src/certificate/**", "crates/qp/src/existence/**"),
        (
            Stage("own", ("--package", "signorini-qp", "--lib"), ("certificate::", "existence::")),
            Stage(
                "quick",
                ("--test", "numerics"),
                ("certificate::", "claims::", "hostile::", "exact_arithmetic::", "findings::"),
            ),
            Stage("unit", ("--package", "signorini-qp", "--lib"), ()),
            Stage(
                "numerics",
                ("--test", "numerics"),
                ("degenerate::", "dual_active_set::", "energy_bound::", "exact_path::", "extremes::", "methods::")
                + ("obstacle_problems::", "penalty_ladder::", "proven_set::", "separate_parts::", "watch::"),
            ),
            Stage("multigrid", ("--test", "multigrid"), ("cycle_bound::", "mprgp::")),
        ),
    ),
    "guarantee": Area(
        ("crates/guarantee/src/**",),
        (
            Stage("own", ("--package", "signorini-guarantee", "--lib"), ("",)),
            Stage("program", ("--test", "program"), ("total_error", "guarantees"), 240),
        ),
    ),
}

WRAPPER = '#!/bin/sh\nexec "$@" -C lto=off\n'
"""The wrapper of the compiler for the crates of the workspace. Where rustc optimises at all, it also optimises across the parts of a crate,
although no profile asks for link-time optimisation; without that a mutant is built sooner."""

MARK = re.compile(r" ?/\* ~ changed by cargo-mutants ~ \*/")
PLACE = re.compile(r":\d+:\d+: ")
CHOICE = re.compile(r"match crate::planted\(\) \{ // ([\d ]+)")

NUMBER = "SIGNORINI_MUTANT"
"""The variable of the environment with the number of the mutant in force; 0 for none."""

PLANTED = f"""
pub(crate) fn planted() -> usize {{
    static NUMBER: std::sync::OnceLock<usize> = std::sync::OnceLock::new();
    *NUMBER.get_or_init(|| std::env::var("{NUMBER}").map_or(0, |number| number.parse().unwrap()))
}}
"""
"""The function that a mutated crate gets."""


@dataclass(frozen=True)
class Mutant:
    """A change of one file: its name, with line and column, the lines that it removes and adds, and where its function is."""

    name: str
    file: str
    diff: str
    function: tuple[int, int] | None = None
    """First and last line."""

    @property
    def key(self) -> tuple[str, str]:
        """Identifies the mutant independently of its line number: its name without the place, and its first new line."""
        added = [line[1:] for line in self.diff.splitlines()[2:] if line.startswith("+")]
        return PLACE.sub(": ", self.name, count=1), MARK.sub("", added[0]).strip() if added else ""

    def applied(self, text: str) -> str:
        """Returns the text of the file with the change."""
        lines, changed, at = text.splitlines(), [], 0
        for line in self.diff.splitlines()[2:]:
            if line.startswith("@@"):
                start = int(re.match(r"@@ -(\d+)", line)[1]) - 1
                changed += lines[at:start]
                at = start
            elif line.startswith("+"):
                changed.append(line[1:])
            elif line.startswith(("-", " ")):
                if lines[at] != line[1:]:
                    raise ValueError(f"{self.name}: line {at + 1} is not that of the list")
                changed += [lines[at]] if line.startswith(" ") else []
                at += 1
        return "\n".join(changed + lines[at:]) + "\n"


def listed(root: Path, area: Area) -> list[Mutant]:
    """Returns all mutants of an area, in the order of cargo-mutants."""
    chosen = [part for file in area.files for part in ("--file", file)]
    command = ["cargo", "mutants", "--workspace", "--no-config", "--list", "--json", *chosen]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"cargo mutants: {done.stderr.strip()}\nIt comes with: cargo install cargo-mutants --locked")
    lines = lambda of: (of["span"]["start"]["line"], of["span"]["end"]["line"]) if of else None
    return [Mutant(one["name"], one["file"], one["diff"], lines(one["function"])) for one in json.loads(done.stdout)]


def switched(text: str, mutants: dict[int, Mutant]) -> str:
    """Returns the text of a file in which each mutated function chooses its body by the number of the mutant in force."""
    lines, count, below = text.splitlines(), len(text.splitlines()), math.inf
    for first, last in sorted({mutant.function for mutant in mutants.values() if mutant.function}, reverse=True):
        heads = (at for at in range(first, last) if re.search(r"^(?! *//).*\{$", lines[at - 1]))
        if (head := next(heads, None)) is None or last >= below:
            continue  # a function around another one
        own = {number: mutant for number, mutant in mutants.items() if mutant.function == (first, last)}
        choice = [f"match crate::planted() {{ // {' '.join(map(str, own))}"]
        for number, mutant in own.items():
            changed = mutant.applied(text).splitlines()
            choice += [f"{number} => {{", *changed[head : last - 1 + len(changed) - count], "}"]
        lines[head : last - 1], below = [*choice, "_ => {", *lines[head : last - 1], "}", "}"], first
    return "\n".join(lines) + "\n"


def together(tree: Path, area: Area, mutants: dict[int, Mutant]) -> set[int]:
    """Puts mutants into the tree, each behind its number. Returns the numbers of those that build beside others."""
    texts = {mutant.file: (tree / mutant.file).read_text() for mutant in mutants.values()}
    root = tree / area.files[0].split("/src/")[0] / "src" / "lib.rs"
    root.write_text(root.read_text() + PLANTED)
    numbers, faults = set(mutants), True
    while faults:
        for file, text in texts.items():
            of_file = {number: mutants[number] for number in sorted(numbers) if mutants[number].file == file}
            (tree / file).write_text(switched(text, of_file))
        choices = [found for file in texts for found in CHOICE.findall((tree / file).read_text())]
        numbers &= {int(number) for found in choices for number in found.split()}
        messages = [message["message"] for message in built(tree, area.stages[0])[1] if message["reason"] == "compiler-message"]
        errors = [span for one in messages if one["level"] == "error" for span in one["spans"] if span["is_primary"]]
        faults = {(span["file_name"], span["line_start"]) for span in errors}
        for file, line in faults:
            found = CHOICE.findall("\n".join((tree / file).read_text().splitlines()[:line]))
            numbers -= {int(number) for number in found[-1].split()} if found else numbers
    return numbers


def numbered(mutants: list[Mutant]) -> list[str]:
    """Returns the identifier of each mutant: its key, and its number among the mutants of the same key, in one text."""
    seen = Counter()
    names = []
    for mutant in mutants:
        names.append("\n".join([*mutant.key, str(seen[mutant.key])]))
        seen[mutant.key] += 1
    return names


def drawn(mutants: list[Mutant], count: int, seed: int) -> list[tuple[str, Mutant]]:
    """Draws `count` mutants with their identifiers, in the order of the list.

    The mutants with the smallest digests of seed and identifier are drawn. An edited line therefore affects only its own mutants, and
    a larger draw of the same seed contains the smaller one.
    """
    named = list(zip(numbered(mutants), mutants))
    digest = lambda place: hashlib.sha256(f"{seed}\n{named[place][0]}".encode()).digest()
    return [named[place] for place in sorted(sorted(range(len(named)), key=digest)[:count])]


def reasons(file: Path) -> dict[tuple[str, str], str]:
    """Reads the reasons why mutants are not faults, by their keys."""
    entries = tomllib.loads(file.read_text())["survivor"] if file.exists() else []
    for entry in entries:
        if not entry["reason"].strip():
            raise SystemExit(f"{file.name}: no reason for {entry['mutant']}")
    return {(entry["mutant"], entry["line"]): entry["reason"] for entry in entries}


def copied(root: Path, tree: Path) -> None:
    """Copies the tracked files into `tree`. Unchanged files keep their modification times, so that little is built again."""
    tracked = subprocess.run(["git", "ls-files", "-z"], cwd=root, capture_output=True, check=True).stdout
    names = [name for name in tracked.decode().split("\0") if name and (root / name).exists()]
    for name in names:
        source, target = root / name, tree / name
        if not target.exists() or target.read_bytes() != source.read_bytes():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)
    for stale in {path for path in tree.rglob("*") if path.is_file()} - {tree / name for name in names}:
        stale.unlink()


def limits(seconds: float):
    """Returns the function that limits memory and processor time of a test program, and of each process that it starts."""

    def limited() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds) + 1))

    return limited


def ended(command: list[str], tree: Path, seconds: float, limit=None) -> tuple[int | None, str]:
    """Runs a command. Returns its exit code (None if it exceeds the time) and its standard output. Its children end with it."""
    environment = os.environ | {
        "CARGO_TARGET_DIR": str(OWN / "build"),
        "CARGO_PROFILE_DEV_DEBUG": "0",
        "CARGO_INCREMENTAL": "1",
        "RUSTC_WORKSPACE_WRAPPER": str(OWN / "rustc"),
    }
    with subprocess.Popen(
        command,
        cwd=tree,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
        preexec_fn=limit,
    ) as process:
        try:
            output, _ = process.communicate(timeout=seconds)
            return process.returncode, output
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            return None, ""


def built(tree: Path, stage: Stage) -> tuple[bool, list[dict]]:
    """Builds the test programs of a stage. Returns `True` if the tree builds, and the messages of cargo."""
    command = ["cargo", "test", "--quiet", "--offline", "--no-run", "--message-format=json", *stage.programs]
    code, output = ended(command, tree, BUILD_SECONDS)
    return code == 0, [json.loads(line) for line in output.splitlines() if line.startswith("{")]


def programs(tree: Path, stage: Stage) -> list[str] | None:
    """Builds and returns the test programs of a stage; None if the tree does not build."""
    builds, messages = built(tree, stage)
    tests = [message for message in messages if message.get("profile", {}).get("test")]
    return [message["executable"] for message in tests if message["executable"]] if builds else None


def judged(tree: Path, area: Area) -> tuple[str, str]:
    """Builds and tests the tree. Returns `unbuildable`, `timed out`, `killed` or `survived`, and the stage."""
    for stage in area.stages:
        found = programs(tree, stage)
        if found is None:
            return "unbuildable", stage.name
        skipped = [part for name in SLOW for part in ("--skip", name)]
        for program in found:
            command = [program, *stage.tests, *skipped]
            code, _ = ended(command, tree, WAITING * stage.seconds, limits(stage.seconds))
            if code in (None, -signal.SIGXCPU):
                return "timed out", stage.name
            if code != 0:
                return "killed", stage.name
    return "survived", ""


def tried(mutant: Mutant, tree: Path, area: Area) -> tuple[str, str]:
    """Returns the outcome of a mutant. The copy of the repository is restored afterwards."""
    file = tree / mutant.file
    text = file.read_text()
    try:
        file.write_text(mutant.applied(text))
        return judged(tree, area)
    finally:
        file.write_text(text)


def summary(outcomes: list[tuple[Mutant, str]], known: dict[tuple[str, str], str]) -> tuple[str, bool]:
    """Returns the table of a run, with the name of every survivor, and `True` if few enough survive without a reason."""
    count = Counter(outcome for _, outcome in outcomes)
    survivors = [mutant for mutant, outcome in outcomes if outcome == "survived"]
    open_ones = [mutant for mutant in survivors if mutant.key not in known]
    viable = len(outcomes) - count["unbuildable"]
    share = lambda number: f"{100.0 * number / viable:.1f} %" if viable else "-"
    rows = [
        ("drawn", len(outcomes), ""),
        ("unbuildable", count["unbuildable"], ""),
        ("viable", viable, ""),
        ("killed", count["killed"], share(count["killed"])),
        ("timed out", count["timed out"], share(count["timed out"])),
        ("survived", len(survivors), share(len(survivors))),
        ("survived, with a reason", len(survivors) - len(open_ones), share(len(survivors) - len(open_ones))),
        ("survived, without", len(open_ones), share(len(open_ones))),
    ]
    lines = [f"{name:<24}{number:>6}  {part:>7}".rstrip() for name, number, part in rows]
    for mutant in survivors:
        lines += ["", mutant.name, f"    {mutant.key[1]}", f"    {known.get(mutant.key, 'NO REASON')}"]
    return "\n".join(lines), len(open_ones) <= ALLOWED * viable


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--count", type=int, default=COUNT, metavar="N", help=f"number of mutants to draw (default {COUNT})")
    parser.add_argument("--seed", type=int, default=SEED, metavar="S", help=f"seed of the draw (default {SEED})")
    parser.add_argument("--again", action="store_true", help="try only what the last run did not kill")
    parser.add_argument("--long", action="store_true", help="run the long form of the tests")
    parser.add_argument("--of", choices=AREAS, default="certificate", help="what is changed (default certificate)")
    options = parser.parse_args()
    area = AREAS[options.of]
    began, tree, kept = time.monotonic(), OWN / "tree", OWN / f"outcomes-{options.of}.json"
    known, mutants = reasons(REASONS), listed(ROOT, area)
    chosen = drawn(mutants, options.count, options.seed)
    print(f"{len(mutants)} mutants, {len(chosen)} drawn with seed {options.seed}", flush=True)
    copied(ROOT, tree)
    (OWN / "rustc").write_text(WRAPPER)
    (OWN / "rustc").chmod(0o755)
    last = dict(json.loads(kept.read_text())) if options.again and kept.exists() else {}
    waiting = {at: mutant for at, (name, mutant) in enumerate(chosen, 1) if last.get(name, "survived") == "survived"}
    beside = together(tree, area, waiting)
    print(f"{len(beside)} of {len(waiting)} build together, after {time.monotonic() - began:.0f} s", flush=True)
    os.environ |= {NUMBER: "0"} | ({"SIGNORINI_LONG": "1"} if options.long else {})
    first = judged(tree, area)
    if first[0] != "survived":
        print(f"without a mutant the tests end with: {' in stage '.join(first)}", file=sys.stderr)
        return 1
    print(f"the tests pass without a mutant, after {time.monotonic() - began:.0f} s", flush=True)
    for at in sorted(waiting, key=lambda at: at not in beside):
        (name, mutant), os.environ[NUMBER] = chosen[at - 1], str(at)
        if at not in beside:
            copied(ROOT, tree)
        outcome, stage = judged(tree, area) if at in beside else tried(mutant, tree, area)
        print(f"{time.monotonic() - began:6.0f} s  {outcome:<12}{stage:<10}{mutant.name}", flush=True)
        last[name] = outcome
        kept.write_text(json.dumps(last, indent=1))
    outcomes = [(mutant, last[name]) for name, mutant in chosen]
    table, is_met = summary(outcomes, known)
    print(f"\n{table}\n\n{time.monotonic() - began:.0f} s in all")
    return 0 if is_met else 1


if __name__ == "__main__":
    sys.exit(main())
