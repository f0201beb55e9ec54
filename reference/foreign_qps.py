"""Solves quadratic programs of others, and generated ones, by signorini and by solvers of qpsolvers, and prints a table per set.

    pip install qpsolvers clarabel piqp proxsuite osqp daqp quadprog pyarrow
    python reference/foreign_qps.py                                   # all sets, all solvers: about three minutes
    python reference/foreign_qps.py --set typed --solvers signorini quadprog
    python reference/foreign_qps.py --set FOLDER                      # *.parquet of qpbenchmark, *.npz of qpsolvers
    python reference/foreign_qps.py --page docs/foreign.md            # puts the tables into the page

| set | programs |
|---|---|
| typed | from the literature, with their known minima (qp_typed.py), and programs with the shape of DUALC and QAFIRO (qp_made.py) |
| singular | 100 with a singular P and equalities and one solution, known exactly (qp_made.py) |
| unsolvable | 40 whose constraints contradict each other, or whose objective has no lower bound (qp_made.py) |
| control | 60 of model predictive control with empty rows whose h is rounding (qp_control.py) |
| forms | 70 as other fields write them: least squares, lasso, Huber, support vectors, portfolio, states, redundant rows (qp_forms.py) |

A program counts as solved to 1e-3, 1e-6 or 1e-9 if the primal and dual residual and the gap of qpbenchmark are at most this, and no
multiplier has the wrong sign by more, which qpbenchmark does not ask. If the minimum is known, `answer` counts the programs whose
objective, and x if it is known, are right to 1e-9 (relative, if they are above 1); of an unsolvable one, that the solver says so.

The exit code is 1 if signorini misses a program of a generated or typed set at 1e-9, and 2 if there is nothing to run.
"""

import argparse
import datetime
import importlib.metadata
import statistics
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import qp_control
import qp_folder
import qp_forms
import qp_made
import qp_typed
from qp_solvers import SOLVERS, Outcome, Server, available
from quadratic import Program, Residuals, residuals

TOLERANCES = (1e-3, 1e-6, 1e-9)

ANSWER = 1e-9
"""Error of the objective and of x, relative to the larger of their size and 1, up to which an answer is right."""

BEGIN, END = "<!-- tables of reference/foreign_qps.py -->", "<!-- end of the tables -->"
"""Lines of a page between which `--page` puts the tables."""


def typed() -> list[Program]:
    return qp_typed.problems() + qp_made.dualc_like() + qp_made.qafiro_like()


SETS = {
    "typed": typed, "singular": qp_made.singular, "unsolvable": qp_made.unsolvable, "control": qp_control.control, "forms": qp_forms.forms,
}


@dataclass(frozen=True)
class Judged:
    """The outcome of one solver on one program, with what it is worth."""

    problem: Program
    outcome: Outcome
    residuals: Residuals
    error: float | None
    """Error of the objective, relative if the minimum is above 1; None without an answer or without a known minimum."""
    error_of_x: float | None
    """The same for the entry of x that is farthest off."""

    def solved(self, tolerance: float) -> bool:
        """Returns `True` if all residuals are at most the tolerance; for an unsolvable program, if the solver says so."""
        return self.outcome.says_none if not self.problem.is_solvable else self.residuals.worst() <= tolerance

    def right(self) -> bool | None:
        """Returns whether the answer is the known one to ANSWER; None if none is known."""
        if not self.problem.is_solvable:
            return self.outcome.says_none
        if self.problem.minimum is None:
            return None
        known = [error for error in (self.error, self.error_of_x) if error is not None]
        return bool(known) and max(known) <= ANSWER

    def missed(self) -> str:
        """Returns why the program is missed at the smallest tolerance; empty if it is not."""
        if self.solved(TOLERANCES[-1]) and self.right() is not False:
            return ""
        if self.outcome.answer is None:
            return self.outcome.note
        if not self.problem.is_solvable:
            return "an answer where there is none"
        r, errors = self.residuals, (self.error, self.error_of_x)
        text = f"primal {r.primal:.1e}, dual {r.dual:.1e}, gap {r.gap:.1e}, sign {r.sign:.1e}"
        return text + "".join(f", {name} off by {e:.1e}" for name, e in zip(("objective", "x"), errors) if e is not None)


def judged(problem: Program, outcome: Outcome) -> Judged:
    error = error_of_x = None
    if outcome.answer is not None and problem.minimum is not None:
        least = float(problem.minimum)
        error = abs(problem.objective(outcome.answer.x) - least) / max(1.0, abs(least))
        if problem.known is not None:
            x = np.asarray(problem.known.x, dtype=float)
            error_of_x = float(np.abs(outcome.answer.x - x).max() / max(1.0, np.abs(x).max()))
    return Judged(problem, outcome, residuals(problem, outcome.answer), error, error_of_x)


