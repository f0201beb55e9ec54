"""The compiled part: arrays go through as they are, work runs without the interpreter and answers Ctrl-C."""

from os import PathLike
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import disjoint_base

__all__ = [
    "Certificate",
    "Comparison",
    "Event",
    "Path",
    "Prepared",
    "Problem",
    "Proven",
    "Scene",
    "SceneSolution",
    "Solution",
    "__version__",
    "_measured",
    "_swept",
    "compare",
    "prepare",
    "solve",
    "solve_qp",
    "verify",
]

__version__: str

_Start: TypeAlias = Solution | ArrayLike

@final
class Problem:
    """Frictionless unilateral contact as a convex quadratic program, checked once.

    minimise 1/2 u'K u - f'u  subject to  B u - g <= 0

    K (n x n): the stiffness after supports with both triangles, symmetric (to rounding, 1e-10 of its diagonal; the lower triangle is
    taken). A sparse matrix of scipy, an array of numpy, or what has `to_scipy()` as matrices of dolfinx. f (n): the load. B (m x n):
    the contact rows, positive towards the obstacle. g (m): the gaps; inf, 1e20 or 1e30 where there is no obstacle. Without B and g
    nothing is in the way.

    near_null (n x k): displacements that cost next to no energy, a column each; multigrid needs them for bodies in space. Where all
    dofs are free and those of a node follow each other, `coordinates` (a row for each node) gives the rigid-body modes instead.

    Raises `BadInput` for arrays that do not fit, `NotConvex` for a negative diagonal entry of K.
    """

    def __new__(
        cls,
        K: Any,
        f: ArrayLike,
        B: Any = None,
        g: ArrayLike | None = None,
        near_null: ArrayLike | None = None,
        *,
        coordinates: ArrayLike | None = None,
    ) -> Problem: ...
    @property
    def dofs(self) -> int:
        """Number of unknowns n."""
    @property
    def row_count(self) -> int:
        """Number of contact rows m."""
    @property
    def K(self) -> Any:
        """The stiffness (n x n), both triangles, a `csc_array` of scipy."""
    @property
    def f(self) -> NDArray[np.float64]:
        """The load, length n, read-only."""
    @property
    def B(self) -> Any:
        """The contact rows (m x n), a `csc_array` of scipy."""
    @property
    def g(self) -> NDArray[np.float64]:
        """The gaps, length m, read-only."""
    @property
    def near_null(self) -> NDArray[np.float64] | None:
        """The near-null space (n x k), where one was given."""
    def replace(self, *, f: ArrayLike | None = None, g: ArrayLike | None = None) -> Problem:
        """The same body and rows under another load or with other gaps; the matrices are shared."""
    def __reduce__(self) -> tuple[Any, ...]:
        """A problem can be sent to another process."""

@disjoint_base
class Solution:
    """The answer to a contact problem. Its arrays are read-only."""

    @property
    def u(self) -> NDArray[np.float64]:
        """Displacement, length n, in the unit of length of the problem."""
    @property
    def multiplier(self) -> NDArray[np.float64]:
        """Contact multiplier, length m, in the unit of force, <= 0 in compression: the force on the body along its row."""
    @property
    def contact_set(self) -> NDArray[np.int64]:
        """The closed rows, from 0 and increasing."""
    @property
    def contact_force(self) -> float:
        """Total contact force `-sum(multiplier)`, >= 0."""
    @property
    def method(self) -> str:
        """`qp`, `active-set`, `penalty` or `mprgp`, with a suffix where a variant ran."""
    @property
    def iterations(self) -> int:
        """Iterations of the method: linear solves of a loop, interior-point steps, or cycles of multigrid."""
    @property
    def certificate(self) -> Certificate:
        """How far the answer can be trusted, recomputed from the problem."""
    @property
    def energy_error_bound(self) -> float:
        """Upper bound on the relative error of u in the energy norm; inf where none is known."""
    @property
    def proven(self) -> Proven | None:
        """The rows whose contact is beyond doubt; None where proofs were not asked for or there is no bound."""
    @property
    def why(self) -> str:
        """Why it was found in this way, and what else was tried, in words."""
    @property
    def seconds(self) -> float:
        """Wall-clock seconds, all in all."""
    @property
    def seconds_of(self) -> dict[str, float]:
        """Seconds of `factor`, `certificate` and `proof`, which are parts of `solve`."""
    @property
    def history(self) -> list[tuple[NDArray[np.int64], float]]:
        """The contact sets on the way, each with its penalty in multiples of the local stiffness (0 without one)."""
    def to_dict(self) -> dict[str, Any]:
        """The numbers without the vectors, with the names of the reports of the program."""
    def plot(self, ax: Any = None) -> Any:
        """Draws the contact force of each row; returns the axes. Needs matplotlib."""
    def _repr_html_(self) -> str: ...

