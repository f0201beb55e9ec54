"""Distances between answers, and their tolerances."""

from dataclasses import dataclass

import numpy as np

from kkt import Kkt, kkt, length_scale, multiplier_scale, ratio
from problem import Answer, Problem
from scaling import largest
from settle import contact_set

DISPLACEMENT_TOLERANCE = 1e-8
"""Tolerance of max|du| / max|u| between two exact answers. Two linear solves with a condition number up to 1e6 differ by a
hundredth of this."""

MULTIPLIER_TOLERANCE = 1e-7
"""Tolerance of max|dlambda| / max|lambda| between two exact answers. Reactions are differences of large elastic forces."""

RAW_DISPLACEMENT_TOLERANCE = 1e-6
"""Tolerance of u for the unpolished answer of an iterative solver. At a row that touches without force, the error of an
interior-point method is the square root of its tolerance: 6e-7 was measured there, and 1e-9 or better elsewhere."""

RAW_MULTIPLIER_TOLERANCE = 1e-3
"""Tolerance of lambda for the same answer. Measured: 4e-4 at such rows, 3e-8 or better elsewhere."""

WEAK = 1e-9
"""A row is weakly active if its slack and its multiplier are both below this share of the largest. Rounding decides whether it
counts as closed, so that contact sets may differ there."""

ENERGY_ALLOWANCE = 1e-12
"""Allowance for rounding when a distance in the energy norm is compared with its bound."""


@dataclass(frozen=True)
class Distance:
    """The distance of an answer from a reference answer of the same problem."""

    displacement: float
    """max|du| / max|u|"""
    multiplier: float
    """max|dlambda| / max|lambda|"""
    differing: np.ndarray
    """Indices of the rows that are closed in one answer and open in the other, without the weakly active ones."""

    def failures(self, displacement: float, multiplier: float, same_contact: bool = True) -> list[str]:
        """Returns one sentence for each difference that exceeds its tolerance."""
        found = []
        if not self.displacement <= displacement:
            found.append(f"u differs by {self.displacement:.1e} > {displacement:.0e}")
        if not self.multiplier <= multiplier:
            found.append(f"lambda differs by {self.multiplier:.1e} > {multiplier:.0e}")
        if same_contact and self.differing.size:
            found.append(f"contact differs in {self.differing.size} rows, the first {self.differing[0]}")
        return found


def distance(problem: Problem, answer: Answer, reference: Answer) -> Distance:
    """Returns the distance of `answer` from `reference`, relative to the largest values of `reference`."""
    closed, expected = contact_set(problem, answer), contact_set(problem, reference)
    return Distance(
        ratio(largest(answer.displacement - reference.displacement), largest(reference.displacement)),
        ratio(largest(answer.multiplier - reference.multiplier), multiplier_scale(problem, reference)),
        np.flatnonzero((closed != expected) & ~weak_rows(problem, reference)),
    )


def farthest(problem: Problem, answer: Answer, references: list[Answer]) -> Distance:
    """Returns, for each number, the largest of the distances from several references."""
    distances = [distance(problem, answer, reference) for reference in references]
    return Distance(
        max(d.displacement for d in distances),
        max(d.multiplier for d in distances),
        np.unique(np.concatenate([d.differing for d in distances])),
    )


def weak_rows(problem: Problem, answer: Answer) -> np.ndarray:
    """Returns the rows that touch without force, as a boolean array of length rows."""
    touching = np.abs(problem.slack(answer.displacement)) < WEAK * length_scale(problem, answer)
    return touching & (np.abs(answer.multiplier) < WEAK * multiplier_scale(problem, answer))


def energy_distance(problem: Problem, answer: Answer, reference: Answer) -> float:
    """Returns norm_K(u - u_reference) / norm_K(u), which the energy error bound must not be below."""
    apart = answer.displacement - reference.displacement
    u = answer.displacement
    return ratio(np.sqrt(max(apart @ (problem.stiffness @ apart), 0.0)), np.sqrt(max(u @ (problem.stiffness @ u), 0.0)))


@dataclass(frozen=True)
class Verdict:
    """One answer of one case, with all numbers of its line in the table and its faults."""

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
    """Compares an answer with the `tolerances` of u and lambda; if it must be `exact`, checks contact set and KKT as well.

    `failures` are faults that were found elsewhere, for example a report that contradicts the files.
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
    """Returns the verdict for a case without an answer."""
    return Verdict(case, solver, 0, 0, np.nan, None, None, [reason])
