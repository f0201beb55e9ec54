"""Checks the program against independent solvers: `python reference/validate.py [--signorini PATH]`.

Every case is solved by cvxpy and OSQP. Each answer is settled on its own contact set, and compared with the others, with closed forms
and with dense oracles. The package solves the case by its three methods; its answers, and the files that the program writes, are
compared with all of these. The exit code is 1 on any disagreement, and 2 if there is nothing to run.
"""

import argparse
import sys
import tempfile
import time
from fnmatch import fnmatch
from pathlib import Path

import signorini as sg

import oracles
import snapshot
import table
from cases import CLOSED_FORM_TOLERANCE, RAW_CASES, SCENE_CASES, Case, scene_file
from compare import EXACT, RAW, Verdict, broken, judge
from kkt import Rejected
from problem import Answer, Problem
from program import METHODS, ProgramFailed, bound_faults, condensation_faults, problem_of_scene, report_faults, solve, write_files
from settle import Settled, Unsettled, contact_set, settle
from solvers import SOLVERS, NoAnswer, by_complementarity
from twin import twin_faults
from vtu import vtu_faults

ROOT = Path(__file__).resolve().parent.parent

COMPLEMENTARITY_ROWS = 2_000
"""Rows of the largest complementarity problem: its matrix is dense."""


def independent(case: Case, problem: Problem) -> tuple[dict[str, Settled], list[Verdict]]:
    """Returns the settled answer of each solver by its name, and the verdicts on raw and settled answers."""
    raw, settled, verdicts = {}, {}, []
    for name, solver in SOLVERS.items():
        try:
            raw[name] = solver(problem)
            settled[name] = settle(problem, contact_set(problem, raw[name].answer))
        except (NoAnswer, Unsettled, Rejected) as error:
            verdicts.append(broken(case.name, name, f"{type(error).__name__}: {error}"))
    references = [result.answer for result in settled.values()]
    for name, result in settled.items():
        verdicts.append(
            judge(case.name, name, problem, raw[name].answer, references, RAW, False, note=raw[name].status)
        )
        note = f"{result.exchanged} rows exchanged" if result.exchanged else ""
        verdicts.append(judge(case.name, name + ", settled", problem, result.answer, references, EXACT, note=note))
    return settled, verdicts


def known(case: Case, problem: Problem, settled: dict[str, Settled]) -> list[Verdict]:
    """Compares the settled answers with closed forms, with a twin assembled here and with a dense oracle."""
    references = [result.answer for result in settled.values()]
    verdicts = []
    if case.expected:
        faults = []
        for expected in case.expected:
            found = expected.measure(problem, references[0])
            scale = abs(expected.value) or abs(problem.load).max()
            if not abs(found - expected.value) <= CLOSED_FORM_TOLERANCE * scale:
                faults.append(f"{expected.quantity} {found:.12g}, in closed form {expected.value:.12g}")
        verdicts.append(judge(case.name, "closed form", problem, references[0], references, EXACT, failures=faults))
    if case.twin:
        faults = twin_faults(problem, references[0], case.twin())
        verdicts.append(judge(case.name, "assembled again", problem, references[0], references, EXACT, failures=faults))
    try:
        if problem.rows <= oracles.ENUMERATED_ROWS and problem.dofs <= oracles.LOOP_DOFS:
            found, name = oracles.enumerate_contact_sets(problem), "all contact sets"
        elif problem.dofs <= oracles.LOOP_DOFS:
            found, name = oracles.active_set_loop(problem), "dense active set"
        else:
            return verdicts
    except (oracles.Cycled, ValueError) as error:
        return [*verdicts, broken(case.name, "dense oracle", str(error))]
    return [*verdicts, judge(case.name, name, problem, found, references, EXACT)]


def tested(case: Case, problem: Problem, references: list[Answer], method: str) -> Verdict:
    """Judges the answer of the package by a method: condensed, and for an exact method on all dofs as well."""
    name = f"signorini {method}"
    try:
        result = solve(problem, method)
        faults = report_faults(problem, method, result) + bound_faults(problem, result, references)
        # The penalty answer is approximate with a stated bound; the other two are exact.
        exact = method != "penalty"
        if exact:
            faults += condensation_faults(problem, result, solve(problem, method, condense=False))
        note = f"{result.reported.seconds:.2f} s" + ("" if exact else f", bound {result.reported.energy_error_bound:.1e}")
        tolerances = EXACT if exact else RAW
        return judge(case.name, name, problem, result.answer, references, tolerances, exact, faults, note)
    except (sg.SignoriniError, ValueError) as error:
        return broken(case.name, name, str(error))


