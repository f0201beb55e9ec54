"""Compares two programs on everything that this repository has: `python reference/before_and_after.py OLD NEW`.

Every scene, problem directory, mesh and deck of `jobs.py` is a few jobs. A job runs commands in an empty folder, once by each program,
and then its exit codes, messages, reports and files are compared. Anything that is not the same bits is listed, worst first: sentences
and numbers with their places, old and new, and the relative difference. Numbers of one list or column are relative to the largest of
them. Only seconds are ignored. A job that reaches its time limit in either program is named and not compared. The exit code is 1 if
anything differs.
"""

import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from jobs import Job, all_jobs, short

WORKERS = 2

FIXED = {"RAYON_NUM_THREADS": "1", "NO_COLOR": "1"}
"""One thread for each program, because two run at a time."""

MEMORY = ("--max-memory", "4GB")
"""The default depends on what the machine has left."""

ENDINGS = {0: "certified", 1: "bad input or file", 2: "usage", 3: "no answer", 4: "not certified"}

SECONDS = re.compile(r"[0-9.e+-]+ s\b|(?<=  seconds  ).*")
"""A duration inside a sentence, for example in the reason of an attempt, and the row of them in a report."""

TABLE = re.compile(r"(?<=seconds\n)(?:.+\n?)+")
"""The rows of a table whose last column has seconds."""

DATA = re.compile(r'(?<=id="data">)[^<]*')
"""The JSON of a page."""

NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")

SHOWN = 3
"""Differences that are printed of one output."""

ABSENT = "(absent)"


@dataclass
class Result:
    """What a job found: one finding for each output that differs, its worst distance first."""

    job: Job
    compared: int = 0
    findings: list[tuple[float, str]] = field(default_factory=list)
    is_cut: bool = False


def timeless(value):
    """Returns a report without its times."""
    if isinstance(value, dict):
        return {key: timeless(inner) for key, inner in value.items() if "seconds" not in key}
    if isinstance(value, list):
        return [timeless(inner) for inner in value]
    return SECONDS.sub("... s", value) if isinstance(value, str) else value


def stripped(content: bytes) -> str | bytes:
    """Returns a file or an output without its times; the order of its fields is kept. Bytes are no text."""
    try:
        text = content.decode()
    except UnicodeDecodeError:
        return content
    try:
        return json.dumps(timeless(json.loads(text)))
    except ValueError:
        text = TABLE.sub(lambda rows: re.sub(r"[0-9.e+-]+$", "...", rows[0], flags=re.MULTILINE), SECONDS.sub("... s", text))
        return DATA.sub(lambda data: json.dumps(timeless(json.loads(data[0]))), text, count=1)


def left_by(program: Path, job: Job, pictures: str, limit: float) -> dict[str, str | bytes] | None:
    """Runs a job and returns all its results by name: exit codes, messages, reports, files. Returns `None` if it takes too long."""
    end = time.monotonic() + limit
    found: dict[str, str | bytes] = {}
    with tempfile.TemporaryDirectory() as folder:
        desk = Path(folder)
        for name, file in job.files:
            (desk / name).write_bytes(file.read_bytes())
        given = set(desk.iterdir())
        for number, command in enumerate(job.commands, 1):
            words = [program, *command, *extra(command, pictures)]
            try:
                left = max(0.0, end - time.monotonic())
                done = subprocess.run(words, cwd=desk, env=os.environ | FIXED, capture_output=True, check=False, timeout=left)
            except subprocess.TimeoutExpired:
                return None
            step = f"{number}, {command[0]}"
            found[f"end of {step}"] = f"{done.returncode} {ENDINGS.get(done.returncode, 'another end')}"
            found[f"messages of {step}"] = stripped(done.stderr.replace(folder.encode(), b"."))
            found[f"report of {step}"] = stripped(done.stdout.replace(folder.encode(), b"."))
        for file in sorted(desk.rglob("*")):
            if file.is_file() and file not in given:
                found[str(file.relative_to(desk))] = stripped(file.read_bytes().replace(folder.encode(), b"."))
    return found


def extra(command: tuple[str, ...], pictures: str) -> tuple[str, ...]:
    """Returns the options that make a command repeatable."""
    if command[0] in ("solve", "compare", "sweep", "sensitivity"):
        return ("--format", "json", "--pictures", pictures, *MEMORY)
    if command[0] == "verify":
        return ("--format", "json", *MEMORY)
    return MEMORY if command[0] in ("export", "ccx") else ()


def leaves(content: str | bytes) -> dict[str, object]:
    """Returns all values of an output by place: those of JSON, the columns of lines of numbers, and other lines as they are."""
    if isinstance(content, bytes):
        return {"bytes": content.hex()}
    try:
        return dict(of_json(json.loads(content), ""))
    except ValueError:
        pass
    found = {}
    if data := DATA.search(content):
        found = dict(of_json(json.loads(data[0]), ""))
        content = DATA.sub("", content, count=1)
    for number, line in enumerate(content.splitlines(), 1):
        words = line.replace(",", " ").split()
        try:
            found |= {f"line[{number}].column {column}": float(word) for column, word in enumerate(words, 1)}
        except ValueError:
            found[f"line {number}"] = line
    return found


