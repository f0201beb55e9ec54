"""Scales problems to dimensionless data, because the tolerances of QP solvers are absolute for values below 1.

u = u0 v,  K = k0 P,  f = f0 c,  lambda = f0 mu,  f0 = k0 u0. All three are powers of two, so that scaling is exact.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import splu

from problem import Answer, Problem, problem_of


@dataclass(frozen=True)
class Scales:
    """Reference displacement (m), stiffness (N/m) and force (N)."""

    displacement: float
    stiffness: float

    @property
    def force(self) -> float:
        return self.displacement * self.stiffness


def scales_of(problem: Problem) -> Scales:
    """Returns the scales. k0 is the largest diagonal entry of K; u0 is the largest finite gap or, if all gaps are zero, the largest free
    displacement."""
    stiffness = power_of_two(largest(problem.stiffness.diagonal()))
    displacement = largest(problem.gap[problem.bound])
    if displacement == 0.0:
        displacement = largest(free_displacement(problem))
    return Scales(power_of_two(displacement), stiffness)


def scaled(problem: Problem, scales: Scales) -> Problem:
    """Returns the same problem with dimensionless data."""
    return problem_of(
        problem.stiffness / scales.stiffness,
        problem.load / scales.force,
        problem.contact,
        problem.gap / scales.displacement,
    )


def unscaled(answer: Answer, scales: Scales) -> Answer:
    """Converts a dimensionless answer into the units of the problem."""
    return Answer(answer.displacement * scales.displacement, answer.multiplier * scales.force)


def free_displacement(problem: Problem) -> np.ndarray:
    """Returns K^-1 f, or f divided by the largest stiffness if K is singular to working precision."""
    rough = problem.load / largest(problem.stiffness.diagonal())
    try:
        free = splu(problem.stiffness).solve(problem.load)
    except RuntimeError:
        return rough
    residual = problem.stiffness @ free - problem.load
    return free if largest(residual) <= 1e-6 * largest(problem.load) else rough


def largest(values: np.ndarray) -> float:
    """Returns the largest magnitude; 0 for an empty array."""
    return float(np.max(np.abs(values), initial=0.0))


def power_of_two(value: float) -> float:
    """Returns the power of two nearest to a positive value; 1 for zero."""
    return 2.0 ** np.round(np.log2(value)) if value > 0.0 else 1.0
