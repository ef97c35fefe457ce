"""The Python client against a running server: what the command line answers is the judge, as a program of its own.

usage: client_test.py COLLIDE DOMAIN [--without-numpy]
"""

import asyncio
import gc
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

COLLIDE, DOMAIN = sys.argv[1], int(sys.argv[2])
if "--without-numpy" in sys.argv:
    sys.modules["numpy"] = None  # importing it fails from here on
SEED = int(os.environ.get("COLLIDED_SEED") or 20261124)

import collided  # noqa: E402
from collided import Verdict  # noqa: E402

try:
    import numpy
except ImportError:
    numpy = None


def said(question, lines):
    """What the command line answers to questions: of each one the first line, which is its first hit."""
    text = "".join(json.dumps(line) + "\n" for line in lines)
    run = subprocess.run(
        [COLLIDE, "--domain", str(DOMAIN), question, "-", "--json"], input=text, capture_output=True, text=True, check=False
    )
    first = {}
    for line in map(json.loads, run.stdout.splitlines()):
        first.setdefault(line["id"], line)
    return list(first.values())


def rays(count, seed=SEED):
    source = random.Random(seed)
    origins = [[source.uniform(-8, 8), source.uniform(-6, 6), source.uniform(0, 4)] for _ in range(count)]
    directions = [[source.gauss(0, 1) for _ in range(3)] for _ in range(count)]
    return origins, directions


def wait_in_step(*watches):
    """Until they report what begins, rather than what holds already."""
    until = time.monotonic() + 20
    while not all(watch.in_step for watch in watches) and time.monotonic() < until:
        time.sleep(0.01)


class WithServer(unittest.TestCase):
    def setUp(self):
        self.client = collided.connect(domain=DOMAIN)
        self.addCleanup(self.client.close)


class Groups(WithServer):
    """Unit cubes 100 m up, two metres between the hand and the wall."""

    def setUp(self):
        super().setUp()
        for name, x in (("robot/hand", 0), ("robot/arm", -1.5), ("cell/wall", 3), ("cell/post", 8)):
            self.client.add(name, collided.Box((0.5, 0.5, 0.5)), (x, 0, 100))
            self.addCleanup(self.client.remove, name)

    def test_clearance_has_the_nearest_pairs_first(self):
        found = self.client.clearance("robot/*", "cell/*")
        self.assertFalse(found)
        (pair,) = found.pairs
        self.assertEqual((pair.a, pair.b), ("robot/hand", "cell/wall"))
        self.assertAlmostEqual(pair.clearance, 2, delta=pair.error)
        self.assertAlmostEqual(pair.on_b[0], 2.5)
        self.assertTrue(found.cut)
        near = self.client.clearance("robot/*", "cell/*", most=10, nearer=4)
        self.assertEqual([pair.a for pair in near.pairs], ["robot/hand", "robot/arm"])
        self.assertFalse(near.cut)
        with self.assertRaisesRegex(collided.Refused, "no object's name matches 'robt/\\*'"):
            self.client.clearance("robt/*")

    def test_what_if_answers_each_configuration_and_moves_nothing(self):
        places = [0, 1.75, 2.25]
        poses = [[x, 0, 100, 1, 0, 0, 0] for x in places]
        free = self.client.what_if(["robot/hand"], poses, "cell/wall")
        self.assertEqual([answer.verdict for answer in free], [Verdict.MISS, Verdict.MISS, Verdict.HIT])
        self.assertEqual(free.object, [None, None, "robot/hand"])
        near = self.client.what_if(["robot/hand"], poses, "cell/wall", clearance=True)
        for answer, x in zip(near, places):
            first, second = answer.hits
            self.assertEqual((first.object, second.object), ("robot/hand", "cell/wall"))
            self.assertAlmostEqual(first.distance, 2 - x, delta=first.error + 1e-12)
        held = self.client.what_if(["robot/hand"], [[4.5, 0, 100, 1, 0, 0, 0]], "cell/wall", attached=[("robot/arm", "robot/hand")])
        self.assertEqual(held.object, ["robot/arm"])
        with self.assertRaises(collided.BadInput):
            self.client.what_if(["robot/hand", "robot/arm"], poses)
        with self.assertRaisesRegex(collided.Refused, "object 'hnd' is not in the world"):
            self.client.what_if(["hnd"], poses)
        if numpy is not None:
            both = numpy.array([[[5, 0, 100, 1, 0, 0, 0], [-5, 0, 100, 1, 0, 0, 0]], [[0, 0, 100, 1, 0, 0, 0], [9, 0, 100, 1, 0, 0, 0]]], dtype=float)
            self.assertEqual(list(self.client.what_if(["robot/hand", "robot/arm"], both, "cell/*").verdict), [Verdict.MISS, Verdict.HIT])


