"""Compares derivatives of small quadratic programs with those of diffcp and cvxpylayers, at kinks and elsewhere, and prints a table.

    pip install -r reference/requirements-derivatives.txt
    python reference/derivatives.py [--count 100]

The programs are those of kinks.py, whose exact derivatives are known by rational arithmetic; every second one is exactly at a kink. A random
output a'u + c'lambda is differentiated with respect to load and gap. Solve and gradient are one run; its time is that of the second of
two. Every package gets the same doubles. diffcp and cvxpylayers see the factor of K by numpy, since their derivatives take no quadratic
objective except in the mode `lpgd`. Their solver is Clarabel, asked for 1e-12.

| column | meaning |
|---|---|
| away | programs away from kinks whose gradient is returned |
| error | the largest difference from the exact gradient, relative to its largest entry: median and largest over these programs |
| ms | the time, median over all programs |
| at kinks, says | number of programs at a kink in which the package says so: by a verdict, a warning or an exception |
| open, closed, mean, other | the gradient that it returns at kinks, to 1e-3: with the weak rows open, closed, the mean of both, another |
| one side | programs at a kink in which that gradient, times a random change of load and gap, is the derivative to one side, to 1e-3 |

The exit code is 1 if a derivative of signorini that it calls proven or one-sided is off by more than 1e-9, or proven at a kink.
"""

import argparse
import importlib.metadata
import os
import statistics
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

# Threads cost more than they give here. This must stand before the first import of numpy.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from scipy import sparse

import kinks

WRONG = 1e-9
"""Relative error above which a proven derivative of signorini is wrong."""
ALIKE = 1e-3
"""Relative difference up to which a gradient at a kink counts as that of a piece."""
TAU = 0.01
"""The step of `lpgd`. At kinks a smaller one leaves less of the digits of the solver; a larger one may step over a kink that is near."""
TIGHT = {"tol_gap_abs": 1e-12, "tol_gap_rel": 1e-12, "tol_feas": 1e-12}

Gradient = tuple[np.ndarray, np.ndarray]


@dataclass
class Found:
    """What a package says about one program."""

    gradient: Gradient | None
    """The derivatives by load and gap; None if it returns none."""
    says: str = ""
    """The verdict, warning or exception, if there is one."""
    sides: tuple[float, float] | None = None
    """The derivatives along the change to the left and to the right, if the package has them."""


def by_signorini(given: kinks.Kink) -> Found:
    import signorini as sg

    solution = sg.solve(sg.Problem(given.stiffness, given.load, given.contact, given.gap))
    found = solution.vjp(*given.output)
    if found.verdict == "proven":
        return Found((found.load, found.gap))
    return Found(None, f"{found.verdict}: {sorted(found.rows_at_kink.tolist())}")


def sides_by_signorini(given: kinks.Kink) -> tuple[float, float] | None:
    """Returns the derivatives along the change to the left and to the right, if the package calls them one-sided."""
    import signorini as sg

    solution = sg.solve(sg.Problem(given.stiffness, given.load, given.contact, given.gap))
    found = solution.jvp(*given.change)
    if found.verdict != "one-sided":
        return None
    by_u, by_lambda = given.output
    left, right = (by_u @ side.displacement + by_lambda @ side.multiplier for side in (found.left, found.right))
    return float(left), float(right)


def by_diffcp(mode: str) -> Callable[[kinks.Kink], Found]:
    """minimise t - f'u  subject to  B u <= g,  t >= 1/2 |L'u|^2, with the unknowns u and t and K = L L'."""
    import diffcp

    def solve(given: kinks.Kink) -> Found:
        n, m = len(given.load), len(given.gap)
        factor = np.linalg.cholesky(given.stiffness).T
        # |(t - 1, sqrt 2 L'u)| <= t + 1
        cone = np.zeros((n + 2, n + 1))
        cone[0, n], cone[1, n], cone[2:, :n] = -1.0, -1.0, -np.sqrt(2.0) * factor
        A = sparse.csc_matrix(np.vstack([np.hstack([given.contact, np.zeros((m, 1))]), cone]))
        b = np.concatenate([given.gap, [1.0, -1.0], np.zeros(n)])
        c = np.concatenate([-given.load, [1.0]])
        cones = {diffcp.ZERO: 0, diffcp.POS: m, diffcp.SOC: [n + 2]}
        *_, adjoint = diffcp.solve_and_derivative(A, b, c, cones, mode=mode, solve_method="Clarabel", **TIGHT)
        by_u, by_lambda = given.output
        dx, dy = np.concatenate([by_u, [0.0]]), np.concatenate([-by_lambda, np.zeros(n + 2)])
        _, db, dc = adjoint(dx, dy, np.zeros(m + n + 2))
        return Found((-dc[:n], db[:m]))

    return solve


