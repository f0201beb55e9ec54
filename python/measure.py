"""Measures the cost of calling the library from Python: `python python/measure.py`, with the package installed.

Six figures are printed: the time to read a stiffness of 8 million entries, compared with the solve by its factor; the time of a solve
of two springs, compared with the time inside the library; the same for the next gap of a block of 131,584 dofs; and the time until an
interrupt is answered; the time of small dense problems, beside those solvers of qpsolvers that are installed; and that of 10,000 of them
at once.
"""

from __future__ import annotations

import argparse
import gc
import os
import signal
import threading
import time
from collections.abc import Callable

import numpy as np
import signorini as sg
from scipy import sparse


def fastest(work: Callable[[], object], runs: int) -> float:
    """Returns the processor seconds of the fastest run. Time of other programs is not counted."""
    seconds = []
    for _ in range(runs):
        gc.collect()
        began = time.process_time()
        work()
        seconds.append(time.process_time() - began)
    return min(seconds)


def block(cells: int) -> sg.Scene:
    """Returns an elastic block of `cells` x `cells` Q4 elements under a parabola, fixed at its bottom."""
    side = {"points": [0, 1], "divisions": [cells]}
    parabola = {"parabola": {"apex": [0.5, 1], "radius": 1}}
    return sg.Scene(
        {
            "body": {"rectangle": {"x": side, "y": side, "element": "q4"}},
            "material": {"young": 1e7, "poisson": 0.3},
            "supports": [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}],
            "obstacles": [{"boundary": "top", "approach": "+y", "rule": "approach", "shape": parabola}],
            "gap": -0.01,
        }
    )


def transfer(cells: int) -> None:
    """Measures the reading of a stiffness, compared with the solve by its factor."""
    problem = block(cells).problem
    K, f, B, g = problem.K, problem.f, problem.B, problem.g
    forms = {"csc, 64-bit indices": K, "csc, 32-bit indices": sparse.csc_array(K), "csr, 32-bit indices": sparse.csr_array(K)}
    for name in list(forms)[1:]:
        matrix = forms[name]
        matrix.indices, matrix.indptr = matrix.indices.astype(np.int32), matrix.indptr.astype(np.int32)
    solve = fastest(lambda: sg.solve(problem, method="active-set", proof=False), 2)
    print(f"stiffness of {K.nnz} entries, {problem.dofs} dofs; solve by the factor {solve:.3f} s")
    for name, matrix in forms.items():
        read = fastest(lambda matrix=matrix: sg.Problem(matrix, f, B, g), 5)
        print(f"  reading {name}: {read:.4f} s, {100 * read / solve:.2f} % of the solve")