def share(count: int, of: int) -> str:
    """Returns a share in percent; only all is 100 %."""
    return "100" if count == of else f"{min(100.0 * count / of, 99.9):.1f}".removesuffix(".0")


def line(solver: str, found: list[Judged]) -> str:
    """Returns the row of a solver in the table of a set."""
    answered = [one for one in found if one.outcome.answer is not None]
    cells = [f"`{solver}`"] + [share(sum(one.solved(t) for one in found), len(found)) + " %" for t in TOLERANCES]
    known = [one.right() for one in found if one.right() is not None]
    cells.append(share(sum(known), len(known)) + " %" if known else "")
    worst = max((one.residuals.worst() for one in answered), default=None)
    errors = [one.error for one in answered if one.error is not None]
    cells.append("" if worst is None else f"{worst:.1e}")
    cells.append(f"{max(errors):.1e}" if errors else "")
    seconds = [one.outcome.seconds for one in found]
    cells += [f"{statistics.median(seconds):.1e} s", f"{max(seconds):.1e} s"]
    return "| " + " | ".join(cells) + " |"


def when() -> str:
    """Returns the line above a table: the day, and the commit of the repository."""
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=Path(__file__).parent, capture_output=True, text=True, check=True)
    return f"*Printed on {datetime.date.today()} at commit {commit.stdout.strip()} by `python reference/foreign_qps.py`.*"


HEADING = "| solver | 1e-3 | 1e-6 | 1e-9 | answer | residual | objective | median | longest |\n|" + "---|" * 9


def table(name: str, problems: list[Program], solvers: list[str], limit: float) -> tuple[str, list[Judged]]:
    """Prints the table of a set as it grows; returns its text and what signorini made of each program."""
    most = max(len(problem.q) for problem in problems)
    rows = max(sum(0 if part is None else len(part) for part in (problem.h, problem.b)) for problem in problems)
    lines = [f"**{name}**: {len(problems)} programs, at most {most} unknowns and {rows} rows", "", when(), "", HEADING]
    print("\n".join(lines), flush=True)
    own: list[Judged] = []
    for solver in solvers:
        server = Server(solver, limit)
        found = [judged(problem, server.solve(problem)) for problem in problems]
        server.stop()
        lines.append(line(solver, found))
        print(lines[-1], flush=True)
        own = found if solver == "signorini" else own
    print()
    return "\n".join(lines), own


def version(solver: str) -> str:
    """Returns the name of the package of a solver and its version."""
    if solver == "signorini":
        import signorini

        return f"signorini {signorini.__version__}"
    package = "proxsuite" if solver == "proxqp" else solver
    return f"{package} {importlib.metadata.version(package)}"


def versions(solvers: list[str]) -> str:
    """Returns the sentence that names the versions of all packages."""
    return f"Versions: {', '.join(map(version, solvers + ['qpsolvers'] * (solvers != ['signorini'])))}."


def put_into(page: Path, tables: list[str]) -> None:
    """Replaces the tables of a page.

    # Errors
    `ValueError` if the page does not have the lines BEGIN and END, in this order.
    """
    text = page.read_text()
    before, begin, rest = text.partition(BEGIN + "\n")
    _, end, after = rest.partition(END + "\n")
    if not begin or not end:
        raise ValueError(f"{page} has no lines {BEGIN!r} and {END!r}")
    page.write_text(before + begin + "\n" + "\n\n".join(tables) + "\n\n" + end + after)


def options(words: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--set", nargs="+", default=list(SETS), help=f"any of {', '.join(SETS)}, or folders")
    parser.add_argument("--solvers", nargs="+", default=list(SOLVERS), help=f"any of {', '.join(SOLVERS)}")
    parser.add_argument("--limit", type=float, default=20.0, help="time limit for a program, in seconds")
    parser.add_argument("--page", type=Path, help="page whose tables are replaced")
    parser.add_argument("--keep", type=Path, help="folder for the programs that signorini misses, as *.npz")
    return parser.parse_args(words)


def main(words: list[str]) -> int:
    given = options(words)
    try:
        solvers = available(given.solvers)
        sets = {name: SETS[name]() if name in SETS else qp_folder.in_folder(Path(name)) for name in given.set}
    except (ValueError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    tables, code = [versions(solvers)], 0
    print(tables[0] + "\n")
    for name, problems in sets.items():
        text, own = table(name if name in SETS else Path(name).name, problems, solvers, given.limit)
        tables.append(text)
        for one in own:
            if reason := one.missed():
                code = 1 if name in SETS else code
                kept = f" ({qp_folder.save(one.problem, given.keep)})" if given.keep else ""
                print(f"signorini misses {one.problem.name}: {reason}{kept}", flush=True)
    if given.page:
        put_into(given.page, tables)
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
