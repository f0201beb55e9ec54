"""Tests of `mutants.py` without cargo: applying and reverting a change, the draw, the stages, the table."""

import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import mutants
from mutants import Mutant, Stage

TEXT = "fn least(a: f64, b: f64) -> f64 {\n    let less = a < b;\n    if less { a } else { b }\n}\n"

MARK = "/* ~ changed by cargo-mutants ~ */"

LESS = Mutant(
    "src/least.rs:2:18: replace < with > in least",
    "src/least.rs",
    "--- src/least.rs\n+++ replace < with > in least\n@@ -1,4 +1,4 @@\n fn least(a: f64, b: f64) -> f64 {\n"
    f"-    let less = a < b;\n+    let less = a > {MARK} b;\n     if less {{ a }} else {{ b }}\n }}\n",
)

BODY = Mutant(
    "src/least.rs:2:5: replace least -> f64 with 0.0",
    "src/least.rs",
    "--- src/least.rs\n+++ replace least -> f64 with 0.0\n@@ -1,4 +1,3 @@\n fn least(a: f64, b: f64) -> f64 {\n"
    f"-    let less = a < b;\n-    if less {{ a }} else {{ b }}\n+    0.0 {MARK}\n }}\n",
)


class Change(unittest.TestCase):
    def test_a_mutant_changes_only_its_own_lines(self):
        self.assertEqual(LESS.applied(TEXT).replace(f" {MARK}", ""), TEXT.replace("<", ">"))
        self.assertEqual(BODY.applied(TEXT), f"fn least(a: f64, b: f64) -> f64 {{\n    0.0 {MARK}\n}}\n")

    def test_a_change_that_does_not_fit_the_text_is_refused(self):
        with self.assertRaisesRegex(ValueError, "line 2"):
            LESS.applied(TEXT.replace("less", "more"))

    def test_the_key_does_not_depend_on_the_place(self):
        self.assertEqual(LESS.key, ("src/least.rs: replace < with > in least", "let less = a > b;"))
        lower = Mutant(LESS.name.replace(":2:", ":200:"), LESS.file, LESS.diff.replace("-1,4 +1,4", "-199,4 +199,4"))
        self.assertEqual(lower.key, LESS.key)
        self.assertNotEqual(BODY.key, LESS.key)

    def test_the_file_is_restored_however_the_tests_end(self):
        for ending in (None, KeyboardInterrupt):
            with tempfile.TemporaryDirectory() as folder, mock.patch.object(mutants, "judged") as judged:
                file = Path(folder) / LESS.file
                file.parent.mkdir()
                file.write_text(TEXT)
                judged.side_effect = lambda tree, _: (self.assertIn(">", file.read_text().split("\n")[1]), ending)[1]
                if ending:
                    judged.side_effect = ending
                    with self.assertRaises(ending):
                        mutants.tried(LESS, Path(folder), mutants.Area((), ()))
                else:
                    mutants.tried(LESS, Path(folder), mutants.Area((), ()))
                self.assertEqual(file.read_text(), TEXT)


