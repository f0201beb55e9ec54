"""The exceptions: what is wrong, where, which value, what is allowed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from signorini._signorini import Solution


class SignoriniError(Exception):
    """Everything that can go wrong between arrays or a file and a certified answer."""

    code: str = "error"
    """The name of the kind of error, the same in every version and in the reports of the program."""


class BadInput(SignoriniError, ValueError):
    """An argument, a scene or a setting with a value that is not allowed."""

    code = "bad-input"


class BadType(BadInput, TypeError):
    """An argument of a wrong kind, as a complex array for a load."""

    code = "bad-type"


class NotConvex(BadInput):
    """A stiffness with a negative eigenvalue: the problem has no unique minimum."""

    code = "not-convex"


class SceneError(BadInput):
    """A scene whose JSON or whose values do not describe a problem."""

    code = "scene"
    path: str = ""
    """JSON path of the value, as `obstacles[0].approach`."""
    line: int | None = None
    """Line in the file, from 1, where there is one."""
    column: int | None = None
    """Column in the file, from 1, where there is one."""


class FileError(SignoriniError, OSError):
    """A file that cannot be read."""

    code = "file"


class Infeasible(SignoriniError):
    """Contact rows that no displacement satisfies together."""

    code = "infeasible"
    rows: NDArray[np.int64]
    """The rows that contradict each other, from 0."""
    weights: NDArray[np.float64]
    """Farkas' weights of these rows, >= 0, under which they cancel."""
    overlap: float = 0.0
    """By how much they overlap, in length, for the largest weight 1."""


class Unbounded(SignoriniError):
    """The load moves the body away without end."""

    code = "unbounded"
    motion: str = ""
    """The motion in words."""
    direction: NDArray[np.float64]
    """The escape d, one entry per dof: K d = 0, B d <= 0, f'd > 0."""


class UnderHeld(SignoriniError):
    """A motion that nothing resists and no load drives: the answer is not unique."""

    code = "under-held"
    motion: str = ""
    """The motion in words."""
    direction: NDArray[np.float64]
    """The free motion, one entry per dof."""


class NotCertified(SignoriniError):
    """An answer was found, but it does not meet the tolerance."""

    code = "not-certified"
    solution: Solution
    """The best answer, with its certificate."""
    condition: str = ""
    """The worst condition."""
    value: float = 0.0
    """Its value."""
    tolerance: float = 0.0
    """What was asked for."""


class OutOfTime(SignoriniError, TimeoutError):
    """A step that cannot be interrupted would take longer than there is time."""

    code = "out-of-time"
    needed: float = 0.0
    """Seconds that it takes, estimated."""
    time: float = 0.0
    """Seconds that are left."""


class TooLarge(SignoriniError, MemoryError):
    """A problem that needs more memory than it may take."""

    code = "too-large"
    bytes: float = 0.0
    """Memory that it takes, estimated, in bytes."""
    allowed: float = 0.0
    """Memory that it may take, in bytes."""


class NumericalError(SignoriniError, ArithmeticError):
    """A step that failed for a reason of its own, as numbers beyond the range of doubles."""

    code = "numerical"


class InternalError(SignoriniError, RuntimeError):
    """A fault of the library itself: please report it."""

    code = "internal"


class Interrupted(KeyboardInterrupt):
    """The work was interrupted. As every KeyboardInterrupt it is no `Exception`, so that nothing swallows it by chance."""

    code: str = "interrupted"
    solution: Any = None
    """The best answer until then, with its certificate; None where there was none yet."""
