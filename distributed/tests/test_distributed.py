"""Compares the distributed programs with a direct solve by signorini, on 1 to 8 ranks.

    python3 -m unittest discover distributed/tests

The tests need mpirun and petsc4py. The environment variable SIGNORINI names the program; the default is `signorini`.
"""

import csv
import json
import os
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
PROGRAMS = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(PROGRAMS))
import scenes
from ranks import PETSc, Ranks

import hierarchy as hierarchies
import problem as problems
from bounds import Bounds
from hierarchy import Hierarchy, built
from parts import components
from problem import in_rows

SIGNORINI = os.environ.get("SIGNORINI", "signorini")
ENVIRONMENT = dict(os.environ)
"""The environment without the variables that MPI has set for this process, which would disturb the runs of mpirun."""

MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--quiet"]

APART = 1e-7
"""Relative tolerance of the largest entries of two answers certified to 1e-9. A bound in the energy norm leaves a factor of 100 open."""

SUMMED = 1e-6
"""Relative tolerance between the residuals of two programs. A residual is a small difference of large sums."""

ROUNDING = 1e-10
"""Rounding error of a small linear solve."""

LAST = 1e-17
"""Absolute tolerance of a residual that is itself a rounding error, in sums of terms of order one."""

MORE = 1.2
"""Largest ratio of the memory of a long run to that of a short one. Objects kept from each iteration would double it."""

MEASURED = 1.2
"""Largest ratio of the error bounds of both programs. At most a tenth of the square of the dual norm depends on the Ritz value, and
`signorini verify` repairs its multiplier in another way."""


def mpi(ranks, program, *arguments, check=True):
    command = [*MPIRUN, "-n", str(ranks), sys.executable, str(PROGRAMS / program), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, stdin=subprocess.DEVNULL,
                          env=ENVIRONMENT)
    if check and done.returncode:
        raise AssertionError(f"{program} ended with {done.returncode}: {done.stdout}{done.stderr}")
    return done


def signorini(*arguments):
    done = subprocess.run([SIGNORINI, *map(str, arguments)], capture_output=True, text=True, timeout=600, stdin=subprocess.DEVNULL,
                          env=ENVIRONMENT)
    if done.returncode:
        raise AssertionError(f"signorini {arguments} ended with {done.returncode}: {done.stdout}{done.stderr}")
    return done


def array(file):
    return np.loadtxt(file, skiprows=2, ndmin=1)


def written(file, values):
    file.write_text(f"%%MatrixMarket matrix array real general\n{len(values)} 1\n" + "".join(f"{v!r}\n" for v in values))


def one_level(stiffness, *_):
    """PETSc's multigrid with one level; what GAMG makes of a problem this small depends on its version."""
    multigrid = PETSc.PC().create(comm=stiffness.comm)
    multigrid.setOperators(stiffness)
    multigrid.setType("mg")
    multigrid.setMGLevels(1)
    multigrid.setUp()
    return multigrid


def has_hypre():
    try:
        PETSc.PC().create().setType("hypre")
    except PETSc.Error:
        return False
    return True


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="distributed-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def exported(self, scene, form="petsc"):
        file, folder = self.folder / "scene.json", self.folder / form
        file.write_text(json.dumps(scene))
        signorini("export", file, folder, "--format", form)
        return folder

    def direct(self, scene):
        """Solves a scene by a factorisation with signorini, and returns the folder of the answer."""
        file, folder = self.folder / "scene.json", self.folder / "direct"
        file.write_text(json.dumps(scene))
        signorini("solve", file, "--method", "active-set", "--pictures", "none", "--out", folder)
        return folder

    def solved(self, ranks, problem, *options):
        out = self.folder / f"out-{ranks}-{len(list(self.folder.iterdir()))}"
        mpi(ranks, "solve.py", problem, "--out", out, *options)
        return out

    def assert_same(self, one, other):
        forces = array(one / "lambda.mtx"), array(other / "lambda.mtx")
        moved = array(one / "u.mtx"), array(other / "u.mtx")
        self.assertTrue(np.any(forces[0] < 0.0))
        np.testing.assert_array_equal(forces[0] < 0.0, forces[1] < 0.0)
        for a, b in (forces, moved):
            self.assertLess(np.abs(a - b).max(), APART * np.abs(a).max())

    def refused(self, ranks, problem, sentence, code, *options, program="solve.py"):
        """Checks that a run ends with this code and sentence, without a Python traceback and without a file of an answer."""
        out = self.folder / "refused"
        done = mpi(ranks, program, problem, "--out", out, *options, check=False)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertIn(sentence, done.stdout + done.stderr)
        self.assertNotIn("Traceback", done.stderr)
        self.assertFalse((out / "u.mtx").exists() or (out / "lambda.mtx").exists())


