"""A real robot's log and benchmark cells with published clearances, asked as users ask: over DDS, through the command line
and the Python library.

usage: panda_test.py COLLIDE DOMAIN     with a server on that domain

COLLIDED_DATA names the folder of recorded data, else shared/data beside the repository.
"""

import csv
import gzip
import itertools
import os
import subprocess
import sys
import tempfile
import unittest

COLLIDE, DOMAIN = sys.argv[1], int(sys.argv[2])
BESIDE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "shared", "data")
DATA = os.path.abspath(os.environ.get("COLLIDED_DATA") or BESIDE)
if not os.path.isdir(os.path.join(DATA, "panda_lab")):
    print("skipped: no folder of recorded data; COLLIDED_DATA may name it")
    sys.exit(77)

import collided  # noqa: E402

# FCL's figures have six digits after the point, and its iteration ends at 1e-6.
FCL_M = 2e-6


def table(*path):
    name = os.path.join(DATA, *path)
    with (gzip.open if name.endswith(".gz") else open)(name, "rt", encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def pose(row):
    return [float(row[key]) for key in ("x", "y", "z", "qw", "qx", "qy", "qz")]


class InItsLab(unittest.TestCase):
    """A Franka Panda's log of 21 s: it ran, so nothing collides; FCL says how near it came."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        # The robot's file names a package whose folders the data set has not kept.
        os.makedirs(cls.path("description", "meshes"))
        os.symlink(os.path.join(DATA, "panda_lab", "meshes"), cls.path("description", "meshes", "collision"))
        with open(cls.path("lab.csv"), "w", encoding="utf-8") as file:
            file.write("name,x,y,z,sx,sy,sz\n")
            for row in table("panda_lab", "env.csv"):
                file.write(",".join(row[key] for key in ("name", "x", "y", "z", "sx", "sy", "sz")) + "\n")
        cls.robot = os.path.join(DATA, "panda_lab", "panda.urdf")
        cls.package = "moveit_resources_panda_description=" + cls.path("description")
        cls.collide("load", cls.path("lab.csv"))
        cls.collide("load", cls.robot, "--moving", "--package", cls.package)
        cls.expected = table("panda_lab", "expected_clearance_50hz.csv")

    @classmethod
    def tearDownClass(cls):
        cls.collide("clear", "panda")
        cls.collide("clear", "lab")

    @classmethod
    def path(cls, *words):
        return os.path.join(cls.folder.name, *words)

    @classmethod
    def collide(cls, *words, codes=(0,)):
        done = subprocess.run([COLLIDE, "--domain", str(DOMAIN), *words], capture_output=True, text=True, check=False)
        if done.returncode not in codes:
            raise AssertionError(f"{words} ended with {done.returncode}: {done.stderr}")
        return done.stdout

    def test_what_if_by_joints_is_free_and_as_near_as_fcl_says(self):
        logged = {f"{float(row['t_s']):.6f}": row for row in table("panda_lab", "joints.csv.gz")}
        with open(self.path("log.csv"), "w", encoding="utf-8") as file:
            file.write("config," + ",".join(f"panda_joint{k}" for k in range(1, 8)) + ",panda_finger_joint1\n")
            for row in self.expected:
                joints = logged[row["t_s"]]
                file.write(row["frame"] + "," + ",".join(joints[f"q{k}"] for k in range(1, 8)) + ",0\n")
        self.collide("allow", "panda/panda_link0", "lab/*", "--because", "it stands there")
        told = self.collide(
            "what-if", "--robot", self.robot, "--joints", self.path("log.csv"), "--against", "lab", "--clearance",
            "--fields", "config,answer,clearance,a,b",
        )
        rows = [line.split("\t") for line in told.splitlines()]
        self.assertEqual([row[0] for row in rows], [row["frame"] for row in self.expected])
        self.assertEqual({row[1] for row in rows}, {"free"})
        for row, expected in zip(rows, self.expected):
            self.assertAlmostEqual(float(row[2]), float(expected["min_distance_m"]), delta=FCL_M, msg=row)
        least = min(rows, key=lambda row: float(row[2]))
        self.assertAlmostEqual(float(least[2]), 0.059009, delta=FCL_M)
        self.assertEqual(least[3:], ["panda/panda_hand", "lab/work_table"])

    def test_clearance_of_the_moved_robot_is_fcl_s(self):
        frames = {
            frame: list(rows)
            for frame, rows in itertools.groupby(table("panda_lab", "link_poses_50hz.csv.gz"), lambda row: row["frame"])
        }
        with collided.connect(domain=DOMAIN) as client:
            for expected in self.expected[::150]:
                for row in frames[expected["frame"]]:
                    if row["link"] != "panda_link0":
                        at = pose(row)
                        client.move("panda/" + row["link"], at[:3], at[3:], teleport=True)
                found = client.clearance("panda/*", "lab", skip="panda/panda_link0")
                self.assertEqual(found.verdict, collided.Verdict.MISS)
                self.assertAlmostEqual(found.pairs[0].clearance, float(expected["min_distance_m"]), delta=FCL_M)
                self.assertEqual(found.pairs[0].b, "lab/" + expected["closest_obstacle"])


class AsSpheres(unittest.TestCase):
    """1,400 starts and goals of 700 benchmark problems, the robot as 59 balls: one state collides, by 3.6 mm, which is why
    VAMP counts 699 valid problems. All cells stand in one world, and one request asks for all states."""

    APART_M = 8.0
    IN_ROW = 27

    def test_one_state_of_1400_collides(self):
        obstacles = table("mbm_panda", "scenes.csv.gz")
        cells = list(dict.fromkeys(row["scene"] for row in obstacles))
        offset = {
            name: (self.APART_M * (i % self.IN_ROW), self.APART_M * (i // self.IN_ROW)) for i, name in enumerate(cells)
        }
        states = [
            (key, list(rows))
            for key, rows in itertools.groupby(
                table("mbm_panda", "spheres.csv.gz"), lambda row: (row["scene"], row["state"])
            )
        ]
        radii = [float(row["r"]) for row in states[0][1]]
        self.assertEqual((len(cells), len(states), len(obstacles), len(radii)), (700, 1400, 8200, 59))
        with collided.connect(domain=DOMAIN) as client, client.publish("cells") as publisher:
            for row in obstacles:
                at, (dx, dy) = pose(row), offset[row["scene"]]
                size = [float(row[key]) for key in ("d0", "d1", "d2")]
                shape = (
                    collided.Box([length / 2 for length in size])
                    if row["type"] == "box"
                    else collided.Cylinder((0, 0, -size[0] / 2), (0, 0, size[0] / 2), size[1])
                )
                name = f"cells/{row['scene']}/{row['object']}"
                publisher.add(name, shape, (at[0] + dx, at[1] + dy, at[2]), at[3:], moving=False, lost="freeze")
            # Balls of one group never meet each other.
            balls = [f"robot/{k}" for k in range(len(radii))]
            for k, (name, radius) in enumerate(zip(balls, radii)):
                publisher.add(name, collided.Sphere(radius), (-50 - k, 0, 0), group=9, lost="freeze")
            publisher.flush()
            publisher.wait_applied(60)
            poses = []
            for (scene, _), rows in states:
                dx, dy = offset[scene]
                self.assertEqual([float(row["r"]) for row in rows], radii)
                poses += [[float(r["x"]) + dx, float(r["y"]) + dy, float(r["z"]), 1, 0, 0, 0] for r in rows]
            answers = client.what_if(balls, poses, "cells/*", timeout=120)
            hits = [key for (key, _), answer in zip(states, answers) if answer.verdict == collided.Verdict.HIT]
            self.assertEqual(hits, [("table_pick/0041", "goal")])
            self.assertNotIn(collided.Verdict.UNDECIDED, [answer.verdict for answer in answers])
            near = client.what_if(balls, poses, "cells/*", clearance=True, nearer=2.0, timeout=120)
            truth = {(r["scene"], r["state"]): r for r in table("mbm_panda", "expected_spheres.csv.gz")}
            for (key, _), answer in zip(states, near):
                self.assertAlmostEqual(
                    answer.hits[0].distance, float(truth[key]["min_signed_distance_m"]), delta=2e-7, msg=key
                )


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
