"""Answers in JSON become dataclasses; no server is needed.

usage: reading_test.py SOURCES
"""

import dataclasses
import math
import sys
import unittest

import collided
from collided import Verdict
from collided._described import read


class Reading(unittest.TestCase):
    def test_members_that_were_not_written_are_false_0_empty_or_none(self):
        pair = read(collided.PairAnswer, {"answer": "miss", "distance": 2, "version": 7})
        self.assertEqual((pair.verdict, pair.distance, pair.version, pair.stale, pair.reason), (Verdict.MISS, 2.0, 7, False, ""))
        self.assertEqual((pair.normal, pair.a_triangle, pair.manifold, pair.certificate), ((0, 0, 0), None, (), None))
        self.assertIs(type(pair.distance), float)

    def test_names_and_words_of_json_become_those_of_python(self):
        row = {"answer": "hit", "in_solid": True, "contained": "b", "pair_count": 3, "a_triangle": 0xFFFFFFFF, "b_triangle": 0}
        pair = read(collided.PairAnswer, row)
        self.assertEqual((pair.is_in_solid, pair.contained, pair.triangle_pair_count), (True, "b_in_a", 3))
        self.assertEqual((pair.a_triangle, pair.b_triangle), (None, 0))
        details = read(collided.ObjectDetails, {"name": "a", "solid_by": "winding", "position": None, "pose": [1, 2, 3, 1, 0, 0, 0]})
        self.assertEqual((details.solid_by_winding, details.position, details.pose), (True, None, (1, 2, 3, 1, 0, 0, 0)))
        self.assertFalse(read(collided.ObjectDetails, {}).solid_by_winding)

    def test_verdicts_have_words_of_their_own_by_what_was_asked(self):
        for words, verdict in ((("miss", "outside", "apart"), Verdict.MISS), (("hit", "inside", "touching"), Verdict.HIT),
                               (("undecided", "a word of later"), Verdict.UNDECIDED)):
            for word in words:
                self.assertIs(read(collided.ExplainedGap, {"answer": word}).verdict, verdict)

    def test_rows_without_names_are_taken_in_the_order_of_the_members(self):
        pair = read(collided.PairAnswer, {"manifold": [[1, 2, 3, 0.5, 1e-9, 0xFFFFFFFF, 7]]})
        self.assertEqual(pair.manifold, (collided.ManifoldPoint((1, 2, 3), 0.5, 1e-9, None, 7),))
        (box,) = read(collided.Loaded, {"covers": [["-inf", 0, 0, "inf", 1, 2]]}).covers
        self.assertEqual((box.low, box.high), ((-math.inf, 0, 0), (math.inf, 1, 2)))

    def test_the_two_ends_of_an_interval_are_one_tuple(self):
        row = {"kind": "within", "closing_mps": 2, "left_low_s": 0.5, "left_high_s": 0.25, "contact_in": {"low_s": 1, "high_s": "inf"}}
        event = read(collided.StandingEvent, row)
        self.assertEqual((event.left, event.contact_in, event.closing), ((0.5, 0.25), (1, math.inf), 2))
        self.assertEqual((event.bracket, read(collided.StandingEvent, {}).contact_in), ((0, 0), None))
        self.assertEqual(read(collided.Event, {"a_triangle": 0xFFFFFFFF, "b_triangle": 3}).b_triangle, 3)

    def test_a_status_has_its_times_in_nanoseconds_and_its_publishers(self):
        row = {"namespace": "cell", "world": 7, "age": 0.5, "age_ns": 500_000_000,
               "publishers": [{"name": "arm", "silent": 0.25, "silent_ns": 250_000_000, "lost": True}]}
        status = read(collided.ServerStatus, row)
        self.assertEqual((status.name_space, status.version, status.age_ns), ("cell", 7, 500_000_000))
        self.assertEqual(status.publishers, (collided.PublisherInfo("arm", 0, 250_000_000, True),))

    def test_an_explained_pair_holds_the_answer_that_its_row_also_has(self):
        why = read(collided.ExplainedPair, {"answer": "hit", "depth": 0.5, "why_not": ["x"], "nearest": {"distance": "inf"}})
        self.assertEqual((why.answer.depth, why.why_not, why.nearest.distance), (0.5, ("x",), math.inf))
        self.assertTrue(why)

    def test_an_answer_is_as_true_as_its_verdict_and_does_not_change(self):
        self.assertFalse(read(collided.ClearanceAnswer, {"answer": "miss"}))
        with self.assertRaises(collided.Undecided):
            bool(read(collided.ExplainedRay, {"answer": "undecided"}))
        # An object that explains is there, whatever its verdict.
        self.assertTrue(read(collided.ExplainedObject, {"answer": "outside"}))
        with self.assertRaises(dataclasses.FrozenInstanceError):
            read(collided.Cleared, {"removed": 1}).removed = 2

    def test_help_has_the_members_of_every_answer(self):
        for name in collided.__all__:
            kind = getattr(collided, name)
            if name == "Shape":
                continue  # a union, which has no text of its own
            self.assertEqual(kind.__module__, "collided", name)
            self.assertTrue(kind.__doc__ and not kind.__doc__.startswith(name + "("), name)
            if name in collided._schema.__all__:
                for field in dataclasses.fields(kind):
                    if field.name in kind.__annotations__:
                        self.assertRegex(kind.__doc__, rf"\n    {field.name}\b")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
