"""Tests of `ledger.py` without valgrind: its verdicts, its table, its inputs."""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import ledger
from ledger import Cost, Table

OLD = {"first": Cost(100.0, 8.0), "second": Cost(2000.0, 50.0), "third": Cost(1.5, 5.0)}

HERE = "rustc 1.95.0, valgrind-3.19.0, glibc 2.36, AVX2"


def grown(share: float, cases=tuple(OLD)) -> dict[str, Cost]:
    """Returns the costs with more instructions in some cases."""
    return {case: Cost(cost.instructions * (1 + share), cost.peak) if case in cases else cost for case, cost in OLD.items()}


class Verdict(unittest.TestCase):
    def test_a_case_that_grows_by_five_percent_is_named(self):
        self.assertIn("second: 1.050 times the instructions", "\n".join(ledger.faults(OLD, grown(0.05, ["second"]))))

    def test_a_case_may_grow_by_one_percent(self):
        self.assertEqual(ledger.faults(OLD, grown(0.01, ["second"])), [])

    def test_the_mean_may_not_grow_by_what_each_case_may(self):
        found = ledger.faults(OLD, grown(0.006))
        self.assertEqual(len(found), 1)
        self.assertIn("geometric mean: 1.0060 times", found[0])

    def test_a_case_that_gains_does_not_hide_one_that_loses(self):
        new = grown(0.05, ["second"]) | {"first": Cost(50.0, 10.0)}
        self.assertEqual(len(ledger.faults(OLD, new)), 1)

    def test_a_case_without_a_result_is_named(self):
        self.assertEqual(ledger.faults(OLD, grown(0) | {"third": None}), ["third: no result"])
        self.assertEqual(ledger.faults(OLD, {case: OLD[case] for case in ("first", "second")}), ["third: no result"])

    def test_a_peak_that_grows_by_more_than_a_fifth_is_named_if_it_is_more_than_noise(self):
        peaks = lambda share: {case: Cost(cost.instructions, cost.peak * (1 + share)) for case, cost in OLD.items()}
        self.assertEqual([fault.split(":")[0] for fault in ledger.faults(OLD, peaks(0.21))], ["second"])
        self.assertEqual(ledger.faults(OLD, peaks(0.15)), [])


class Whole(unittest.TestCase):
    """The command, with counts that are given."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.table = Path(folder.name) / "ledger.csv"
        self.table.write_text(
            f"# release: 2026-01-02, commit 0123456, {HERE}\n# dev: 2026-01-02, commit 0123456, {HERE}\n"
            "case,release M,release MB,dev M,dev MB,0.2.0 M,0.2.0 MB,command\n"
            "first,100.0,10.0,300.0,11.0,,,solve first.json --method qp\nsecond,2000.0,50.0,,,1000.0,40.0,solve second\n"
        )

    def ended(self, costs: dict[str, Cost | None], *options: str, here: str = HERE) -> tuple[int, str]:
        """Runs the command; returns its exit code and what it prints."""
        counted = lambda command, _: costs[command.split()[1].removesuffix(".json")]
        with (
            mock.patch.multiple(ledger, TABLE=self.table, measured=counted, conditions=lambda: here),
            mock.patch.object(sys, "argv", ["ledger.py", *options, "program"]),
            mock.patch("builtins.print") as printed,
        ):
            code = ledger.main()
        return code, "\n".join(str(call.args[0]) for call in printed.call_args_list)

    def test_the_exit_code_is_that_of_the_verdict(self):
        same = {"first": Cost(100.0, 10.0), "second": Cost(2000.0, 50.0)}
        self.assertEqual(self.ended(same)[0], 0)
        self.assertEqual(self.ended(same | {"second": Cost(2100.0, 50.0)})[0], 1)
        self.assertEqual(self.ended(same | {"second": None})[0], 1)

    def test_the_short_form_runs_only_the_cases_of_the_build_for_tests(self):
        self.assertEqual(self.ended({"first": Cost(300.0, 11.0)}, "--short")[0], 0)
        self.assertEqual(self.ended({"first": Cost(315.0, 11.0)}, "--short")[0], 1)

    def test_another_compiler_is_not_compared(self):
        code, printed = self.ended({}, here=HERE.replace("1.95", "1.96"))
        self.assertEqual(code, 0)
        self.assertRegex(printed, r"^ledger: not comparable: here rustc 1\.96.*the table has rustc 1\.95")

    def test_a_renewed_table_has_the_new_numbers_of_one_build_only(self):
        self.ended({"first": Cost(90.0, 9.0), "second": Cost(2500.0, 50.0)}, "--write")
        table = Table(self.table)
        self.assertEqual(table.costs("release"), {"first": Cost(90.0, 9.0), "second": Cost(2500.0, 50.0)})
        self.assertEqual(table.costs("dev"), {"first": Cost(300.0, 11.0)})
        self.assertEqual(table.costs("0.2.0"), {"second": Cost(1000.0, 40.0)})
        self.assertEqual(table.heads["release"][2], HERE)
        self.assertIn("| second | 1,000.0 | 2,500.0 | 2.50 |", table.page())


class Kept(unittest.TestCase):
    def test_every_case_of_the_kept_table_has_numbers_and_five_are_quick(self):
        table = Table(ledger.TABLE)
        self.assertEqual(table.costs("release").keys(), {row["case"] for row in table.rows})
        self.assertEqual(len(table.costs("dev")), 5)
        with tempfile.TemporaryDirectory() as folder:
            for name in ("mortar.json", "coarse-axis.json", "dense-10", "deck.inp"):
                ledger.INPUTS[name](Path(folder) / name)
            self.assertEqual(json.loads((Path(folder) / "coarse-axis.json").read_text())["model"], "axisymmetric")
        words = {word for row in table.rows for word in row["command"].split()}
        self.assertLessEqual(ledger.INPUTS.keys(), words)

    def test_the_peak_is_that_of_the_program_and_not_of_python(self):
        with tempfile.TemporaryDirectory() as folder:
            small = ledger.peak(["sh", "-c", "true"], Path(folder))
            large = ledger.peak([sys.executable, "-c", "b'0' * 100_000_000"], Path(folder))
        self.assertLess(small, 6)
        self.assertTrue(100 < large < 150, large)

    def test_a_command_that_fails_has_no_cost(self):
        with mock.patch.object(ledger, "instructions", side_effect=RuntimeError("exit code 1")), mock.patch("builtins.print"):
            self.assertIsNone(ledger.measured("--version", Path(".")))


if __name__ == "__main__":
    unittest.main()
