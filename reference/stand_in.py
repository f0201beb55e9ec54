"""A stand-in for the program, to test the validation itself: same command line, files and report, dense solves inside.

A scene is any JSON with a `gap`; it stands for the indented block of `elastic_block`. The environment variable
STAND_IN_FAULT makes it wrong in one of the ways below.
"""

import json
import os
import sys
from pathlib import Path

import meshio
import numpy as np

import elastic_block
from compare import energy_distance
from kkt import kkt
from problem import Answer, Problem, read_problem, write_answer, write_problem
from settle import contact_set, settle

BLOCK = dict(columns=8, layers=4)


def flipped_sign(answer: Answer) -> Answer:
    """The multiplier of the other sign convention."""
    return Answer(answer.displacement, -answer.multiplier)


def lost_factor(answer: Answer) -> Answer:
    """Half the multiplier, as from an energy without its 1/2."""
    return Answer(answer.displacement, 0.5 * answer.multiplier)


def swapped_dofs(answer: Answer) -> Answer:
    """Two neighbouring displacements exchanged in the middle."""
    u, middle = answer.displacement.copy(), answer.displacement.size // 4
    u[[middle, middle + 1]] = u[[middle + 1, middle]]
    return Answer(u, answer.multiplier)


def slightly_off(answer: Answer) -> Answer:
    """A displacement beyond the tolerance by a factor of ten."""
    return Answer(answer.displacement * (1.0 + 1e-7), answer.multiplier)


WRONG_ANSWERS = {fault.__name__: fault for fault in (flipped_sign, lost_factor, swapped_dofs, slightly_off)}
WRONG_REPORTS = {
    "overstated_bound": {"certificate": {"energy_error_bound": 1e-30}},
    "lying_status": {"status": "not_certified"},
    "wrong_force": {"contact": {"count": 1, "force": 0.0}},
}


def penalty(problem: Problem) -> Answer:
    """The answer with springs of 1e8 times the stiffness in the closed rows instead of constraints."""
    closed = settled(problem).closed
    traces, eps = problem.contact[np.flatnonzero(closed)].toarray(), 1e8 * problem.stiffness.max()
    # With v = u - B'g, which for rows of single entries shifts the closed ones to zero, nothing large cancels.
    shift = traces.T @ problem.gap[closed]
    matrix = problem.stiffness.toarray() + eps * traces.T @ traces
    v = np.linalg.solve(matrix, problem.load - problem.stiffness @ shift)
    multiplier = np.zeros(problem.rows)
    multiplier[closed] = -eps * (traces @ v)
    return Answer(v + shift, multiplier)


def settled(problem: Problem):
    """The solution from all rows closed where K is singular, else from none."""
    start = np.full(problem.rows, np.linalg.matrix_rank(problem.stiffness.toarray()) < problem.dofs)
    return settle(problem, start)


def solve(target: Path, method: str, out: Path, on_all_dofs: bool) -> int:
    """Writes the files of one solve, prints its report and returns the exit code."""
    problem = scene_problem(target) if target.is_file() else read_problem(target)
    exact = settled(problem).answer
    answer = penalty(problem) if method == "penalty" else exact
    fault = os.environ.get("STAND_IN_FAULT", "")
    if fault in WRONG_ANSWERS and method != "penalty":
        answer = WRONG_ANSWERS[fault](answer)
    if fault == "full_differs" and on_all_dofs:
        answer = Answer(answer.displacement * (1.0 + 1e-10), answer.multiplier)
    certified = kkt(problem, answer).worst() <= 1e-9 or method != "penalty"
    report = {
        "status": "certified" if certified else "not_certified",
        "method": method,
        "history": [{"closed": int(contact_set(problem, answer).sum())}],
        "contact": {"count": int(contact_set(problem, answer).sum()), "force": answer.force},
        "certificate": {"energy_error_bound": 2.0 * energy_distance(problem, answer, exact) + 1e-14},
    }
    report |= WRONG_REPORTS.get(fault, {})
    write_answer(answer, out)
    if target.is_file():
        write_vtu(answer, problem, out)
    print(json.dumps(report))
    return 0 if certified else 4


def scene_problem(path: Path) -> Problem:
    """The block of a scene file."""
    return elastic_block.indentation(json.loads(path.read_text())["gap"], **BLOCK)


def write_vtu(answer: Answer, problem: Problem, out: Path) -> None:
    """The arrays that a scene's file has, of which only u and the contact flag mean something here."""
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


def main(arguments: list[str]) -> int:
    """`export SCENE DIR` and `solve TARGET --method M --format json --out DIR [--no-condense]`."""
    if arguments[0] == "export":
        write_problem(scene_problem(Path(arguments[1])), arguments[2])
        return 0
    if os.environ.get("STAND_IN_FAULT") == "refused":
        print("the body is not held", file=sys.stderr)
        return 3
    pairs = [argument for argument in arguments[2:] if argument != "--no-condense"]
    options = dict(zip(pairs[::2], pairs[1::2], strict=True))
    return solve(Path(arguments[1]), options["--method"], Path(options["--out"]), "--no-condense" in arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
