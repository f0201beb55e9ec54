"""Studies: the trade-off between time and accuracy, and sweeps over gaps, forces or loads."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from signorini import _signorini
from signorini._errors import BadInput, BadType, NotCertified
from signorini._signorini import Prepared, Problem, Scene, SceneSolution, Solution

# An error of zero is drawn at this value, because the axis is logarithmic.
_LEAST_ERROR = 1e-16


@dataclass(frozen=True, repr=False)
class Tradeoff:
    """A problem or a scene solved by every method at every accuracy. `signorini.tradeoff` makes it.

    All errors are relative to the exact solution of the mesh, except "total_error".

    Attributes
    ----------
    meshes : list of dict
        One per mesh: "divided_by" (parts of each edge of the mesh of the scene), "dofs", "contact_rows", and
        "discretisation_error", estimated, for a scene.
    points : list of dict
        One per solve. "mesh" is its index in `meshes`; "method" and "knob" say how it was solved; "condensed" is a
        bool; "seconds", "certificate_seconds" and "proof_seconds" are times. "energy_error", "total_error" (against
        the continuum), "force_error" and "pressure_error" are relative. "rows_wrong" is the number of wrong rows,
        "energy_error_bound" the bound of the certificate. "best" is True if no other point of its mesh is both faster
        and more accurate.
    advice : list of dict
        For each goal ("accuracy", "total_error" or "seconds") in "point" the index of the best point, or None.
    """

    meshes: list[dict[str, Any]]
    points: list[dict[str, Any]]
    advice: list[dict[str, Any]]

    def __repr__(self) -> str:
        return f"<signorini.Tradeoff: {len(self.points)} points on {len(self.meshes)} meshes>"

    def plot(self, ax: Any = None) -> Any:
        """Draws error over time with one line per method. Needs matplotlib: `pip install "signorini[plot]"`.

        Parameters
        ----------
        ax : Axes of matplotlib, optional
            Where to draw. A new figure by default.

        Returns
        -------
        Axes of matplotlib
            `ax`, or the new axes.

        Raises
        ------
        ImportError
            matplotlib is not installed.
        """
        from signorini._show import axes

        ax = axes(ax)
        has_total = any(point.get("total_error") is not None for point in self.points)
        name = "total_error" if has_total else "energy_error"
        lines: dict[tuple[str, bool, int], list[tuple[float, float]]] = {}
        for point in self.points:
            error = point.get(name)
            if error is not None:
                key = (point["method"], point["condensed"], point["mesh"])
                lines.setdefault(key, []).append((point["seconds"], max(error, _LEAST_ERROR)))
        colours = {method: f"C{i % 10}" for i, method in enumerate(sorted({key[0] for key in lines}))}
        seen: set[str] = set()
        for (method, condensed, _), points in sorted(lines.items()):
            label = None if method in seen else method
            seen.add(method)
            style = "-" if condensed else ":"
            ax.plot(*zip(*points, strict=True), style, marker="o", markersize=3, color=colours[method], label=label)
        ax.set_xscale("log")
        ax.set_yscale("log")
        ax.set_xlabel("seconds")
        ax.set_ylabel("total error, relative in energy" if has_total else "error of the algebra, relative in energy")
        ax.legend(frameon=False, title="solid: condensed, dotted: all dofs", fontsize="small")
        return ax


@dataclass(frozen=True, repr=False)
class Sweep:
    """The solutions of a sweep: for several gaps or forces, or along a straight line to other gaps and another load.

    `signorini.sweep` makes it.

    Attributes
    ----------
    gaps : list
        The gaps, in length: one number per point for a scene, one array of shape (m,) per point for a problem.
    solutions : list of Solution or SceneSolution
        The solutions, one per gap, force or point of the line. They may miss the tolerance.
    events : list of dict
        The exact points between the first and the last gap at which a row closes or opens; empty if they are not known.
    corners : list of dict
        The exact corners of the curves of force, width and pressure over the gap of a scene; otherwise empty.
    forces : list of float
        The forces of a sweep over forces, in force; otherwise empty.
    t : list of float
        The places of a sweep along a straight line, from 0 to 1; otherwise empty.
    """

    gaps: list[Any]
    solutions: list[Any]
    events: list[dict[str, Any]]
    corners: list[dict[str, Any]]
    forces: list[float] = field(default_factory=list)
    t: list[float] = field(default_factory=list)

    @property
    def contact_force(self) -> NDArray[np.float64]:
        """Total contact force at each point of the sweep, shape (points,), >= 0, in force."""
        return np.array([solution.contact_force for solution in self.solutions])

    def __repr__(self) -> str:
        over = "forces" if self.forces else "points" if self.t else "gaps"
        return f"<signorini.Sweep: {len(self.gaps)} {over}, {len(self.events)} events>"

    def plot(self, ax: Any = None) -> Any:
        """Draws the contact force over the gaps or over t, or the travel over the forces.

        Needs matplotlib: `pip install "signorini[plot]"`.

        Parameters
        ----------
        ax : Axes of matplotlib, optional
            Where to draw. A new figure by default.

        Returns
        -------
        Axes of matplotlib
            `ax`, or the new axes.

        Raises
        ------
        ImportError
            matplotlib is not installed.
        """
        from signorini._show import axes

        ax = axes(ax)
        is_scene = bool(self.gaps) and np.ndim(self.gaps[0]) == 0
        units = self.solutions[0].scene.units if is_scene else {"length": "", "force": ""}

        def label(name: str, unit: str) -> str:
            return f"{name} [{unit}]" if unit else name

        if self.forces:
            ax.plot(self.forces, [_travel(solution) for solution in self.solutions], "o-", markersize=4)
            ax.set_xlabel(label("force", units["force"]))
            ax.set_ylabel(label("travel", units["length"]))
            return ax
        if self.corners:
            ax.plot([corner["gap"] for corner in self.corners], [corner["force"] for corner in self.corners], color="0.7")
        places = self.gaps if is_scene else self.t or np.arange(len(self.gaps))
        ax.plot(places, self.contact_force, "o", markersize=4)
        ax.set_xlabel(label("gap", units["length"]) if is_scene else "way t" if self.t else "number of the gap")
        ax.set_ylabel(label("contact force", units["force"]))
        return ax


def tradeoff(
    problem: Problem | Scene,
    *,
    refinements: int = 1,
    runs: int = 5,
    most_full_dofs: int = 10_000,
    time: float | None = None,
) -> Tradeoff:
    """Solves a problem or a scene by every method at every accuracy, and measures time and error.

    Parameters
    ----------
    problem : Problem or Scene
        What is solved.
    refinements : int, optional
        Number of finer meshes of a scene, >= 0; 1 by default. Each halves the cells of the mesh before it.
    runs : int, optional
        Smallest number of runs of each measurement, 5 by default; 0 counts as 1. There are up to four times as many
        until the two fastest differ by less than 3 %. The fastest counts.
    most_full_dofs : int, optional
        Problems with more dofs are solved in condensed form only; 10,000 by default.
    time : float, optional
        Limit in seconds, positive: a finer mesh is not begun if it is expected to end later. No limit by default.

    Returns
    -------
    Tradeoff
        Time and errors of every solve, and the recommended choices.

    Raises
    ------
    BadInput
        An option has a value that is not allowed.
    BadType or TypeError
        An argument has a wrong type.
    SignoriniError or Interrupted
        As `solve`, except `NotCertified`; for a scene also as `Scene.solve`.
    """
    for name, value in (("refinements", refinements), ("runs", runs), ("most_full_dofs", most_full_dofs)):
        if not isinstance(value, (int, np.integer)) or value < 0:
            raise BadInput(f"{name} is {value!r}; it must be a whole number that is not negative")
    measured = _signorini._measured(problem, refinements, max(runs, 1), most_full_dofs, time)
    return Tradeoff(measured["meshes"], measured["points"], measured["advice"])


@overload
def sweep(
    problem: Scene,
    gaps: ArrayLike | None = None,
    *,
    forces: ArrayLike | None = None,
    method: str | None = None,
    threads: int | None = None,
) -> Sweep: ...
@overload
def sweep(
    problem: Problem, gaps: Iterable[ArrayLike], *, method: str | None = None, threads: int | None = None
) -> Sweep: ...
@overload
def sweep(
    problem: Problem,
    *,
    g1: ArrayLike | None = None,
    f1: ArrayLike | None = None,
    points: int = 11,
    method: str | None = None,
    threads: int | None = None,
) -> Sweep: ...


def sweep(
    problem: Problem | Scene,
    gaps: Any = None,
    *,
    forces: ArrayLike | None = None,
    g1: ArrayLike | None = None,
    f1: ArrayLike | None = None,
    points: int = 11,
    method: str | None = None,
    threads: int | None = None,
) -> Sweep:
    """Solves a scene or a problem for several gaps, forces or loads.

    The stiffness is factorised once, and every solve starts from the previous solution. Give exactly one of `gaps`,
    `forces`, and the pair `g1`, `f1`, of which one is enough. Rows are not proven.

    Parameters
    ----------
    problem : Problem or Scene
        What is solved.
    gaps : sequence, optional
        For a scene: gaps of the whole scene, numbers in length. For a problem: arrays of shape (m,), in length.
    forces : sequence of float, optional
        Only for a scene: forces >= 0, in force, on the one obstacle that a force presses.
    g1 : array, shape (m,), optional
        Only for a problem: its gaps go on a straight line to these, in length. `inf` stays in the same rows.
    f1 : array, shape (n,), optional
        Only for a problem: its load goes on a straight line to this one, in force.
    points : int, optional
        Number of equidistant points of the line to `g1` and `f1`, both ends included, from 2 to 10,000; 11 by default.
    method, threads : optional
        As in `solve`.

    Returns
    -------
    Sweep
        The solutions. One that is not certified is returned as well; its certificate shows the residuals.

    Raises
    ------
    BadInput
        The arguments do not belong together, or one has a value that is not allowed.
    BadType or TypeError
        An argument has a wrong type.
    SignoriniError or Interrupted
        As `solve`, except `NotCertified`; for a scene also as `Scene.solve`.
    """
    _check_kind(problem)
    is_scene = isinstance(problem, Scene)
    given = {"gaps": gaps is not None, "forces": forces is not None, "g1, f1": g1 is not None or f1 is not None}
    asked = [name for name, is_given in given.items() if is_given]
    allowed = ["gaps", "forces"] if is_scene else ["gaps", "g1, f1"]
    if len(asked) != 1 or asked[0] not in allowed:
        named = " and ".join(asked) or "nothing"
        raise BadInput(f"a sweep over {named}; a {'scene' if is_scene else 'problem'} is swept over {' or '.join(allowed)}")
    if isinstance(problem, Scene):
        found = _signorini._swept(problem, asked[0], gaps if forces is None else forces, method, threads)
        return Sweep(found["gaps"], found["solutions"], found["events"], found["corners"], found["forces"])
    if gaps is None:
        return _on_the_way(problem, problem.replace(f=f1, g=g1), points, method, threads)
    all_gaps = [np.asarray(gap) for gap in gaps]
    prepared = _signorini.prepare(problem, gaps=max(len(all_gaps), 1), method=method, threads=threads, proof=False)
    return Sweep(all_gaps, _series(problem, prepared, [(gap, None) for gap in all_gaps], method, threads), [], [])


# A sweep keeps all solutions in memory, so that their number is limited.
_MOST_POINTS = 10_000


def _on_the_way(problem: Problem, end: Problem, points: int, method: str | None, threads: int | None) -> Sweep:
    """Solves a problem at points of the straight line from its own gaps and load to those of `end`."""
    if not isinstance(points, (int, np.integer)) or not 2 <= points <= _MOST_POINTS:
        raise BadInput(f"points is {points!r}; it must be a whole number from 2 to {_MOST_POINTS}")
    changed = np.flatnonzero(np.isfinite(problem.g) != np.isfinite(end.g))
    if len(changed):
        row = changed[0]
        ends = f"goes from {problem.g[row]} to {end.g[row]}"
        raise BadInput(f"the gap of row {row} {ends}; a sweep cannot add an obstacle to a row or remove it")
    same_load = np.array_equal(problem.f, end.f)
    # Rounded to fifteen digits, so that t is 0.3 and not 0.30000000000000004.
    t = [float(f"{place:.14e}") for place in np.linspace(0.0, 1.0, int(points))]
    gaps = [_between(problem.g, end.g, place) for place in t]
    loads = [None if same_load else _between(problem.f, end.f, place) for place in t]
    prepared = _signorini.prepare(problem, gaps=len(t), method=method, threads=threads, proof=False)
    solutions = _series(problem, prepared, list(zip(gaps, loads, strict=True)), method, threads)
    events: list[dict[str, Any]] = []
    if same_load:
        # A problem that is not condensed has no path; its events stay empty.
        with suppress(BadInput):
            path = prepared.path(problem.g, end.g)
            events = [{"t": event.at, "row": event.row, "touches": event.touches} for event in path.events]
    return Sweep(gaps, solutions, events, [], t=t)


def _between(first: NDArray[np.float64], last: NDArray[np.float64], t: float) -> NDArray[np.float64]:
    """Returns (1 - t) first + t last. Entries that are equal at both ends, such as infinite gaps, are copied unchanged."""
    moves = first != last
    between = first.copy()
    between[moves] = (1.0 - t) * first[moves] + t * last[moves]
    return between


def _series(
    problem: Problem, prepared: Prepared, states: list[tuple[Any, Any]], method: str | None, threads: int | None
) -> list[Solution]:
    """Solves for all gaps and loads (None: the problem's own); each solve starts from the previous solution."""
    # If `auto` chose multigrid and its solution is not certified, another method may reach the tolerance.
    is_by_choice = method in (None, "auto") and prepared.factor_entries == 0
    solutions: list[Solution] = []
    for gap, load in states:
        try:
            answer = prepared.solve(gap, load, start=solutions[-1] if solutions else None)
        except NotCertified as fell_short:
            answer = _solved_anew(problem.replace(g=gap, f=load), threads) if is_by_choice else fell_short.solution
        solutions.append(answer)
    return solutions


def _solved_anew(problem: Problem, threads: int | None) -> Solution:
    try:
        return _signorini.solve(problem, threads=threads, proof=False)
    except NotCertified as fell_short:
        best: Solution = fell_short.solution
        return best


def _check_kind(problem: object) -> None:
    if not isinstance(problem, (Problem, Scene)):
        raise BadType(f"the argument is of the type {type(problem).__name__}; it must be a Problem or a Scene")


def _travel(solution: SceneSolution) -> float:
    """Returns the travel of the obstacle on which the force acts, in the unit of length."""
    return next(float(of["travel"]) for of in solution.resultants if "travel" in of)
