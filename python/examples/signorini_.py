"""Solver interface for `signorini <https://pypi.org/project/signorini/>`__.

signorini solves contact problems without friction, which are convex quadratic
programs, by an active-set method with sparse factors. It recomputes the
optimality conditions of every answer from the matrices of the problem, and
bounds the distance from the minimum if there is only one. The cost matrix may
be singular. Nearly linear programs are a non-goal.

It needs signorini with scipy: ``pip install "signorini[sparse]" qpsolvers``.

**Warm-start:** this solver interface supports warm starting
"""

import time
from typing import Optional, Union

import numpy as np
import scipy.sparse as spa
import signorini

from ..exceptions import ProblemError, SolverError
from ..problem import Problem
from ..solution import Solution


def signorini_solve_problem(
    problem: Problem,
    initvals: Optional[np.ndarray] = None,
    verbose: bool = False,
    **kwargs,
) -> Solution:
    """Solve a quadratic program by signorini.

    Parameters
    ----------
    problem :
        The program, with dense or sparse matrices.
    initvals :
        A point near the solution, from which the method starts.
    verbose :
        If `True`, print the extras of the solution.

    Returns
    -------
    :
        The solution. Its ``extras`` are ``certificate``, the recomputed
        residuals and the error bound, ``unique``, which is ``True`` if there
        is no other solution, and ``reason``, which is a sentence if
        there is none or it was not found.

    Raises
    ------
    ProblemError :
        If the arrays do not form a convex quadratic program, for instance if
        the cost matrix has a negative eigenvalue.

    SolverError :
        If signorini fails, for instance if the memory does not suffice.

    Notes
    -----
    All other keyword arguments are options of ``signorini.solve``, as in
    ``signorini_solve_qp(P, q, G, h, tolerance=1e-12)``:

    .. list-table::
       :widths: 30 70
       :header-rows: 1

       * - Name
         - Effect
       * - ``tolerance``
         - Tolerance of the optimality conditions, each relative to the sizes
           of its terms.
       * - ``method``
         - Solution method; the default is chosen by estimated cost.
       * - ``time``
         - Time limit in seconds.
       * - ``threads``
         - Number of threads.
       * - ``memory``
         - Memory limit in bytes.
    """
    build_start_time = time.perf_counter()
    P, q, G, h, A, b, lb, ub = problem.unpack()
    solution = Solution(problem)
    solve_start_time = time.perf_counter()
    try:
        answer = signorini.qp.solve_problem(
            P, q, G, h, A, b, lb, ub, initvals=initvals, **kwargs
        )
    except signorini.BadInput as error:
        raise ProblemError(str(error)) from error
    except (
        signorini.NotCertified,
        signorini.OutOfTime,
        signorini.Undecided,
    ) as error:
        solution.found = False
        solution.extras = {"reason": str(error)}
    except signorini.SignoriniError as error:
        raise SolverError(str(error)) from error
    else:
        solution.found = answer.found
        solution.x = answer.x
        solution.obj = answer.obj
        if answer.found:
            none = np.empty((0,))
            solution.y = none if answer.y is None else answer.y
            solution.z = none if answer.z is None else answer.z
            solution.z_box = none if answer.z_box is None else answer.z_box
        solution.extras = {
            "certificate": answer.certificate,
            "reason": answer.reason,
            "unique": answer.unique,
        }
    solve_end_time = time.perf_counter()
    if verbose:
        print(solution.extras)
    solution.build_time = solve_start_time - build_start_time
    solution.solve_time = solve_end_time - solve_start_time
    return solution


def signorini_solve_qp(
    P: Union[np.ndarray, spa.csc_matrix],
    q: np.ndarray,
    G: Optional[Union[np.ndarray, spa.csc_matrix]] = None,
    h: Optional[np.ndarray] = None,
    A: Optional[Union[np.ndarray, spa.csc_matrix]] = None,
    b: Optional[np.ndarray] = None,
    lb: Optional[np.ndarray] = None,
    ub: Optional[np.ndarray] = None,
    initvals: Optional[np.ndarray] = None,
    verbose: bool = False,
    **kwargs,
) -> Optional[np.ndarray]:
    r"""Solve a quadratic program by signorini:

    .. math::

        \min_x \tfrac{1}{2} x^T P x + q^T x \quad \text{such that} \quad
        G x \leq h, \; A x = b, \; lb \leq x \leq ub

    Parameters
    ----------
    P :
        Cost matrix, symmetric and positive semidefinite.
    q :
        Cost vector.
    G :
        Matrix of the inequalities.
    h :
        Right-hand sides of the inequalities.
    A :
        Matrix of the equalities.
    b :
        Right-hand sides of the equalities.
    lb :
        Lower bounds on x.
    ub :
        Upper bounds on x.
    initvals :
        A point near the solution, from which the method starts.
    verbose :
        If `True`, print the extras of the solution.

    Returns
    -------
    :
        The solution x, or ``None`` if there is none or it was not found.
    """
    problem = Problem(P, q, G, h, A, b, lb, ub)
    solution = signorini_solve_problem(problem, initvals, verbose, **kwargs)
    return solution.x if solution.found else None
