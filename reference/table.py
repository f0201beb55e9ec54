"""The printed table: one line for every judged answer."""

import sys

from compare import Verdict

HEADING = (
    f"{'case':22} {'answer':26} {'closed':>6} {'weak':>4} {'force':>12} {'|du|/|u|':>8} {'|dl|/|l|':>8}"
    f" {'station.':>8} {'penetr.':>8} {'adhesion':>8} {'compl.':>8} {'dual gap':>8}  verdict"
)

LEGEND = """\
closed    rows in contact; weak: rows that touch without force, for which rounding decides if they are closed
force     -sum(lambda), in the unit of the problem
|du|/|u|  largest difference from any settled answer of the independent solvers, relative to the largest value
|dl|/|l|  the same for lambda
station. to dual gap: violations recomputed from K, f, B and g, relative"""


def line(verdict: Verdict) -> str:
    """Returns one row of the table."""
    apart, numbers = verdict.distance, verdict.numbers
    if numbers is None:
        figures = " " * 84
    else:
        conditions = (
            numbers.stationarity,
            numbers.penetration,
            numbers.adhesion,
            numbers.complementarity,
            numbers.duality_gap,
        )
        measured = ((apart.displacement, apart.multiplier) if apart else (None, None)) + conditions
        shown = " ".join(f"{value:8.1e}" if value is not None else " " * 8 for value in measured)
        figures = f"{verdict.closed:6d} {verdict.weak or '':>4} {verdict.force:12.6g} {shown}"
    outcome = "pass" if verdict.passed else "FAIL: " + "; ".join(verdict.failures)
    note = f" ({verdict.note})" if verdict.note else ""
    return f"{verdict.case:22} {verdict.solver:26} {figures:84}  {outcome}{note}"


def show(verdicts: list[Verdict]) -> None:
    """Prints the lines of a case as soon as it is done."""
    for verdict in verdicts:
        print(line(verdict))
    sys.stdout.flush()