class Draw(unittest.TestCase):
    def every(self, count: int, places: int = 1) -> list[Mutant]:
        """Returns changes of `count` functions, each at `places` places with the same new line."""
        both = [(number, place) for number in range(count) for place in range(places)]
        return [Mutant(f"f.rs:{place}:1: change {number}", "f.rs", f"-\n+\n+x{number}") for number, place in both]

    def drawn(self, *arguments) -> list[Mutant]:
        return [mutant for _, mutant in mutants.drawn(*arguments)]

    def test_a_draw_depends_only_on_its_seed_and_keeps_the_order(self):
        for every in (self.every(500), self.every(100, places=5), self.every(1, places=500)):
            first = self.drawn(every, 100, 1)
            self.assertEqual(first, self.drawn(every, 100, 1))
            self.assertNotEqual(first, self.drawn(every, 100, 2))
            self.assertEqual(first, sorted(first, key=every.index))
            self.assertEqual(len(set(first)), 100)
            self.assertEqual(self.drawn(every, 1000, 1), every)

    def test_a_larger_draw_contains_the_smaller_one(self):
        for every in (self.every(1737), self.every(579, places=3)):
            self.assertLess(set(self.drawn(every, 60, 20)), set(self.drawn(every, 1000, 20)))

    def test_the_other_mutants_stay_drawn_if_some_are_removed(self):
        every = self.every(1737)
        draw = self.drawn(every, 60, 20)
        # An edited line loses its three mutants, drawn or not.
        for gone in (every[100:103], draw[:3], draw[-3:]):
            rest = [mutant for mutant in every if mutant not in gone]
            left = [mutant for mutant in draw if mutant not in gone]
            after = self.drawn(rest, 60, 20)
            self.assertLessEqual(set(left), set(after))
            # The removed mutants are replaced by the next ones of a larger draw.
            larger = self.drawn(every, 60 + len(draw) - len(left), 20)
            self.assertEqual(after, [mutant for mutant in larger if mutant not in gone])

    def test_new_mutants_displace_at_most_their_own_number_and_line_numbers_do_not_matter(self):
        every = self.every(1737)
        draw = self.drawn(every, 60, 20)
        added = [Mutant(f"new.rs:{place}:1: change", "new.rs", f"-\n+\n+y{place}") for place in range(40)]
        after = self.drawn(added + every, 60, 20)
        self.assertEqual(len(set(draw) - set(after)), len(set(after) & set(added)))
        self.assertLessEqual(set(after), set(draw) | set(added))
        self.assertEqual(set(after), set(self.drawn(every + added, 60, 20)))
        # Changes of the lines above a mutant do not change its key.
        lower = [Mutant(mutant.name.replace(":0:", ":70:"), mutant.file, mutant.diff) for mutant in every]
        self.assertEqual([one.key for one in self.drawn(lower, 60, 20)], [one.key for one in draw])

    def test_a_mutant_is_identified_by_its_key_and_its_number_among_equal_ones(self):
        other = Mutant(LESS.name.replace(":2:18:", ":7:3:"), LESS.file, LESS.diff)
        names = mutants.numbered([LESS, BODY, other])
        self.assertEqual(len(set(names)), 3)
        self.assertEqual(mutants.numbered([other, BODY]), names[:2])


class Stages(unittest.TestCase):
    """Tests of `judged` with one stage whose program passes, fails, or does not end."""

    def verdict(self, script: str, builds: bool = True) -> tuple[str, str]:
        program = [sys.executable, "-c", script] if builds else None
        stage = Stage("only", (), (), 1.0)
        run = mutants.ended
        with (
            mock.patch.object(mutants, "programs", lambda tree, stage: [program] if builds else None),
            mock.patch.object(mutants, "ended", lambda command, *rest: run(command[0], *rest)),
        ):
            return mutants.judged(Path("."), mutants.Area((), (stage,)))

    def test_each_ending_has_its_name(self):
        self.assertEqual(self.verdict("pass"), ("survived", ""))
        self.assertEqual(self.verdict("raise SystemExit(101)"), ("killed", "only"))
        self.assertEqual(self.verdict("while True: pass"), ("timed out", "only"))
        self.assertEqual(self.verdict("", builds=False), ("unbuildable", "only"))


class Table(unittest.TestCase):
    def outcomes(self, killed: int, survived: int, unbuildable: int = 0) -> list[tuple[Mutant, str]]:
        kinds = ["killed"] * killed + ["survived"] * survived + ["unbuildable"] * unbuildable
        return [(Mutant(f"f.rs:{at}:1: change {at}", "f.rs", f"a\nb\n+x{at}"), kind) for at, kind in enumerate(kinds)]

    def test_at_most_two_of_a_hundred_may_survive_without_a_reason(self):
        self.assertTrue(mutants.summary(self.outcomes(98, 2), {})[1])
        self.assertFalse(mutants.summary(self.outcomes(97, 3), {})[1])
        # Mutants that do not build are not counted.
        self.assertFalse(mutants.summary(self.outcomes(48, 2, 50), {})[1])

    def test_a_reason_counts_for_its_own_mutant_only(self):
        outcomes = self.outcomes(97, 3)
        known = {outcomes[99][0].key: "it changes the speed only"}
        table, is_met = mutants.summary(outcomes, known)
        self.assertTrue(is_met)
        self.assertIn("it changes the speed only", table)
        self.assertEqual(table.count("NO REASON"), 2)
        known = {("f.rs: change 99", "another line"): "of another line"}
        self.assertFalse(mutants.summary(outcomes, known)[1])

    def test_an_empty_reason_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "mutants.toml"
            self.assertEqual(mutants.reasons(file), {})
            file.write_text('[[survivor]]\nmutant = "f.rs: change"\nline = "x"\nreason = "a tie"\n')
            self.assertEqual(mutants.reasons(file), {("f.rs: change", "x"): "a tie"})
            file.write_text('[[survivor]]\nmutant = "f.rs: change"\nline = "x"\nreason = " "\n')
            with self.assertRaises(SystemExit):
                mutants.reasons(file)


if __name__ == "__main__":
    unittest.main()
