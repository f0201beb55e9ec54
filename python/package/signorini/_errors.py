"""The exceptions. Each message says what is wrong, at which place, which value was found, and what is allowed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from signorini._signorini import SceneSolution


class SignoriniError(Exception):
    """Base class of all exceptions of this package except `Interrupted`.

    Attributes
    ----------
    code : str
        Short name of the kind of error. It is the same in every version and in the reports of the program.
    """

    code: str = "error"


class BadInput(SignoriniError, ValueError):
    """An argument, a scene or a setting with a value that is not allowed."""

    code = "bad-input"


class BadType(BadInput, TypeError):
    """An argument of a wrong type, for example a complex array as load."""

    code = "bad-type"


class NotConvex(BadInput):
    """A stiffness with a negative eigenvalue: the problem has no unique minimum."""

    code = "not-convex"


class SceneError(BadInput):
    """A scene whose JSON or whose values do not describe a problem.

    Attributes
    ----------
    path : str
        JSON path of the value, for example "obstacles[0].approach".
    line : int or None
        Line in the file, counted from 1; None if the scene is not from a file.
    column : int or None
        Column in the file, counted from 1; None if the scene is not from a file.
    """

    code = "scene"
    path: str = ""
    line: int | None = None
    column: int | None = None


class FileError(SignoriniError, OSError):
    """A file that cannot be read."""

    code = "file"


class Infeasible(SignoriniError):
    """Contact rows that no displacement satisfies at the same time, or inequalities of a complementarity problem.

    Attributes
    ----------
    ray : array, shape (n,), or None
        Of a complementarity problem: y, its largest entry from 1 to 2, which shows that no z meets the inequalities.
        Without upper bounds y >= 0, M'y <= 0 and q'y < 0. `rows` and `weights` are its entries that are not zero, and
        `overlap` is what the rows demand beyond what they can give. None for a contact problem.
    rows : array of int
        Indices of the rows that contradict each other, counted from 0.
    weights : array, one per row of `rows`
        Farkas weights, >= 0: the weighted sum of the rows is zero, and that of their gaps is negative. Empty if the
        rows would contradict each other only as equalities.
    overlap : float
        Overlap of the rows, in length, with the largest weight scaled to 1.
    """

    code = "infeasible"
    rows: NDArray[np.int64]
    weights: NDArray[np.float64]
    overlap: float = 0.0
    ray: NDArray[np.float64] | None = None


class NotFound(SignoriniError):
    """No solution of a complementarity problem was found, and none is shown to be impossible. M is not monotone."""

    code = "not-found"


class Unbounded(SignoriniError):
    """The load moves the body away without end.

    Attributes
    ----------
    motion : str
        The motion in words.
    direction : array, shape (n,)
        The motion d without end, without a unit: K d = 0, B d <= 0, f'd > 0.
    """

    code = "unbounded"
    motion: str = ""
    direction: NDArray[np.float64]


class UnderHeld(SignoriniError):
    """An insufficiently supported body: nothing resists one of its motions, and no load drives it.

    The solution is not unique.

    Attributes
    ----------
    motion : str
        The motion in words.
    direction : array, shape (n,)
        The free motion, without a unit, up to a factor of either sign.
    """

    code = "under-held"
    motion: str = ""
    direction: NDArray[np.float64]


class NotCertified(SignoriniError):
    """A solution was found, but it does not meet the tolerance.

    Attributes
    ----------
    solution : Solution or LcpSolution
        The best solution, with its certificate.
    condition : str
        Name of the condition that misses most.
    value : float
        The relative value of this condition.
    tolerance : float
        The value that is allowed for it.
    """

    code = "not-certified"
    solution: Any
    condition: str = ""
    value: float = 0.0
    tolerance: float = 0.0


class BeyondSmallDisplacements(SignoriniError):
    """A solution of a scene that the equations of small displacements do not describe.

    A strain is above 50 %, a rotation above 0.5 rad, or a contact row starts deeper inside its obstacle than its body is
    thick. The sentence names the place and the likely cause. `Scene(..., linear=True)` gives the solution all the same.

    Attributes
    ----------
    solution : SceneSolution
        The solution of small displacements, with its certificate.
    """

    code = "beyond-small-displacements"
    solution: SceneSolution


class Undecided(SignoriniError):
    """It could not be decided whether the problem has a solution, and only one. The sentence says why."""

    code = "undecided"


class NoDerivative(SignoriniError):
    """A derivative that is not proven: the solution has a kink, or may have one. The sentence names the rows.

    Attributes
    ----------
    verdict : str
        "one-sided", "undecided" or "unknown".
    rows : array of int
        Indices of the rows that may be open or closed, counted from 0; empty if nothing is known.
    """

    code = "no-derivative"
    verdict: str = ""
    rows: NDArray[np.int64]


class OutOfTime(SignoriniError, TimeoutError):
    """A step that cannot be interrupted is estimated to take longer than the remaining time.

    Attributes
    ----------
    needed : float
        Estimated duration of the step, in seconds.
    time : float
        Remaining time, in seconds.
    """

    code = "out-of-time"
    needed: float = 0.0
    time: float = 0.0


class TooLarge(SignoriniError, MemoryError):
    """A problem that needs more memory than is available or allowed.

    Attributes
    ----------
    bytes : float
        Estimated memory that the problem needs, in bytes.
    allowed : float
        Memory that may be used, in bytes.
    """

    code = "too-large"
    bytes: float = 0.0
    allowed: float = 0.0


class NumericalError(SignoriniError, ArithmeticError):
    """A computation that failed numerically, for example by numbers beyond the range of doubles."""

    code = "numerical"


class InternalError(SignoriniError, RuntimeError):
    """A fault of the library itself. Please report it."""

    code = "internal"


class Interrupted(KeyboardInterrupt):
    """The work was interrupted. It is not an `Exception`, so that `except Exception` does not catch it by accident.

    Attributes
    ----------
    code : str
        "interrupted".
    solution : Solution, SceneSolution, TotalError or None
        The best solution so far; None if there was none yet.
    """

    code: str = "interrupted"
    solution: Any = None
