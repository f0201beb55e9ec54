"""Recomputes every condition of the solution from the original data.

The status that a solver reports is not used. Each number is relative; 0 divided by 0 counts as 0.
"""

from dataclasses import astuple, dataclass, fields

import numpy as np

from problem import Answer, Problem
from scaling import largest

NO_FORCE = 1e-9
"""Multipliers below this share of the load are rounding errors of a contact without force; their scale is then the load."""

KKT_TOLERANCE = 1e-9
"""Tolerance of an exact answer. It is the default tolerance of the program; linear solves reach 1e-13 to 1e-11 here."""


@dataclass(frozen=True)
class Kkt:
    """Relative violations of the optimality conditions, all >= 0."""

    stationarity: float
    """max|K u - f - B' lambda| / max(|f|, |B' lambda|)"""
    penetration: float
    """max(B u - g, 0) / length scale"""
    adhesion: float
    """max(lambda, 0) / multiplier scale; a positive multiplier pulls"""
    complementarity: float
    """max|lambda_i (B u - g)_i| / (multiplier scale times length scale)"""
    duality_gap: float
    """|u'K u - f'u - g'lambda| / largest of the three energies"""

    def worst(self) -> float:
        """Returns the largest of the five; infinite if one is not a number."""
        values = astuple(self)
        return max(values) if np.all(np.isfinite(values)) else np.inf

    def violated(self, tolerance: float = KKT_TOLERANCE) -> list[str]:
        """Returns the names of the conditions that do not hold to `tolerance`."""
        return [field.name for field in fields(self) if not getattr(self, field.name) <= tolerance]


class Rejected(Exception):
    """An answer that does not satisfy the optimality conditions."""


def kkt(problem: Problem, answer: Answer) -> Kkt:
    """Returns the relative violations of an answer."""
    u, multiplier = answer.displacement, answer.multiplier
    if u.shape != (problem.dofs,) or multiplier.shape != (problem.rows,):
        raise ValueError(
            f"u {u.shape} and lambda {multiplier.shape} do not fit {problem.dofs} dofs, {problem.rows} rows"
        )
    elastic, reaction = problem.stiffness @ u, problem.contact.T @ multiplier
    violation = -problem.slack(u)
    # A row without obstacle has an infinite gap. It counts only if it carries a multiplier.
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
    """Returns the largest displacement of a dof or along a contact row or, if nothing moves, the largest finite gap, in m."""
    displacement = answer.displacement
    moved = max(largest(displacement), largest(problem.contact @ displacement))
    return moved or largest(problem.gap[problem.bound])


def multiplier_scale(problem: Problem, answer: Answer) -> float:
    """Returns the largest multiplier or, if all multipliers are rounding errors, the largest load, in N."""
    multiplier, load = largest(answer.multiplier), largest(problem.load)
    return multiplier if multiplier > NO_FORCE * load else load


def reject(problem: Problem, answer: Answer, tolerance: float = KKT_TOLERANCE) -> Kkt:
    """Returns the violations of an answer that satisfies all conditions; otherwise raises `Rejected` with the names of the others."""
    numbers = kkt(problem, answer)
    names = numbers.violated(tolerance)
    if names:
        raise Rejected(", ".join(f"{name} {getattr(numbers, name):.1e}" for name in names) + f" above {tolerance:.0e}")
    return numbers


def ratio(value: float, scale: float) -> float:
    """Returns value / scale, with 0 / 0 = 0 and any other value / 0 = infinity."""
    if value == 0.0:
        return 0.0
    return float(value / scale) if scale > 0.0 else np.inf
