"""Distances between answers, and the tolerances they are held to."""

from dataclasses import dataclass

import numpy as np

from kkt import Kkt, kkt, length_scale, multiplier_scale, ratio
from problem import Answer, Problem
from scaling import largest
from settle import contact_set

DISPLACEMENT_TOLERANCE = 1e-8
"""max|du| / max|u| between two exact answers: two linear solves with a condition number up to 1e6 are a hundred times
nearer."""

MULTIPLIER_TOLERANCE = 1e-7
"""max|dlambda| / max|lambda| between two exact answers: reactions are differences of large elastic forces."""

RAW_DISPLACEMENT_TOLERANCE = 1e-6
"""The same for the unpolished answer of an iterative solver. A row that touches without force leaves an interior-point
method at the square root of its tolerance: 6e-7 was measured, and 1e-9 or better elsewhere."""

RAW_MULTIPLIER_TOLERANCE = 1e-3
"""Measured: 4e-4 at such rows, 3e-8 or better elsewhere."""

WEAK = 1e-9
"""A row is weakly active when its slack and its multiplier are both below this part of the largest. Whether it counts
as closed is a matter of rounding, so that contact sets may differ there."""

ENERGY_ALLOWANCE = 1e-12
"""What rounding adds to a distance in the energy norm before it is held against its bound."""


@dataclass(frozen=True)
class Distance:
    """How far an answer is from a reference answer of the same problem."""

    displacement: float
    """max|du| / max|u|"""
    multiplier: float
    """max|dlambda| / max|lambda|"""
    differing: np.ndarray
    """Indices of rows that one has closed and the other open, without the weakly active ones."""

    def failures(self, displacement: float, multiplier: float, same_contact: bool = True) -> list[str]:
        """What is beyond the given tolerances, in words."""
        found = []
        if not self.displacement <= displacement:
            found.append(f"u differs by {self.displacement:.1e} > {displacement:.0e}")
        if not self.multiplier <= multiplier:
            found.append(f"lambda differs by {self.multiplier:.1e} > {multiplier:.0e}")
        if same_contact and self.differing.size:
            found.append(f"contact differs in {self.differing.size} rows, the first {self.differing[0]}")
        return found


def distance(problem: Problem, answer: Answer, reference: Answer) -> Distance:
    """The distance of `answer` from `reference`, relative to the largest values of `reference`."""
    closed, expected = contact_set(problem, answer), contact_set(problem, reference)
    return Distance(
        ratio(largest(answer.displacement - reference.displacement), largest(reference.displacement)),
        ratio(largest(answer.multiplier - reference.multiplier), multiplier_scale(problem, reference)),
        np.flatnonzero((closed != expected) & ~weak_rows(problem, reference)),
    )


def farthest(problem: Problem, answer: Answer, references: list[Answer]) -> Distance:
    """The largest of the distances from several references, number by number."""
    distances = [distance(problem, answer, reference) for reference in references]
    return Distance(
        max(d.displacement for d in distances),
        max(d.multiplier for d in distances),
        np.unique(np.concatenate([d.differing for d in distances])),
    )


def weak_rows(problem: Problem, answer: Answer) -> np.ndarray:
    """The rows that touch without a force; boolean, length rows."""
    touching = np.abs(problem.slack(answer.displacement)) < WEAK * length_scale(problem, answer)
    return touching & (np.abs(answer.multiplier) < WEAK * multiplier_scale(problem, answer))


def energy_distance(problem: Problem, answer: Answer, reference: Answer) -> float:
    """norm_K(u - u_reference) / norm_K(u), the quantity that an energy error bound is about."""
    apart = answer.displacement - reference.displacement
    u = answer.displacement
    return ratio(np.sqrt(max(apart @ (problem.stiffness @ apart), 0.0)), np.sqrt(max(u @ (problem.stiffness @ u), 0.0)))


@dataclass(frozen=True)
class Verdict:
    """One answer of one case, all that the table shows of it, and what is wrong with it."""

    case: str
    solver: str
    closed: int
    weak: int
    force: float
    distance: Distance | None
    numbers: Kkt | None
    failures: list[str]
    note: str = ""

    @property
    def passed(self) -> bool:
        return not self.failures


def judge(case, solver, problem, answer, references, tolerances, exact=True, failures=(), note="") -> Verdict:
    """The verdict on an answer: `tolerances` for u and lambda, and, where it is to be `exact`, contact set and KKT.

    `failures` are faults found elsewhere, as a report that contradicts the files.
    """
    apart, numbers = farthest(problem, answer, references), kkt(problem, answer)
    wrong = list(failures) + apart.failures(*tolerances, same_contact=exact)
    if exact:
        wrong += [f"{name} {getattr(numbers, name):.1e}" for name in numbers.violated()]
    weak = weak_rows(problem, answer)
    closed = contact_set(problem, answer) & ~weak
    return Verdict(case, solver, int(closed.sum()), int(weak.sum()), answer.force, apart, numbers, wrong, note)


EXACT = (DISPLACEMENT_TOLERANCE, MULTIPLIER_TOLERANCE)
RAW = (RAW_DISPLACEMENT_TOLERANCE, RAW_MULTIPLIER_TOLERANCE)


def broken(case: str, solver: str, reason: str) -> Verdict:
    """The verdict where there is no answer to judge."""
    return Verdict(case, solver, 0, 0, np.nan, None, None, [reason])