@final
class Certificate:
    """How far an answer is from the conditions that define the solution; all numbers are relative."""

    @property
    def stationarity(self) -> float:
        """Imbalance of forces."""
    @property
    def penetration(self) -> float:
        """Penetration into the obstacle."""
    @property
    def adhesion(self) -> float:
        """Multipliers of the wrong sign: an obstacle that pulls."""
    @property
    def complementarity(self) -> float:
        """Products of force and open distance."""
    @property
    def duality_gap(self) -> float:
        """Difference of the primal and the dual energy."""
    @property
    def energy_error_bound(self) -> float:
        """Upper bound on the error of u in the energy norm; inf where none is known."""
    @property
    def part_error_bound(self) -> float:
        """The largest such bound over the whole and each part that nothing couples."""
    @property
    def bound_is_measured(self) -> bool:
        """Whether the bound rests on a measured eigenvalue, because K was not factorised."""
    @property
    def worst(self) -> tuple[str, float]:
        """The condition that is worst, and its value."""
    def meets(self, tolerance: float) -> bool:
        """Whether all conditions and the bound hold to `tolerance`, or rounding explains what is left."""
    def conditions_hold(self, tolerance: float) -> bool:
        """Whether all conditions hold to `tolerance`, whatever the bound."""
    def to_dict(self) -> dict[str, Any]:
        """The numbers, with the names of the reports of the program."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class Proven:
    """Rows that an answer proves to be open or closed in the exact answer."""

    @property
    def open(self) -> NDArray[np.int64]:
        """Rows that are open beyond doubt."""
    @property
    def closed(self) -> NDArray[np.int64]:
        """Rows that are closed beyond doubt."""
    @property
    def undecided(self) -> NDArray[np.int64]:
        """Rows of which neither is proven."""

@final
class Prepared:
    """A problem factorised once, for many gaps, loads and starts."""

    def solve(
        self,
        g: ArrayLike | None = None,
        f: ArrayLike | None = None,
        *,
        start: _Start | None = None,
        time: float | None = None,
    ) -> Solution:
        """Solves with these gaps (length m) or under this load (length n), from what is known of the answer beforehand.

        Raises what `solve` raises.
        """
    def path(self, g0: ArrayLike, g1: ArrayLike) -> Path:
        """The exact path of the answer while the gaps move from g0 to g1 on a straight line.

        Raises `BadInput` if the problem is not condensed or only its rows hold it.
        """
    @property
    def dofs(self) -> int:
        """Number of unknowns of the problem."""
    @property
    def condensed_dofs(self) -> int:
        """Number of unknowns that the methods work on."""
    @property
    def factor_entries(self) -> int:
        """Number of values of the factor; 0 without one."""
    @property
    def seconds(self) -> float:
        """Wall-clock seconds of the preparation."""

@final
class Event:
    """A row that touches or releases on a path."""

    @property
    def at(self) -> float:
        """Where on the path, from 0 to 1."""
    @property
    def row(self) -> int:
        """Which row, from 0."""
    @property
    def touches(self) -> bool:
        """Whether it touches; otherwise it releases."""

@final
class Path:
    """The answers for all gaps (1 - t) g0 + t g1, t from 0 to 1, as polylines."""

    @property
    def events(self) -> list[Event]:
        """The rows that touch or release on the way, in order."""
    @property
    def corners(self) -> NDArray[np.float64]:
        """The corners of all polylines: the beginning, every event, the end."""
    def gap(self, t: float) -> NDArray[np.float64]:
        """The gaps at t, length m."""
    def multiplier(self, t: float) -> NDArray[np.float64]:
        """The multipliers at t, length m."""
    def contact_set(self, t: float) -> NDArray[np.int64]:
        """The closed rows at t; at an event those of the stretch before it."""
    def solution(self, t: float) -> Solution:
        """The whole answer at t, certified like any other."""

@final
class Scene:
    """A contact scene: bodies, supports, loads and obstacles.

    From a JSON file, or from a dictionary with the same names, whose further files start from `folder`. Files outside the folder of
    the scene are read only if `allow_outside` says so. The model is built when it is first asked for.

    Raises `SceneError` for values that are no scene, with path, line and column; `FileError`.
    """

    def __new__(
        cls,
        source: str | PathLike[str] | dict[str, Any],
        *,
        folder: str | PathLike[str] | None = None,
        allow_outside: bool = False,
    ) -> Scene: ...
    @property
    def title(self) -> str:
        """What the scene shows."""
    @property
    def units(self) -> dict[str, str]:
        """Names of the units of `length`, `force` and `pressure`; empty where the scene has none."""
    @property
    def problem(self) -> Problem:
        """The contact problem in the free dofs."""
    @property
    def nodes(self) -> NDArray[np.float64]:
        """Coordinates of the nodes, one row each."""
    @property
    def elements(self) -> NDArray[np.int64]:
        """Nodes of the elements, one row each, in the order of VTK."""
    @property
    def element_kind(self) -> str:
        """Name of the elements, as `Q4`."""
    @property
    def rows(self) -> dict[str, Any]:
        """What the contact rows stand for, with an entry for each: `node`, `obstacle`, `normal`, `gap` and `area`."""
    @property
    def warnings(self) -> list[str]:
        """What a reader of the answer should know, in sentences."""
    def solve(
        self,
        *,
        method: str | None = None,
        accuracy: float | str | None = None,
        time: float | None = None,
        start: _Start | None = None,
        threads: int | None = None,
        tolerance: float | None = None,
        memory: float | None = None,
        precision: str | None = None,
        condense: bool = True,
        proof: bool = True,
    ) -> SceneSolution:
        """Solves the scene; arguments and exceptions as `signorini.solve`."""
    def compare(self) -> Comparison:
        """Solves the scene by three methods."""

@final
class SceneSolution(Solution):
    """The answer to a scene, with what follows from it. Nodal arrays have a row for each node."""

    @property
    def scene(self) -> Scene:
        """The scene."""
    @property
    def displacement(self) -> NDArray[np.float64]:
        """Displacement of the nodes, supports included."""
    @property
    def pressure(self) -> NDArray[np.float64]:
        """Contact pressure of each row, in force per area, >= 0."""
    @property
    def remaining_gap(self) -> NDArray[np.float64]:
        """What is left of the gap of each row, in length."""
    @property
    def stress(self) -> NDArray[np.float64]:
        """Stress at the nodes: xx, yy, zz, xy, yz, zx; tension is positive."""
    @property
    def element_stress(self) -> NDArray[np.float64]:
        """Stress at the middle of the elements: xx, yy, zz, xy, yz, zx."""
    @property
    def von_mises(self) -> NDArray[np.float64]:
        """Von Mises stress at the nodes."""
    @property
    def contact_forces(self) -> NDArray[np.float64]:
        """Contact forces on the nodes."""
    @property
    def reactions(self) -> NDArray[np.float64]:
        """Support reactions on the nodes."""
    @property
    def resultants(self) -> list[dict[str, Any]]:
        """Force, moment and centre of each obstacle, support and load."""
    def report(self) -> dict[str, Any]:
        """The report of the program, as `signorini solve --format json` prints it; the seconds of the assembly are left out."""
    def to_pyvista(self) -> Any:
        """The mesh with displacement and stress, a grid of pyvista."""

@final
class Comparison:
    """One problem solved by interior point, active set and penalty."""

    @property
    def qp(self) -> Solution:
        """The answer of the interior point."""
    @property
    def active_set(self) -> Solution:
        """The answer of the active set."""
    @property
    def penalty(self) -> Solution:
        """The answer of the penalty."""
    @property
    def agreement(self) -> dict[str, Any]:
        """How far the answers are from each other, with the names of the reports of the program."""
    @property
    def agrees(self) -> bool:
        """Whether interior point and active set are certified and agree."""

def solve(
    problem: Problem,
    *,
    method: str | None = None,
    accuracy: float | str | None = None,
    time: float | None = None,
    start: _Start | None = None,
    threads: int | None = None,
    tolerance: float | None = None,
    memory: float | None = None,
    precision: str | None = None,
    condense: bool = True,
    proof: bool = True,
) -> Solution:
    """Solves a contact problem; what is returned is certified.

    method: `auto` (the default), `qp`, `active-set`, `penalty` or `mprgp`. accuracy: a relative error in energy that is good enough, or
    `exact`. time: seconds after which the best answer so far is taken. start: a solution nearby, an array of closed rows (whole
    numbers), or a displacement. tolerance: what is certified, 1e-9 by default. memory: bytes that it may take; by default what the
    machine has available. precision: `auto`, `double` or `mixed`. condense: whether the body may be condensed onto its contact dofs.
    proof: whether rows are proven open or closed.

    Raises `Infeasible`, `Unbounded`, `UnderHeld`, `NotConvex`; `NotCertified` with the best answer; `OutOfTime`; `TooLarge`;
    `BadInput` for an option out of its range; `Interrupted` with the best answer after Ctrl-C.
    """

def solve_qp(problem: Problem) -> Solution:
    """Solves a contact problem as a QP by the interior point, its set settled by the active set, certified to 1e-9."""

def prepare(
    problem: Problem,
    *,
    gaps: int = 10,
    method: str | None = None,
    accuracy: float | str | None = None,
    threads: int | None = None,
    tolerance: float | None = None,
    memory: float | None = None,
    precision: str | None = None,
    condense: bool = True,
    proof: bool = True,
) -> Prepared:
    """Factorises a problem once for about this number of gaps, loads or starts; options as in `solve`."""

def verify(problem: Problem, u: ArrayLike, multiplier: ArrayLike) -> Certificate:
    """The certificate of anybody's answer: displacement u (n) and multiplier (m, <= 0 in compression)."""

def compare(problem: Problem | Scene) -> Comparison:
    """Solves a problem or a scene by three methods; an answer that is not certified is an answer here."""

def _measured(
    problem: Problem | Scene, refinements: int, runs: int, most_full_dofs: int, time: float | None
) -> dict[str, Any]: ...
def _swept(
    scene: Scene, over: str, values: ArrayLike, method: str | None, threads: int | None
) -> dict[str, Any]: ...
