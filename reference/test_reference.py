"""Tests of the reference itself: `python -m unittest` in this folder, with the pinned environment."""

import unittest

import numpy as np

import derivatives
import elastic_block
import kinks
import oracles
import raw_problems
from compare import distance, weak_rows
from kkt import Rejected, kkt, reject
from problem import Answer, problem_of
from scaling import largest, scales_of
from settle import Unsettled, contact_set, settle
from solvers import SOLVERS, osqp_direct
from stand_in import WRONG_ANSWERS

ROUNDING = 1e-12
"""Relative tolerance for small well-conditioned problems in double precision."""


def solution(problem) -> Answer:
    """Returns the settled answer of OSQP."""
    return settle(problem, contact_set(problem, osqp_direct(problem).answer)).answer


def random_problem(random, dofs: int, rows: int):
    """Returns a dense positive definite problem with general rows. It is feasible, because one point satisfies all rows strictly."""
    factor = random.standard_normal((dofs, dofs))
    contact = random.standard_normal((rows, dofs))
    inside = random.standard_normal(dofs)
    stiffness = factor @ factor.T + 0.1 * np.identity(dofs)
    stiffness = 0.5 * (stiffness + stiffness.T)
    return problem_of(
        stiffness, random.standard_normal(dofs), contact, contact @ inside + random.uniform(0.0, 1.0, rows)
    )


class Generators(unittest.TestCase):
    def test_two_springs_share_the_force_with_the_obstacle(self):
        answer = solution(raw_problems.two_springs(first=300.0, second=100.0, force=10.0, gap=0.05))
        self.assertAlmostEqual(answer.force, 10.0 - 0.05 / (1 / 300 + 1 / 100), delta=ROUNDING * 10)

    def test_two_springs_out_of_reach_have_the_answer_of_a_linear_solve(self):
        answer = solution(raw_problems.two_springs(gap=0.2))
        self.assertAlmostEqual(answer.displacement[1], 10.0 * (1 / 300 + 1 / 100), delta=ROUNDING)
        self.assertEqual(answer.force, 0.0)

    def test_string_lies_on_the_obstacle_between_b_and_1_minus_b(self):
        problem = raw_problems.string_over_obstacle(elements=200, load=1.0, gap=0.08)
        answer = solution(problem)
        nodes = np.flatnonzero(answer.multiplier < 0.0) + 1
        self.assertEqual((nodes[0], nodes[-1]), (80, 120))
        self.assertAlmostEqual(answer.force, 0.2, delta=1e-11)
        x = np.arange(1, 80) / 200
        self.assertLess(largest(answer.displacement[:79] - (0.5 * (0.4 - x) ** 2 - 0.08)), 1e-13)

    def test_string_has_two_weak_nodes_at_the_intended_places(self):
        problem = raw_problems.string_with_weak_nodes(elements=256, node=100)
        self.assertEqual(list(np.flatnonzero(weak_rows(problem, solution(problem))) + 1), [100, 156])

    def test_membrane_carries_less_than_its_load_and_is_symmetric(self):
        problem = raw_problems.membrane_over_obstacle(side=21)
        answer = solution(problem)
        pressure = answer.multiplier.reshape(21, 21)
        self.assertLess(largest(pressure - pressure.T), 1e-12 * largest(pressure))
        self.assertTrue(0.0 < answer.force < -problem.load.sum())

    def test_floating_rod_shortens_between_force_and_wall(self):
        answer = solution(raw_problems.floating_rod(axial_stiffness=2e3, length=2.0, force=5.0, gap=0.01))
        self.assertAlmostEqual(answer.force, 5.0, delta=5.0 * ROUNDING)
        self.assertAlmostEqual(answer.displacement[0], 0.01 + 5.0 * 2.0 / 2e3, delta=ROUNDING)

    def test_two_sided_bounds_are_kept_and_partly_reached(self):
        problem = raw_problems.bounded_quadratic()
        closed = solution(problem).multiplier < 0.0
        self.assertFalse(np.any(closed[:400] & closed[400:]))
        self.assertTrue(50 < closed.sum() < 350)

    def test_rectangle_resists_no_rigid_body_mode(self):
        stiffness = elastic_block.rectangle_stiffness(0.3, 0.2, elastic_block.plane_strain(1e7, 0.3))
        x, y = np.array([0, 0.3, 0.3, 0]), np.array([0, 0, 0.2, 0.2])
        for motion in (np.tile([1, 0], 4), np.tile([0, 1], 4), np.column_stack([-y, x]).ravel()):
            self.assertLess(largest(stiffness @ motion), 1e-14 * largest(stiffness))

    def test_rectangle_stretched_between_rollers_stores_half_m_eps_squared(self):
        # For eps_xx = 1 only, the energy per volume is M/2 with M = E (1-nu) / ((1+nu)(1-2nu)).
        stiffness = elastic_block.rectangle_stiffness(0.3, 0.2, elastic_block.plane_strain(1e7, 0.3))
        stretch = np.array([0, 0, 0.3, 0, 0.3, 0, 0, 0])
        modulus = 1e7 * 0.7 / (1.3 * 0.4)
        self.assertAlmostEqual(stretch @ stiffness @ stretch / (0.3 * 0.2 * modulus), 1.0, delta=ROUNDING)