def two_springs(calls: int) -> None:
    """Measures how many microseconds a call takes in addition to those of the library."""
    problem = sg.Problem(np.array([[3.0, -1.0], [-1.0, 1.0]]), [0.0, 3.0], np.array([[0.0, 1.0]]), [1.0])
    for name, solve in (
        ("solve", lambda: sg.solve(problem)),
        ("solve, and its arrays", lambda: [answer := sg.solve(problem), answer.u, answer.multiplier, answer.contact_set][0]),
    ):
        for _ in range(calls // 10):
            solve()
        above = []
        for _ in range(calls):
            began = time.perf_counter()
            answer = solve()
            above.append(1e6 * (time.perf_counter() - began - answer.seconds))
        own = 1e6 * answer.seconds
        print(f"two springs, {name}: {np.median(above):.1f} microseconds above the library's {own:.0f}")


def next_gap(cells: int, gaps: int) -> None:
    """Measures the solve for the next gap from Python, compared with the time inside the library."""
    problem = block(cells).problem
    prepared = sg.prepare(problem, gaps=gaps, method="active-set", proof=False)
    answer = prepared.solve()
    ratios = []
    for step in range(gaps):
        g = problem.g - 1e-4 * step
        began = time.perf_counter()
        answer = prepared.solve(g, start=answer)
        answer.u, answer.multiplier, answer.contact_set
        wall = time.perf_counter() - began
        ratios.append(wall / answer.seconds)
    print(f"next gap of {problem.dofs} dofs: {np.median(ratios):.4f} times the library's {answer.seconds:.4f} s")


def interrupt(cells: int) -> None:
    """Measures the time until an interrupt is answered, at several moments of a solve."""
    problem = block(cells).problem
    for method, after in (("active-set", 0.1), ("active-set", 0.5), ("mprgp", 0.3), ("qp", 0.5)):
        sent: list[float] = []

        def send(sent: list[float] = sent) -> None:
            sent.append(time.perf_counter())
            os.kill(os.getpid(), signal.SIGINT)

        threading.Timer(after, send).start()
        try:
            sg.solve(problem, method=method)
            print(f"interrupt after {after} s of {method}: it was solved before")
            time.sleep(after)
        except sg.Interrupted as stopped:
            waited = 1e3 * (time.perf_counter() - sent[0])
            carries = "an answer" if stopped.solution is not None else "no answer yet"
            print(f"interrupt after {after} s of {method}: {waited:.0f} ms, {carries}")
        except KeyboardInterrupt:
            print(f"interrupt after {after} s of {method}: it came too late")
        # Work that was left behind by an interrupt must end before the next measurement.
        time.sleep(3.0)


def dense(count: int, n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Returns K, f, B and g of random dense problems: K = A A' / n + 0.1 I, n / 2 rows."""
    rng = np.random.default_rng(n)
    a = rng.standard_normal((count, n, n))
    K = a @ a.transpose(0, 2, 1) / n + 0.1 * np.eye(n)
    K = (K + K.transpose(0, 2, 1)) / 2
    gaps = rng.uniform(0.1, 0.6, (count, n // 2))
    return K, rng.standard_normal((count, n)), rng.standard_normal((count, n // 2, n)), gaps


def small(sizes: list[int], runs: int) -> None:
    """Measures the microseconds of a small dense problem from its arrays to its answer, by several solvers."""
    try:
        import qpsolvers

        peers = [name for name in PEERS if name in qpsolvers.available_solvers]
    except ImportError:
        peers = []
    for n in sizes:
        problems = list(zip(*dense(5, n), strict=True))
        solvers: dict[str, Callable[..., object]] = {
            "signorini": lambda K, f, B, g: sg.solve(sg.Problem(K, f, B, g)),
            "signorini.qp": lambda K, f, B, g: sg.qp.solve_qp(K, -f, B, g),
        }
        for name in peers:
            solvers[name] = lambda K, f, B, g, name=name: qpsolvers.solve_qp(K, -f, B, g, solver=name)
        figures = []
        for name, solve in solvers.items():
            seconds = [min(seconds_of(lambda data=data, solve=solve: solve(*data)) for _ in range(runs)) for data in problems]
            figures.append(f"{name} {1e6 * np.mean(seconds):.0f}")
        print(f"dense problem of {n} unknowns, {n // 2} rows, microseconds: {', '.join(figures)}")


# Solvers of qpsolvers that small dense problems are compared with.
PEERS = ("daqp", "quadprog", "piqp", "proxqp", "clarabel", "osqp")


def seconds_of(work: Callable[[], object]) -> float:
    """Returns the seconds of one call."""
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def many(count: int, n: int) -> None:
    """Measures the seconds of many small problems at once."""
    arrays = dense(count, n)
    for threads in (1, 2):
        began = time.perf_counter()
        answers = sg.solve_many(*arrays, threads=threads)
        seconds = time.perf_counter() - began
        certified = int(answers.certified.sum())
        print(f"{count} dense problems of {n} unknowns, {threads} threads: {seconds:.2f} s, {certified} certified")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--short", action="store_true", help="smaller bodies and fewer calls")
    parser.add_argument("--small", action="store_true", help="small dense problems only")
    given = parser.parse_args()
    short = given.short
    small([10, 30] if short else [10, 30, 100, 200], 10 if short else 50)
    many(1_000 if short else 10_000, 30)
    if given.small:
        return
    two_springs(2_000 if short else 20_000)
    next_gap(64 if short else 256, 10)
    interrupt(200 if short else 400)
    transfer(120 if short else 512)


if __name__ == "__main__":
    main()
