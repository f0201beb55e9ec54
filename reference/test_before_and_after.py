"""Tests of `before_and_after.py`, with shell scripts as the two programs."""

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import before_and_after
from before_and_after import clipped, differences, stripped
from jobs import TOTAL_ERRORS, Job, all_jobs, short

PROGRAM = """#!/bin/sh
mkdir out
echo '{{"force": {force}, "history": [{{"energy": 2.0, "seconds": '$$'}}], "why": "took '$$' s"}}'
echo "error: {sentence}" >&2
printf '3 3 2\\n1 1 4.0\\n2 2 {entry}\\n' > out/K.mtx
printf '\\377{byte}' > out/K.petsc
[ -z "{left_out}" ] && echo 1.0 > out/u.mtx
exit {code}
"""

RIGHT = {"force": "1.5", "sentence": "the gap is 0.25 m wide", "entry": "8.0", "byte": "\\001", "left_out": "", "code": "0"}


class Comparison(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def program(self, name: str, **changes: str) -> str:
        file = self.folder / name
        file.write_text(PROGRAM.format(**(RIGHT | changes)))
        file.chmod(0o755)
        return str(file)

    def outcome(self, *options: str, **changes: str) -> tuple[int, str]:
        """Returns the exit code and the lines for a second program with some changes."""
        jobs = [Job("block.json", kind, (("solve", "block.json", "--out", "out"),)) for kind in ("solve", "compare")]
        words = ["before_and_after.py", self.program("old"), self.program("new", **changes), *options]
        printed = io.StringIO()
        with (
            mock.patch.object(before_and_after, "all_jobs", return_value=jobs),
            mock.patch.object(sys, "argv", words),
            contextlib.redirect_stdout(printed),
        ):
            return before_and_after.main(), printed.getvalue()

    def test_equal_programs_have_no_difference_but_their_seconds(self):
        code, text = self.outcome()
        self.assertEqual(code, 0, text)
        self.assertIn("2 jobs, 12 outputs and files compared, 0 differ, 0 jobs cut", text)

    def test_every_kind_of_difference_is_found_and_named(self):
        for change, line in {
            ("force", "1.25"): "1.7e-01  force: 1.5 -> 1.25",
            ("sentence", "the gap is 0.5 m wide"): "5.0e-01  line 1: error: the gap is 0.25 m wide -> error: the gap is 0.5 m wide",
            ("sentence", "there is no gap"): "inf  line 1: error: the gap is 0.25 m wide -> error: there is no gap",
            ("entry", "-8.0"): "2.0e+00  line[3].column 3: 8.0 -> -8.0",
            ("byte", "\\002"): "inf  bytes: ff01 -> ff02",
            ("left_out", "u"): "out/u.mtx: written by OLD only",
            ("code", "4"): "inf  line 1: 0 certified -> 4 not certified",
        }.items():
            with self.subTest(change):
                code, text = self.outcome(**dict([change]))
                self.assertEqual(code, 1)
                self.assertIn(line, text)
                self.assertIn("2 differ", text)
                self.assertIn("block.json: solve: ", text)

    def test_the_worst_difference_stands_first(self):
        lines = self.outcome(force="1.5000000001", entry="8.5", code="4")[1].splitlines()
        order = [next(n for n, line in enumerate(lines) if word in line) for word in ("not certified", "8.5", "1.5000000001")]
        self.assertEqual(order, sorted(order))

    def test_differences_below_a_tolerance_are_printed_but_not_counted(self):
        code, text = self.outcome("--tolerance", "1e-6", force="1.5000000001")
        self.assertEqual(code, 0)
        self.assertIn("force: 1.5 -> 1.5000000001", text)
        self.assertEqual(self.outcome("--tolerance", "1e-12", force="1.5000000001")[0], 1)

    def test_another_form_of_a_number_and_another_key_are_differences(self):
        self.assertIn("the same values in another form", self.outcome(entry="8.00")[1])
        code, text = self.outcome(force='1.5, "extra": null')
        self.assertEqual(code, 1)
        self.assertIn("inf  extra: (absent) -> None", text)

    def test_a_job_that_is_cut_is_named_and_not_compared(self):
        slow = self.program("new").replace("new", "slow")
        Path(slow).write_text("#!/bin/sh\nexec sleep 9\n")
        Path(slow).chmod(0o755)
        job = Job("block.json", "solve", (("solve", "block.json"),))
        result = before_and_after.compared([Path(self.program("old")), Path(slow)], "none", 0.3, job)
        self.assertTrue(result.is_cut)
        self.assertEqual(result.compared, 0)

    def test_only_names_the_jobs_that_run(self):
        self.assertIn("1 jobs, 6 outputs", self.outcome("--only", "json: solve")[1])


class Outputs(unittest.TestCase):
    def test_numbers_of_a_list_are_relative_to_the_largest_of_it(self):
        found = differences('{"u": [100.0, 1.0], "a": 1.0}', '{"u": [100.0, 2.0], "a": 2.0}')
        self.assertEqual([far for far, _ in found], [0.5, 0.01])

    def test_the_sign_of_zero_is_a_difference(self):
        self.assertEqual(differences("[0.0]", "[-0.0]"), [(0.0, " 0.0e+00  [0]: 0.0 -> -0.0")])

    def test_only_the_column_of_seconds_is_ignored_in_a_table(self):
        table = b"mesh,force,seconds\n1,4.5,0.5\n2,4.25,0.125\n\n3,4.0,9.0\n"
        expected = "mesh,force,seconds\n1,4.5,...\n2,4.25,...\n\n3,4.0,9.0\n"
        self.assertEqual(stripped(table), expected)

    def test_long_texts_are_shown_from_where_they_part(self):
        self.assertIn("here", clipped("a" * 500 + "here", "a" * 500 + "there"))


class Jobs(unittest.TestCase):
    def test_the_inputs_of_this_repository_are_found(self):
        with tempfile.TemporaryDirectory() as folder:
            jobs = all_jobs(Path(folder))
        names = [job.name for job in jobs]
        self.assertEqual(len(set(names)), len(names))
        for target in TOTAL_ERRORS:
            self.assertIn(f"{target}: total error", names)
        kinds = {job.kind for job in jobs}
        self.assertEqual(kinds, {job.kind for job in short(jobs)})
        for kind in ("export", "solve", "compare", "sweep", "sensitivity", "problem", "directory", "deck", "new", "refusal"):
            self.assertIn(kind, kinds)
        self.assertGreater(len(jobs), 600)


if __name__ == "__main__":
    unittest.main()
