"""Tests of the command `validate.py`, with a stand-in for the package that can return wrong answers."""

import contextlib
import dataclasses
import io
import json
import sys
import tempfile
import unittest
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import meshio
import numpy as np

import elastic_block
import snapshot
import stand_in
import table
import validate
from cases import GAPS, RAW_CASES, SCENE_CASES, Case
from problem import Answer
from program import METHODS, ProgramFailed, Run, write_files
from settle import contact_set, settle
from solvers import osqp_direct
from vtu import vtu_faults

BLOCK = Case(
    "block",
    scene="indentation.json",
    gap=-0.05,
    twin=lambda: elastic_block.indentation(-0.05, **stand_in.BLOCK),
)


EXAMPLES = Path(__file__).parent.parent / "examples"


class WithStandIn(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.program = self.folder / "signorini"
        self.program.touch()
        scene = json.loads((EXAMPLES / "indentation.json").read_text())
        for axis, divisions in (("x", "columns"), ("y", "layers")):
            scene["body"]["rectangle"][axis]["divisions"] = [stand_in.BLOCK[divisions]]
        (self.folder / "indentation.json").write_text(json.dumps(scene))

    def standing_in(self, fault: str):
        """Replaces the package and the program by the stand-in."""
        stack = contextlib.ExitStack()
        stack.enter_context(mock.patch("program.sg.solve", partial(stand_in.solve, fault=fault)))
        stack.enter_context(mock.patch("program.subprocess.run", stand_in.run))
        return stack

    def verdicts(self, case: Case, fault: str = "") -> dict:
        """Returns the verdicts of a case by the name of the answer."""
        folder = Path(tempfile.mkdtemp(dir=self.folder))
        with self.standing_in(fault):
            found, _ = validate.run_case(case, self.program, self.folder, folder, None)
        return {verdict.solver: verdict for verdict in found}


class RightAnswers(WithStandIn):
    def test_right_answers_pass_on_a_scene(self):
        verdicts = self.verdicts(BLOCK)
        self.assertEqual([verdict.failures for verdict in verdicts.values()], [[]] * len(verdicts))
        for name in ("assembled again", "signorini qp", "signorini penalty", "signorini scene, .vtu"):
            self.assertIn(name, verdicts)

    def test_right_answers_pass_on_a_floating_body(self):
        rod = next(case for case in RAW_CASES if case.name == "floating rod")
        verdicts = self.verdicts(rod)
        self.assertEqual([verdict.failures for verdict in verdicts.values()], [[]] * len(verdicts))


class WrongAnswers(WithStandIn):
    def test_every_wrong_answer_fails_for_qp_and_active_set(self):
        for fault in stand_in.WRONG_ANSWERS:
            with self.subTest(fault):
                verdicts = self.verdicts(BLOCK, fault)
                self.assertFalse(verdicts["signorini qp"].passed)
                self.assertFalse(verdicts["signorini active-set"].passed)
                self.assertTrue(verdicts["signorini penalty"].passed)

    def test_every_wrong_statement_fails(self):
        for fault in (*stand_in.WRONG_WORDS, "not_certified"):
            with self.subTest(fault):
                verdicts = self.verdicts(BLOCK, fault)
                self.assertFalse(all(verdicts[f"signorini {method}"].passed for method in METHODS))

    def test_an_answer_on_all_dofs_that_differs_fails(self):
        verdicts = self.verdicts(BLOCK, "full_differs")
        self.assertRegex(verdicts["signorini qp"].failures[0], "^u differs by .* from that on all dofs$")

    def test_a_refusal_shows_its_sentence(self):
        verdicts = self.verdicts(BLOCK, "refused")
        self.assertEqual(verdicts["signorini qp"].failures, ["the body is not held"])

    def test_a_program_that_fails_shows_its_exit_code_and_sentence(self):
        self.program.write_text("#!/bin/sh\necho 'the disk is full' >&2\nexit 1\n")
        self.program.chmod(0o755)
        with self.assertRaisesRegex(ProgramFailed, "^exit code 1: the disk is full$"):
            write_files(self.program, self.folder / "indentation.json", self.folder)

    def test_another_stiffness_is_detected_by_the_twin(self):
        softer = dataclasses.replace(BLOCK, twin=lambda: elastic_block.indentation(-0.05, young=5e6, **stand_in.BLOCK))
        self.assertFalse(self.verdicts(softer)["assembled again"].passed)

    def test_a_missing_scene_fails_by_name(self):
        verdicts = self.verdicts(Case("missing", scene="nowhere.json", gap=-0.01))
        self.assertIn("nowhere.json", verdicts["signorini scene"].failures[0])


class Command(WithStandIn):
    def run_main(self, *arguments: str) -> tuple[int, str]:
        """Returns the exit code and the output of the command."""
        arguments = mock.patch.object(sys, "argv", ["validate.py", *arguments])
        with arguments, contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(out):
            return validate.main(), out.getvalue()

    def test_exit_code_and_last_line_count_the_checks(self):
        with self.standing_in(""):
            code, text = self.run_main("--signorini", str(self.program), "--cases", "two springs")
        self.assertEqual(code, 0, text)
        self.assertRegex(text.splitlines()[-1], r"^\d+ passed, 0 failed$")

    def test_wrong_answers_give_a_nonzero_exit_code(self):
        with self.standing_in("flipped_sign"):
            code, text = self.run_main("--signorini", str(self.program), "--cases", "two springs")
        self.assertEqual(code, 1)
        self.assertRegex(text.splitlines()[-1], r"^\d+ passed, 2 failed$")

    def test_a_missing_program_or_an_unknown_case_is_a_usage_error(self):
        self.assertEqual(self.run_main("--signorini", str(self.folder / "nothing"))[0], 2)
        self.assertEqual(self.run_main("--without-program", "--cases", "no such case")[0], 2)


class Parts(unittest.TestCase):
    def setUp(self):
        self.problem = elastic_block.indentation(-0.05, **stand_in.BLOCK)
        self.settled = settle(self.problem, contact_set(self.problem, osqp_direct(self.problem).answer))
        self.reported = SimpleNamespace(contact_set=np.flatnonzero(self.settled.closed))

    def test_a_stored_result_is_recognised_and_a_changed_one_is_not(self):
        entry = json.loads(json.dumps(snapshot.record(self.problem, self.settled, "osqp")))
        self.assertEqual(snapshot.stored_faults(entry, self.problem, self.settled), [])
        entry["displacement"]["value"][0] += 1e-7
        self.assertEqual(len(snapshot.stored_faults(entry, self.problem, self.settled)), 1)

    def test_runs_of_neighbouring_indices(self):
        self.assertEqual(snapshot.runs(np.array([0, 1, 2, 5, 7, 8])), [[0, 2], [5, 5], [7, 8]])
        self.assertEqual(snapshot.runs(np.array([], int)), [])

    def test_missing_and_infinite_arrays_of_a_vtu_are_named(self):
        answer = self.settled.answer
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            run = Run(answer, self.reported, True)
            self.assertEqual(vtu_faults(folder, run), ["0 .vtu files instead of one"])
            stand_in.write_vtu(answer, self.problem, folder)
            self.assertEqual(vtu_faults(folder, run), [])
            mesh = meshio.read(folder / "scene.vtu")
            del mesh.point_data["sigma_1"]
            mesh.point_data["pressure"][3] = np.nan
            mesh.write(folder / "scene.vtu")
            faults = vtu_faults(folder, run)
        self.assertEqual([fault.split(":")[0] for fault in faults], ["sigma_1", "pressure"])

    def test_a_vtu_with_another_displacement_is_detected(self):
        with tempfile.TemporaryDirectory() as name:
            stand_in.write_vtu(self.settled.answer, self.problem, Path(name))
            doubled = Answer(2.0 * self.settled.answer.displacement, self.settled.answer.multiplier)
            self.assertEqual(len(vtu_faults(Path(name), Run(doubled, self.reported, True))), 1)

    def test_a_vtu_with_another_contact_set_is_detected(self):
        with tempfile.TemporaryDirectory() as name:
            stand_in.write_vtu(self.settled.answer, self.problem, Path(name))
            fewer = SimpleNamespace(contact_set=self.reported.contact_set[1:])
            faults = vtu_faults(Path(name), Run(self.settled.answer, fewer, True))
        self.assertRegex(faults[0], "^contact is set at 5 points, the answer has 4$")

    def test_the_table_has_a_line_for_answers_and_for_failures(self):
        right = validate.judge(
            "case", "answer", self.problem, self.settled.answer, [self.settled.answer], validate.EXACT
        )
        self.assertTrue(table.line(right).endswith("pass"))
        self.assertIn("FAIL: no reason", table.line(validate.broken("case", "answer", "no reason")))

    def test_names_of_cases_are_unique_and_all_ten_gaps_are_there(self):
        names = [case.name for case in RAW_CASES + SCENE_CASES]
        self.assertEqual(len(names), len(set(names)))
        self.assertEqual(GAPS, (-0.01, -0.02, -0.03, -0.04, -0.05, -0.06, -0.07, -0.08, -0.09, -0.1))


if __name__ == "__main__":
    unittest.main()
