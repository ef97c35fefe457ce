"""What lies in a declared solid, as a client hears of it: through server, wire, library, C and Python; and that a server
that starts again knows which meshes are solid.

usage: solid_test.py COLLIDED DOMAIN
"""

import os
import subprocess
import sys
import tempfile
import time
import unittest

SERVER, DOMAIN = sys.argv[1], int(sys.argv[2])

import collided  # noqa: E402


class Server:
    """A server of the built-in warehouse that keeps its state from start to start."""

    def __init__(self, state):
        self.state = state
        self.process = None

    def __enter__(self):
        self.said = open(os.path.join(self.state, "said"), "w+", encoding="utf-8")
        self.process = subprocess.Popen(
            [SERVER, "--domain", str(DOMAIN), "--state-dir", os.path.join(self.state, "state")],
            stdout=self.said,
            stderr=subprocess.STDOUT,
        )
        until = time.monotonic() + 60
        while time.monotonic() < until and self.process.poll() is None:
            self.said.seek(0)
            if "ready:" in self.said.read():
                return self
            time.sleep(0.05)
        raise RuntimeError("the server is not ready")

    def kill(self):
        self.process.kill()
        self.process.wait()

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.terminate()
            self.process.wait(30)
        self.said.close()


class Solids(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def next_of(self, watch, wait=20.0):
        event = watch.next(wait)
        self.assertIsNotNone(event, "no event came")
        return event

    def within(self, event):
        """The name of the one that lies in the other."""
        return {"": None, "a_in_b": event.a, "b_in_a": event.b}[event.contained]

    def test_what_comes_to_lie_in_a_solid_is_told_and_a_late_watch_knows_it(self):
        with Server(self.folder.name), collided.connect(DOMAIN, wait=20.0) as client:
            client.load("embedded:", replace=True, solid="*")
            client.add("pea", collided.Sphere(0.002), (0, 0, 1.3))
            watch = client.watch(only="pea", persisted=False)
            until = time.monotonic() + 60
            while not watch.in_step and time.monotonic() < until:
                time.sleep(0.01)
            client.move("pea", (0, 0, 1.19))
            began = self.next_of(watch)
            self.assertEqual((began.kind, began.contained), ("began", ""))
            contained = self.next_of(watch)
            self.assertEqual((contained.kind, self.within(contained)), ("contained", "pea"))
            self.assertEqual(contained.episode, began.sequence)
            self.assertLessEqual(abs(contained.depth - 0.012), contained.depth_error + 1e-12)
            with client.watch(only="pea") as late:
                there = self.next_of(late)
                self.assertEqual((there.kind, self.within(there)), ("open", "pea"))
            client.move("pea", (0, 0, 1.3))
            emerged = self.next_of(watch)
            self.assertEqual((emerged.kind, self.within(emerged)), ("emerged", "pea"))
            self.assertEqual(self.next_of(watch).kind, "ended")
            watch.close()

    def test_a_server_that_starts_again_knows_which_meshes_are_solid(self):
        corners = [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        faces = [face for a, b, c, d in sides for face in ([a, b, c], [a, c, d])]
        crate = collided.Mesh(corners, faces)
        asked = [[0, 0, 1.19], [20.5, 0.5, 0.5], [30.5, 0.5, 0.5]]
        with Server(self.folder.name) as server, collided.connect(DOMAIN, wait=20.0) as client:
            client.load("embedded:", replace=True, solid="*")
            client.add("crate", crate, (20, 0, 0), solid=True)
            client.add("shell", crate, (30, 0, 0))
            before = [[hit.object for hit in answer.hits] for answer in client.inside(asked)]
            server.kill()
        with Server(self.folder.name), collided.connect(DOMAIN, wait=20.0) as client:
            after = [[hit.object for hit in answer.hits] for answer in client.inside(asked)]
        self.assertEqual(before, [["warehouse/shelf_3/top"], ["crate"], []])
        self.assertEqual(after, before)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
