"""Tests of foreign_qps.py and its parts: the problems are right, their known answers are proven, and signorini solves a short form."""

import contextlib
import io
import tempfile
import unittest
from fractions import Fraction
from pathlib import Path

import numpy as np

import foreign_qps
import qp_control
import qp_folder
import qp_forms
import qp_made
import qp_typed
from qp_solvers import Outcome, Server, by_signorini
from quadratic import Answer, Program, exact, is_exact, on_active_set, program, residuals

DECIMALS = 1e-13
"""Relative change of a minimum by the rounding of decimal data to doubles."""


def judged(problem: Program) -> foreign_qps.Judged:
    return foreign_qps.judged(problem, by_signorini(problem))


IDLE = np.array([0, 1, 0, 1, 0, 0, 0, 1, 0, 1, 0, 1.0])
"""The idle times of LOTSCHD that are 0 at its minimum."""


def near(problem: Program) -> Answer:
    """Returns an answer that proposes the active set. Any solver may propose it: the proof in fractions does not rest on it."""
    if problem.name == "LOTSCHD":
        return Answer(np.zeros(12), np.zeros(0), np.zeros(7), -IDLE)
    return by_signorini(problem).answer


class Typed(unittest.TestCase):
    def test_every_known_minimum_is_proven_in_fractions(self):
        for problem in qp_typed.problems():
            with self.subTest(problem.name):
                proven = on_active_set(problem, near(problem))
                self.assertTrue(is_exact(problem, proven))
                x = proven.x
                least = x.dot(exact(problem.P).dot(x)) / 2 + x.dot(exact(problem.q)) + Fraction(problem.constant)
                self.assertLessEqual(abs(least - problem.minimum), DECIMALS * max(1, abs(problem.minimum)))

    def test_minima_are_those_that_the_sources_print(self):
        printed = {
            "HS21": -9.9960000e01, "HS35": 1.1111111e-01, "HS51": 0.0, "HS52": 5.3266476e00, "HS53": 4.0930233e00, "HS76": -4.6818182e00,
            "HS118": 6.6482045e02, "HS268": 0.0, "GENHS28": 9.2717369e-01, "TAME": 0.0, "LOTSCHD": 2.3984159e03, "ZECEVIC2": -4.1250000e00,
        }
        found = {problem.name: float(problem.minimum) for problem in qp_typed.problems()}
        for name, value in printed.items():
            self.assertLessEqual(abs(found[name] - value), 1e-7 * abs(value), name)

    def test_signorini_finds_every_minimum(self):
        for problem in foreign_qps.typed():
            with self.subTest(problem.name):
                self.assertEqual(judged(problem).missed(), "")


class Generated(unittest.TestCase):
    def test_the_answer_of_a_singular_program_is_exact_and_its_matrix_is_singular(self):
        for problem in qp_made.singular(10):
            self.assertTrue(is_exact(problem, problem.known))
            self.assertLess(np.linalg.matrix_rank(problem.P), len(problem.q))

    def test_signorini_solves_ten_singular_programs(self):
        for problem in qp_made.singular(10):
            with self.subTest(problem.name):
                self.assertEqual(judged(problem).missed(), "")

    def test_signorini_says_of_ten_programs_that_there_is_no_solution(self):
        for problem in qp_made.unsolvable(10):
            with self.subTest(problem.name):
                self.assertEqual(judged(problem).missed(), "")

    def test_control_programs_have_empty_rows_with_a_right_hand_side_of_rounding_size(self):
        negative = 0
        for problem in qp_control.control(12):
            h = qp_control.empty_rows(problem)
            tiny = (h != 0) & (np.abs(h) < qp_control.ROUNDING)
            self.assertTrue(tiny.any() and h.min() > -qp_control.ROUNDING)
            self.assertGreaterEqual(np.abs(problem.G).max(), 1e-3)
            negative += h.min() < 0
        self.assertEqual(negative, 9)

    def test_signorini_solves_five_control_programs(self):
        for problem in [qp_control.one(kind, number) for kind, number in CONTROL]:
            with self.subTest(problem.name):
                self.assertEqual(judged(problem).missed(), "")

    def test_every_form_has_a_positive_semidefinite_matrix(self):
        for problem in qp_forms.forms(len(qp_forms.FORMS)):
            values = np.linalg.eigvalsh(problem.P)
            self.assertGreaterEqual(values[0], -1e-12 * values[-1])


CONTROL = (("walk", 3), ("walk", 6), ("walk", 12), ("masses", 2), ("masses", 5))


