"""Every condition of the solution, recomputed from the original data.

A status that a solver reports is never believed. Each number is relative, and 0 for nothing over nothing.
"""

from dataclasses import astuple, dataclass, fields

import numpy as np

from problem import Answer, Problem
from scaling import largest

NO_FORCE = 1e-9
"""Multipliers below this part of the load are rounding, and are measured by the load: the obstacle is only touched."""

KKT_TOLERANCE = 1e-9
"""What an answer that claims to be exact must satisfy: the tolerance to which the program certifies by default.
Linear solves leave 1e-13 to 1e-11 here."""


@dataclass(frozen=True)
class Kkt:
    """Relative violations of the optimality conditions, all >= 0."""

    stationarity: float
    """max|K u - f - B' lambda| / max(|f|, |B' lambda|)"""
    penetration: float
    """max(B u - g, 0) / length scale"""
    adhesion: float
    """max(lambda, 0) / multiplier scale: a multiplier that pulls"""
    complementarity: float
    """max|lambda_i (B u - g)_i| / (multiplier scale times length scale)"""
    duality_gap: float
    """|u'K u - f'u - g'lambda| / largest of the three energies"""

    def worst(self) -> float:
        """The largest of the five; infinite if one is not a number."""
        values = astuple(self)
        return max(values) if np.all(np.isfinite(values)) else np.inf

    def violated(self, tolerance: float = KKT_TOLERANCE) -> list[str]:
        """Names of the conditions that do not hold to `tolerance`."""
        return [field.name for field in fields(self) if not getattr(self, field.name) <= tolerance]


class Rejected(Exception):
    """An answer that does not satisfy the optimality conditions."""


def kkt(problem: Problem, answer: Answer) -> Kkt:
    """The relative violations of an answer."""
    u, multiplier = answer.displacement, answer.multiplier
    if u.shape != (problem.dofs,) or multiplier.shape != (problem.rows,):
        raise ValueError(
            f"u {u.shape} and lambda {multiplier.shape} do not fit {problem.dofs} dofs, {problem.rows} rows"
        )
    elastic, reaction = problem.stiffness @ u, problem.contact.T @ multiplier
    violation = -problem.slack(u)
    # A row without obstacle has an infinite gap: it enters only if it carries a multiplier.
    carrying = np.flatnonzero(multiplier)
    products = multiplier[carrying] * violation[carrying]
    work = u @ elastic, problem.load @ u, multiplier[carrying] @ problem.gap[carrying]

    force = max(largest(problem.load), largest(reaction))
    length, contact_force = length_scale(problem, answer), multiplier_scale(problem, answer)
    return Kkt(
        stationarity=ratio(largest(elastic - problem.load - reaction), force),
        penetration=ratio(np.max(violation, initial=0.0), length),
        adhesion=ratio(np.max(multiplier, initial=0.0), contact_force),
        complementarity=ratio(largest(products), contact_force * length),
        duality_gap=ratio(abs(work[0] - work[1] - work[2]), max(work[0] / 2.0, abs(work[1]), abs(work[2]))),
    )


def length_scale(problem: Problem, answer: Answer) -> float:
    """The largest displacement, of a dof or along a contact row, or, where none moves, the largest finite gap; in m."""
    displacement = answer.displacement
    moved = max(largest(displacement), largest(problem.contact @ displacement))
    return moved or largest(problem.gap[problem.bound])


def multiplier_scale(problem: Problem, answer: Answer) -> float:
    """The largest multiplier or, where there is none to speak of, the largest load; in N."""
    multiplier, load = largest(answer.multiplier), largest(problem.load)
    return multiplier if multiplier > NO_FORCE * load else load


def reject(problem: Problem, answer: Answer, tolerance: float = KKT_TOLERANCE) -> Kkt:
    """The violations of an answer that satisfies all conditions; raises `Rejected` naming those that fail."""
    numbers = kkt(problem, answer)
    names = numbers.violated(tolerance)
    if names:
        raise Rejected(", ".join(f"{name} {getattr(numbers, name):.1e}" for name in names) + f" above {tolerance:.0e}")
    return numbers


def ratio(value: float, scale: float) -> float:
    """value / scale, where nothing over nothing is nothing and something over nothing is infinite."""
    if value == 0.0:
        return 0.0
    return float(value / scale) if scale > 0.0 else np.inf