class Questions(WithServer):
    def test_rays_equal_the_command_lines(self):
        origins, directions = rays(500)
        answers = self.client.rays(origins, directions)
        judged = said("ray", [{"from": o, "dir": d} for o, d in zip(origins, directions)])
        self.assertEqual(len(answers), len(judged))
        self.assertGreater(sum(1 for line in judged if line["answer"] == "hit"), 100)
        self.assertGreater(sum(1 for line in judged if line["answer"] == "miss"), 10)
        for answer, line in zip(answers, judged):
            self.assertEqual(answer.verdict.name.lower(), line["answer"])
            if answer.verdict == Verdict.HIT:
                self.assertEqual(answer.hits[0].object, line["object"])
                self.assertEqual(answer.hits[0].distance, line["distance"])  # to the last bit

    def test_a_verdict_alone_has_no_hits(self):
        origins, directions = rays(300, SEED + 2)
        expected = self.client.rays(origins, directions, mode="any")
        answers = self.client.rays(origins, directions, mode="verdict")
        self.assertEqual([answer.verdict for answer in answers], [answer.verdict for answer in expected])
        self.assertEqual(sum(len(answer.hits) for answer in answers), 0)
        self.assertGreater(sum(len(answer.hits) for answer in expected), 10)
        with self.assertRaisesRegex(collided.Refused, "near questions do not have hit mode 4"):
            self.client.nearest([[0, 0, 0]], mode="verdict")

    def test_columns_are_of_each_first_hit(self):
        origins, directions = rays(300, SEED + 1)
        answers = self.client.rays(origins, directions, mode="all")
        names = answers.object
        for i, answer in enumerate(answers):
            self.assertEqual(int(answers.hit_count[i]), len(answer.hits))
            if answer.hits:
                self.assertEqual(float(answers.distance[i]), answer.hits[0].distance)
                self.assertEqual(names[i], answer.hits[0].object)
            else:
                self.assertTrue(math.isnan(float(answers.distance[i])))
                self.assertIsNone(names[i])
        self.assertGreater(max(len(answer.hits) for answer in answers), 1)
        table = answers.hits()
        self.assertEqual(len(table), sum(len(answer.hits) for answer in answers))

    def test_lengths_cut_rays(self):
        origins, directions = [[0, 0, 5]] * 3, [[0, 0, -1]] * 3
        free = self.client.rays(origins, directions)
        reach = free[0].hits[0].distance
        cut = self.client.rays(origins, directions, [reach * 0.99, reach * 1.01, math.inf])
        self.assertEqual([a.verdict for a in cut], [Verdict.MISS, Verdict.HIT, Verdict.HIT])
        self.assertEqual(self.client.rays(origins, directions, 0.5)[2].verdict, Verdict.MISS)

    def test_spheres_boxes_and_nearest_equal_the_command_lines(self):
        source = random.Random(SEED + 2)
        points = [[source.uniform(-8, 8), source.uniform(-6, 6), source.uniform(0, 3)] for _ in range(200)]
        spheres = self.client.spheres(points, 0.4)
        judged = said("sphere", [{"center": p, "radius": 0.4} for p in points])
        self.assertEqual(len(judged), len(points))
        for answer, line in zip(spheres, judged):
            self.assertEqual(answer.verdict.name.lower(), line["answer"])
            if answer.hits:
                self.assertEqual(answer.hits[0].distance, line["depth"])
        nearest = self.client.nearest(points)
        for answer, line in zip(nearest, said("near", [{"point": p} for p in points])):
            self.assertEqual(answer.hits[0].object, line["object"])
            self.assertEqual(answer.hits[0].distance, line["distance"])
        boxes = self.client.boxes(points, [[0.4, 0.4, 0.4]] * len(points))
        turned = self.client.boxes(points, [[0.4, 0.4, 0.4]] * len(points), [[math.sqrt(0.5), 0, 0, math.sqrt(0.5)]] * len(points))
        hits = [answer.verdict == Verdict.HIT for answer in boxes]
        self.assertTrue(any(hits) and not all(hits))
        # A cube turned by a quarter is the same cube; only where it merely touches may the rounded quaternion matter.
        self.assertLess(sum(a != (t.verdict == Verdict.HIT) for a, t in zip(hits, turned)), 3)

    def test_inside_of_a_box_and_of_a_declared_mesh(self):
        corners = [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
        self.client.add("py_solid", collided.Mesh(corners, faces), (600, 0, 0), solid=True)
        try:
            answers = self.client.inside([[600, 0, 0.75], [600, 0, 1.25]])
            self.assertEqual([a.verdict for a in answers], [Verdict.HIT, Verdict.MISS])
            self.assertEqual(answers[0].hits[0].object, "py_solid")
            self.assertEqual(answers[0].hits[0].distance, 0.25)
            with self.assertRaises(collided.Refused):
                self.client.add("py_open", collided.Mesh(corners, faces[1:]), (610, 0, 0), solid=True)
            self.client.add("py_scan", collided.Mesh(corners, faces[1:]), (620, 0, 0), solid="winding")
            scanned, beside = self.client.inside([[620.5, 0, 0], [622, 0, 0]])
            self.assertEqual((scanned.verdict, beside.verdict), (Verdict.HIT, Verdict.MISS))
            self.assertTrue(scanned.hits[0].inside and scanned.hits[0].by_winding)
            self.assertFalse(answers[0].hits[0].by_winding)
            both = self.client.inside([[600, 0, 0.75], [620.5, 0, 0], [622, 0, 0]])
            self.assertEqual([list(map(int, column)) for column in (both.inside, both.by_winding)], [[1, 2, 0], [0, 1, 0]])
            with self.assertRaisesRegex(collided.BadInput, "solid is 'guess'; known are True, False and \"winding\""):
                self.client.add("py_guess", collided.Mesh(corners, faces), solid="guess")
            self.client.remove("py_scan")
            with tempfile.TemporaryDirectory() as folder:
                path = os.path.join(folder, "tub.obj")
                with open(path, "w", encoding="utf-8") as file:
                    file.write("o tub\n" + "".join(f"v {x} {y} {z}\n" for x, y, z in corners))
                    file.write("".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces[1:]))
                self.client.load(path, solid="*", solid_by="winding")
            self.assertTrue(self.client.get("tub/tub").solid_by_winding)
            self.assertTrue(self.client.clear("tub").removed)
        finally:
            self.client.remove("py_solid")

    def test_a_sweep_finds_the_first_contact(self):
        self.client.add("py_gate", collided.Box((0.5, 5, 5)), (3, 0, 150))
        self.addCleanup(self.client.remove, "py_gate")
        at = lambda x, z=150: [x, 0, z, 1, 0, 0, 0]
        answers = self.client.sweep(collided.Sphere(0.5), [at(0), at(0), at(0, 160)], [at(4), at(1), at(4, 160)], only="py_*")
        self.assertEqual([answer.verdict for answer in answers], [Verdict.HIT, Verdict.MISS, Verdict.MISS])
        (hit,) = answers[0].hits
        self.assertEqual(hit.object, "py_gate")
        self.assertLessEqual(hit.time_low, 0.5)
        self.assertGreaterEqual(hit.time_high, 0.5)
        self.assertLess(hit.time_high - hit.time_low, 1e-5)
        self.assertEqual(answers.time_low[0], hit.time_low)
        two = [collided.Sphere(0.5), collided.Sphere(0.5, (1, 0, 0))]
        self.assertTrue(self.client.sweep(two, [at(0)], [at(1.25)], only="py_*", mode="any")[0])
        for wrong in (lambda: self.client.sweep([], [at(0)], [at(1)]), lambda: self.client.sweep(two, [at(0)], [at(1), at(2)]),
                      lambda: self.client.sweep(collided.HalfSpace((0, 0, 0)), [at(0)], [at(1)])):
            with self.assertRaises(collided.BadInput):
                wrong()

    def test_memory_of_earlier_answers_is_used_again(self):
        origins, directions = rays(1000)
        first = self.client.rays(origins, directions)
        kept = list(first.distance)
        second = self.client.rays(origins[:7], directions[:7], out=first)
        self.assertIs(second, first)
        self.assertEqual(len(second), 7)
        self.assertEqual([x for x in second.distance if not math.isnan(x)], [x for x in kept[:7] if not math.isnan(x)])
        with self.assertRaises(collided.BadInput):
            self.client.rays([[0, 0, 0]], [[0, 0, 0]], out=first)
        self.assertEqual(len(first), 0)  # nothing of the earlier ones is passed off as an answer

    def test_undecided_is_neither_true_nor_false(self):
        origins, directions = rays(200)
        answers = self.client.rays(origins, directions, mode="all", max_hits=1)
        cut = [answer for answer in answers if answer.verdict == Verdict.UNDECIDED]
        self.assertTrue(cut)
        self.assertEqual(cut[0].reason, "truncated")
        for doubtful in (cut[0], cut[0].verdict, Verdict.INVALID):
            with self.assertRaises(collided.Undecided):
                bool(doubtful)
        with self.assertRaises(collided.Undecided):
            answers.is_hit()
        with self.assertRaises(collided.Undecided):
            bool(answers)

    def test_pair(self):
        self.client.add("py_box", collided.Box((0.5, 0.5, 0.5)), (100, 0, 0))
        self.client.add("py_ball", collided.Sphere(0.5), (102, 0, 0))
        try:
            apart = self.client.pair("py_box", "py_ball")
            self.assertFalse(apart)
            self.assertAlmostEqual(apart.distance, 1.0, delta=apart.error + 1e-15)
            self.client.move("py_ball", (100.75, 0, 0))
            touching = self.client.pair("py_box", "py_ball", certificate=True)
            self.assertTrue(touching)
            self.assertAlmostEqual(touching.depth, 0.25, delta=touching.error + 1e-15)
            for point in touching.manifold:
                self.assertAlmostEqual(point.depth, 0.25, delta=point.error + 1e-15)
            self.assertTrue(touching.certificate.touches if touching.certificate else touching.no_certificate)
            self.assertIsNone(touching.opinion)
        finally:
            self.assertEqual(self.client.remove("py_*"), 2)

    def test_many_threads_ask_one_client(self):
        origins, directions = rays(400)
        wanted = self.client.rays(origins, directions).object
        found = []

        def ask():
            for _ in range(5):
                found.append(self.client.rays(origins, directions, timeout=20).object)

        threads = [threading.Thread(target=ask) for _ in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(found, [wanted] * 30)


@unittest.skipIf(numpy is None, "numpy is not installed")
class Arrays(WithServer):
    def test_contiguous_doubles_are_not_copied(self):
        from collided import _numbers

        array = numpy.zeros((10, 3))
        self.assertEqual(_numbers.rows(array, 3, "it").pointer.value, array.ctypes.data)
        array.setflags(write=False)
        self.assertEqual(_numbers.rows(array, 3, "it").pointer.value, array.ctypes.data)

    def test_other_layouts_answer_the_same(self):
        origins, directions = rays(100)
        wanted = self.client.rays(origins, directions).distance
        o, d = numpy.array(origins), numpy.array(directions)
        wide = numpy.zeros((100, 9))
        wide[:, 2:5] = o
        forms = [numpy.asfortranarray(o), wide[:, 2:5], o.astype(">f8"), o[::-1][::-1]]
        for form in forms:
            numpy.testing.assert_array_equal(self.client.rays(form, d).distance, wanted)
        self.assertEqual(self.client.rays(o, d).point.shape, (100, 3))

    def test_wrong_arrays_are_refused(self):
        good = numpy.zeros((4, 3))
        down = numpy.tile([0.0, 0.0, -1.0], (4, 1))
        for bad in (
            numpy.zeros((4, 2)),
            numpy.zeros(3),
            numpy.zeros((2, 3, 3)),
            numpy.zeros((4, 3), dtype=complex),
            numpy.zeros((4, 3), dtype=object),
            numpy.zeros((4, 3), dtype=bool),
            numpy.array([["a", "b", "c"]]),
            numpy.zeros((3, 3)),
            None,
        ):
            with self.assertRaises(collided.BadInput, msg=repr(bad)):
                self.client.rays(bad, down)
            with self.assertRaises(collided.BadInput):
                self.client.rays(good, bad)

    def test_a_hundred_thousand_rays(self):
        origins, directions = rays(100_000)
        answers = self.client.rays(numpy.array(origins), numpy.array(directions), timeout=60)
        table = answers.hits()
        self.assertEqual(len(answers), 100_000)
        hit = answers.verdict == int(Verdict.HIT)
        numpy.testing.assert_array_equal(table["distance"], answers.distance[hit])
        numpy.testing.assert_array_equal(table["question"], numpy.flatnonzero(hit))


class Refusals(WithServer):
    def test_bad_input_says_what_is_wrong(self):
        nan = math.nan
        for wrong in (
            lambda c: c.rays([[0, 0]], [[0, 0, 1]]),
            lambda c: c.rays([[0, 0, 0]] * 2, [[0, 0, 1]]),
            lambda c: c.rays([["a", 0, 0]], [[0, 0, 1]]),
            lambda c: c.rays([[nan, 0, 0]], [[0, 0, 1]]),
            lambda c: c.rays([[0, 0, 0]], [[0, 0, 0]]),
            lambda c: c.rays([], []),
            lambda c: c.rays([[0, 0, 0]], [[0, 0, 1]], mode="first"),
            lambda c: c.rays([[0, 0, 0]], [[0, 0, 1]], timeout=0),
            lambda c: c.rays([[0, 0, 0]], [[0, 0, 1]], timeout=-1),
            lambda c: c.rays([[0, 0, 0]], [[0, 0, 1]], as_of="yesterday"),
            lambda c: c.rays([[0, 0, 0]], [[0, 0, 1]], mask=-1),
            lambda c: c.rays([[0, 0, 0]], [[0, 0, 1]], max_hits=0),
            lambda c: c.rays([[0, 0, 0]], [[0, 0, 1]], max_hit=1),
            lambda c: c.rays([[0, 0, 0]], [[0, 0, 1]], only="a\0b"),
            lambda c: c.spheres([[0, 0, 0]], -1.0),
            lambda c: c.spheres([[0, 0, 0]], [1.0, 2.0]),
            lambda c: c.add("x", "a box"),
            lambda c: c.add("x", []),
            lambda c: c.add("x", collided.Sphere(nan)),
            lambda c: c.add("x", collided.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]])),
            lambda c: c.add("x", collided.Mesh([[0, 0, 0]], [[-1, 0, 0]])),
            lambda c: c.add("x", collided.HeightField([])),
            lambda c: c.add("x", collided.Sphere(1), position=(0, 0)),
        ):
            with self.assertRaises(collided.BadInput) as told:
                wrong(self.client)
            self.assertGreater(len(str(told.exception)), 10)

    def test_the_servers_no_is_an_error_with_its_reason(self):
        with self.assertRaises(collided.Refused) as told:
            self.client.pair("nosuch", "neither")
        self.assertIn("nosuch", str(told.exception))
        with self.assertRaises(collided.Refused):
            self.client.add("", collided.Sphere(1))
        with self.assertRaises(collided.Refused):
            self.client.add("x", collided.Sphere(1), orientation=(2, 0, 0, 0))

    def test_what_is_closed_says_so(self):
        client = collided.connect(domain=DOMAIN)
        watch = client.watch()
        client.close()
        client.close()
        self.assertTrue(client.closed)
        with self.assertRaises(collided.BadInput):
            client.ray((0, 0, 5), (0, 0, -1))
        self.assertIsNone(watch.next(0.0))  # it keeps the connection
        watch.close()
        with self.assertRaises(collided.BadInput):
            watch.next(0.0)

    def test_a_forked_child_is_told(self):
        pid = os.fork()
        if pid == 0:
            try:
                self.client.status()
            except collided.BadInput as told:
                os._exit(7 if "fork" in str(told) else 8)
            finally:
                os._exit(9)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), 7)
        self.assertEqual(self.client.status().state, "ready")

    def test_keys_that_are_not_there(self):
        with self.assertRaises(collided.Error) as told:
            collided.connect(domain=DOMAIN - 100, keys="/nonexistent/keys")
        self.assertIn("/nonexistent/keys", str(told.exception))

    def test_no_server(self):
        with self.assertRaises(collided.NoServer):
            collided.connect(domain=DOMAIN, name_space="nobody", wait=0.2)