class AnswersOfTheDirectPath(Case):
    def check(self, scene, ranks, form="petsc", *options, most_cycles=30):
        direct, problem = self.direct(scene), self.exported(scene, form)
        for count in ranks:
            out = self.solved(count, problem, *options)
            self.assert_same(direct, out)
            self.assertLessEqual(json.loads((out / "log.json").read_text())["iterations"], most_cycles)

    def test_a_block_under_a_sphere_on_1_2_4_and_8_ranks(self):
        self.check(scenes.pressed_by_sphere(8), (1, 2, 4, 8))

    def test_a_box_on_rollers_in_both_formats(self):
        self.check(scenes.on_rollers(), (2,))
        self.check(scenes.on_rollers(), (1, 3), "matrix-market")

    def test_a_box_under_an_inclined_plane(self):
        self.check(scenes.under_inclined_plane(), (1, 4))

    def test_a_body_without_supports_in_a_corner(self):
        self.check(scenes.held_by_contact(), (1, 4))

    def test_unknowns_with_bounds_on_both_sides(self):
        problem = self.exported(scenes.sheared_under_a_plane(), "matrix-market")
        head, sizes, *entries = (problem / "B.mtx").read_text().split("\n")
        rows, dofs, count = (int(word) for word in sizes.split())
        more = [f"{int(row) + rows} {dof} -{b}" for row, dof, b in (line.split() for line in entries if line)]
        (problem / "B.mtx").write_text("\n".join([head, f"{2 * rows} {dofs} {2 * count}", *filter(None, entries), *more, ""]))
        written(problem / "g.mtx", [*array(problem / "g.mtx").tolist(), *[1e-3] * rows])
        signorini("solve", problem, "--method", "active-set", "--out", self.folder / "direct")
        out = self.solved(3, problem)
        self.assert_same(self.folder / "direct", out)
        closed = array(out / "lambda.mtx") < 0.0
        self.assertTrue(closed[:rows].any() and closed[rows:].any())

    def test_a_quarter_of_a_half_ball(self):
        # The aspect ratio of its cells is up to 100, for which every multigrid with point smoothers needs more cycles.
        self.check(scenes.quarter_ball(), (2,), most_cycles=100)

    def test_linear_tetrahedra(self):
        self.check(scenes.pressed_by_sphere(6, "tet4"), (2,))

    def test_triangles_in_the_plane(self):
        self.check(scenes.in_the_plane(), (2,))

    @unittest.skipUnless(has_hypre(), "PETSc was built without hypre")
    def test_levels_of_boomeramg(self):
        self.check(scenes.pressed_by_sphere(6), (2,), "petsc", "--multigrid", "boomeramg")

    def test_levels_built_in_less_memory(self):
        self.check(scenes.pressed_by_sphere(8), (1, 2), "petsc", "--save-memory")

    def test_a_box_on_an_inclined_support(self):
        # Its dofs are no components of nodes along the axes: the near-null space is read, not made from coordinates.
        self.check(scenes.on_an_inclined_support(), (1, 2))

    def test_more_ranks_than_nodes(self):
        self.check(scenes.under_inclined_plane(1), (8,), most_cycles=5)


class Cycles(Case):
    def cycled(self, divisions):
        """Returns a hierarchy in the face of one closed row, and its cycle as a function of arrays."""
        ranks = Ranks()
        problem = problems.read(ranks, str(self.exported(scenes.pressed_by_sphere(divisions))))
        hierarchy = Hierarchy(Bounds(problem))
        hierarchy.hold(np.arange(len(hierarchy.candidates)) == 0)

        def cycle(force):
            f, x = problem.load.duplicate(), problem.load.duplicate()
            f.array[:] = force
            hierarchy.cycle(f, x)
            return x.array_r.copy()

        return hierarchy, cycle

    def test_a_cycle_of_one_level_solves_exactly_in_its_face(self):
        with mock.patch.object(hierarchies, "built", one_level):
            hierarchy, cycle = self.cycled(1)
        self.assertEqual(hierarchy.levels, [])
        force = np.linspace(1.0, 2.0, hierarchy.stiffness.getSize()[0])
        moved = cycle(force)
        (held,) = hierarchy.held
        rest = hierarchy.stiffness[:, :] @ moved - force
        self.assertEqual(moved[held], 0.0)
        self.assertGreater(abs(rest[held]), 1.0)
        rest[held] = 0.0
        self.assertLess(np.abs(rest).max(), ROUNDING)

    def test_a_cycle_is_symmetric_and_does_not_move_closed_rows(self):
        hierarchy, cycle = self.cycled(4)
        self.assertGreater(len(hierarchy.levels), 0)
        size = hierarchy.stiffness.getSize()[0]
        one, other = np.cos(np.arange(size)), np.sin(0.3 * np.arange(size) ** 2)
        self.assertEqual(cycle(one)[hierarchy.held].tolist(), [0.0])
        there, back = other @ cycle(one), one @ cycle(other)
        self.assertLess(abs(there - back), ROUNDING * abs(there))
        self.assertGreater(one @ cycle(one), 0.0)


