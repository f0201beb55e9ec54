"""Solves a quadratic program by signorini, by the solvers of qpsolvers, and by cvxpy.

`register` adds signorini to the solvers of qpsolvers. Then `qpsolvers.solve_qp(..., solver="signorini")`, and every
program that is built on qpsolvers, can use it. The interface is `signorini_.py` beside this file, which has the form of
a module in the folder `solvers` of qpsolvers: it can be put there unchanged.

Needs scipy, qpsolvers and cvxpy: `pip install "signorini[sparse]" qpsolvers cvxpy`. The solvers clarabel, osqp and
highs of qpsolvers are compared if they are installed: `pip install clarabel osqp highspy`.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from typing import Any

import numpy as np
import qpsolvers


def register() -> None:
    """Loads `signorini_.py` as a module of `qpsolvers.solvers`, and adds "signorini" to the solvers of qpsolvers."""
    from qpsolvers import solvers

    name = "qpsolvers.solvers.signorini_"
    if name in sys.modules:
        return
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name("signorini_.py"))
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.modules[name] = module
    solvers.solve_function["signorini"] = module.signorini_solve_problem
    for names in (solvers.available_solvers, solvers.dense_solvers, solvers.sparse_solvers):
        names.append("signorini")


def program(unknowns: int = 40) -> tuple[Any, ...]:
    """Returns P, q, G, h, A, b, lb, ub of a chain of springs between two walls, whose ends have the same displacement."""
    P = 2 * np.eye(unknowns) - np.eye(unknowns, k=1) - np.eye(unknowns, k=-1)
    q = -0.05 * np.sin(np.linspace(0.0, 3 * np.pi, unknowns))
    G = np.eye(unknowns, k=1)[:-1] - np.eye(unknowns)[:-1]
    A = np.zeros((1, unknowns))
    A[0, 0], A[0, -1] = 1.0, -1.0
    bound = np.full(unknowns, 1.0)
    return P, q, G, np.full(unknowns - 1, 0.08), A, np.zeros(1), -bound, 0.5 * bound


def main() -> dict[str, float]:
    """Returns the objective found by each solver."""
    register()
    data = program()
    objectives = {}
    answer = qpsolvers.solve_problem(qpsolvers.Problem(*data), solver="signorini")
    objectives["signorini by qpsolvers"] = answer.obj
    for other in ("clarabel", "osqp", "highs"):
        if other in qpsolvers.available_solvers:
            x = qpsolvers.solve_qp(*data, solver=other)
            objectives[f"{other} by qpsolvers"] = float(0.5 * x @ data[0] @ x + data[1] @ x)
    import cvxpy

    P, q, G, h, A, b, lb, ub = data
    x = cvxpy.Variable(len(q))
    objective = cvxpy.Minimize(0.5 * cvxpy.quad_form(x, cvxpy.psd_wrap(P)) + q @ x)
    objectives["cvxpy"] = float(cvxpy.Problem(objective, [G @ x <= h, A @ x == b, lb <= x, x <= ub]).solve(solver="CLARABEL"))
    for name, value in objectives.items():
        print(f"{name:24} {value:.12f}")
    print(f"residuals of signorini: {answer.primal_residual():.1e}, {answer.dual_residual():.1e}, gap {answer.duality_gap():.1e}")
    return objectives


if __name__ == "__main__":
    main()