class World(WithServer):
    SHAPES = [
        collided.Sphere(0.3),
        collided.Box((0.2, 0.3, 0.4)),
        collided.Capsule((0, 0, 0), (0, 0, 1), 0.2),
        collided.Cylinder((0, 0, 0), (0, 0, 1), 0.2),
        collided.Cone((0, 0, 1), (0, 0, 0), 0.2),
        collided.Ellipsoid((0.2, 0.3, 0.4)),
        collided.HalfSpace((0, 0, 1), (0, 0, -1000)),
        collided.Hull([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]),
        collided.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
        collided.HeightField([[0, 0.1], [0.2, 0.3], [0, 0]], 0.5, 0.25),
        collided.Cloud([[0, 0, 0], [1, 1, 1]], 0.1),
        collided.Polyline([[0, 0, 0], [1, 1, 1], [2, 1, 1]], 0.1),
    ]

    def test_every_shape(self):
        for i, shape in enumerate(self.SHAPES):
            moving = not isinstance(shape, collided.HalfSpace)
            self.client.add(f"py_shape{i}", shape, (200 + 10 * i, 0, 0), moving=moving)
        try:
            listed = self.client.list("py_shape*", limit=3)
            self.assertEqual((len(listed.objects), listed.count), (3, len(self.SHAPES)))
            (ball,) = self.client.list("py_shape0").objects
            self.assertEqual([ball.kind, self.client.list("py_shape*", moving=False).count], ["sphere", 1])
            self.assertEqual(self.client.ray((200, 0, 5), (0, 0, -1), only="py_shape0").hits[0].distance, 4.7)
            above = self.client.ray((290.25, 0.125, 5), (0, 0, -1), only="py_shape9").hits[0]
            self.assertAlmostEqual(above.distance, 5 - 0.15, delta=1e-12)  # between 0, 0.1, 0.2 and 0.3
        finally:
            self.assertEqual(self.client.remove("py_shape*"), len(self.SHAPES))

    def test_regions_and_bands_report_what_comes(self):
        def events_of(watch, count):
            events = []
            until = time.monotonic() + 20
            while len(events) < count and time.monotonic() < until:
                event = watch.next(0.5)
                if event:
                    events.append(event)
            return events

        self.client.add("py_post", collided.Sphere(0.5), (500, 0, 0))
        self.client.add_region("py_zone", collided.Box((1, 1, 1), (503, 0, 0)), only="py_guest*", detect=("enter", "exit"))
        self.assertEqual(self.client.add_bands("py_close", "py_post", "py_guest*", [2, 1], hysteresis=0.25), 0)
        with self.client.watch_standing("py_*", form="region") as region, self.client.watch_standing("py_*", form="bands") as bands:
            wait_in_step(region, bands)
            self.client.add("py_guest", collided.Sphere(0.5), (510, 0, 0))
            self.client.move("py_guest", (502.5, 0, 0))
            listed = self.client.standing("py_*", "region")
            self.assertEqual([(row.name, [held.object for held in row.holds]) for row in listed], [("py_zone", ["py_guest"])])
            self.assertEqual(listed[0].detect, ("enter", "exit"))
            (held,) = self.client.standing("py_close")[0].holds
            self.assertEqual((held.object, held.other, held.band), ("py_guest", "py_post", 2))
            self.client.move("py_guest", (510, 0, 0))
            both = events_of(region, 2)
            self.assertEqual([(event.kind, event.form, event.object, event.standing) for event in both],
                             [("enter", "region", "py_guest", "py_zone"), ("exit", "region", "py_guest", "py_zone")])
            self.assertEqual(both[1].reason, "separated")
            came, left = events_of(bands, 2)
            self.assertEqual((came.kind, came.form, came.object, came.other, came.band), ("approach", "bands", "py_guest", "py_post", 2))
            self.assertAlmostEqual(came.distance, 2, delta=1e-3)
            self.assertGreater(came.closing, 0)
            self.assertIsNotNone(came.contact_in)
            self.assertEqual((left.kind, left.reason), ("leave", "separated"))
            self.assertEqual(bands.lost, 0)
        for wrong in ([1, 2], [-1], [float("nan")]):
            with self.assertRaises(collided.Error):
                self.client.add_bands("py_wrong", "a", "b", wrong)
        with self.assertRaises(collided.BadInput):
            self.client.add_region("py_wrong", collided.Sphere(1), detect=("enter", "leave"))
        for wrong in (self.client.standing, self.client.remove_standing):
            with self.assertRaises(collided.BadInput):
                wrong("py_*", "fence")
        self.assertEqual(self.client.remove_standing("py_*", "region"), 1)
        self.assertEqual(self.client.remove_standing("py_*"), 1)
        self.client.remove("py_post")
        self.client.remove("py_guest")

    def test_the_nearest_is_reported_with_the_one_before(self):
        self.client.add("py_lamp_a", collided.Sphere(0.5), (500, 50, 0))
        self.client.add("py_lamp_b", collided.Sphere(0.5), (510, 50, 0))
        self.client.add("py_walker", collided.Sphere(0.5), (502, 50, 0))
        self.client.add_nearest("py_light", "py_lamp_*", "py_walker", 20)
        self.client.add_nearest("py_corner", "py_lamp_*", (511, 50, 0), 20)
        with self.client.watch_standing("py_light", capacity=1000) as watch:
            wait_in_step(watch)
            first = watch.next(20)
            self.assertEqual((first.kind, first.form, first.standing, first.object), ("is", "nearest", "py_light", "py_lamp_a"))
            self.assertAlmostEqual(first.distance, 1, delta=1e-9)
            self.client.move("py_walker", (509, 50, 0))
            event = watch.next(20)
            self.assertEqual((event.kind, event.other, event.object, event.reason),
                             ("changed", "py_lamp_a", "py_lamp_b", "separated"))
            self.assertAlmostEqual(event.distance, 4, delta=1e-3)
            self.assertGreaterEqual(event.bracket[0], event.bracket[1])
            self.assertEqual(watch.lost, 0)
        self.assertEqual({row.name: [held.object for held in row.holds] for row in self.client.standing("py_*", "nearest")},
                         {"py_light": ["py_lamp_b"], "py_corner": ["py_lamp_b"]})
        for wrong in (0, -1, float("nan"), float("inf")):
            with self.assertRaises(collided.Error):
                self.client.add_nearest("py_wrong", "a", "b", wrong)
        with self.assertRaises(collided.BadInput):
            self.client.add_nearest("py_wrong", "a", "", 1)
        self.assertEqual(self.client.remove_standing("py_*", "nearest"), 2)
        for name in ("py_lamp_a", "py_lamp_b", "py_walker"):
            self.client.remove(name)

    def test_a_recording_has_the_events_of_the_watch(self):
        self.client.add("py_truck", collided.Sphere(0.5), (900, 0, 0))
        self.client.add("py_wall", collided.Sphere(0.5), (904, 0, 0))
        self.addCleanup(self.client.remove, "py_*")
        self.client.add_region("py_bay", collided.Box((1, 1, 1), (910, 0, 0)), only="py_truck")
        self.client.add_bands("py_gap", "py_wall", "py_truck", [2.0])
        self.client.add_nearest("py_who", "py_truck", (910, 0, 0), 5)
        names = ("py_bay", "py_gap", "py_who")
        for name in names:
            self.addCleanup(self.client.remove_standing, name)
        watched = []
        with self.client.watch_standing("py_[bgw]*") as watch:
            wait_in_step(watch)
            self.client.move("py_truck", (910, 0, 0))
            self.client.move("py_truck", (900, 0, 0))
            while len(watched) < 12:  # 2 of the region, 8 of the bands, 2 of the nearest
                event = watch.next(20)
                self.assertIsNotNone(event, watched)
                watched.append(event)
        of = {name: [event.kind for event in watched if event.standing == name] for name in names}
        self.assertEqual((of["py_bay"], len(of["py_gap"]), of["py_who"]), (["enter", "exit"], 8, ["changed", "changed"]))
        self.assertEqual([event.sequence for event in watched], sorted(event.sequence for event in watched))
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "last.mcap")
            subprocess.run([COLLIDE, "--domain", str(DOMAIN), "record", path, "--last", "30s"], check=True, stdout=subprocess.DEVNULL)
            recorded = collided.recorded_standing_events(path, only="py_[bgw]*")
            self.assertEqual((recorded.lost, recorded.warnings), (0, ()))
            self.assertLess(recorded.begin_ns, recorded.end_ns)
            self.assertEqual([event for event in recorded.events if event.standing in names], watched)
            self.assertEqual(collided.recorded_standing_events(path, only="py_none"),
                             collided.RecordedStandingEvents((), recorded.begin_ns, recorded.end_ns, 0, ()))
            # Between its coming in and its going out it was in.
            entered = next(event for event in watched if event.kind == "enter")
            between = entered.world_time_ns - int(entered.bracket[1] * 1e9) + 1
            (inside,) = collided.recorded_standing_events(path, only="py_bay", from_ns=between, to_ns=between).events
            self.assertEqual((inside.kind, inside.object, inside.episode), ("inside", "py_truck", entered.episode))
            self.assertEqual(collided.recorded_standing_events(path, only="py_bay", from_ns=0, since="end").events, ())
            self.assertEqual(len(collided.recorded_standing_events(path, only="py_bay", from_ns=0, since="begin").events), 2)
            for wrong in (lambda: collided.recorded_standing_events(path, since="noon"),
                          lambda: collided.recorded_standing_events(path, from_ns=1, to_ns=0),
                          lambda: collided.recorded_standing_events(os.path.join(folder, "none.mcap"))):
                with self.assertRaises(collided.BadInput):
                    wrong()

    def test_a_run_is_fetched_read_and_replayed(self):
        with tempfile.TemporaryDirectory() as folder, self.client.watch("py_run_*") as watch:
            self.client.add("py_run_post", collided.Box((0.5, 0.5, 0.5)), (950, 0, 0))
            self.addCleanup(self.client.remove, "py_run_post")
            with self.client.publish("py_run", lease=60) as publisher:
                ball = publisher.add("py_run_ball", collided.Sphere(0.5), (953, 0, 0))
                publisher.flush()
                publisher.move(ball, (950.5, 0, 0))
                publisher.flush()
                publisher.wait_applied(20)
                touched = watch.next(20)
            path = os.path.join(folder, "run.mcap")
            size = collided.fetch_recording(path, 60, domain=DOMAIN)
            self.assertEqual(size, os.path.getsize(path))
            recorded = collided.recorded_events(path, only="py_run_*")
            self.assertEqual(recorded.lost, 0)
            self.assertIn((touched.sequence, touched.began_ns), [(event.sequence, event.began_ns) for event in recorded.events])
            self.assertEqual(collided.recorded_events(path, only="py_run_*", to_ns=0, since="begin").events, ())
            report = collided.replay(path, rate=1e6, domain=DOMAIN)
            self.assertGreater(report.samples, 0)
            self.assertFalse(report.stopped)
        with self.assertRaises(collided.BadInput):
            collided.replay("/nowhere.mcap", domain=DOMAIN)
        with self.assertRaisesRegex(collided.BadInput, "rate"):
            collided.replay(path, rate=0, domain=DOMAIN)

    def test_servers_are_listed_and_judged_without_a_client(self):
        fleet = collided.fleet(domain=DOMAIN)
        self.assertEqual([(member.role, member.state, member.pid) for member in fleet.members],
                         [("primary", "ready", self.client.status().pid)])
        self.assertEqual(fleet.findings, ())
        found = collided.diagnose(domain=DOMAIN)
        self.assertIn(("ok", "server"), [(finding.health, finding.about) for finding in found])
        with self.assertRaises(TypeError):
            collided.fleet(domian=DOMAIN)

    def test_explanations_say_why_and_why_not(self):
        self.client.add("py_glass", collided.Box((0.5, 0.5, 0.5)), (800, 0, 2), layers=2)
        self.client.add("py_floor", collided.Box((5, 5, 0.5)), (800, 0, -0.5))
        self.client.add("py_mast", collided.Sphere(0.5), (801, 0, 2))
        self.addCleanup(self.client.remove, "py_*")
        ray = self.client.explain_ray((800, 0, 5), (0, 0, -1), mask=1, why_not="py_mast", most=1)
        self.assertTrue(ray)
        self.assertEqual([(met.object, met.kind, met.rung, met.part) for met in ray.met], [("py_floor", "box", "double", None)])
        self.assertAlmostEqual(ray.met[0].distance, 5, delta=ray.met[0].error)
        (glass,) = ray.left_out
        self.assertEqual((glass.object, glass.why_left_out), ("py_glass", "its layers 0x2 are not in the mask 0x1"))
        mast = next(miss for miss in ray.misses if miss.object == "py_mast")
        self.assertEqual((mast.verdict, mast.where, mast.box_met), (Verdict.MISS, "beside", False))
        self.assertEqual((ray.uncovered, ray.stale, ray.unknown, ray.cut, ray.late), (None, (), (), False, False))

        apart = self.client.explain_pair("py_mast", "py_floor")
        self.assertFalse(apart)
        self.assertAlmostEqual(apart.answer.distance, 1.5, delta=apart.answer.error)
        self.assertEqual(apart.nearest.end, "found")

        self.client.add_region("py_yard", collided.Box((1, 1, 1), (800, 20, 2)), only="py_m*")
        self.addCleanup(self.client.remove_standing, "py_yard")
        with self.client.watch_standing("py_yard") as yard:
            wait_in_step(yard)
            self.client.move("py_mast", (800, 20, 2))
            entered = yard.next(20)
            self.client.move("py_mast", (800, 0, 0.25))
            self.assertEqual((entered.kind, yard.next(20).kind), ("enter", "exit"))
        region = self.client.explain_standing("py_yard", why_not="py_floor")
        self.assertEqual((region.form, region.kind, region.looked_at, region.holds), ("region", "box", 1, ()))
        self.assertEqual([(one.object, one.verdict) for one in region.others], [("py_mast", Verdict.MISS)])
        self.assertEqual(region.asked_for.why_left_out, "the fence looks at 'py_m*' alone")
        self.assertEqual([(news.what, news.object) for news in region.events], [("enter", "py_mast"), ("exit", "py_mast")])

        event = self.client.explain_event(entered.sequence, of="standing")
        self.assertEqual((event.what, event.of), ("enter", "standing"))
        self.assertLessEqual(event.low_ns, event.high_ns)
        for refused in (lambda: self.client.explain_standing("py_none"), lambda: self.client.explain_ray((0, 0, 0), (0, 0, 0)),
                        lambda: self.client.explain_pair("py_mast", "py_none"), lambda: self.client.explain_event(10**9)):
            with self.assertRaises(collided.Refused):
                refused()
        with self.assertRaises(collided.BadInput):
            self.client.explain_ray((0, 0, math.nan), (0, 0, 1))
        with self.assertRaises(collided.BadInput):
            self.client.explain_pair("py_mast", "py_floor", as_of="now")

    def test_a_probe_reads_its_clearance(self):
        self.client.add("py_deck", collided.Box((5, 5, 0.5)), (850, 0, -0.5))
        self.client.add("py_lift", collided.Sphere(0.1), (850, 0, 1))
        self.addCleanup(self.client.remove, "py_*")
        self.client.add_probe("py_foot", "py_lift", (0, 0, -0.25), reach=math.inf)
        self.addCleanup(self.client.remove_probes, "py_f*")
        (foot,) = self.client.probes("py_foot")
        self.assertEqual((foot.object, foot.state, foot.met, foot.triangle), ("py_lift", "gap", "py_deck", None))
        self.assertAlmostEqual(foot.clearance, 0.75, delta=foot.error + 1e-12)
        self.assertEqual(self.client.remove_probes("py_f*"), 1)
        self.assertIn("built", vars(self.client.plan().structures[0]))

    def test_a_scan_is_an_obstacle_of_cells(self):
        wall = [[702.02, 0.01 * i, 1.05] for i in range(-50, 50)]
        scans = [wall] if numpy is None else [wall, numpy.array(wall), numpy.array(wall, dtype="float32")]
        for number, points in enumerate(scans):
            name = f"py_scan_{number}"
            with self.client.publish(name) as publisher:
                with publisher.voxels(name, 0.1, unknown="undecided", decay=10) as voxels:
                    scan = voxels.insert(points, origin=(700.05, 0.05, 1.05))
                    self.assertEqual((scan.points, scan.refused, scan.occupied), (100, 0, 10))
                    self.assertGreater(scan.crossed, 0)
                    publisher.wait_applied()
                    ahead = self.client.rays([[701, 0.05, 1.05]], [[1, 0, 0]], only=name + "/*")[0]
                    self.assertEqual(ahead.verdict, Verdict.HIT)
                    self.assertAlmostEqual(ahead.hits[0].distance, 1, delta=1e-4)
                    back = self.client.rays([[701, 0.05, 1.05]], [[-1, 0, 0]])[0]
                    self.assertEqual((back.verdict, back.reason), (Verdict.UNDECIDED, "not_covered"))
                    self.assertTrue(0 <= back.covered <= 1)
                    self.assertAlmostEqual(back.uncovered[0], 701 - back.covered, delta=1e-9)
                    self.assertEqual((ahead.uncovered, ahead.covered), (None, None))
                    voxels.clear()
                    publisher.wait_applied()
                    cleared = self.client.rays([[701, 0.05, 1.05]], [[1, 0, 0]], only=name + "/*")[0]
                    self.assertEqual((cleared.verdict, cleared.hits), (Verdict.UNDECIDED, ()))
        with self.client.publish("py_bad_scan") as publisher:
            for wrong in ({"unknown": "maybe"}, {"lost": "maybe"}, {"cell": -1}, {"clearing_delay": -1}):
                with self.assertRaises(collided.BadInput):
                    publisher.voxels("py_bad_scan", **wrong)
            with publisher.voxels("py_bad_scan", 0.1) as voxels, self.assertRaises(collided.BadInput):
                voxels.insert([[1, 2]])
            with publisher.voxels("py_small_scan", 0.1, most_blocks=1) as voxels:
                self.assertEqual(voxels.insert([[702, 0, 1], [720, 0, 1]]).dropped, 1)

    def test_silence_is_reported_and_not_called_free(self):
        with self.client.publish("py_tracker", lease=0.2, gap=2) as publisher:
            drone = publisher.add("py_tracker/drone", collided.Sphere(0.2), (330, 0, 0))
            publisher.flush()
            publisher.wait_applied()
            time.sleep(0.6)
            silent = self.client.spheres([[330, 0, 0]], [0.1])
            self.assertNotEqual(silent[0].verdict, Verdict.MISS)
            self.assertGreater(silent.oldest_pose_age_ns, 0)
            publisher.move(drone, (330, 0, 0))
            with self.assertWarnsRegex(RuntimeWarning, "'py_tracker' was silent for .* longer than its lease of 200 ms"):
                publisher.flush()
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                publisher.keep_alive()
                publisher.keep_alive(time.time_ns())
                publisher.flush()
        with self.assertRaisesRegex(collided.BadInput, "its gap is 9 s; allowed 1 ms to 8 s"):
            self.client.publish("py_slow", gap=9)

    def test_a_publisher_s_ball_meets_a_box_and_leaves(self):
        self.client.add("py_wall", collided.Box((0.1, 1, 1)), (300, 0, 0))
        events = []
        with self.client.watch("py_wall") as watch, self.client.publish("py_mover") as publisher:
            ball = publisher.add("py_mover/ball", collided.Sphere(0.2), (297, 0, 0))
            publisher.flush()
            publisher.wait_applied()
            for i in range(61):
                publisher.move_many([ball], [[297 + 0.1 * i, 0, 0]])
                publisher.flush()
                time.sleep(0.002)
            publisher.wait_applied()
            self.assertEqual(publisher.report(), collided.PublisherReport("", [], 0, 0))
            publisher.add("py_wall", collided.Sphere(0.2), (310, 0, 0))
            publisher.flush()
            with self.assertRaises(collided.Refused):
                publisher.wait_applied()
            self.assertEqual(publisher.report().left_out, [("py_wall", "the name is taken")])
            until = time.monotonic() + 20
            while len(events) < 2 and time.monotonic() < until:
                event = watch.next(0.5)
                if event:
                    events.append(event)
            self.assertEqual(watch.lost, 0)
        self.client.remove("py_wall")
        self.assertEqual([event.kind for event in events], ["began", "ended"])
        self.assertEqual({events[0].a, events[0].b}, {"py_wall", "py_mover/ball"})
        self.assertEqual(events[1].reason, "separated")
        self.assertEqual(events[1].episode, events[0].sequence)
        self.assertLess(abs(abs(events[0].normal[0]) - 1), 1e-9)
        self.assertEqual(events[0].surface_normal, events[0].normal)
        self.assertFalse(events[0].poses_merged or events[1].poses_merged)
        self.assertEqual((events[0].surface_depth, events[0].surface_depth_error), (events[0].depth, events[0].depth_error))

    def test_pairs_may_touch_and_what_is_attached_moves_along(self):
        self.client.add("py_hand", collided.Box((0.5, 0.5, 0.5)), (400, 0, 0))
        self.client.add("py_crate", collided.Box((0.5, 0.5, 0.5)), (400.9, 0, 0))
        try:
            self.assertEqual(self.client.allow("py_hand", "py_crate", "a grip"), 1)
            self.assertEqual(self.client.rules()[0], collided.ListedRule("py_hand", "py_crate", "a grip", True))
            self.assertEqual(self.client.deny("py_hand", "py_crate"), 1)
            self.client.attach("py_crate", "py_hand")
            with self.client.publish("py_driver") as publisher:
                hand = publisher.claim("py_hand", (400, 0, 0))
                publisher.wait_applied()
                publisher.move(hand, (405, 0, 0))
                publisher.flush()
                publisher.wait_applied()
                crate = self.client.get("py_crate")
                self.assertEqual(crate.attached_to, "py_hand")
                self.assertAlmostEqual(crate.position[0], 405.9)
            with self.assertRaisesRegex(collided.Refused, "'py_crate' moves along with it"):
                self.client.attach("py_hand", "py_crate")
            self.client.detach("py_crate")
            self.assertEqual(self.client.get("py_crate").attached_to, "")
        finally:
            self.client.remove("py_hand")
            self.client.remove("py_crate")

    def test_a_robot_is_moved_by_its_joints(self):
        arm = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "deploy", "examples", "arm.urdf")
        self.client.load(os.path.abspath(arm), name="py_arm", moving=True)

        def hand():
            publisher.flush()
            publisher.wait_applied()
            return self.client.get("py_arm/hand").position

        with self.client.publish("py_joints") as publisher:
            robot = publisher.robot(arm, scene="py_arm", position=(1100, 0, 0), joints={"shoulder": 0.5})
            self.assertAlmostEqual(hand()[0], 1100 + 0.9 * math.sin(0.5), delta=1e-9)
            self.assertEqual(robot.set_joints({"shoulder": 0}, teleport=True), [])
            robot.set_base((1101, 0, 0))
            self.assertAlmostEqual(hand()[0], 1101, delta=1e-9)
            for wrong in ({"sholder": 1}, {"elbow": 3}, {"elbow": math.nan}):
                with self.assertRaises(collided.BadInput):
                    robot.set_joints(wrong)
            robot.close()

    def test_a_what_if_sees_filtered_pairs_and_a_question_unknown_objects_where_asked(self):
        for name, x in (("py_twin_a", 1200), ("py_twin_b", 1210)):
            self.client.add(name, collided.Sphere(0.5), (x, 0, 0), group=7)
        self.addCleanup(self.client.remove, "py_twin_*")
        close = ["py_twin_b"], [[1200.5, 0, 0, 1, 0, 0, 0]], "py_twin_a"
        self.assertFalse(self.client.what_if(*close)[0])
        self.assertTrue(self.client.what_if(*close, with_filtered=True)[0])
        with self.client.publish("py_fog") as publisher:
            publisher.add("py_fog", collided.Box((1, 1, 1)), (1220, 0, 0), unknown=True)
            publisher.flush()
            publisher.wait_applied()
            self.assertEqual(self.client.ray((1220, 0, 5), (0, 0, -1)).reason, "not_covered")
        with collided.connect(domain=DOMAIN, replicas=False, wait_is_limit=True) as alone:
            self.assertEqual(alone.status().pid, self.client.status().pid)

    def test_a_watch_follows_the_readings_of_a_probe(self):
        self.client.add("py_ground", collided.Sphere(0.5), (1150, 0, 0))
        self.client.add("py_flyer", collided.Sphere(0.5), (1150, 0, 8))
        self.addCleanup(self.client.remove, "py_[gf]*")
        self.addCleanup(self.client.remove_probes, "py_height")
        with self.client.watch_probes("py_height") as watch:
            self.client.add_probe("py_height", "py_flyer")
            reading, until = None, time.monotonic() + 20
            while reading is None and time.monotonic() < until:  # a step before the server knows of the watch is not reported
                self.client.move("py_flyer", (1150, 0, 8))
                self.client.move("py_flyer", (1150, 0, 5))
                reading = watch.next(1)
                while reading is not None and abs(reading.clearance - 4.5) > 1e-9:
                    reading = watch.next(1)
        self.assertIsNotNone(reading)
        self.assertEqual((reading.probe, reading.object, reading.met, reading.triangle), ("py_height", "py_flyer", "py_ground", None))
        self.assertEqual(reading.epoch, self.client.status().epoch)

    def test_a_publisher_s_mesh_is_solid_where_it_closes(self):
        corners = [[0, 0, 0], [3, 0, 0], [0, 3, 0], [0, 0, 3]]
        faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
        with self.client.publish("py_cutter") as publisher:
            publisher.add("py_closed", collided.Mesh(corners, faces), (500, 0, 0), solid=True)
            publisher.flush()
            publisher.wait_applied()
            self.assertTrue(self.client.inside([(500.2, 0.2, 0.2)], only="py_closed")[0])
            publisher.add("py_open", collided.Mesh(corners, faces[:3]), (510, 0, 0), solid=True)
            with self.assertRaisesRegex(collided.Refused, "'py_open' is not in the world: it is not solid"):
                publisher.wait_applied()

    def test_async_for(self):
        async def first():
            with self.client.watch("py_async*") as watch:
                loop = asyncio.get_running_loop()
                await loop.run_in_executor(None, self.client.add, "py_async_a", collided.Sphere(1), (400, 0, 0))
                await loop.run_in_executor(None, self.client.add, "py_async_b", collided.Sphere(1), (401, 0, 0))
                async for event in watch:
                    return event

        try:
            event = asyncio.run(asyncio.wait_for(first(), 20))
            self.assertEqual({event.a, event.b}, {"py_async_a", "py_async_b"})
        finally:
            self.client.remove("py_async*")

    def test_nothing_is_left_behind(self):
        def one():
            answers = self.client.rays(*rays(1000))
            return answers.distance

        def resident():
            with open("/proc/self/statm") as file:
                return int(file.read().split()[1]) * 4096

        for _ in range(50):
            one()
        gc.collect()
        before = resident()
        for _ in range(300):
            one()
        gc.collect()
        self.assertLess(resident() - before, 8 << 20)  # kept answers would be some 60 MB


if __name__ == "__main__":
    print(f"COLLIDED_SEED={SEED}, numpy {'absent' if numpy is None else numpy.__version__}")
    unittest.main(argv=[sys.argv[0]])
