"""The program under test: run as a user runs it, its report and files read back."""

import json
import math
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from compare import ENERGY_ALLOWANCE, WEAK, energy_distance, weak_rows
from problem import Answer, Problem, read_answer
from scaling import largest
from settle import contact_set

METHODS = ("qp", "active-set", "penalty")
CERTIFIED, NOT_CERTIFIED = 0, 4
EXIT_STATUS = {CERTIFIED: "certified", NOT_CERTIFIED: "not_certified"}

SECONDS = 3600
"""A run that hangs ends after this; none takes as long on a slow machine that is busy, too."""

REPORT_TOLERANCE = 1e-9
"""Between the total force in a report and the one from its files, relative."""


CONDENSATION_TOLERANCE = 1e-11
"""Between answers on the contact dofs and on all dofs, relative: rounding times the condition of the stiffness."""


class ProgramFailed(Exception):
    """A run that ended in an error, printed no report or left out a file."""


@dataclass(frozen=True)
class Run:
    """One `solve`: the report it printed, the answer it wrote, exit code and wall-clock seconds."""

    answer: Answer
    report: dict
    exit_code: int
    seconds: float

    @property
    def energy_error_bound(self) -> float:
        """The reported bound on norm_K(u - u*) / norm_K(u); infinite where there is none."""
        bound = self.report.get("certificate", {}).get("energy_error_bound")
        return float(bound) if bound is not None else math.inf


def export(program: Path, scene: Path, directory: Path) -> None:
    """`signorini export SCENE DIRECTORY`."""
    run(program, "export", str(scene), str(directory))


def solve(program: Path, target: Path, method: str, out: Path, *options: str) -> Run:
    """`signorini solve TARGET --method METHOD --format json --out OUT OPTIONS`; exit codes 0 and 4 give an answer."""
    began = time.perf_counter()
    done = run(program, "solve", str(target), "--method", method, "--format", "json", "--out", str(out), *options)
    seconds = time.perf_counter() - began
    try:
        report = json.loads(done.stdout)
    except json.JSONDecodeError as error:
        raise ProgramFailed(f"the report is no JSON: {error}") from error
    try:
        answer = read_answer(out)
    except (OSError, ValueError) as error:
        raise ProgramFailed(f"u.mtx or lambda.mtx: {error}") from error
    return Run(answer, report, done.returncode, seconds)


def run(program: Path, *arguments: str) -> subprocess.CompletedProcess:
    """Runs the program; an exit code other than 0 or 4 is an error with the first line it wrote."""
    try:
        done = subprocess.run([str(program), *arguments], capture_output=True, text=True, timeout=SECONDS)
    except subprocess.TimeoutExpired as error:
        raise ProgramFailed(f"no answer within {SECONDS} s") from error
    if done.returncode not in EXIT_STATUS:
        words = (done.stderr.strip() or done.stdout.strip() or "nothing written").splitlines()[0]
        raise ProgramFailed(f"exit code {done.returncode}: {words}")
    return done


def report_faults(problem: Problem, method: str, result: Run) -> list[str]:
    """Where the report of a run contradicts its exit code or its files, in words."""
    report, answer, faults = result.report, result.answer, []
    if report.get("status") != EXIT_STATUS[result.exit_code]:
        faults.append(f"status {report.get('status')} with exit code {result.exit_code}")
    if method != "penalty" and result.exit_code != CERTIFIED:
        faults.append("not certified")
    if not str(report.get("method", "")).startswith(method):
        faults.append(f"method {report.get('method')}")
    contact = report.get("contact", {})
    weak = weak_rows(problem, answer)
    closed = int((contact_set(problem, answer) & ~weak).sum())
    if method != "penalty" and not closed <= contact.get("count", -1) <= closed + weak.sum():
        faults.append(f"reports {contact.get('count')} closed rows, its files have {closed}")
    scale = largest(answer.multiplier) * np.sqrt(problem.rows) + WEAK * largest(problem.load)
    if not abs(contact.get("force", math.nan) - answer.force) <= REPORT_TOLERANCE * scale:
        faults.append(f"reports a force of {contact.get('force')}, its files have {answer.force:.10g}")
    return faults


def condensation_faults(problem: Problem, condensed: Run, full: Run) -> list[str]:
    """Where an answer on the contact dofs differs from the one on all dofs; forces, for rows may share theirs anyhow."""
    faults = []
    forces = [problem.contact.T @ run.answer.multiplier for run in (condensed, full)]
    pairs = {"u": (condensed.answer.displacement, full.answer.displacement), "B' lambda": tuple(forces)}
    for name, (one, other) in pairs.items():
        scale = largest(other) if name == "u" else max(largest(other), largest(problem.load))
        difference = largest(one - other)
        if difference > CONDENSATION_TOLERANCE * scale:
            faults.append(f"{name} differs by {difference / scale:.1e} from that on all dofs")
    if math.isfinite(full.energy_error_bound) and condensed.report["method"] == full.report["method"] == "active-set":
        sets = [[step["closed"] for step in run.report["history"]] for run in (condensed, full)]
        if sets[0] != sets[1]:
            faults.append(f"closed rows on the way {sets[0]}, on all dofs {sets[1]}")
    return faults


def bound_faults(problem: Problem, result: Run, references: list[Answer]) -> list[str]:
    """Where an answer is farther from a reference, in the energy norm, than its certificate says."""
    bound = result.energy_error_bound
    farthest = max(energy_distance(problem, result.answer, reference) for reference in references)
    if farthest <= bound + ENERGY_ALLOWANCE:
        return []
    return [f"energy-norm distance {farthest:.1e} above its stated bound {bound:.1e}"]