def by_lpgd(mode: str, tau: float) -> Callable[[kinks.Kink], Found]:
    """The quadratic program itself, by a finite step tau of the Lagrangian proximal method."""
    import diffcp

    def solve(given: kinks.Kink) -> Found:
        n, m = len(given.load), len(given.gap)
        P, A = sparse.csc_matrix(np.triu(given.stiffness)), sparse.csc_matrix(given.contact)
        cones = {diffcp.ZERO: 0, diffcp.POS: m}
        options = {"derivative_kwargs": {"tau": tau, "rho": 0.0}, **TIGHT}
        b, c = given.gap.copy(), -given.load
        *_, adjoint = diffcp.solve_and_derivative(A, b, c, cones, mode=mode, solve_method="Clarabel", P=P, **options)
        by_u, by_lambda = given.output
        _, db, dc = adjoint(by_u.copy(), -by_lambda, np.zeros(m))
        return Found((-dc[:n], db[:m]))

    return solve


def by_cvxpylayers() -> Callable[[kinks.Kink], Found]:
    import cvxpy as cp
    import jax
    from cvxpylayers.jax import CvxpyLayer

    jax.config.update("jax_enable_x64", True)
    layers: dict[int, CvxpyLayer] = {}

    def layer(given: kinks.Kink) -> CvxpyLayer:
        if id(given) not in layers:
            u, load, gap = cp.Variable(len(given.load)), cp.Parameter(len(given.load)), cp.Parameter(len(given.gap))
            rows = given.contact @ u <= gap
            factor = np.linalg.cholesky(given.stiffness).T
            program = cp.Problem(cp.Minimize(0.5 * cp.sum_squares(factor @ u) - load @ u), [rows])
            layers[id(given)] = CvxpyLayer(program, parameters=[load, gap], variables=[u, rows.dual_variables[0]])
        return layers[id(given)]

    def prepare(given: kinks.Kink) -> None:
        layer(given)

    def solve(given: kinks.Kink) -> Found:
        by_u, by_lambda = given.output

        def output(load, gap):
            u, dual = layer(given)(load, gap, solver_args={"solve_method": "Clarabel", **TIGHT})
            return by_u @ u - by_lambda @ dual

        found = jax.grad(output, argnums=(0, 1))(jax.numpy.asarray(given.load), jax.numpy.asarray(given.gap))
        return Found(tuple(np.asarray(values) for values in found))

    solve.prepare = prepare
    return solve


def packages() -> dict[str, Callable[[kinks.Kink], Found]]:
    """Returns the packages that are installed, with their modes."""
    found: dict[str, Callable[[kinks.Kink], Found]] = {"signorini": by_signorini}
    if installed("diffcp"):
        found |= {f"diffcp, {mode}": by_diffcp(mode) for mode in ("lsqr", "dense")}
        found |= {f"diffcp, {mode}, tau {TAU:g}": by_lpgd(mode, TAU) for mode in ("lpgd", "lpgd_left", "lpgd_right")}
    if installed("cvxpylayers") and installed("jax"):
        found["cvxpylayers, jax"] = by_cvxpylayers()
    return found


def installed(name: str) -> bool:
    try:
        importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return False
    return True


@dataclass
class Row:
    """What a package makes of all programs."""

    errors: list[float] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    says: int = 0
    pieces: Counter = field(default_factory=Counter)
    one_side: int = 0

    def text(self, name: str, away: int, at_kink: int) -> str:
        error = f"{short(statistics.median(self.errors))} | {short(max(self.errors))}" if self.errors else " | "
        pieces = " | ".join(str(self.pieces[piece]) for piece in PIECES)
        says = f"{self.says} of {at_kink}"
        seconds = f"{1e3 * statistics.median(self.seconds):.2f}"
        return f"| {name} | {len(self.errors)} of {away} | {error} | {seconds} | {says} | {pieces} | {self.one_side} |"


