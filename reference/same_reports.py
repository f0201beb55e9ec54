"""Compares the results of two programs: `python reference/same_reports.py PROGRAM OTHER [TARGET ...]`.

Both programs run `solve TARGET --format json --out FOLDER` for every target. A target is a scene, a problem directory, or a folder
that contains them. The default is all scenes and problems of this repository, and the raw problems of `cases.py` if numpy and scipy are
installed. Exit code, messages, report and every file of the folder are compared byte by byte; only the seconds in reports are
ignored. The exit code is 1 if anything differs.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = ("examples", "studies/impact", "tests/corpus", "tests/faults")

SECONDS = re.compile(r"[0-9.e+-]+ s\b")
"""A duration inside a sentence, for example in the reason of an attempt."""

DATA = re.compile(rb'(?<=id="data">)[^<]*')
"""The JSON of a page."""


def targets(path: Path) -> list[Path]:
    """Returns the scenes and problem directories at or below a path, sorted."""
    if path.is_file() or (path / "K.mtx").exists():
        return [path]
    found = [directory.parent for directory in path.rglob("K.mtx")]
    found += [file for file in path.rglob("*.json") if is_scene(file)]
    return sorted(found)


def is_scene(file: Path) -> bool:
    """Returns `True` for a file with a JSON object that has a body."""
    try:
        scene = json.loads(file.read_text())
    except ValueError:
        return False
    return isinstance(scene, dict) and "body" in scene


def raw_problems(folder: Path) -> list[Path]:
    """Writes the raw problems of the reference into a folder. Returns an empty list without numpy and scipy."""
    try:
        from cases import RAW_CASES
        from problem import write_problem
    except ImportError:
        return []
    for number, case in enumerate(RAW_CASES):
        write_problem(case.generate(), folder / f"{number:02}")
    return sorted(folder.iterdir())


def timeless(value):
    """Returns a report without its times."""
    if isinstance(value, dict):
        return {key: timeless(inner) for key, inner in value.items() if key != "seconds"}
    if isinstance(value, list):
        return [timeless(inner) for inner in value]
    return SECONDS.sub("... s", value) if isinstance(value, str) else value


def stripped(name: str, content: bytes) -> bytes:
    """Returns a file or an output without its times; the order of its fields is kept."""
    if name.endswith(".json"):
        try:
            return json.dumps(timeless(json.loads(content))).encode()
        except ValueError:
            return content
    if name.endswith(".html"):
        return DATA.sub(lambda data: json.dumps(timeless(json.loads(data[0]))).encode(), content, count=1)
    return content


def left_by(program: Path, target: Path) -> dict[str, bytes]:
    """Runs a program and returns all its results by name: exit code, messages, report, files."""
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "solve", target, "--format", "json", "--out", folder]
        done = subprocess.run(command, capture_output=True, check=False)
        found = {"exit code": str(done.returncode).encode(), "messages": done.stderr}
        found["report on standard output"] = stripped("report.json", done.stdout)
        for file in sorted(Path(folder).rglob("*")):
            if file.is_file():
                found[str(file.relative_to(folder))] = stripped(file.name, file.read_bytes())
    return found


def differences(programs: list[Path], target: Path) -> tuple[int, list[str]]:
    """Returns the number of compared results, and the names of those that differ."""
    one, other = (left_by(program, target) for program in programs)
    names = one.keys() | other.keys()
    return len(names), sorted(name for name in names if one.get(name) != other.get(name))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("programs", nargs=2, type=Path, metavar="PROGRAM")
    parser.add_argument("targets", nargs="*", type=Path, metavar="TARGET")
    options = parser.parse_args()
    compared, different = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        chosen = options.targets or [ROOT / name for name in FOLDERS]
        found = [target for path in chosen for target in targets(path)]
        found += [] if options.targets else raw_problems(Path(folder))
        for target in found:
            count, names = differences(options.programs, target)
            compared += count
            different += len(names)
            for name in names:
                print(f"{target}: {name} differs")
    print(f"{len(found)} problems, {compared} outputs and files compared, {different} differ")
    return 1 if different or not found else 0


if __name__ == "__main__":
    sys.exit(main())
