"""Studies: trade-offs between time and accuracy, and series of gaps."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from signorini import _signorini
from signorini._signorini import Problem, Scene, SceneSolution, Solution


@dataclass(frozen=True, repr=False)
class Tradeoff:
    """A problem or a scene solved by every method at every accuracy."""

    meshes: list[dict[str, Any]]
    """The meshes: divisions, dofs, contact rows, the estimated error of the mesh."""
    points: list[dict[str, Any]]
    """The points: method, its setting, seconds, errors and bounds; `best` marks the Pareto front of its mesh."""
    advice: list[dict[str, Any]]
    """What to choose: for an accuracy or for a time the index of a point."""

    def __repr__(self) -> str:
        return f"<signorini.Tradeoff: {len(self.points)} points on {len(self.meshes)} meshes>"

    def plot(self, ax: Any = None) -> Any:
        """Draws error over time, a line for each method; returns the axes. Needs matplotlib."""
        from signorini._show import tradeoff_plot

        return tradeoff_plot(self, ax)


@dataclass(frozen=True, repr=False)
class Sweep:
    """A series of gaps."""

    gaps: list[Any]
    """The gaps: numbers for a scene, arrays for a problem."""
    solutions: list[Any]
    """The answers, one for each gap."""
    events: list[dict[str, Any]]
    """Rows that touch or release between the first and the last gap of a scene, exactly."""
    corners: list[dict[str, Any]]
    """The corners of force, width and pressure over the gap of a scene, exactly."""

    @property
    def contact_force(self) -> NDArray[np.float64]:
        """Total contact force at each gap."""
        return np.array([solution.contact_force for solution in self.solutions])

    def __repr__(self) -> str:
        return f"<signorini.Sweep: {len(self.gaps)} gaps, {len(self.events)} events>"

    def plot(self, ax: Any = None) -> Any:
        """Draws the contact force over the gaps; returns the axes. Needs matplotlib."""
        from signorini._show import sweep_plot

        return sweep_plot(self, ax)


def tradeoff(
    problem: Problem | Scene,
    *,
    refinements: int = 1,
    runs: int = 5,
    most_full_dofs: int = 10_000,
    time: float | None = None,
) -> Tradeoff:
    """Solves a problem or a scene by every method at every accuracy.

    `refinements` is the number of meshes beside that of a scene, each with half the cell size of the one before. Each point is run
    `runs` times at least. Points of more than `most_full_dofs` dofs are solved on the contact boundary only. No finer mesh is begun
    that would end later than `time` seconds after the start.
    """
    for name, value in (("refinements", refinements), ("runs", runs), ("most_full_dofs", most_full_dofs)):
        if not isinstance(value, (int, np.integer)) or value < 0:
            from signorini._errors import BadInput

            raise BadInput(f"{name} is {value!r}; it must be a whole number that is not negative")
    measured = _signorini._measured(problem, refinements, max(runs, 1), most_full_dofs, time)
    return Tradeoff(measured["meshes"], measured["points"], measured["advice"])


@overload
def sweep(problem: Scene, gaps: ArrayLike, *, method: str | None = None, threads: int | None = None) -> Sweep: ...
@overload
def sweep(
    problem: Problem, gaps: Iterable[ArrayLike], *, method: str | None = None, threads: int | None = None
) -> Sweep: ...


def sweep(problem: Problem | Scene, gaps: Any, *, method: str | None = None, threads: int | None = None) -> Sweep:
    """Solves a scene at several scene-wide gaps (numbers), or a problem at several gaps (an array for each).

    The stiffness is factorised once, and every solve starts from the last contact set. An answer that is not certified is an answer
    here; its certificate says so.
    """
    if isinstance(problem, Scene):
        found = _signorini._swept(problem, gaps, method, threads)
        return Sweep(found["gaps"], found["solutions"], found["events"], found["corners"])
    if not isinstance(problem, Problem):
        from signorini._errors import BadType

        raise BadType(f"the argument is of the type {type(problem).__name__}; it must be a Problem or a Scene")
    from signorini._errors import NotCertified

    all_gaps = [np.asarray(gap) for gap in gaps]
    prepared = _signorini.prepare(problem, gaps=max(len(all_gaps), 1), method=method, threads=threads, proof=False)
    solutions: list[Solution | SceneSolution] = []
    for gap in all_gaps:
        try:
            solutions.append(prepared.solve(gap, start=solutions[-1] if solutions else None))
        except NotCertified as fell_short:
            solutions.append(fell_short.solution)
    return Sweep(all_gaps, solutions, [], [])