class Memory(Case):
    def test_options_of_products_reach_petsc_and_end_with_the_set_up(self):
        problem = problems.read(Ranks(), str(self.exported(scenes.pressed_by_sphere(4))))
        rows = in_rows(problem.stiffness)
        rows.setNearNullSpace(PETSc.NullSpace().create(vectors=problems.orthonormal(problem.modes), comm=rows.comm))
        with self.assertRaises(PETSc.Error):
            built(rows, "gamg", "", {"matptap_via": "a-way-that-petsc-does-not-know"})
        built(rows, "gamg", "", {})

    def test_stiffness_in_rows_is_gone_after_the_set_up(self):
        ranks = Ranks()
        problem = problems.read(ranks, str(self.exported(scenes.pressed_by_sphere(8))))
        self.assertEqual(problem.stiffness.getBlockSize(), 3)
        self.assertIn("baij", problem.stiffness.getType())
        kept = []

        def remembered(matrix):
            kept.append(in_rows(matrix))
            return kept[-1]

        with mock.patch.object(hierarchies, "in_rows", remembered):
            hierarchy = Hierarchy(Bounds(problem))
        ranks.clean()
        self.assertGreater(len(hierarchy.levels), 0)
        self.assertEqual([matrix.getRefCount() for matrix in kept], [1])

    def test_a_long_run_holds_no_more_memory_than_a_short_one(self):
        problem = self.exported(scenes.pressed_by_sphere(16))
        held = []
        for cycles in ("5", "400"):
            out = self.folder / f"out{cycles}"
            mpi(2, "solve.py", problem, "--out", out, "--most-cycles", cycles, "--tolerance", "1e-300", check=False)
            held.append(json.loads((out / "log.json").read_text())["memory_bytes"]["all_ranks"])
        self.assertLess(held[1], MORE * held[0])


class Components(unittest.TestCase):
    def test_components_of_random_graphs_are_those_of_a_plain_search(self):
        random = np.random.default_rng(7)
        for _ in range(200):
            count, edges = random.integers(1, 40), random.integers(0, 50)
            one, other = random.integers(0, count, (2, edges))
            label, is_changed = np.arange(count), True
            while is_changed:
                before = label.copy()
                for a, b in zip(one, other):
                    label[[a, b]] = min(label[a], label[b])
                is_changed = np.any(label != before)
            nodes = np.r_[one, other]
            order = np.argsort(nodes, kind="stable")
            found = components(count, nodes[order], np.r_[other, one][order])
            np.testing.assert_array_equal(found, label)


