"""The exceptions. Each message says what is wrong, at which place, which value was found, and what is allowed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from signorini._signorini import Solution


class SignoriniError(Exception):
    """Base class of all exceptions of this package except `Interrupted`."""

    code: str = "error"
    """Short name of the kind of error. It is the same in every version and in the reports of the program."""


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
    """A scene whose JSON or whose values do not describe a problem."""

    code = "scene"
    path: str = ""
    """JSON path of the value, for example `obstacles[0].approach`."""
    line: int | None = None
    """Line in the file, counted from 1; None if the scene is not from a file."""
    column: int | None = None
    """Column in the file, counted from 1; None if the scene is not from a file."""


class FileError(SignoriniError, OSError):
    """A file that cannot be read."""

    code = "file"


class Infeasible(SignoriniError):
    """Contact rows that no displacement satisfies at the same time."""

    code = "infeasible"
    rows: NDArray[np.int64]
    """Indices of the rows that contradict each other, counted from 0."""
    weights: NDArray[np.float64]
    """Farkas weights of these rows, >= 0: the weighted sum of the rows is zero, that of their gaps is negative."""
    overlap: float = 0.0
    """Overlap of the rows in the unit of length, with the largest weight scaled to 1."""


class Unbounded(SignoriniError):
    """The load moves the body away without end."""

    code = "unbounded"
    motion: str = ""
    """The motion in words."""
    direction: NDArray[np.float64]
    """The motion d without end, length n: K d = 0, B d <= 0, f'd > 0."""


class UnderHeld(SignoriniError):
    """An insufficiently supported body: nothing resists one of its motions, and no load drives it. The answer is not unique."""

    code = "under-held"
    motion: str = ""
    """The motion in words."""
    direction: NDArray[np.float64]
    """The free motion, length n."""


class NotCertified(SignoriniError):
    """An answer was found, but it does not meet the tolerance."""

    code = "not-certified"
    solution: Solution
    """The best answer, with its certificate."""
    condition: str = ""
    """Name of the condition with the largest residual."""
    value: float = 0.0
    """Relative residual of this condition."""
    tolerance: float = 0.0
    """The tolerance that was requested."""


class Undecided(SignoriniError):
    """It could not be decided whether the problem has an answer, and only one; the sentence says why."""

    code = "undecided"


class NoDerivative(SignoriniError):
    """A derivative was asked for that is not proven: the answer has a kink, or may have one; the sentence names the rows."""

    code = "no-derivative"
    verdict: str = ""
    """`one-sided`, `undecided` or `unknown`."""
    rows: NDArray[np.int64]
    """Indices of the rows that may be open or closed, counted from 0; empty if nothing is known."""


class OutOfTime(SignoriniError, TimeoutError):
    """A step that cannot be interrupted is estimated to take longer than the remaining time."""

    code = "out-of-time"
    needed: float = 0.0
    """Estimated duration of the step, in seconds."""
    time: float = 0.0
    """Remaining time, in seconds."""


class TooLarge(SignoriniError, MemoryError):
    """A problem that needs more memory than is available or allowed."""

    code = "too-large"
    bytes: float = 0.0
    """Estimated memory that the problem needs, in bytes."""
    allowed: float = 0.0
    """Memory that may be used, in bytes."""


class NumericalError(SignoriniError, ArithmeticError):
    """A computation that failed numerically, for example by numbers beyond the range of doubles."""

    code = "numerical"


class InternalError(SignoriniError, RuntimeError):
    """A fault of the library itself. Please report it."""

    code = "internal"


class Interrupted(KeyboardInterrupt):
    """The work was interrupted. It is not an `Exception`, so that `except Exception` does not catch it by accident."""

    code: str = "interrupted"
    solution: Any = None
    """The best answer so far, with its certificate; None if there was no answer yet."""
