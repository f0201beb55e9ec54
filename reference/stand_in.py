"""A stand-in for the package and the program, which tests the validation itself. It uses dense solves and can plant each fault below."""

import subprocess
from pathlib import Path
from types import SimpleNamespace

import meshio
import numpy as np
import signorini as sg

from compare import energy_distance
from kkt import kkt
from problem import Answer, Problem, problem_of
from program import problem_of_scene
from settle import contact_set, settle

BLOCK = dict(columns=8, layers=4)


def flipped_sign(answer: Answer) -> Answer:
    """Returns the answer with the multiplier in the other sign convention."""
    return Answer(answer.displacement, -answer.multiplier)


def lost_factor(answer: Answer) -> Answer:
    """Returns the answer with half the multiplier, as from an energy without its factor 1/2."""
    return Answer(answer.displacement, 0.5 * answer.multiplier)


def swapped_dofs(answer: Answer) -> Answer:
    """Returns the answer with two neighbouring displacements exchanged."""
    u, middle = answer.displacement.copy(), answer.displacement.size // 4
    u[[middle, middle + 1]] = u[[middle + 1, middle]]
    return Answer(u, answer.multiplier)


def slightly_off(answer: Answer) -> Answer:
    """Returns the answer with a displacement error of ten tolerances."""
    return Answer(answer.displacement * (1.0 + 1e-7), answer.multiplier)


WRONG_ANSWERS = {fault.__name__: fault for fault in (flipped_sign, lost_factor, swapped_dofs, slightly_off)}
WRONG_WORDS = {
    "overstated_bound": {"energy_error_bound": 1e-30},
    "wrong_count": {"contact_set": np.array([0])},
    "wrong_force": {"contact_force": 0.0},
}


def penalty(problem: Problem) -> Answer:
    """Returns the answer with springs of 1e8 times the stiffness in the closed rows instead of constraints."""
    closed = settled(problem).closed
    traces, eps = problem.contact[np.flatnonzero(closed)].toarray(), 1e8 * problem.stiffness.max()
    # The unknown v = u - B'g avoids cancellation: for rows of single entries it shifts the closed gaps to zero.
    shift = traces.T @ problem.gap[closed]
    matrix = problem.stiffness.toarray() + eps * traces.T @ traces
    v = np.linalg.solve(matrix, problem.load - problem.stiffness @ shift)
    multiplier = np.zeros(problem.rows)
    multiplier[closed] = -eps * (traces @ v)
    return Answer(v + shift, multiplier)


def settled(problem: Problem):
    """Returns the solution, beginning with all rows closed if K is singular, and otherwise with no closed row."""
    start = np.full(problem.rows, np.linalg.matrix_rank(problem.stiffness.toarray()) < problem.dofs)
    return settle(problem, start)


def solve(given: sg.Problem, *, method: str, condense: bool, proof: bool, fault: str = "") -> SimpleNamespace:
    """Returns or raises the same as `signorini.solve`."""
    if fault == "refused":
        raise sg.UnderHeld("the body is not held")
    problem = problem_of(given.K, given.f, given.B, given.g)
    exact = settled(problem).answer
    answer = penalty(problem) if method == "penalty" else exact
    if fault in WRONG_ANSWERS and method != "penalty":
        answer = WRONG_ANSWERS[fault](answer)
    if fault == "full_differs" and not condense:
        answer = Answer(answer.displacement * (1.0 + 1e-10), answer.multiplier)
    closed = np.flatnonzero(contact_set(problem, answer))
    reported = {
        "u": answer.displacement,
        "multiplier": answer.multiplier,
        "method": method,
        "seconds": 0.0,
        "history": [(closed, 0.0)],
        "contact_set": closed,
        "contact_force": answer.force,
        "energy_error_bound": 2.0 * energy_distance(problem, answer, exact) + 1e-14,
    }
    solution = SimpleNamespace(**reported | WRONG_WORDS.get(fault, {}))
    if fault == "not_certified" or (method == "penalty" and kkt(problem, answer).worst() > 1e-9):
        fell_short = sg.NotCertified("not certified")
        fell_short.solution = solution
        raise fell_short
    return solution


def run(arguments: list[str], **_) -> subprocess.CompletedProcess:
    """Replaces `subprocess.run` for `signorini solve SCENE ... --out OUT`."""
    problem, out = problem_of_scene(Path(arguments[2])), Path(arguments[-1])
    out.mkdir()
    write_vtu(settled(problem).answer, problem, out)
    return subprocess.CompletedProcess(arguments, 0, "", "")


def write_vtu(answer: Answer, problem: Problem, out: Path) -> None:
    """Writes the arrays of a scene's file; only u and the contact flag have meaningful values here."""
    x, y = np.meshgrid(np.linspace(0, 1, BLOCK["columns"] + 1), np.linspace(0, 0.5, BLOCK["layers"] + 1))
    points = np.column_stack([x.ravel(), y.ravel(), 0.0 * x.ravel()])
    u = np.zeros_like(points)
    u[BLOCK["columns"] + 1 :, :2] = answer.displacement.reshape(-1, 2)
    scalars = ("sigma_1", "sigma_2", "von_mises", "gap", "remaining_gap", "pressure", "contact")
    arrays = {name: np.zeros(len(points)) for name in scalars}
    arrays |= {name: np.zeros((len(points), 3)) for name in ("reaction", "contact_force", "normal")}
    arrays["stress"] = np.zeros((len(points), 6))
    arrays["contact"][-problem.rows :] = contact_set(problem, answer)
    cell = [[0, 1, BLOCK["columns"] + 2, BLOCK["columns"] + 1]]
    meshio.Mesh(points, [("quad", cell)], point_data={"u": u, **arrays}).write(out / "scene.vtu")