class Conditions(unittest.TestCase):
    def setUp(self):
        self.problem = elastic_block.indentation(-0.05, columns=8, layers=4)
        self.answer = solution(self.problem)

    def test_the_solution_is_not_rejected(self):
        self.assertLess(reject(self.problem, self.answer).worst(), 1e-12)

    def test_every_planted_fault_is_rejected(self):
        for name, fault in WRONG_ANSWERS.items():
            with self.subTest(name), self.assertRaises(Rejected):
                reject(self.problem, fault(self.answer))

    def test_each_condition_detects_its_own_fault(self):
        u, multiplier = self.answer.displacement, self.answer.multiplier
        open_row = int(np.flatnonzero(multiplier == 0.0)[0])
        pulled, shifted = multiplier.copy(), u.copy()
        pulled[open_row] = 0.1 * largest(multiplier)
        shifted[0] += 0.1 * largest(u)
        through = Answer(u * 1.01, multiplier)
        unload = problem_of(self.problem.stiffness, self.problem.load, self.problem.contact, self.problem.gap + 0.01)
        self.assertIn("adhesion", kkt(self.problem, Answer(u, pulled)).violated())
        self.assertIn("stationarity", kkt(self.problem, Answer(shifted, multiplier)).violated())
        self.assertIn("penetration", kkt(self.problem, Answer(u * 0.99, multiplier)).violated())
        self.assertIn("complementarity", kkt(unload, self.answer).violated())
        self.assertIn("duality_gap", kkt(self.problem, through).violated())

    def test_numbers_do_not_depend_on_units(self):
        p, a = self.problem, Answer(self.answer.displacement * 1.001, self.answer.multiplier)
        other = problem_of(p.stiffness * 2.0**40, p.load, p.contact, p.gap * 2.0**-30)
        scaled = Answer(a.displacement * 2.0**-30, a.multiplier * 2.0**10)
        self.assertEqual(kkt(p, a), kkt(other, scaled))

    def test_not_a_number_is_rejected(self):
        with self.assertRaises(Rejected):
            reject(self.problem, Answer(self.answer.displacement * np.nan, self.answer.multiplier))

    def test_a_different_contact_set_is_named_by_its_row(self):
        multiplier = self.answer.multiplier.copy()
        row = int(np.argmin(multiplier))
        multiplier[row] = 0.0
        apart = distance(self.problem, Answer(self.answer.displacement - 1e-6, multiplier), self.answer)
        self.assertIn(row, apart.differing)


