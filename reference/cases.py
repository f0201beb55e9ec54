"""The cases: problems made here and scenes from examples/, with their known results in closed form."""

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import elastic_block
import raw_problems
from problem import Answer, Problem, problem_of

CLOSED_FORM_TOLERANCE = 1e-9
"""Relative tolerance. The nodal values of these problems are exact, so that only rounding errors remain."""


@dataclass(frozen=True)
class Expected:
    """A number known in closed form, and the function that computes it from a solution."""

    quantity: str
    value: float
    measure: Callable[[Problem, Answer], float]


@dataclass(frozen=True)
class Case:
    """A problem from a generator, or a scene file, possibly with another gap; and the known results."""

    name: str
    generate: Callable[[], Problem] | None = None
    scene: str = ""
    gap: float | None = None
    expected: tuple[Expected, ...] = field(default=())
    twin: Callable[[], Problem] | None = None
    """The same problem assembled here. Its rows have the same order; its dofs may have another order."""


def force(value: float) -> Expected:
    """Expects this total contact force -sum(lambda), in N."""
    return Expected("total force", value, lambda problem, answer: answer.force)


def displacement(dof: int, value: float) -> Expected:
    """Expects this value of one entry of u, in m."""
    return Expected(f"u[{dof}]", value, lambda problem, answer: answer.displacement[dof])


def pressed_from(row: int) -> Expected:
    """Expects that this row is the first one with a force."""
    return Expected("first closed row", row, lambda problem, answer: np.flatnonzero(answer.multiplier < -1e-9)[0])


def without_obstacle_on_one_half() -> Problem:
    """Returns the string with infinite gaps on the right half of its rows."""
    string = raw_problems.string_over_obstacle()
    gap = string.gap.copy()
    gap[string.rows // 2 :] = np.inf
    return problem_of(string.stiffness, string.load, string.contact, gap)


RAW_CASES = (
    Case(
        "two springs", raw_problems.two_springs, expected=(force(6.25), displacement(0, 0.0125), displacement(1, 0.05))
    ),
    # The contact begins at b = 0.4, node 80 of 200, which carries half a reaction.
    Case("string", raw_problems.string_over_obstacle, expected=(force(0.2), pressed_from(79), displacement(99, -0.08))),
    Case("string, weak rows", raw_problems.string_with_weak_nodes, expected=(force(55 / 256), pressed_from(100))),
    Case("string, half obstacle", without_obstacle_on_one_half),
    Case(
        "string, out of reach",
        lambda: raw_problems.string_over_obstacle(gap=1.0),
        expected=(force(0.0), displacement(99, -0.125)),
    ),
    Case("membrane", raw_problems.membrane_over_obstacle),
    Case("membrane, 19600 dofs", lambda: raw_problems.membrane_over_obstacle(140)),
    Case("two-sided bounds", raw_problems.bounded_quadratic),
    Case(
        "floating rod", raw_problems.floating_rod, expected=(force(5.0), displacement(0, 0.015), displacement(20, 0.01))
    ),
    Case(
        "cycling, any start",
        raw_problems.cycling_from_any_start,
        expected=(displacement(1, 4 / 19), displacement(2, 11 / 19)),
    ),
    Case("cycling, all open", raw_problems.cycling_from_all_open, expected=(displacement(2, 0.6), force(2.4))),
    Case(
        "weakly active", raw_problems.weakly_active, expected=(displacement(0, 1.0), displacement(1, 6.0), force(0.0))
    ),
    Case("elastic block", lambda: elastic_block.indentation(-0.05)),
)

GAPS = tuple(round(-0.01 * step, 2) for step in range(1, 11))

SCENE_CASES = (
    *(
        Case(
            f"indentation {gap:.2f}",
            scene="indentation.json",
            gap=gap,
            twin=lambda gap=gap: elastic_block.indentation(gap),
        )
        for gap in GAPS
    ),
    Case("inclined plane", scene="inclined.json"),
    Case("between obstacles", scene="between.json"),
    Case("plane-stress block", scene="block.json"),
)


def scene_file(case: Case, examples: Path, folder: Path) -> Path:
    """Returns the scene file of a case: the file itself or, with another gap, a changed copy in `folder`."""
    source = examples / case.scene
    if case.gap is None:
        return source
    scene = json.loads(source.read_text())
    scene["gap"] = case.gap
    changed = folder / case.scene
    changed.write_text(json.dumps(scene))
    return changed
