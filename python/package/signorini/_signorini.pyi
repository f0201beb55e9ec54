"""Types of the compiled module: it reads arrays in place, releases the interpreter while it works, and answers Ctrl-C."""

from collections.abc import Sequence
from os import PathLike
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import disjoint_base

__all__ = [
    "Certificate",
    "Comparison",
    "Event",
    "Gradient",
    "Jvp",
    "Path",
    "Prepared",
    "Problem",
    "Proven",
    "Scene",
    "SceneSolution",
    "Solution",
    "Tangent",
    "TotalError",
    "Vjp",
    "__version__",
    "_jvp",
    "_measured",
    "_mortar_rows",
    "_solve_many",
    "_swept",
    "_vjp",
    "compare",
    "prepare",
    "modes",
    "sensitivity",
    "solve",
    "solve_qp",
    "total_error",
    "verify",
]

__version__: str

_Start: TypeAlias = Solution | ArrayLike

@final
class Problem:
    """Frictionless unilateral contact as a convex quadratic program. The arrays are checked once, here.

    minimise 1/2 u'K u - f'u  subject to  B u - g <= 0,  E u = e

    K: stiffness after supports, n x n, symmetric to rounding (1e-10 of its diagonal). Both triangles must be given; the values are
    taken from the lower one. K is a sparse matrix of scipy, an array of numpy, or an object with `to_scipy()`, such as a matrix of
    dolfinx.
    f: external load, length n, in the unit of force, positive along the axes.
    B: contact rows, m x n, in the same forms as K, positive towards the obstacle.
    g: initial gaps, length m, in the unit of length. A negative gap means that the obstacle starts inside the body; inf, 1e20 or
    1e30 means that the row has no obstacle.
    If B and g are left out, the problem has no contact rows.

    E: equality rows, p x n, in the same forms as K; e: their values, length p. They may follow from each other.
    A row without entries whose gap or value is rounding beside the largest (16 eps) counts as 0, with a warning that names it.

    near_null: displacements of almost zero energy, n x k, one per column. Multigrid needs them for bodies in space.
    coordinates: coordinates of the nodes, one row per node; the rigid-body modes are computed from them. They can replace
    `near_null` if all dofs are free and the dofs of each node follow each other.

    Raises `BadInput` if the arrays do not fit together, `BadType` for an array of a wrong type, and `NotConvex` if K has a negative
    diagonal entry.
    """

    def __new__(
        cls,
        K: Any,
        f: ArrayLike,
        B: Any = None,
        g: ArrayLike | None = None,
        near_null: ArrayLike | None = None,
        E: Any = None,
        e: ArrayLike | None = None,
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
    def equality_count(self) -> int:
        """Number of equality rows p."""
    @property
    def K(self) -> Any:
        """Stiffness, n x n, with both triangles, as a `csc_array` of scipy."""
    @property
    def f(self) -> NDArray[np.float64]:
        """External load, length n, read-only."""
    @property
    def B(self) -> Any:
        """Contact rows, m x n, as a `csc_array` of scipy."""
    @property
    def g(self) -> NDArray[np.float64]:
        """Initial gaps, length m, read-only."""
    @property
    def E(self) -> Any:
        """Equality rows, p x n, as a `csc_array` of scipy; None without such rows."""
    @property
    def e(self) -> NDArray[np.float64] | None:
        """Values of the equality rows, length p, read-only; None without such rows."""
    @property
    def near_null(self) -> NDArray[np.float64] | None:
        """Displacements of almost zero energy, n x k, one per column; None if none were given."""
    def replace(self, *, f: ArrayLike | None = None, g: ArrayLike | None = None) -> Problem:
        """Returns a problem with the load f (length n), the gaps g (length m), or both replaced; the matrices are shared, and so are the
        equality rows."""
    def __reduce__(self) -> tuple[Any, ...]:
        """Supports pickle, so that a problem can be sent to another process."""

@disjoint_base
class Solution:
    """The solution of a contact problem. Its arrays are read-only."""

    @property
    def u(self) -> NDArray[np.float64]:
        """Displacements, length n, in the order of the unknowns of K and in the problem's unit of length."""
    @property
    def multiplier(self) -> NDArray[np.float64]:
        """Contact multipliers, length m, in the unit of force: the force on the body along each row, <= 0 in compression."""
    @property
    def equality_multiplier(self) -> NDArray[np.float64]:
        """Multipliers of the equality rows, length p, in the unit of force, of either sign; empty without such rows."""
    @property
    def contact_set(self) -> NDArray[np.int64]:
        """Indices of the closed rows, counted from 0, in increasing order."""
    @property
    def contact_force(self) -> float:
        """Total contact force `-sum(multiplier)`, >= 0, in the unit of force."""
    @property
    def method(self) -> str:
        """Name of the method: `qp`, `active-set`, `penalty` or `mprgp`, with a suffix for a variant."""
    @property
    def iterations(self) -> int:
        """Number of iterations of the method: linear solves, interior-point steps, or multigrid cycles."""
    @property
    def certificate(self) -> Certificate:
        """The residuals of all conditions and the error bound, recomputed from the original problem."""
    @property
    def energy_error_bound(self) -> float:
        """Upper bound on the relative error of u in the energy norm; inf if none is known."""
    @property
    def proven(self) -> Proven | None:
        """Rows that are proven open or closed; None if `proof=False` was given or no error bound is known."""
    @property
    def why(self) -> str:
        """Explanation in words: why this method was chosen, and which methods were tried before it."""
    @property
    def seconds(self) -> float:
        """Wall-clock time of the whole solve, in seconds."""
    @property
    def seconds_of(self) -> dict[str, float]:
        """Seconds of the steps `factor`, `certificate` and `proof`, and of the whole `solve`, which contains them."""
    @property
    def history(self) -> list[tuple[NDArray[np.int64], float]]:
        """The closed rows in each iteration, with the penalty in multiples of the local stiffness (0 without a penalty)."""
    def vjp(
        self,
        displacement: ArrayLike | None = None,
        multiplier: ArrayLike | None = None,
        equality_multiplier: ArrayLike | None = None,
    ) -> Vjp:
        """Returns the derivatives of an output phi(u, multiplier, equality_multiplier) with respect to all data of the problem.

        displacement: d phi / d u, length n. multiplier: d phi / d multiplier, length m. equality_multiplier: the same, length p. One that is
        left out is zero. The unit of the result is that of phi over that of the data; what phi itself depends on the data is not in it.

        The first derivative factorises K, unless the solution is one of `prepare`, whose factor it takes; the solution keeps what it needs
        for more of them. Each costs one linear solve.

        Raises `BadInput` for an array that does not fit or is not finite, `BadType` for an argument of a wrong type, and the exceptions
        of `signorini.prepare`. A derivative that is not proven is no exception: the result says so.
        """
    def jvp(
        self,
        load: ArrayLike | None = None,
        gap: ArrayLike | None = None,
        stiffness: Any = None,
        rows: Any = None,
        equality_values: ArrayLike | None = None,
    ) -> Jvp:
        """Returns the derivatives of displacement and multipliers along a change of the data, per unit of a parameter.

        load: df, length n. gap: dg, length m; the gap of a row without an obstacle stays infinite. stiffness: dK, n x n, symmetric, with
        both triangles. rows: dB, m x n. equality_values: de, length p. stiffness and rows may have entries where K and B have none. What is
        left out does not change.

        Costs and exceptions are those of `vjp`.
        """
    def to_dict(self) -> dict[str, Any]:
        """Returns all scalar results, under the names that the program uses in its reports; the vectors are left out."""
    def plot(self, ax: Any = None) -> Any:
        """Draws the contact force of each row and returns the axes. Needs matplotlib."""
    def _repr_html_(self) -> str: ...

@final
class Certificate:
    """Relative residuals of the conditions that define the solution, and a bound on the error."""

    @property
    def stationarity(self) -> float:
        """Residual of equilibrium, K u - f - B' multiplier = 0, at each dof relative to its own terms. It does not decide."""
    @property
    def penetration(self) -> float:
        """Relative penetration into the obstacle, a violation of B u - g <= 0."""
    @property
    def adhesion(self) -> float:
        """Relative size of the multipliers of the wrong sign: an obstacle would pull on the body. It must be zero."""
    @property
    def complementarity(self) -> float:
        """Products of contact force and open distance, relative to twice the strain energy. It does not decide."""
    @property
    def duality_gap(self) -> float:
        """Difference of the primal and the dual energy, relative to twice the strain energy. It does not decide."""
    @property
    def energy_error_bound(self) -> float:
        """Upper bound on the relative error of u in the energy norm; inf if none is known, or for a body at rest."""
    @property
    def imbalance(self) -> float:
        """Residual of equilibrium above rounding, relative to the largest force on the part."""
    @property
    def open_force(self) -> float:
        """Relative force of a row over its relative open distance, the smaller of the two."""
    @property
    def energy_error(self) -> float:
        """Upper bound on the error of u in the energy norm, in the square root of the problem's unit of energy; inf if none is known."""
    @property
    def met_tolerance(self) -> float:
        """The tolerance that is met without the excuse of rounding or, if none is, with it; inf if none is met."""
    @property
    def met(self) -> str | None:
        """'tolerance' or 'rounding', the way in which the goal is met; `None` if it is not."""
    @property
    def at_rest(self) -> bool:
        """`True` if no part moves: there is no relative error, and `rest_error` bounds the error."""
    @property
    def rest_error(self) -> float:
        """Largest error bound of a part at rest, relative to what the forces on it could do to a single dof."""
    @property
    def worst_dof(self) -> int:
        """The dof, from 0, at which loads and contact forces cancel most digits of the elastic force."""
    @property
    def digits_left(self) -> float:
        """Digits of the elastic force that doubles can hold at that dof, from 0 to 16."""
    @property
    def part_error_bound(self) -> float:
        """Largest error bound over the whole problem and over each of its uncoupled parts that moves."""
    @property
    def bound_is_measured(self) -> bool:
        """`True` if the bound uses a measured eigenvalue, because K was not factorised."""
    @property
    def worst(self) -> tuple[str, float]:
        """Name and value of the largest of the numbers that decide."""
    def meets(self, tolerance: float) -> bool:
        """Returns `True` if all conditions hold to `tolerance` and the error bound is at most `tolerance` or explained by rounding."""
    def conditions_hold(self, tolerance: float) -> bool:
        """Returns `True` if all conditions hold to `tolerance`. The error bound is not compared."""
    def to_dict(self) -> dict[str, Any]:
        """Returns all numbers, under the names that the program uses in its reports."""
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class Proven:
    """Rows that the error bound proves to be open or closed in the exact solution."""

    @property
    def open(self) -> NDArray[np.int64]:
        """Indices of the rows that are proven open, counted from 0."""
    @property
    def closed(self) -> NDArray[np.int64]:
        """Indices of the rows that are proven closed, counted from 0."""
    @property
    def undecided(self) -> NDArray[np.int64]:
        """Indices of the rows that are proven neither open nor closed, counted from 0."""

@final
class Gradient:
    """The derivatives of an output phi with respect to all data, with some rows taken as closed and all others as open."""

    @property
    def load(self) -> NDArray[np.float64]:
        """Derivatives with respect to the load f, length n."""
    @property
    def gap(self) -> NDArray[np.float64]:
        """Derivatives with respect to the gaps g, length m; zero on open rows."""
    @property
    def equality_values(self) -> NDArray[np.float64]:
        """Derivatives with respect to the values e of the equality rows, length p."""
    @property
    def stiffness(self) -> Any:
        """Derivatives with respect to the entries of K, n x n, as a symmetric `csc_array` of scipy on the pattern of K.

        For a symmetric change dK on that pattern d phi is `(stiffness * dK).sum()`, over both triangles: an entry off the diagonal and its
        mirror image each have half of the derivative with respect to both of them moved together.
        """
    @property
    def rows(self) -> Any:
        """Derivatives with respect to the entries of B, m x n, as a `csc_array` of scipy on the pattern of B: d phi is `(rows * dB).sum()`."""
    @property
    def error(self) -> float:
        """Relative error of the linear solve: with a factor its last correction, with multigrid a bound in the energy norm."""

@final
class Vjp:
    """The derivatives of an output phi with respect to all data, with the verdict whether they exist.

    Without a proof the derivatives raise `NoDerivative`, which names the rows; `between` has those of the pieces around.
    """

    @property
    def verdict(self) -> str:
        """`proven`: every row is proven to be closed and to press, or to be open, so that there is one derivative. `undecided`: the rows in
        `rows_at_kink` are at a kink, or the proof leaves them open. `unknown`: no bound on the error of the solution is known."""
    @property
    def load(self) -> NDArray[np.float64]:
        """Derivatives with respect to the load f, length n. Raises `NoDerivative` if it is not proven, as those that follow."""
    @property
    def gap(self) -> NDArray[np.float64]:
        """Derivatives with respect to the gaps g, length m; zero on open rows."""
    @property
    def equality_values(self) -> NDArray[np.float64]:
        """Derivatives with respect to the values e of the equality rows, length p."""
    @property
    def stiffness(self) -> Any:
        """Derivatives with respect to the entries of K, as `Gradient.stiffness`: d phi is `(stiffness * dK).sum()` over both triangles."""
    @property
    def rows(self) -> Any:
        """Derivatives with respect to the entries of B, m x n, as `Gradient.rows`."""
    @property
    def error(self) -> float:
        """Relative error of the linear solve, as `Gradient.error`."""
    @property
    def between(self) -> list[Gradient]:
        """If it is undecided: the derivatives with all rows of `rows_at_kink` open, then with all of them closed, as far as they exist.
        Of several rows some may be open and others closed."""
    @property
    def rows_at_kink(self) -> NDArray[np.int64]:
        """Indices of the rows that may be open or closed, counted from 0; empty if none is, or nothing is known."""
    @property
    def why(self) -> str:
        """Why no derivative is proven, in one sentence; empty if it is."""

@final
class Tangent:
    """The derivatives of displacement and multipliers along a change of the data, per unit of its parameter."""

    @property
    def displacement(self) -> NDArray[np.float64]:
        """Derivatives of the displacement u, length n, in the unit of length per unit of the parameter."""
    @property
    def multiplier(self) -> NDArray[np.float64]:
        """Derivatives of the multipliers, length m, in the unit of force per unit of the parameter; zero on open rows."""
    @property
    def equality_multiplier(self) -> NDArray[np.float64]:
        """Derivatives of the multipliers of the equality rows, length p, in the unit of force per unit of the parameter."""
    @property
    def error(self) -> float:
        """Relative error, as `Gradient.error`; at a kink the energy error bound of the small contact problem."""

@final
class Jvp:
    """The derivatives of displacement and multipliers along a change of the data, with the verdict whether they exist."""

    @property
    def verdict(self) -> str:
        """`proven`, `undecided` and `unknown` as `Vjp.verdict`. `one-sided`: gap and force of the rows in `rows_at_kink` are exactly zero, so
        that `left` and `right` are the derivatives."""
    @property
    def displacement(self) -> NDArray[np.float64]:
        """Derivatives of the displacement u, length n. Raises `NoDerivative` if it is not proven, as those that follow."""
    @property
    def multiplier(self) -> NDArray[np.float64]:
        """Derivatives of the multipliers, length m; zero on open rows."""
    @property
    def equality_multiplier(self) -> NDArray[np.float64]:
        """Derivatives of the multipliers of the equality rows, length p."""
    @property
    def error(self) -> float:
        """Relative error of the linear solve, as `Tangent.error`."""
    @property
    def left(self) -> Tangent:
        """The derivative for a falling parameter; the derivative if it is proven. Raises `NoDerivative` if it is undecided or unknown."""
    @property
    def right(self) -> Tangent:
        """The derivative for a growing parameter, as `left`."""
    @property
    def between(self) -> list[Tangent]:
        """If it is undecided: the derivatives with all rows of `rows_at_kink` open, then with all of them closed, as far as they exist."""
    @property
    def rows_at_kink(self) -> NDArray[np.int64]:
        """Indices of the rows that may be open or closed, counted from 0; empty if none is, or nothing is known."""
    @property
    def why(self) -> str:
        """Why no derivative is proven, in one sentence; empty if it is."""

@final
class Prepared:
    """A problem that is factorised once and then solved for many gaps, loads and starts."""

    def solve(
        self,
        g: ArrayLike | None = None,
        f: ArrayLike | None = None,
        *,
        start: _Start | None = None,
        time: float | None = None,
    ) -> Solution:
        """Solves the problem with the gaps g (length m) and the load f (length n); both default to those of the problem.

        start: a solution nearby, an array of closed rows (integers), or a displacement (length n). It changes the number of
        iterations, not the answer. time: limit in seconds.

        Raises the exceptions of `signorini.solve`.
        """
    def plan(self) -> str:
        """The attempts and steps that a solve makes, in order, each with its condition and its reason: text, a line each."""
    def path(self, g0: ArrayLike, g1: ArrayLike) -> Path:
        """Computes the exact solution for all gaps on the straight line from g0 to g1 (length m each).

        Raises `BadInput` if the problem is not condensed, or if the body is supported by its contact rows only.
        """
    @property
    def dofs(self) -> int:
        """Number of unknowns of the problem."""
    @property
    def condensed_dofs(self) -> int:
        """Number of unknowns after condensation, on which the methods work."""
    @property
    def factor_entries(self) -> int:
        """Number of values in the factor of K; 0 if K was not factorised."""
    @property
    def seconds(self) -> float:
        """Wall-clock time of the preparation, in seconds."""

@final
class Event:
    """A point of a path at which a row closes or opens."""

    @property
    def at(self) -> float:
        """Parameter t of the event, from 0 to 1."""
    @property
    def row(self) -> int:
        """Index of the row, counted from 0."""
    @property
    def touches(self) -> bool:
        """`True` if the row closes, `False` if it opens."""

@final
class Path:
    """The exact solutions for all gaps (1 - t) g0 + t g1 with t from 0 to 1. They are piecewise linear in t."""

    @property
    def events(self) -> list[Event]:
        """All points at which a row closes or opens, in the order of t."""
    @property
    def corners(self) -> NDArray[np.float64]:
        """Increasing values of t between which the solution is linear: 0, every event, 1."""
    def gap(self, t: float) -> NDArray[np.float64]:
        """Returns the gaps at t, length m. Raises `BadInput` for a t outside [0, 1], as all methods of a path do."""
    def multiplier(self, t: float) -> NDArray[np.float64]:
        """Returns the multipliers at t, length m, <= 0 in compression."""
    def equality_multiplier(self, t: float) -> NDArray[np.float64]:
        """Returns the multipliers of the equality rows at t, length p, of either sign."""
    def contact_set(self, t: float) -> NDArray[np.int64]:
        """Returns the indices of the closed rows at t; at an event, those just before it."""
    def solution(self, t: float) -> Solution:
        """Returns the certified solution at t."""

@final
class Scene:
    """A contact scene: bodies, supports, loads and obstacles.

    source: the name of a JSON file or of a deck of CalculiX (`.inp`), or a dictionary with the same keys. folder: the folder of the files
    that a dictionary names. allow_outside: `True` lets the scene read files outside its folder. Of a deck: step, from 1, the last one if it
    is left out; without_friction: `True` leaves friction out; linear: `True` answers NLGEOM with small displacements whatever the strains
    are. The mesh and the matrices are built at the first access.

    Raises `SceneError`, with JSON path, line and column, for a value that is not allowed, and `FileError` for a file that cannot be
    read.
    """

    def __new__(
        cls,
        source: str | PathLike[str] | dict[str, Any],
        *,
        folder: str | PathLike[str] | None = None,
        allow_outside: bool = False,
        without_friction: bool = False,
        linear: bool = False,
        step: int | None = None,
    ) -> Scene: ...
    @property
    def title(self) -> str:
        """Title of the scene; empty if it has none."""
    @property
    def parameters(self) -> list[str]:
        """Names of the numbers by which outputs have derivatives, and "nodes" for the places of all nodes."""
    @property
    def outputs(self) -> list[str]:
        """Names of the outputs that have derivatives; X,Y stands for the coordinates of a place."""
    def with_parameter(self, name: str, value: float) -> Scene:
        """Returns the same scene with another value of a parameter; "loads[0]" is a factor of that load.

        Raises `SceneError` for a name that does not exist, and for a value that the scene does not allow.
        """
    @property
    def units(self) -> dict[str, str]:
        """Names of the units of `length`, `force` and `pressure`; empty strings if the scene names no units."""
    @property
    def problem(self) -> Problem:
        """The contact problem in the free dofs."""
    @property
    def nodes(self) -> NDArray[np.float64]:
        """Coordinates of the nodes, one row per node, in the unit of length."""
    @property
    def elements(self) -> NDArray[np.int64]:
        """Node numbers of the elements, one row per element, counted from 0, in the order of VTK; -1 after the last node of an
        element with fewer nodes than others have."""
    @property
    def element_kinds(self) -> list[str]:
        """Names of the kinds of the elements, one per element, for example `Q4`."""
    @property
    def rows(self) -> dict[str, Any]:
        """Node, obstacle, normal, gap and tributary area of each contact row.

        The keys are `node`, `obstacle`, `normal`, `gap` and `area`; each value is an array with one entry per contact row.
        """
    @property
    def warnings(self) -> list[str]:
        """Warnings about the scene, one sentence each."""
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
        """Solves the scene. Arguments and exceptions are those of `signorini.solve`."""
    def compare(self) -> Comparison:
        """Solves the scene by interior point, active set and penalty, and compares the solutions."""

@final
class SceneSolution(Solution):
    """The solution of a scene, with stresses, pressures and forces. Nodal arrays have one row per node."""

    @property
    def scene(self) -> Scene:
        """The scene that was solved."""
    @property
    def displacement(self) -> NDArray[np.float64]:
        """Displacements of all nodes, supported ones included, one row per node, in the unit of length."""
    @property
    def pressure(self) -> NDArray[np.float64]:
        """Contact pressure of each row, length m, >= 0, in the unit of pressure."""
    @property
    def remaining_gap(self) -> NDArray[np.float64]:
        """Remaining gap of each row after deformation, length m, in the unit of length."""
    @property
    def stress(self) -> NDArray[np.float64]:
        """Stress at the nodes, one row per node: xx, yy, zz, xy, yz, zx; tension is positive."""
    @property
    def element_stress(self) -> NDArray[np.float64]:
        """Stress at the centres of the elements, one row per element: xx, yy, zz, xy, yz, zx; tension is positive."""
    @property
    def von_mises(self) -> NDArray[np.float64]:
        """Von Mises stress at the nodes, one value per node, >= 0."""
    @property
    def contact_forces(self) -> NDArray[np.float64]:
        """Contact forces on the body at the nodes, one row per node, along the axes."""
    @property
    def reactions(self) -> NDArray[np.float64]:
        """Support reactions on the body at the nodes, one row per node, along the axes."""
    @property
    def resultants(self) -> list[dict[str, Any]]:
        """Resultant force, moment and centre of each obstacle, support and load, one dictionary for each."""
    def report(self) -> dict[str, Any]:
        """Returns the report that `signorini solve --format json` prints; only the seconds of the assembly are left out."""
    def to_pyvista(self) -> Any:
        """Returns the mesh with displacement, stress and von Mises stress as a grid of pyvista. Needs pyvista."""

@final
class Comparison:
    """One problem solved by interior point, active set and penalty."""

    @property
    def qp(self) -> Solution:
        """The solution of the interior-point method."""
    @property
    def active_set(self) -> Solution:
        """The solution of the active-set method."""
    @property
    def penalty(self) -> Solution:
        """The solution of the penalty method."""
    @property
    def agreement(self) -> dict[str, Any]:
        """Differences between the three solutions, under the names that the program uses in its reports."""
    @property
    def agrees(self) -> bool:
        """`True` if the solutions of interior point and active set are certified and agree."""

@final
class TotalError:
    """An answer with its error against the continuum: u is the exact displacement of the linear model, v the answer.

    With a guarantee `nodes`, `elements` and `displacement` describe v, which keeps the distance of the obstacles between its nodes
    too; they may differ from those of `solution`. Otherwise they are those of `solution`.
    """

    @property
    def bound(self) -> float:
        """|u - v| / |v| in the energy norm: an upper bound if it is guaranteed, otherwise an estimate."""
    @property
    def guaranteed(self) -> bool:
        """`True` if the bound is proven, `False` if it is estimated."""
    @property
    def reason(self) -> str | None:
        """The part of the scene for which there is no guarantee, with its place; None if the bound is guaranteed."""
    @property
    def force_interval(self) -> tuple[float, float] | None:
        """The interval that contains the exact contact force, in the unit of force; None if it is not known."""
    @property
    def levels(self) -> list[dict[str, Any]]:
        """One dictionary per mesh, from the first to the last, under the names that the program uses in its reports.

        All have `elements`, `dofs`, `total_error`, `contact_force` and `seconds`. With a guarantee there are also `stress_dofs`,
        `mean_stress_error`, `force_interval` where it is known, `displacement_seconds` and `stress_seconds`; otherwise `contact_rows`,
        `method`, `discretisation_error`, `energy_error_bound` and `depth_between_nodes`.
        """
    @property
    def ended(self) -> str:
        """Why no finer mesh was made: `goal`, `time`, `memory`, or `mesh` if the mesh of a file cannot be refined."""
    @property
    def status(self) -> str:
        """`certified` if the goal is met, otherwise `not_certified`."""
    @property
    def model(self) -> dict[str, Any]:
        """Size of the problem on the last mesh, under the names that the program uses in its reports, such as `dofs`."""
    @property
    def nodes(self) -> NDArray[np.float64]:
        """Coordinates of the nodes of the last mesh, one row per node, in the unit of length."""
    @property
    def elements(self) -> NDArray[np.int64]:
        """Node numbers of the elements of the last mesh, one row per element, counted from 0, in the order of VTK.

        With a guarantee they are triangles: three corners, then the middles of the sides 0-1, 1-2 and 2-0.
        """
    @property
    def displacement(self) -> NDArray[np.float64]:
        """The displacement v of each node of the last mesh, one row per node, in the unit of length."""
    @property
    def solution(self) -> SceneSolution | None:
        """The solution of the scene on the last mesh, which its `scene` has; None if time or memory ended before it."""
    def to_dict(self) -> dict[str, Any]:
        """Returns all numbers, under the names that the program uses in its reports; the arrays are left out."""

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
    """Solves a contact problem. The returned solution is certified to `tolerance`.

    method: `auto` (the default), `qp`, `active-set`, `penalty` or `mprgp`.
    accuracy: a sufficient relative error in the energy norm, or `exact`.
    time: limit in seconds; after it the best solution so far is taken.
    start: a solution nearby, an array of closed rows (integers), or a displacement (length n).
    threads: number of threads.
    tolerance: largest relative residual and error bound of a certified solution, 1e-9 by default.
    memory: limit in bytes; by default the memory that the machine has available.
    precision: `auto`, `double` or `mixed`.
    condense: `False` forbids condensing the body onto its contact dofs.
    proof: `False` omits the proof of open and closed rows.

    Raises
    `Infeasible` if contact rows contradict each other;
    `Unbounded` if the load moves the body away without end;
    `UnderHeld` if the body is insufficiently supported, so that the solution is not unique;
    `NotConvex` if K has a negative eigenvalue;
    `NotCertified`, with the best solution, if the tolerance is not reached;
    `OutOfTime` and `TooLarge` if time or memory do not suffice;
    `NumericalError` if a computation fails, for example by overflow;
    `BadInput` for an option out of its range;
    `Interrupted`, with the best solution so far, after Ctrl-C.
    """

def solve_qp(problem: Problem) -> Solution:
    """Solves a contact problem by an interior-point method, certified to 1e-9; the active-set method makes the contact set exact.

    Raises the exceptions of `solve`.
    """

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
    """Factorises a problem once, to solve it for several gaps, loads or starts.

    gaps: the expected number of solves, by which the method is chosen. The other options are those of `solve`.

    Raises `BadInput` for an option out of its range, `Infeasible`, `NotConvex`, `OutOfTime`, `TooLarge`, `NumericalError` and
    `Interrupted`.
    """

def verify(
    problem: Problem, u: ArrayLike, multiplier: ArrayLike, equality_multiplier: ArrayLike | None = None
) -> Certificate:
    """Returns the certificate of any displacement u (length n), multiplier (length m, <= 0 in compression) and multiplier of the
    equality rows (length p, of either sign).

    Raises `BadInput` if a length is wrong or a value is not finite.
    """

def compare(problem: Problem | Scene) -> Comparison:
    """Solves a problem or a scene by interior point, active set and penalty, and compares the solutions.

    A solution that is not certified is returned as well; its certificate shows the residuals.
    """

def sensitivity(
    scene: Scene,
    of: str | Sequence[str],
    to: str | Sequence[str] | None = None,
    *,
    method: str | None = None,
    tolerance: float | None = None,
    threads: int | None = None,
    memory: float | None = None,
) -> list[dict[str, Any]]:
    """Solves a scene, and gives the derivatives of its outputs `of` with respect to its parameters `to`.

    of: outputs by name, as "force", "peak-pressure", "obstacles[0].travel", "stress@0.5,0.4:xx". to: parameters by name, as "gap",
    "young", "loads[0]", "obstacles[0].radius", or "nodes" for the places of all nodes; all numbers of the scene if left out. Others as
    in `solve`.

    One dictionary per output with `output`, `value`, `unit` and `by`; `by` has one dictionary per parameter with `parameter`, `value`,
    `unit`, `derivative` and `relative` (per cent of the output for one per cent of the parameter). A derivative is a dictionary with its
    `verdict` and `value` (proven), `left` and `right` (one-sided), `between` and `rows` (undecided), or `why` (unknown). For "nodes"
    there are also `places`, the derivatives by the coordinates of each node, one row per node.

    Raises `SceneError` for a name that does not exist, with those that do, and for a motion; and the exceptions of `solve`.
    """

def modes(
    scene: Scene,
    count: int,
    *,
    method: str | None = None,
    tolerance: float | None = None,
    threads: int | None = None,
    memory: float | None = None,
) -> dict[str, Any]:
    """The lowest natural vibrations of a scene about its equilibrium: closed contact rows stay closed, open ones stay open.

    count: number of modes, from 1 to 1000. Every material needs a density. Others as in `solve`.

    A dictionary with `modes`, `closed` and `undecided` (row indices), `unproven` (the reason if no row is proven, or None),
    `is_complete` (no frequency below the last is missed), `rigid_motions`, `mass` (of the whole bodies) and `seconds`. Each mode is a
    dictionary with `frequency` in one over time, `frequency_open` (with undecided rows open), `residual` (dimensionless),
    `participation` and `effective_mass` (in mass) for each axis, `opens` and `closes` (the `amplitude` in length, with `row`, `node` and
    `obstacle`; None if no row does), and `displacement`, one row per node, with mass 1.

    Raises `SceneError` for a count that is not allowed and for a material without density; and the exceptions of `solve`.
    """

def total_error(
    scene: Scene,
    goal: float,
    *,
    force_error: float | None = None,
    time: float | None = None,
    threads: int | None = None,
    memory: float | None = None,
) -> TotalError:
    """Refines the mesh of a scene until its error against the continuum is at most `goal`, relative in the energy norm.

    The error is guaranteed for plane strain and plane stress with what `docs/accuracy.md` lists, and estimated otherwise.

    goal: largest error |u - v| / |v|, above 0 and below 1. force_error: largest error of the contact force, half the width of its
    interval over the force; only with a guarantee. time: limit in seconds; after it the finest mesh so far is taken. threads and
    memory: as in `solve`. A result that does not reach the goal is returned as well; its `status` says so.

    Raises `BadInput` for an error out of its range, `SceneError` for a scene without an answer in the continuum and for `force_error`
    without a guarantee, `Interrupted`, with the `TotalError` so far in `solution`, after Ctrl-C, and the exceptions of `solve` for the
    first mesh.
    """

def _jvp(
    solution: Solution,
    load: ArrayLike | None,
    gap: ArrayLike | None,
    stiffness: Any,
    rows: Any,
    equality_values: ArrayLike | None,
) -> Jvp: ...
def _measured(
    problem: Problem | Scene, refinements: int, runs: int, most_full_dofs: int, time: float | None
) -> dict[str, Any]: ...
def _mortar_rows(
    slave: tuple[ArrayLike, ArrayLike, str | None],
    master: tuple[ArrayLike, ArrayLike, str | None],
    model: str,
    thickness: float,
    direction: ArrayLike | None,
    reach: float | None,
) -> dict[str, Any]: ...
def _solve_many(
    K: ArrayLike,
    f: ArrayLike,
    B: ArrayLike,
    g: ArrayLike,
    method: str | None,
    accuracy: float | str | None,
    time: float | None,
    threads: int | None,
    tolerance: float | None,
    proof: bool,
) -> dict[str, Any]: ...
def _swept(
    scene: Scene, over: str, values: ArrayLike, method: str | None, threads: int | None
) -> dict[str, Any]: ...
def _vjp(
    solution: Solution,
    displacement: ArrayLike | None,
    multiplier: ArrayLike | None,
    equality_multiplier: ArrayLike | None,
) -> Vjp: ...
