"""Frictionless unilateral contact as a convex QP, cross-checked and certified.

    minimise 1/2 u'K u - f'u   subject to   B u - g <= 0
    K u - f - B' multiplier = 0,  B u - g <= 0,  multiplier <= 0,  multiplier_i (B u - g)_i = 0

K, shape (n, n), is the stiffness after supports, symmetric and positive semidefinite. f, shape (n,), is the load. B,
shape (m, n), has the contact rows, positive towards the obstacle. g, shape (m,), has the gaps. A gap is negative if the
obstacle starts inside the body, and `inf` if the row has no obstacle. The multiplier is the force on the body along its
row, so that compression is negative.

Any consistent system of units can be used. Docstrings name a unit by its kind: "in length", "in force", "in pressure".
The package needs numpy. Some functions also need scipy, matplotlib or pyvista, and say so.

>>> import numpy as np, signorini as sg
>>> p = sg.Problem(np.array([[3.0, -1.0], [-1.0, 1.0]]), [0.0, 3.0], np.array([[0.0, 1.0]]), [1.0])
>>> s = sg.solve(p)
>>> s.u.round(12).tolist(), s.multiplier.round(12).tolist(), s.energy_error_bound < 1e-9
([0.333333333333, 1.0], [-2.333333333333], True)
"""

from signorini import qp
from signorini._errors import (
    BadInput,
    BadType,
    BeyondSmallDisplacements,
    FileError,
    Infeasible,
    InternalError,
    Interrupted,
    NoDerivative,
    NotCertified,
    NotConvex,
    NotFound,
    NumericalError,
    OutOfTime,
    SceneError,
    SignoriniError,
    TooLarge,
    Unbounded,
    Undecided,
    UnderHeld,
)
from signorini._many import Solutions, solve_many
from signorini._mortar import MortarRows, mortar_rows
from signorini._signorini import (
    Certificate,
    Comparison,
    Delassus,
    Event,
    Gradient,
    Jvp,
    LcpSolution,
    Path,
    Prepared,
    Problem,
    Proven,
    Scene,
    SceneSolution,
    Solution,
    Tangent,
    TotalError,
    Vjp,
    __version__,
    compare,
    lcp,
    modes,
    prepare,
    sensitivity,
    solve,
    solve_qp,
    total_error,
    verify,
)
from signorini._studies import Sweep, Tradeoff, sweep, tradeoff

__all__ = [
    "BadInput",
    "BadType",
    "BeyondSmallDisplacements",
    "Certificate",
    "Comparison",
    "Delassus",
    "Event",
    "FileError",
    "Gradient",
    "Infeasible",
    "InternalError",
    "Interrupted",
    "Jvp",
    "LcpSolution",
    "MortarRows",
    "NoDerivative",
    "NotCertified",
    "NotConvex",
    "NotFound",
    "NumericalError",
    "OutOfTime",
    "Path",
    "Prepared",
    "Problem",
    "Proven",
    "Scene",
    "SceneError",
    "SceneSolution",
    "SignoriniError",
    "Solution",
    "Solutions",
    "Sweep",
    "Tangent",
    "TooLarge",
    "TotalError",
    "Tradeoff",
    "Unbounded",
    "Undecided",
    "UnderHeld",
    "Vjp",
    "__version__",
    "compare",
    "lcp",
    "modes",
    "mortar_rows",
    "prepare",
    "qp",
    "sensitivity",
    "solve",
    "solve_many",
    "solve_qp",
    "sweep",
    "total_error",
    "tradeoff",
    "verify",
]