class Oracles(unittest.TestCase):
    def agree(self, problem, one: Answer, other: Answer):
        self.assertLess(largest(one.displacement - other.displacement), 1e-9 * largest(other.displacement))
        self.assertLess(largest(one.multiplier - other.multiplier), 1e-8 * (largest(other.multiplier) or 1.0))

    def test_settled_answers_equal_the_enumeration_of_all_contact_sets(self):
        random = np.random.default_rng(7)
        for _ in range(20):
            problem = random_problem(random, dofs=8, rows=6)
            self.agree(problem, solution(problem), oracles.enumerate_contact_sets(problem))

    def test_settling_reaches_the_solution_from_any_contact_set(self):
        for problem in (raw_problems.cycling_from_any_start(), raw_problems.cycling_from_all_open()):
            expected = oracles.enumerate_contact_sets(problem)
            for bits in range(8):
                start = np.array([bits & 1, bits & 2, bits & 4], bool)
                self.agree(problem, settle(problem, start).answer, expected)

    def test_the_basic_loop_cycles_on_the_problems_made_for_it(self):
        for problem in (raw_problems.cycling_from_any_start(), raw_problems.cycling_from_all_open()):
            with self.assertRaises(oracles.Cycled):
                oracles.active_set_loop(problem)

    def test_the_basic_loop_finds_the_settled_answer_on_a_block(self):
        problem = elastic_block.indentation(-0.05, columns=8, layers=4)
        self.agree(problem, oracles.active_set_loop(problem), solution(problem))

    def test_every_solver_reaches_the_enumerated_answer(self):
        problem = random_problem(np.random.default_rng(11), dofs=6, rows=5)
        expected = oracles.enumerate_contact_sets(problem)
        for name, solver in SOLVERS.items():
            with self.subTest(name):
                apart = distance(problem, solver(problem).answer, expected)
                self.assertLess(apart.displacement, 1e-6)
                self.assertLess(apart.multiplier, 1e-6)

    def test_answers_of_solvers_do_not_depend_on_units(self):
        problem = raw_problems.two_springs()
        tiny = problem_of(problem.stiffness * 2.0**30, problem.load * 2.0**-10, problem.contact, problem.gap * 2.0**-40)
        for name, solver in SOLVERS.items():
            with self.subTest(name):
                plain, scaled = solver(problem).answer, solver(tiny).answer
                np.testing.assert_array_equal(scaled.displacement * 2.0**40, plain.displacement)
                np.testing.assert_array_equal(scaled.multiplier * 2.0**10, plain.multiplier)

    def test_a_body_without_any_support_is_not_settled(self):
        rod = raw_problems.floating_rod()
        with self.assertRaises(Unsettled):
            settle(rod, np.zeros(1, bool))

    def test_scales_are_powers_of_two(self):
        scales = scales_of(elastic_block.indentation(-0.03, columns=8, layers=4))
        self.assertEqual(np.frexp(scales.displacement)[0], 0.5)
        self.assertEqual(np.frexp(scales.stiffness)[0], 0.5)


class Kinks(unittest.TestCase):
    def test_exact_one_sided_derivatives_are_slopes_of_enumerated_answers(self):
        def output(given, step: float) -> float:
            (df, dg), (by_u, by_lambda) = given.change, given.output
            moved = problem_of(given.stiffness, given.load + step * df, given.contact, given.gap + step * dg)
            answer = oracles.enumerate_contact_sets(moved)
            return by_u @ answer.displacement + by_lambda @ answer.multiplier

        for given in kinks.kinks(20, seed=3):
            for sign in (-1, 1):
                # The answer is linear up to the next kink.
                near, far = sign * 2.0**-14, sign * 2.0**-13
                slope = (output(given, far) - output(given, near)) / (far - near)
                self.assertAlmostEqual(slope, given.along(sign), delta=1e-8 * (1 + abs(slope)))

    def test_away_from_kinks_the_gradient_gives_the_derivative_along_every_change(self):
        for given in kinks.kinks(10, seed=4)[::2]:
            along = sum(gradient @ change for gradient, change in zip(given.gradient(with_weak=False), given.change, strict=True))
            self.assertAlmostEqual(along, given.along(1), delta=ROUNDING * 1e3)
            self.assertEqual(given.along(1), given.along(-1))

    def test_derivatives_of_the_package_are_exact_and_no_kink_is_called_smooth(self):
        programs = kinks.kinks(10)
        row = derivatives.judge(derivatives.by_signorini, programs)
        self.assertEqual((len(row.errors), row.says, sum(row.pieces.values())), (5, 5, 0))
        self.assertLess(max(row.errors), derivatives.WRONG)
        claimed, named, worst = derivatives.judge_sides(programs[1::2])
        self.assertEqual((claimed, named), (5, 5))
        self.assertLess(worst, derivatives.WRONG)


class Data(unittest.TestCase):
    def test_vectors_that_do_not_fit_are_refused(self):
        with self.assertRaises(ValueError):
            problem_of(np.identity(2), [0.0, 0.0], [[1.0, 0.0]], [0.0, 0.0])


if __name__ == "__main__":
    unittest.main()