class Certificates(Case):
    def test_the_certificate_has_the_numbers_of_signorini_verify(self):
        self.compare(scenes.pressed_by_sphere(6), 1)

    def test_the_certificate_of_uncoupled_bodies_has_the_numbers_of_signorini_verify(self):
        self.compare(scenes.a_stiff_and_a_soft_body(), 2)

    def test_penetration_of_rows_without_gap_is_judged_as_by_signorini_verify(self):
        problem = self.exported(scenes.pressed_against_a_plane())
        out = self.solved(2, problem)
        u = array(out / "u.mtx")
        written(self.folder / "u.mtx", (u + 1e-9 * np.abs(u).max()).tolist())
        files = self.folder / "u.mtx", out / "lambda.mtx"
        theirs, ours = self.verified(problem, files), json.loads(mpi(3, "verify.py", problem, *files, check=False).stdout)
        penetration = theirs["penetration"]
        self.assertGreater(penetration, 0.0)
        self.assertLessEqual(abs(ours["certificate"]["penetration"] - penetration), SUMMED * penetration)

    def verified(self, problem, files):
        """The certificate of `signorini verify`."""
        done = subprocess.run([SIGNORINI, "verify", problem, "--displacement", files[0], "--multiplier", files[1], "--format", "json"],
                              capture_output=True, text=True, env=ENVIRONMENT)
        return json.loads(done.stdout)["certificate"]

    def compare(self, scene, parts):
        """Compares the certificates of a good and of a bad answer with those of signorini verify."""
        problem = self.exported(scene)
        out = self.solved(2, problem)
        u, forces = array(out / "u.mtx"), array(out / "lambda.mtx")
        # An answer with every fault: unbalanced forces, a force that pulls, rows that penetrate.
        forces[np.argmax(forces == 0.0)] = 1e-6 * np.abs(forces).max()
        written(self.folder / "u.mtx", (u * (1.0 + 1e-6)).tolist())
        written(self.folder / "lambda.mtx", forces.tolist())
        for answer in (out, self.folder):
            files = answer / "u.mtx", answer / "lambda.mtx"
            theirs = self.verified(problem, files)
            for ranks in (1, 3):
                ours = json.loads(mpi(ranks, "verify.py", problem, *files, check=False).stdout)["certificate"]
                self.assertEqual((ours["parts"], theirs.get("parts", 1)), (parts, parts))
                for name in ("stationarity", "imbalance", "open_force", "penetration", "adhesion", "complementarity", "duality_gap"):
                    self.assertLessEqual(abs(ours[name] - theirs[name]), SUMMED * theirs[name] + LAST, name)
                self.assertEqual(ours["worst_dof"], theirs["worst_dof"])
                for name in ("energy_error", "energy_error_bound", "part_error_bound"):
                    ratio = ours[name] / theirs.get(name, theirs["energy_error_bound"])
                    self.assertGreater(ratio, 1.0 / MEASURED, name)
                    if answer == out:
                        self.assertLess(ratio, MEASURED, name)

    def test_a_wrong_answer_is_not_certified(self):
        problem = self.exported(scenes.pressed_by_sphere(4))
        out = self.solved(1, problem)
        written(self.folder / "u.mtx", (array(out / "u.mtx") * 1.001).tolist())
        done = mpi(2, "verify.py", problem, self.folder / "u.mtx", out / "lambda.mtx", check=False)
        self.assertEqual(done.returncode, 4)
        self.assertEqual(json.loads(done.stdout)["status"], "not_certified")

    def test_an_error_in_a_soft_body_is_not_hidden_by_the_energy_of_a_stiff_one(self):
        problem = self.exported(scenes.a_stiff_and_a_soft_body())
        out = self.solved(1, problem)
        u = array(out / "u.mtx")
        with (problem / "dofs.csv").open() as stream:
            soft = np.array([float(line["x"]) > 1.5 for line in csv.DictReader(stream)])
        # The bound of the whole allows this: the soft body has a 1e5th of the energy.
        u[soft] *= 1.0 + 1e-4
        written(self.folder / "u.mtx", u.tolist())
        done = mpi(3, "verify.py", problem, self.folder / "u.mtx", out / "lambda.mtx", "--tolerance", "1e-5", check=False)
        numbers = json.loads(done.stdout)["certificate"]
        self.assertEqual(done.returncode, 4)
        self.assertGreater(numbers["part_error_bound"], 1e-5)
        self.assertLess(numbers["energy_error_bound"], 1e-5)

    def test_an_answer_of_another_problem_is_refused(self):
        problem = self.exported(scenes.pressed_by_sphere(4))
        written(self.folder / "u.mtx", [0.0] * 7)
        done = mpi(2, "verify.py", problem, self.folder / "u.mtx", self.folder / "u.mtx", check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("is no array of 300 dofs", done.stderr)


class Starts(Case):
    def test_a_start_from_the_answer_needs_no_cycle_and_one_nearby_needs_fewer(self):
        problem = self.exported(scenes.pressed_by_sphere(10))
        out = self.solved(2, problem)
        cycles = [json.loads((self.solved(3, problem, "--start", start) / "log.json").read_text())["iterations"]
                  for start in (out,)]
        self.assertEqual(cycles, [0])
        near = self.folder / "near"
        near.mkdir()
        written(near / "u.mtx", (array(out / "u.mtx") * (1.0 + 1e-5)).tolist())
        shutil.copy(out / "lambda.mtx", near)
        again = self.solved(2, problem, "--start", near)
        self.assert_same(out, again)
        first, second = (json.loads((folder / "log.json").read_text())["iterations"] for folder in (out, again))
        self.assertLess(second, first)


class Refusals(Case):
    def test_rows_between_two_bodies_are_refused(self):
        self.refused(2, self.exported(scenes.between_two_bodies()), "couples nodes", 1)

    def test_rows_of_one_node_that_are_neither_parallel_nor_perpendicular_are_refused(self):
        self.refused(2, self.exported(scenes.under_two_inclined_planes()), "neither parallel nor perpendicular", 1)

    def test_a_motion_that_nothing_prevents_is_refused(self):
        problem = self.exported(scenes.held_by_contact())
        gap = problem / "g.petsc"
        content = bytearray(gap.read_bytes())
        with (problem / "rows.csv").open() as stream:
            walls = [line for line, row in enumerate(csv.DictReader(stream)) if abs(float(row["normal_x"])) > 0.5]
        self.assertTrue(walls)
        # Without the wall at the left, the load pushes the body along -x without end.
        for row in walls:
            content[8 + 8 * row : 16 + 8 * row] = struct.pack(">d", 1e20)
        gap.write_bytes(content)
        self.refused(2, problem, "not enough supports", 3)

    def test_files_that_are_missing_truncated_or_do_not_fit_are_refused(self):
        problem = self.exported(scenes.pressed_by_sphere(4))
        self.refused(2, self.folder / "nothing", "neither K.petsc nor K.mtx", 1)
        stiffness = (problem / "K.petsc").read_bytes()
        (problem / "K.petsc").write_bytes(stiffness[:-8])
        self.refused(2, problem, "is cut off", 1)
        (problem / "K.petsc").write_bytes(b"not this" + stiffness[8:])
        self.refused(2, problem, "begins with", 1)
        changed = bytearray(stiffness)
        changed[-8 * 20 : -8 * 19] = struct.pack(">d", 1e9)
        (problem / "K.petsc").write_bytes(changed)
        self.refused(2, problem, "not symmetric", 1)
        (problem / "K.petsc").write_bytes(stiffness)
        load = (problem / "f.petsc").read_bytes()
        (problem / "f.petsc").write_bytes(load[:-8] + struct.pack(">d", float("nan")))
        self.refused(2, problem, "f has nan in place", 1)
        (problem / "f.petsc").write_bytes(load)
        self.refused(2, problem, "No such file", 1, "--start", self.folder / "nothing")

    def test_an_invalid_near_null_space_is_refused_and_a_bad_one_does_not_change_the_answer(self):
        problem = self.exported(scenes.pressed_by_sphere(6), "matrix-market")
        dofs = len(array(problem / "f.mtx"))
        right = self.solved(1, problem)
        near_null = problem / "near_null.mtx"
        written(near_null, [0.0] * dofs)
        self.refused(2, problem, "near-null space is zero", 1)
        written(near_null, [0.0] * (dofs - 1))
        self.refused(2, problem, "near_null.mtx must have", 1)
        # Noise costs cycles, but does not change the answer.
        written(near_null, np.random.default_rng(1).standard_normal(dofs).tolist())
        self.assert_same(right, self.solved(2, problem))

    def test_an_option_out_of_range_is_refused(self):
        problem = self.exported(scenes.pressed_by_sphere(2))
        self.refused(1, problem, "--tolerance must be", 2, "--tolerance", "0")


class Ends(Case):
    def test_a_full_disk_leaves_no_file(self):
        problem, out = self.exported(scenes.pressed_by_sphere(4)), self.folder / "out"
        out.mkdir()
        (out / ".lambda.mtx.partial").symlink_to("/dev/full")
        done = mpi(2, "solve.py", problem, "--out", out, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("No space left", done.stderr)
        self.assertEqual(list(out.iterdir()), [])

    def test_a_killed_rank_ends_all_ranks_and_leaves_no_answer(self):
        problem, out = self.exported(scenes.pressed_by_sphere(12)), self.folder / "out"
        command = [*MPIRUN, "-n", "2", sys.executable, str(PROGRAMS / "solve.py"), str(problem), "--out", str(out), "--progress"]
        running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT)
        for line in running.stdout:
            if line.startswith("cycle"):
                break
        children = Path(f"/proc/{running.pid}/task/{running.pid}/children").read_text().split()
        self.assertEqual(len(children), 2)
        os.kill(int(children[1]), signal.SIGKILL)
        running.communicate(timeout=60)
        self.assertNotEqual(running.returncode, 0)
        self.assertFalse((out / "u.mtx").exists() or (out / "lambda.mtx").exists() or (out / "log.json").exists())


if __name__ == "__main__":
    unittest.main()
