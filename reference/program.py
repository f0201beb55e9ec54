"""The tested results: the answers of the package, its statements about them, and the files of the program."""

import math
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import signorini as sg

from compare import ENERGY_ALLOWANCE, WEAK, energy_distance, weak_rows
from problem import Answer, Problem, problem_of
from scaling import largest
from settle import contact_set

METHODS = ("qp", "active-set", "penalty")

SECONDS = 3600
"""Time limit of a run. No run takes this long, even on a slow and busy machine."""

FORCE_TOLERANCE = 1e-9
"""Relative tolerance between the reported total force and the sum of the multipliers."""


CONDENSATION_TOLERANCE = 1e-11
"""Relative tolerance between answers on the contact dofs and on all dofs: rounding times the condition of the stiffness."""


class ProgramFailed(Exception):
    """A run of the program that ended in an error."""


@dataclass(frozen=True)
class Run:
    """One solve: its answer, the solution that the package reports, and `True` if it is certified."""

    answer: Answer
    reported: sg.Solution
    certified: bool


def problem_of_scene(file: Path) -> Problem:
    """Returns K, f, B and g of a scene, assembled by the package."""
    problem = sg.Scene(file).problem
    return problem_of(problem.K, problem.f, problem.B, problem.g)


def solve(problem: Problem, method: str, condense: bool = True) -> Run:
    """Solves a problem by a method of the package, and returns the answer, certified or not."""
    given = sg.Problem(problem.stiffness, problem.load, problem.contact, problem.gap)
    try:
        reported, certified = sg.solve(given, method=method, condense=condense, proof=False), True
    except sg.NotCertified as fell_short:
        reported, certified = fell_short.solution, False
    return Run(Answer(reported.u, reported.multiplier), reported, certified)


def write_files(program: Path, scene: Path, out: Path) -> None:
    """Runs `signorini solve SCENE --method qp --out OUT`. An exit code other than 0 is an error with the first line of its output."""
    command = [str(program), "solve", str(scene), "--method", "qp", "--out", str(out)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS)
    except subprocess.TimeoutExpired as error:
        raise ProgramFailed(f"no answer within {SECONDS} s") from error
    if done.returncode != 0:
        words = (done.stderr.strip() or done.stdout.strip() or "nothing written").splitlines()[0]
        raise ProgramFailed(f"exit code {done.returncode}: {words}")


def report_faults(problem: Problem, method: str, result: Run) -> list[str]:
    """Returns one sentence for each statement of the package that contradicts its answer."""
    reported, answer, faults = result.reported, result.answer, []
    if method != "penalty" and not result.certified:
        faults.append("not certified")
    if not reported.method.startswith(method):
        faults.append(f"method {reported.method}")
    weak = weak_rows(problem, answer)
    closed = int((contact_set(problem, answer) & ~weak).sum())
    if method != "penalty" and not closed <= len(reported.contact_set) <= closed + weak.sum():
        faults.append(f"reports {len(reported.contact_set)} closed rows, the answer has {closed}")
    scale = largest(answer.multiplier) * np.sqrt(problem.rows) + WEAK * largest(problem.load)
    if not abs(reported.contact_force - answer.force) <= FORCE_TOLERANCE * scale:
        faults.append(f"reports a force of {reported.contact_force}, the answer has {answer.force:.10g}")
    return faults


def condensation_faults(problem: Problem, condensed: Run, full: Run) -> list[str]:
    """Returns one sentence for each difference between the answers on the contact dofs and on all dofs.

    The forces B' lambda are compared, because dependent rows may share their multipliers in any way.
    """
    faults = []
    forces = [problem.contact.T @ run.answer.multiplier for run in (condensed, full)]
    pairs = {"u": (condensed.answer.displacement, full.answer.displacement), "B' lambda": tuple(forces)}
    for name, (one, other) in pairs.items():
        scale = largest(other) if name == "u" else max(largest(other), largest(problem.load))
        difference = largest(one - other)
        if difference > CONDENSATION_TOLERANCE * scale:
            faults.append(f"{name} differs by {difference / scale:.1e} from that on all dofs")
    if math.isfinite(full.reported.energy_error_bound) and condensed.reported.method == full.reported.method == "active-set":
        sets = [[len(closed) for closed, _ in run.reported.history] for run in (condensed, full)]
        if sets[0] != sets[1]:
            faults.append(f"closed rows on the way {sets[0]}, on all dofs {sets[1]}")
    return faults


def bound_faults(problem: Problem, result: Run, references: list[Answer]) -> list[str]:
    """Returns a sentence if the distance of an answer from a reference, in the energy norm, exceeds its certified bound."""
    bound = result.reported.energy_error_bound
    farthest = max(energy_distance(problem, result.answer, reference) for reference in references)
    if farthest <= bound + ENERGY_ALLOWANCE:
        return []
    return [f"energy-norm distance {farthest:.1e} above its stated bound {bound:.1e}"]
