"""The jobs of `before_and_after.py`: which commands run on which scene, deck, mesh and problem directory of this repository.

Inputs that stand inside other files are written into a folder first: scenes and decks of the pages, the changes of
`tests/faults/cases.jsonl` and `tests/wrong_scenes.json`, damaged files of `tests/corpus`, whole decks in tests, and the problems of
`cases.py` if numpy and scipy are installed. Inputs that tests make by a program are not among them.
"""

import copy
import json
import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

FOLDERS = ("examples", "studies", "tests/corpus/findings", "tests/faults", "tests/meshes")
"""Folders with scenes, problem directories, decks and meshes as files."""

TOTAL_ERRORS = {
    "studies/guarantee/coarse.json": "1e-2",
    "studies/guarantee/quarter.json": "0.5",
    "examples/bar.json": "0.1",
    "examples/between.json": "0.2",
    "examples/circle.json": "0.2",
    "examples/inclined.json": "0.2",
    "examples/indentation.json": "0.2",
}
"""Scenes whose mesh is refined quickly, and the error against the continuum that is asked for."""

SMALL = {
    "title": "A small block",
    "body": {"rectangle": {"x": {"points": [0, 1], "divisions": [4]}, "y": {"points": [0, 0.5], "divisions": [2]}}},
    "material": {"young": 1e7, "poisson": 0.3},
    "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
    "obstacles": [{"boundary": "top", "approach": "+y", "shape": {"parabola": {"apex": [0.5, 0.5], "radius": 1}}}],
    "gap": -0.01,
}
"""An example of `docs/scenes.md` replaces some of its fields."""

BLOCK = re.compile(r"^(?:```json(?:\n// (\S+\.json))?|cat > (\S+) <<'(\w+)')\n(.*?)\n(?:```|\3)$", re.DOTALL | re.MULTILINE)
"""A block of a page, which may begin with the name of its file, or a file that a command of a page writes."""

DECK = re.compile(r'"(\*HEADING\n.*?)"', re.DOTALL)

RESULTS = "*NODE FILE\nU, RF\n*EL FILE\nS, E\n*NODE PRINT, NSET=ALL, TOTALS=YES\nU, RF\n*EL PRINT, ELSET=PART\nS, E\n*END STEP\n"
"""Cards that the decks of tests end with here."""

MOST_OF_A_KIND = 12
"""Jobs of one kind in the short form."""

ALL_OF_KINDS = ("export", "refusal")
"""They are quick: the short form has all of them."""

LARGE = ("docs/scale-block.json", "tests/corpus/findings/strip_max_memory/scene.json")
"""Scenes that are only exported and solved."""

SLOW = (*LARGE, "studies/impact/", "examples/two_cylinders.json", "examples/gallery/", "tests/meshes/quarter-ball-tet10.msh")
"""Beginnings of the targets that the short form leaves out."""


@dataclass(frozen=True)
class Job:
    """Commands that run one after another in a folder with some files."""

    target: str
    kind: str
    commands: tuple[tuple[str, ...], ...]
    files: tuple[tuple[str, Path], ...] = ()

    @property
    def name(self) -> str:
        return f"{self.target}: {self.kind}"


def all_jobs(folder: Path) -> list[Job]:
    """Writes the inputs that are no files into a folder and returns all jobs, sorted."""
    jobs = [job for name in FOLDERS for file in (ROOT / name).rglob("*") for job in of_file(file, str(file.relative_to(ROOT)))]
    for writer in (of_pages, of_decks, of_faults, of_corpus, of_wrong_scenes, of_raw_problems):
        jobs += writer(folder)
    return sorted(jobs, key=lambda job: job.name)