class Judgement(unittest.TestCase):
    def setUp(self):
        self.problem = qp_made.singular(3)[2]

    def test_a_planted_fault_is_seen_by_its_own_residual(self):
        known = self.problem.known
        x, z, y, z_box = (np.asarray(part, dtype=float) for part in (known.x, known.z, known.y, known.z_box))
        self.assertEqual(residuals(self.problem, Answer(x, z, y, z_box)).worst(), 0.0)
        off = residuals(self.problem, Answer(x, z, y + 1e-6, z_box))
        self.assertGreater(off.dual, 1e-7)
        self.assertEqual(off.primal, 0.0)
        off = residuals(self.problem, Answer(x + 1e-6, z, y, z_box))
        self.assertGreater(off.primal, 1e-7)
        self.assertFalse(is_exact(self.problem, Answer(x, z, y + 1e-9, z_box)))

    def test_multipliers_of_the_wrong_sign_are_seen_although_the_other_residuals_vanish(self):
        # The maximum of -x on 0 <= x <= 1 with a multiplier of the wrong sign: all residuals of qpbenchmark are 0.
        problem = program("sign", [[0.0]], [-1.0], [[-1.0]], [0.0])
        found = residuals(problem, Answer(np.zeros(1), np.array([-1.0]), np.zeros(0), np.zeros(1)))
        self.assertEqual((found.primal, found.dual, found.gap, found.sign), (0.0, 0.0, 0.0, 1.0))

    def test_an_answer_that_is_no_number_has_infinite_residuals(self):
        n = len(self.problem.q)
        known = self.problem.known
        self.assertEqual(residuals(self.problem, Answer(np.full(n, np.nan), known.z, known.y, known.z_box)).worst(), np.inf)

    def test_an_answer_of_an_unsolvable_program_is_missed(self):
        problem = qp_made.unsolvable(1)[0]
        n = len(problem.q)
        answer = Answer(np.zeros(n), np.zeros(len(problem.h)), np.zeros(len(problem.b)), np.zeros(n))
        self.assertNotEqual(foreign_qps.judged(problem, Outcome(answer, False, 0.1, "")).missed(), "")

    def test_only_all_is_a_hundred_percent(self):
        self.assertEqual([foreign_qps.share(*of) for of in ((24, 24), (1999999, 2000000), (1, 3), (0, 5))], ["100", "99.9", "33.3", "0"])


class Folders(unittest.TestCase):
    def test_a_saved_program_is_read_again_bit_by_bit(self):
        with tempfile.TemporaryDirectory() as folder:
            problems = [qp_typed.hs76(), qp_typed.hs118(), qp_made.singular(1)[0]]
            for problem in problems:
                qp_folder.save(problem, Path(folder))
            found = qp_folder.in_folder(Path(folder))
            for problem, again in zip(sorted(problems, key=lambda p: p.name.replace(" ", "-")), found):
                for one, other in zip(problem.data, again.data):
                    np.testing.assert_array_equal(one, other) if one is not None else self.assertIsNone(other)

    def test_a_parquet_file_is_read_as_qpbenchmark_writes_it(self):
        try:
            import pyarrow
            import pyarrow.parquet
        except ImportError:
            self.skipTest("pyarrow is not installed")
        problems = [qp_typed.hs21(), qp_typed.hs76(), qp_typed.hs118(), qp_typed.genhs28()]
        flat = lambda values: None if values is None else values.ravel()
        columns = {key: [flat(getattr(problem, key)) for problem in problems] for key in qp_folder.KEYS}
        columns["name"] = [problem.name for problem in problems]
        with tempfile.TemporaryDirectory() as folder:
            pyarrow.parquet.write_table(pyarrow.table(columns), Path(folder) / "set.parquet")
            for problem, again in zip(problems, qp_folder.in_folder(Path(folder)), strict=True):
                self.assertEqual(problem.name, again.name)
                for one, other in zip(problem.data, again.data):
                    np.testing.assert_array_equal(one, other) if one is not None else self.assertIsNone(other)

    def test_a_folder_without_programs_is_refused(self):
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stderr(io.StringIO()):
            self.assertEqual(foreign_qps.main(["--set", folder, "--solvers", "signorini"]), 2)

    def test_tables_replace_those_of_a_page_and_nothing_else(self):
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "page.md"
            page.write_text(f"# Title\n\n{foreign_qps.BEGIN}\nold\n{foreign_qps.END}\n\nEnd.\n")
            foreign_qps.put_into(page, ["new"])
            self.assertEqual(page.read_text(), f"# Title\n\n{foreign_qps.BEGIN}\n\nnew\n\n{foreign_qps.END}\n\nEnd.\n")
            page.write_text("# Title\n")
            with self.assertRaises(ValueError):
                foreign_qps.put_into(page, ["new"])


class Limits(unittest.TestCase):
    def test_a_solver_that_takes_too_long_is_ended_and_starts_again(self):
        slow, server = qp_typed.hs21(), Server("signorini", 60.0)
        try:
            self.assertIsNotNone(server.solve(slow).answer)
            server.limit = 0.0
            self.assertIn("no answer within", server.solve(slow).note)
            server.limit = 60.0
            self.assertIsNotNone(server.solve(slow).answer)
        finally:
            server.stop()


if __name__ == "__main__":
    unittest.main()