def pictured(case: Case, scene: Path, program: Path, folder: Path, problem: Problem, references) -> Verdict:
    """Judges the .vtu file that the program writes for a scene."""
    try:
        write_files(program, scene, folder)
        result = solve(problem, "qp")
        faults = vtu_faults(folder, result)
        return judge(case.name, "signorini scene, .vtu", problem, result.answer, references, EXACT, failures=faults)
    except (ProgramFailed, sg.SignoriniError, ValueError) as error:
        return broken(case.name, "signorini scene, .vtu", str(error))


def of_forces(case: Case, problem: Problem, references: list[Answer]) -> Verdict:
    """Judges the answer of cvxpy to the complementarity problem of the contact forces, as the package makes it."""
    name = "cvxpy on the LCP"
    try:
        raw = by_complementarity(problem)
        return judge(case.name, name, problem, raw.answer, references, RAW, False, note=raw.status)
    except (NoAnswer, sg.SignoriniError) as error:
        return broken(case.name, name, str(error))


def run_case(
    case: Case, program: Path | None, examples: Path, folder: Path, stored: dict
) -> tuple[list[Verdict], dict]:
    """Returns all verdicts on a case, and the data to be stored."""
    try:
        scene = scene_file(case, examples, folder) if case.scene else None
        problem = problem_of_scene(scene) if scene else case.generate()
    except (OSError, sg.SignoriniError) as error:
        return [broken(case.name, "signorini scene", str(error))], {}

    settled, verdicts = independent(case, problem)
    if not settled:
        return verdicts, {}
    references = [result.answer for result in settled.values()]
    verdicts += known(case, problem, settled)
    solver, result = next(iter(settled.items()))
    if stored is not None:
        faults = ["nothing stored: run with --write-snapshot"]
        if case.name in stored:
            faults = snapshot.stored_faults(stored[case.name], problem, result)
        verdicts.append(judge(case.name, "results.json", problem, result.answer, references, EXACT, failures=faults))
    if program:
        verdicts += [tested(case, problem, references, method) for method in METHODS]
        if problem.rows <= COMPLEMENTARITY_ROWS:
            verdicts.append(of_forces(case, problem, references))
    if scene:
        verdicts.append(pictured(case, scene, program, folder / "scene", problem, references))
    return verdicts, snapshot.record(problem, result, solver)


def main() -> int:
    """Reads the command line, runs the cases and prints the table."""
    parser = argparse.ArgumentParser(description="Check signorini against cvxpy (Clarabel, OSQP) and OSQP.")
    parser.add_argument("--signorini", type=Path, default=ROOT / "target/release/signorini", help="the program")
    parser.add_argument("--examples", type=Path, default=ROOT / "examples", help="folder of the scenes")
    parser.add_argument(
        "--cases", nargs="+", metavar="NAME", default=["*"], help="names or patterns of the cases to run"
    )
    parser.add_argument("--without-program", action="store_true", help="run only the problems made here and the independent solvers")
    parser.add_argument("--write-snapshot", action="store_true", help="write reference/results.json if all cases pass")
    options = parser.parse_args()
    if not options.without_program and not options.signorini.is_file():
        print(f"{options.signorini} is not there: run `cargo build --release` first", file=sys.stderr)
        return 2
    program = None if options.without_program else options.signorini.resolve()
    every = RAW_CASES if options.without_program else RAW_CASES + SCENE_CASES
    chosen = [case for case in every if any(fnmatch(case.name, pattern) for pattern in options.cases)]
    if not chosen:
        print(f"no case matches; there are: {', '.join(case.name for case in every)}", file=sys.stderr)
        return 2

    began, verdicts, records = time.perf_counter(), [], {}
    stored = snapshot.read()
    print(table.HEADING)
    for case in chosen:
        with tempfile.TemporaryDirectory() as folder:
            found, entry = run_case(
                case, program, options.examples, Path(folder), None if options.write_snapshot else stored
            )
        table.show(found)
        verdicts += found
        if entry:
            records[case.name] = entry

    failed = [verdict for verdict in verdicts if not verdict.passed]
    print(f"\n{table.LEGEND}\n")
    if options.write_snapshot and not failed:
        snapshot.write(stored | records)
        print(f"wrote {snapshot.RESULTS.name}: {len(records)} cases")
    for verdict in failed:
        print(f"FAIL {verdict.case}, {verdict.solver}: {'; '.join(verdict.failures)}")
    print(f"{len(chosen)} cases in {time.perf_counter() - began:.0f} s")
    print(f"{len(verdicts) - len(failed)} passed, {len(failed)} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
