"""Tests that the programs start on ranks from any interpreter, or end with one sentence.

    SIGNORINI=target/release/signorini /usr/bin/python3 -m unittest discover -s distributed/tests -p test_launch.py
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import venv
from pathlib import Path

PROGRAMS = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(PROGRAMS))
import launch
import scenes

SIGNORINI = os.environ.get("SIGNORINI", "signorini")


class Launch(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="launch-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def ended(self, *arguments, python=sys.executable, program="solve.py", **variables):
        return subprocess.run([python, str(PROGRAMS / program), *map(str, arguments)], capture_output=True, text=True, timeout=120,
                              stdin=subprocess.DEVNULL, env=os.environ | variables)

    def refused(self, sentence, *arguments, **options):
        done = self.ended(*arguments, **options)
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn(sentence, done.stderr)

    def empty(self):
        """An interpreter without numpy and petsc4py."""
        venv.create(self.folder / "venv", symlinks=True)
        return str(self.folder / "venv/bin/python3")

    def without(self, file, old, new):
        """A copy of the programs in which a text of a file is another one."""
        copy = self.folder / "programs"
        shutil.copytree(PROGRAMS, copy, ignore=shutil.ignore_patterns("tests", "__pycache__"))
        text = (copy / file).read_text()
        self.assertIn(old, text)
        (copy / file).write_text(text.replace(old, new))
        return copy / "solve.py"

    def test_commands_of_the_readme_run_on_their_ranks(self):
        scene, problem, out = self.folder / "scene.json", self.folder / "problem", self.folder / "answer"
        scene.write_text(json.dumps(scenes.pressed_by_sphere(4)))
        subprocess.run([SIGNORINI, "export", scene, problem, "--format", "petsc"], check=True, capture_output=True)
        pythons = [sys.executable]
        if launch.has_petsc(launch.DEBIAN):
            pythons.append(self.empty())
        for python in pythons:
            solved = self.ended(problem, "--out", out, "--ranks", 4, python=python)
            self.assertEqual(solved.returncode, 0, solved.stderr)
            self.assertEqual(json.loads((out / "log.json").read_text())["ranks"], 4)
            judged = self.ended(problem, out / "u.mtx", out / "lambda.mtx", "--ranks=4", python=python, program="verify.py")
            self.assertEqual((judged.returncode, json.loads(judged.stdout)["ranks"]), (0, 4))
            alone = self.ended(problem, "--out", out, python=python)
            self.assertEqual(alone.returncode, 0, alone.stderr)
            self.assertEqual(json.loads((out / "log.json").read_text())["ranks"], 1)

    def test_an_error_on_many_ranks_is_one_sentence_with_the_exit_code_of_the_program(self):
        done = self.ended(self.folder / "nothing", "--out", self.folder / "answer", "--ranks", 3)
        # The event library of the launcher may warn when it closes its own files.
        said = [line for line in done.stderr.splitlines() if not line.startswith("[warn] Epoll")]
        self.assertEqual((done.returncode, len(said)), (1, 1), done.stderr)
        self.assertIn("signorini export writes them", done.stderr)

    def test_a_number_of_ranks_below_one_is_refused(self):
        self.refused("--ranks must be at least 1, not 0", "problem", "--out", "answer", "--ranks", 0)

    def test_ranks_within_ranks_are_refused_by_one_of_them(self):
        self.refused("leave out one of both", "problem", "--out", "answer", "--ranks", 2, PMI_RANK="0")
        other = self.ended("problem", "--out", "answer", "--ranks", 2, PMI_RANK="1")
        self.assertEqual((other.returncode, other.stderr), (2, ""))

    def test_a_machine_without_mpirun_is_told_what_to_install(self):
        self.refused("there is no mpirun; install PETSc and MPI", "problem", "--out", "answer", "--ranks", 2, PATH=str(self.folder))

    def test_a_machine_without_petsc_is_told_what_to_install(self):
        program = self.without("launch.py", 'DEBIAN = "/usr/bin/python3"', 'DEBIAN = "/nowhere/python3"')
        self.refused("PETSc does not run with", "problem", "--out", "answer", python=self.empty(), program=program)
        self.refused("apt-get install", "problem", "--out", "answer", "--ranks", 2, python=self.empty(), program=program)

    def test_a_rank_whose_interpreter_has_no_petsc_says_so(self):
        self.refused("has no numpy: start with --ranks", "problem", "--out", "answer", python=self.empty(), PMI_RANK="0")


if __name__ == "__main__":
    unittest.main()