def short(jobs: list[Job]) -> list[Job]:
    """Returns a fixed spread of each kind of jobs."""
    kinds = defaultdict(list)
    for job in jobs:
        if not job.target.startswith(SLOW):
            kinds[job.kind].append(job)
    step = {kind: 1 if kind in ALL_OF_KINDS else -(-len(of_kind) // MOST_OF_A_KIND) for kind, of_kind in kinds.items()}
    return [job for kind, of_kind in kinds.items() for job in of_kind[:: step[kind]]]


def of_file(file: Path, target: str) -> Iterator[Job]:
    """Yields the jobs of a scene, deck, mesh or problem directory; of other files none."""
    if file.name == "K.mtx":
        yield from of_problem(file.parent, target.removesuffix("/K.mtx"))
    elif file.suffix == ".json" and '"body"' in file.read_text():
        yield from of_scene(file, target)
    elif file.suffix == ".msh":
        made = (("export", "new.json", "problem"), ("solve", "new.json", "--out", "out"))
        yield Job(target, "new", (("new", file.name, "--out", "new.json"), *made), ((file.name, file),))
    elif file.suffix == ".inp":
        permits = ("--linear", "--without-friction")
        commands = (("solve", file.name, "--out", "out", *permits), ("ccx", "-i", file.stem, *permits))
        made = (("new", file.name, "--out", "new.json", *permits), ("export", file.name, "problem", *permits))
        yield Job(target, "deck", commands + made, ((file.name, file),))


def of_scene(file: Path, target: str) -> Iterator[Job]:
    """Yields the jobs of a scene: one that is wrong or that moves has only some of them."""
    path = str(file)
    scene = parsed(file.read_text())
    yield Job(target, "solve", (("solve", path, "--out", "out"),))
    if scene is None:
        return
    yield Job(target, "export", (("export", path, "problem"), ("export", path, "petsc", "--format", "petsc")))
    if "analysis" in scene or target in LARGE:
        return
    yield Job(target, "compare", (("compare", path, "--out", "out"),))
    yield Job(target, "methods", of_methods(path))
    yield Job(target, "sensitivity", (("sensitivity", path, "--of", "force,peak-pressure", "--out", "out"),))
    yield Job(target, "problem", (("export", path, "problem"), ("solve", "problem", "--out", "out"), *judged("problem", "out")))
    if "gap" in scene:
        gaps = f"{scene['gap']}:{-2 * abs(scene['gap'] or 1e-3)}:4"
        yield Job(target, "sweep", (("sweep", path, "--gaps", gaps, "--out", "out"),))
    if forces := [obstacle["force"] for obstacle in scene.get("obstacles", ()) if "force" in obstacle]:
        yield Job(target, "sweep of forces", (("sweep", path, "--forces", f"0:{forces[0]}:4", "--out", "out"),))
    if error := TOTAL_ERRORS.get(target):
        yield Job(target, "total error", (("solve", path, "--total-error", error, "--out", "out"),))


def of_problem(directory: Path, target: str) -> Iterator[Job]:
    """Yields the jobs of a problem directory; some have an answer of another program, which is judged too."""
    path = str(directory)
    yield Job(target, "compare", (("compare", path, "--out", "out"),))
    yield Job(target, "methods", of_methods(path))
    kept = judged(path, path) if (directory / "u.mtx").exists() else ()
    yield Job(target, "directory", (("solve", path, "--out", "out"), *judged(path, "out"), *kept))


def judged(problem: str, answer: str) -> tuple[tuple[str, ...], ...]:
    """Returns the certificates of an answer without and with multipliers of equality rows; one of the two is refused."""
    command = ("verify", problem, "--displacement", f"{answer}/u.mtx", "--multiplier", f"{answer}/lambda.mtx")
    return command, (*command, "--equality-multiplier", f"{answer}/mu.mtx")


def of_methods(path: str) -> tuple[tuple[str, ...], ...]:
    """Returns what `solve` and `compare` do not show: the plan, multigrid, and an answer of less accuracy."""
    multigrid = ("solve", path, "--method", "mprgp", "--out", "multigrid")
    return ("solve", path, "--plan"), multigrid, ("solve", path, "--accuracy", "1e-3", "--out", "accuracy")


def parsed(text: str) -> dict | None:
    """Returns a scene without its comments. Returns `None` if it is no object of JSON."""
    try:
        scene = json.loads(re.sub(r"^\s*//.*$", "", text, flags=re.MULTILINE))
    except ValueError:
        return None
    return scene if isinstance(scene, dict) else None


def written(file: Path, content: str | bytes) -> Path:
    """Writes a file and its folder, and returns it."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    return file


def of_pages(folder: Path) -> Iterator[Job]:
    """Yields the jobs of the scenes and decks in pages, beside the meshes that they name."""
    for mesh in [*ROOT.glob("examples/*/*.msh"), ROOT / "tests/faults/stack.inp"]:
        written(folder / "docs" / mesh.name, mesh.read_bytes())
    for page in [ROOT / "README.md", *sorted(ROOT.glob("docs/*.md"))]:
        text = page.read_text()
        for block in BLOCK.finditer(text):
            line = text.count("\n", 0, block.start()) + 1
            name = f"{page.stem}-{block[1] or block[2] or f'{line}.json'}"
            content = block[4]
            if page.name == "scenes.md":
                scene = SMALL | (parsed(content) or {})
                content = json.dumps({key: value for key, value in scene.items() if value is not None})
            yield from of_file(written(folder / "docs" / name, content), f"docs/{name}")


def of_decks(folder: Path) -> Iterator[Job]:
    """Yields the jobs of the whole decks in tests."""
    for test in sorted((ROOT / "tests").rglob("*.rs")):
        for deck in DECK.findall(test.read_text()):
            name = f"decks/{test.stem}.inp"
            yield from of_file(written(folder / name, deck.split("*END STEP")[0] + RESULTS), name)


def refused(file: Path, target: str) -> Job:
    """Returns the job of a malformed file."""
    command = ("new", str(file), "--out", "new.json") if file.suffix == ".msh" else ("solve", str(file))
    return Job(target, "refusal", (command,))


def damaged(file: Path, content: str | bytes) -> Path:
    """Writes a damaged file. Returns it, or for a file of a matrix its problem directory with the other files."""
    if file.suffix != ".mtx":
        return written(file, content)
    for name in ("K.mtx", "f.mtx", "B.mtx", "g.mtx"):
        written(file.parent / name, (ROOT / "tests/faults" / name).read_bytes())
    return written(file, content).parent


def of_faults(folder: Path) -> Iterator[Job]:
    """Yields the changes of `tests/faults/cases.jsonl`."""
    for line, case in enumerate((ROOT / "tests/faults/cases.jsonl").read_text().splitlines(), 1):
        name, old, new, *_ = json.loads(case)
        text = (ROOT / "tests/faults" / name).read_text().replace(old, new, 1)
        yield refused(damaged(folder / f"faults/{line}/{name}", text), f"tests/faults/cases.jsonl:{line}")


def of_corpus(folder: Path) -> Iterator[Job]:
    """Yields the damaged files of `tests/corpus`; the name of one begins with that of the right file."""
    for file in sorted((ROOT / "tests/corpus").glob("*.*")):
        name = file.name.split("-")[0] + file.suffix
        place = folder / "corpus" / file.stem / name
        yield refused(damaged(place, file.read_bytes()), f"tests/corpus/{file.name}")


def of_wrong_scenes(folder: Path) -> Iterator[Job]:
    """Yields the changes of `tests/wrong_scenes.json`: a value at a place, or a key that is taken away."""
    wrong = json.loads((ROOT / "tests/wrong_scenes.json").read_text())
    for number, change in enumerate(wrong["changes"], 1):
        scene = copy.deepcopy(wrong["base"])
        *above, key = change["at"].split("/")[1:]
        place = scene
        for step in above:
            place = place[int(step) if isinstance(place, list) else step]
        key = int(key) if isinstance(place, list) else key
        if "value" in change:
            place[key] = change["value"]
        else:
            del place[key]
        file = written(folder / f"wrong/{number}.json", json.dumps(scene))
        yield refused(file, f"tests/wrong_scenes.json: {change['wrong']}")


def of_raw_problems(folder: Path) -> Iterator[Job]:
    """Yields the raw problems of the reference; none without numpy and scipy."""
    try:
        from cases import RAW_CASES
        from problem import write_problem
    except ImportError:
        return
    for case in RAW_CASES:
        write_problem(case.generate(), folder / "raw" / case.name)
        yield from of_problem(folder / "raw" / case.name, f"reference/cases.py, {case.name}")
