"""Compares a problem with the same problem assembled here, for any order of the dofs."""

import numpy as np

from kkt import multiplier_scale
from problem import Answer, Problem
from scaling import largest
from settle import settle

TWIN_TOLERANCE = 1e-9
"""Relative tolerance. Two assemblies round differently, by about 1e-13 in u."""


def twin_faults(problem: Problem, answer: Answer, twin: Problem) -> list[str]:
    """Returns one sentence for each difference between a problem and its twin, whose rows have the same order."""
    if (problem.dofs, problem.rows) != (twin.dofs, twin.rows):
        return [f"{problem.dofs} dofs and {problem.rows} rows, assembled here {twin.dofs} and {twin.rows}"]
    own = settle(twin, answer.multiplier < 0.0).answer
    faults = []
    if largest(problem.gap - twin.gap) > TWIN_TOLERANCE * largest(twin.gap):
        faults.append(f"gaps differ by {largest(problem.gap - twin.gap):.1e}")
    multipliers = largest(answer.multiplier - own.multiplier) / multiplier_scale(twin, own)
    if not multipliers <= TWIN_TOLERANCE:
        faults.append(f"lambda differs by {multipliers:.1e} from the one assembled here")
    sorted_apart = np.sort(answer.displacement) - np.sort(own.displacement)
    if not largest(sorted_apart) <= TWIN_TOLERANCE * largest(own.displacement):
        faults.append(
            f"sorted u differs by {largest(sorted_apart) / largest(own.displacement):.1e} from the one assembled here"
        )
    return faults
