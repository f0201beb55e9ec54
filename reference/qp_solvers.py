"""Solves quadratic programs by signorini and by the solvers of qpsolvers, each in a process of its own with a time limit.

The settings of the other solvers are those that qpbenchmark calls `high_accuracy`: absolute tolerances of 1e-9 on the three residuals
where a solver has them, and relative ones of 0.
"""

import multiprocessing
import time
import warnings
from dataclasses import dataclass

import numpy as np

from quadratic import Answer, Program, program

SETTINGS = {
    "clarabel": {"tol_feas": 1e-9, "tol_gap_abs": 1e-9, "tol_gap_rel": 0.0},
    "piqp": {
        "eps_abs": 1e-9, "eps_rel": 0.0, "check_duality_gap": True, "eps_duality_gap_abs": 1e-9, "eps_duality_gap_rel": 0.0,
    },
    "proxqp": {
        "eps_abs": 1e-9, "eps_rel": 0.0, "check_duality_gap": True, "eps_duality_gap_abs": 1e-9, "eps_duality_gap_rel": 0.0,
    },
    "osqp": {"eps_abs": 1e-9, "eps_rel": 0.0},
    "daqp": {"primal_tol": 1e-9, "dual_tol": 1e-9},
    "quadprog": {},
}

SOLVERS = ("signorini", *SETTINGS)

WARM_UP_SECONDS = 60.0
"""Time limit for the start of a process and its imports."""


@dataclass(frozen=True)
class Outcome:
    """What a solver returned for a program."""

    answer: Answer | None
    says_none: bool
    """`True` if the solver says that there is no solution. qpsolvers does not tell this from a failure without an exception."""
    seconds: float
    note: str
    """Why there is no answer; empty if there is one."""


def answer_of(found, n: int) -> Answer:
    """Converts a solution of `signorini.qp` or of qpsolvers, both of which have None or nothing for constraints that are not there."""
    filled = lambda values, length: np.zeros(length) if values is None or len(values) == 0 else np.array(values, dtype=float)
    return Answer(np.array(found.x, dtype=float), filled(found.z, 0), filled(found.y, 0), filled(found.z_box, n))


def by_signorini(problem: Program) -> Outcome:
    import signorini

    start = time.perf_counter()
    try:
        found = signorini.qp.solve_problem(*problem.data)
    except signorini.SignoriniError as error:
        return Outcome(None, False, time.perf_counter() - start, f"{type(error).__name__}: {error}")
    seconds = time.perf_counter() - start
    return Outcome(answer_of(found, len(problem.q)) if found.found else None, not found.found, seconds, found.reason)


def by_qpsolvers(problem: Program, solver: str) -> Outcome:
    """Solves by a solver of qpsolvers. The conversion to sparse matrices, for a solver that knows no others, is not timed."""
    import qpsolvers
    from scipy import sparse

    data = [None if part is None else part.copy() for part in problem.data]
    if solver not in qpsolvers.dense_solvers:
        data = [sparse.csc_matrix(part) if part is not None and part.ndim == 2 else part for part in data]
    given = qpsolvers.Problem(*data)
    start = time.perf_counter()
    try:
        found = qpsolvers.solve_problem(given, solver, **SETTINGS[solver])
    except Exception as error:  # Any error of a foreign solver is a missing answer.
        return Outcome(None, False, time.perf_counter() - start, f"{type(error).__name__}: {error}")
    seconds = time.perf_counter() - start
    if not found.found or found.x is None:
        return Outcome(None, True, seconds, "no solution found")
    return Outcome(answer_of(found, len(problem.q)), False, seconds, "")


def solve(problem: Program, solver: str) -> Outcome:
    return by_signorini(problem) if solver == "signorini" else by_qpsolvers(problem, solver)


def serve(connection, solver: str) -> None:
    """Solves what arrives until the other end closes."""
    warnings.simplefilter("ignore")
    solve(program("warm-up", np.eye(2), np.ones(2), [[1.0, 1.0]], [1.0]), solver)
    connection.send(None)
    while True:
        try:
            problem = connection.recv()
        except EOFError:
            return
        connection.send(solve(problem, solver))


class Server:
    """A process that solves by one solver. It is ended and started again if it takes longer than `limit` seconds or crashes."""

    def __init__(self, solver: str, limit: float) -> None:
        self.solver, self.limit = solver, limit
        self.process = None

    def start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, other = context.Pipe()
        self.process = context.Process(target=serve, args=(other, self.solver), daemon=True)
        self.process.start()
        other.close()
        if not self.connection.poll(WARM_UP_SECONDS):
            raise RuntimeError(f"{self.solver} does not start")
        self.connection.recv()

    def stop(self) -> None:
        if self.process is not None:
            self.process.kill()
            self.process.join()
            self.connection.close()
        self.process = None

    def solve(self, problem: Program) -> Outcome:
        """Returns the outcome; at the time limit, and if the process ends, one without an answer."""
        if self.process is None:
            self.start()
        try:
            self.connection.send(problem)
            if self.connection.poll(self.limit):
                return self.connection.recv()
            note, seconds = f"no answer within {self.limit:g} s", self.limit
        except (EOFError, ConnectionError):
            note, seconds = "the process of the solver ended", self.limit
        self.stop()
        return Outcome(None, False, seconds, note)


def available(names: list[str]) -> list[str]:
    """Returns the named solvers.

    # Errors
    `ValueError` if one is unknown or not installed.
    """
    others = [name for name in names if name != "signorini"]
    installed: list[str] = []
    if others:
        import qpsolvers

        installed = qpsolvers.available_solvers
    for name in others:
        if name not in SETTINGS:
            raise ValueError(f"there is no solver {name!r} here; there are {', '.join(SOLVERS)}")
        if name not in installed:
            raise ValueError(f"{name} is not installed: pip install qpsolvers {'proxsuite' if name == 'proxqp' else name}")
    return names
