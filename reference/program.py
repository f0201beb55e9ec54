"""What is under test: the answers of the package, with what it says of them, and the files of the program."""

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
"""A run that hangs ends after this; none takes as long on a slow machine that is busy, too."""

FORCE_TOLERANCE = 1e-9
"""Between the total force that is told and the sum of the multipliers, relative."""


CONDENSATION_TOLERANCE = 1e-11
"""Between answers on the contact dofs and on all dofs, relative: rounding times the condition of the stiffness."""


class ProgramFailed(Exception):
    """A run of the program that ended in an error."""


@dataclass(frozen=True)
class Run:
    """One solve: its answer, what the package says of it, and whether it is certified."""

    answer: Answer
    told: sg.Solution
    certified: bool


def problem_of_scene(file: Path) -> Problem:
    """K, f, B and g of a scene, as the package makes them."""
    problem = sg.Scene(file).problem
    return problem_of(problem.K, problem.f, problem.B, problem.g)


def solve(problem: Problem, method: str, condense: bool = True) -> Run:
    """The answer of the package by a method, certified or not."""
    given = sg.Problem(problem.stiffness, problem.load, problem.contact, problem.gap)
    try:
        told, certified = sg.solve(given, method=method, condense=condense, proof=False), True
    except sg.NotCertified as fell_short:
        told, certified = fell_short.solution, False
    return Run(Answer(told.u, told.multiplier), told, certified)


def write_files(program: Path, scene: Path, out: Path) -> None:
    """`signorini solve SCENE --method qp --out OUT`; any exit code but 0 is an error with the first line it wrote."""
    command = [str(program), "solve", str(scene), "--method", "qp", "--out", str(out)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=SECONDS)
    except subprocess.TimeoutExpired as error:
        raise ProgramFailed(f"no answer within {SECONDS} s") from error
    if done.returncode != 0:
        words = (done.stderr.strip() or done.stdout.strip() or "nothing written").splitlines()[0]
        raise ProgramFailed(f"exit code {done.returncode}: {words}")


def told_faults(problem: Problem, method: str, result: Run) -> list[str]:
    """Where what is told of an answer contradicts it, in words."""
    told, answer, faults = result.told, result.answer, []
    if method != "penalty" and not result.certified:
        faults.append("not certified")
    if not told.method.startswith(method):
        faults.append(f"method {told.method}")
    weak = weak_rows(problem, answer)
    closed = int((contact_set(problem, answer) & ~weak).sum())
    if method != "penalty" and not closed <= len(told.contact_set) <= closed + weak.sum():
        faults.append(f"tells {len(told.contact_set)} closed rows, the answer has {closed}")
    scale = largest(answer.multiplier) * np.sqrt(problem.rows) + WEAK * largest(problem.load)
    if not abs(told.contact_force - answer.force) <= FORCE_TOLERANCE * scale:
        faults.append(f"tells a force of {told.contact_force}, the answer has {answer.force:.10g}")
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
    if math.isfinite(full.told.energy_error_bound) and condensed.told.method == full.told.method == "active-set":
        sets = [[len(closed) for closed, _ in run.told.history] for run in (condensed, full)]
        if sets[0] != sets[1]:
            faults.append(f"closed rows on the way {sets[0]}, on all dofs {sets[1]}")
    return faults


def bound_faults(problem: Problem, result: Run, references: list[Answer]) -> list[str]:
    """Where an answer is farther from a reference, in the energy norm, than its certificate says."""
    bound = result.told.energy_error_bound
    farthest = max(energy_distance(problem, result.answer, reference) for reference in references)
    if farthest <= bound + ENERGY_ALLOWANCE:
        return []
    return [f"energy-norm distance {farthest:.1e} above its stated bound {bound:.1e}"]