def of_json(value, place: str):
    """Yields the place and the value of each leaf of a report."""
    inner = ()
    if isinstance(value, dict):
        inner = ((f"{place}.{key}".lstrip("."), below) for key, below in value.items())
    elif isinstance(value, list):
        inner = ((f"{place}[{index}]", below) for index, below in enumerate(value))
    else:
        yield place, value
    for name, below in inner:
        yield from of_json(below, name)


def is_number(value) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def group(place: str) -> str:
    """Returns the list or the column of a number; a single number is a group of its own."""
    return re.sub(r"\[\d+\]", "[]", place)


def distance(one, other, scale: float) -> float:
    """Returns the relative difference of two values; infinity if they differ in more than numbers."""
    if is_number(one) and is_number(other):
        return abs(one - other) / scale if scale else 0.0
    if isinstance(one, str) and isinstance(other, str) and NUMBER.sub("", one) == NUMBER.sub("", other):
        pairs = [[float(number) for number in pair] for pair in zip(NUMBER.findall(one), NUMBER.findall(other), strict=True)]
        return max((abs(a - b) / max(abs(a), abs(b)) for a, b in pairs if a != b), default=0.0)
    return math.inf


def differences(one: str | bytes, other: str | bytes) -> list[tuple[float, str]]:
    """Returns the differences of two outputs that are not the same, worst first."""
    old, new = leaves(one), leaves(other)
    scales: dict[str, float] = {}
    for place, value in [*old.items(), *new.items()]:
        if is_number(value) and math.isfinite(value):
            scales[group(place)] = max(scales.get(group(place), 0.0), abs(value))
    found = []
    for place in old | new:
        a, b = old.get(place, ABSENT), new.get(place, ABSENT)
        if repr(a) != repr(b):
            far = distance(a, b, scales.get(group(place), 0.0))
            found.append((far, f"{far:8.1e}  {place}: {clipped(a, b)}"))
    found.sort(key=lambda difference: -difference[0])
    return found or [(0.0, "the same values in another form")]


def clipped(one, other, most: int = 160) -> str:
    """Returns two values as text, without a long beginning that they share."""
    one, other = str(one), str(other)
    shared = len(os.path.commonprefix([one, other]))
    start = max(0, shared - most // 4) if max(len(one), len(other)) > most else 0
    cut = [("..." if start else "") + text[start : start + most] for text in (one, other)]
    return " -> ".join(cut)


def compared(programs: list[Path], pictures: str, limit: float, job: Job) -> Result:
    """Runs a job by both programs, and compares what they leave."""
    one, other = (left_by(program, job, pictures, limit) for program in programs)
    if one is None or other is None:
        return Result(job, is_cut=True)
    names = one | other
    result = Result(job, compared=len(names))
    for name in names:
        if name not in one or name not in other:
            result.findings.append((math.inf, f"{name}: written by {'OLD' if name in one else 'NEW'} only"))
        elif one[name] != other[name]:
            found = differences(one[name], other[name])
            shown = "".join(f"\n    {text}" for _, text in found[:SHOWN])
            result.findings.append((found[0][0], f"{name}: {len(found)} differ{shown}"))
    return result


def printed(results: list[Result], tolerance: float) -> int:
    """Prints what was found, worst first, and returns the number of outputs that differ by more than the tolerance."""
    found = [(far, f"{result.job.name}: {text}") for result in results for far, text in result.findings]
    for _, text in sorted(found, key=lambda finding: -finding[0]):
        print(text)
    cut = [result.job.name for result in results if result.is_cut]
    for name in cut:
        print(f"cut, and not compared: {name}")
    different = sum(far > tolerance or tolerance == 0.0 for far, _ in found)
    outputs = sum(result.compared for result in results)
    print(f"{len(results)} jobs, {outputs} outputs and files compared, {different} differ, {len(cut)} jobs cut")
    return different


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("programs", nargs=2, type=Path, metavar="PROGRAM", help="the old one, then the new one")
    parser.add_argument("--short", action="store_true", help="a fixed spread of the jobs, in less than a minute")
    parser.add_argument("--only", default="", metavar="TEXT", help="only the jobs with this text in their name")
    parser.add_argument("--tolerance", type=float, default=0.0, metavar="T", help="smaller differences are printed but not counted")
    parser.add_argument("--pictures", default="none", choices=("none", "answer", "all"), help="pictures that are drawn and compared")
    parser.add_argument("--limit", type=float, default=20.0, metavar="S", help="seconds of a job and a program")
    options = parser.parse_args()
    programs = [program.resolve(strict=True) for program in options.programs]
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder, ProcessPoolExecutor(WORKERS) as pool:
        jobs = all_jobs(Path(folder))
        chosen = [job for job in (short(jobs) if options.short else jobs) if options.only in job.name]
        results = list(pool.map(partial(compared, programs, options.pictures, options.limit), chosen))
    different = printed(results, options.tolerance)
    print(f"{time.monotonic() - began:.0f} s")
    return 1 if different or all(result.is_cut for result in results) else 0


if __name__ == "__main__":
    sys.exit(main())