def short(error: float) -> str:
    return f"{error:.0e}" if error else "0"


PIECES = ("open", "closed", "mean", "other")


def difference(found: Gradient, exact: Gradient) -> float:
    """Returns the largest difference relative to the largest entry of the exact gradient."""
    one, other = np.concatenate(found), np.concatenate(exact)
    return float(np.abs(one - other).max() / (np.abs(other).max() or 1.0))


def piece_of(found: Gradient, given: kinks.Kink) -> str:
    """Returns the piece that a gradient at a kink belongs to."""
    opened, closed = given.gradient(with_weak=False), given.gradient(with_weak=True)
    mean = tuple(0.5 * (one + other) for one, other in zip(opened, closed, strict=True))
    return next((name for name, piece in zip(PIECES, (opened, closed, mean)) if difference(found, piece) <= ALIKE), "other")


def is_one_side(found: Gradient, given: kinks.Kink) -> bool:
    value = sum(float(gradient @ change) for gradient, change in zip(found, given.change, strict=True))
    size = sum(float(np.abs(gradient) @ np.abs(change)) for gradient, change in zip(found, given.change, strict=True))
    return any(abs(value - given.along(sign)) <= ALIKE * size for sign in (-1, 1))


def judge(solve: Callable[[kinks.Kink], Found], programs: list[kinks.Kink]) -> Row:
    """Runs a package on all programs."""
    row = Row()
    for given in programs:
        getattr(solve, "prepare", lambda _: None)(given)
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always")
            for _ in range(2):
                began = time.perf_counter()
                try:
                    found = solve(given)
                except Exception as error:  # Any error of a foreign package is a missing gradient.
                    found = Found(None, f"{type(error).__name__}: {error}")
                seconds = time.perf_counter() - began
        row.seconds.append(seconds)
        says = found.says or "; ".join(str(warning.message) for warning in warned)
        if not given.weak:
            if found.gradient is not None:
                row.errors.append(difference(found.gradient, given.gradient(with_weak=False)))
            continue
        row.says += bool(says)
        if found.gradient is not None:
            row.pieces[piece_of(found.gradient, given)] += 1
            row.one_side += is_one_side(found.gradient, given)
    return row


def judge_sides(programs: list[kinks.Kink]) -> tuple[int, int, float]:
    """Returns for signorini at kinks: the one-sided derivatives, the kinks whose rows are named exactly, and the largest relative error."""
    claimed, named, worst = 0, 0, 0.0
    for given in programs:
        sides = sides_by_signorini(given)
        named += by_signorini(given).says == f"undecided: {list(given.weak)}"
        if sides is not None:
            claimed += 1
            exact = given.along(-1), given.along(1)
            size = max(1.0, *(abs(value) for value in exact))
            worst = max(worst, *(abs(a - b) / size for a, b in zip(sides, exact, strict=True)))
    return claimed, named, worst


def table(programs: list[kinks.Kink]) -> tuple[list[str], bool]:
    """Returns the lines of the table and of what follows it, and False if a derivative of signorini is wrong."""
    away, at_kink = (sum(bool(given.weak) == weak for given in programs) for weak in (False, True))
    lines = [
        f"| package | away | error, median | largest | ms | at kinks, says | {' | '.join(PIECES)} | one side |",
        "|---" * 11 + "|",
    ]
    is_right = True
    for name, solve in packages().items():
        row = judge(solve, programs)
        lines.append(row.text(name, away, at_kink))
        if name == "signorini":
            is_right = max(row.errors, default=0.0) <= WRONG and not row.pieces
    claimed, named, worst = judge_sides([given for given in programs if given.weak])
    sides = f"{claimed} one-sided, their largest error {short(worst)}"
    lines += ["", f"`jvp` of signorini at the {at_kink} kinks: {sides}; `vjp` names the weak rows of {named}."]
    packages_here = (name for name in ("diffcp", "cvxpylayers", "jax", "clarabel") if installed(name))
    versions = [f"{name} {importlib.metadata.version(name)}" for name in packages_here]
    lines.append(f"Versions: {', '.join(versions) or 'no other package'}.")
    return lines, is_right and worst <= WRONG


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=100, help="number of programs, half of them at a kink")
    lines, is_right = table(kinks.kinks(parser.parse_args().count))
    print("\n".join(lines))
    return 0 if is_right else 1


if __name__ == "__main__":
    sys.exit(main())
