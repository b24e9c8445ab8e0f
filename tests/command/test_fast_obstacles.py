#!/usr/bin/env python3
"""Obstacles faster than a step can follow, and pins that pull cloth through them: the cloth gets out of the way in
shorter steps, or the run ends and says where."""
import unittest

import numpy as np

import running
from taut import Run

RANKS = (1, 2, 4)
LIMIT = 60  # s, of a run
SPEED = 5  # m/s
HANGING = """\
cloth:
  grid: {size: [0.4, 0.4], vertices: [17, 17]}
  start: {rotate: {axis: [1, 0, 0], angle: -90 deg}, translate: [-0.2, 0, 0.6]}
contact: {thickness: 2 mm, check: step}
time: {end: 0.12, frame_rate: 50, max_step: 0.01}
"""
FREE = HANGING + "pins: [{vertices: [8]}]\n"
HELD = HANGING + """\
pins:
  - box: {min: [-1, -1, -1], max: [-0.19, 1, 1]}
  - box: {min: [0.19, -1, -1], max: [1, 1, 1]}
  - box: {min: [-0.189, -1, 0.59], max: [0.189, 1, 1]}
  - box: {min: [-0.189, -1, 0], max: [0.189, 1, 0.21]}
"""
THROUGH = f"motion: [{{time: 0}}, {{time: 0.12, translate: [0, {0.12 * SPEED}, 0]}}]"  # is there after 0.04 s
SHAPES = {
    "ball": "sphere: {centre: [0.05, -0.3, 0.4], radius: 0.1}",
    "stone": "mesh: stone.obj, scale: 0.1",
}
OCTAHEDRON = "".join(f"v {x + 0.5} {y - 3} {z + 4}\n" for x, y, z in
                     ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)))
OCTAHEDRON += "".join(f"f {a} {b} {c}\n" for a in (1, 2) for b in (3, 4) for c in (5, 6))


SQUEEZED = """\
cloth: {grid: {size: [0.4, 0.4], vertices: [17, 17]}, start: {translate: [-0.2, -0.2, 0.1]}}
obstacles:
  - {name: floor, plane: {}}
  - name: stamp
    box: {min: [-0.1, -0.1, 0.2], max: [0.1, 0.1, 0.3]}
    motion: [{time: 0}, {time: 0.06, translate: [0, 0, -0.3]}]
contact: {thickness: 2 mm, check: step}
time: {end: 0.1, frame_rate: 50, max_step: 0.01}
"""
DRAGGED = """\
cloth: {grid: {size: [0.2, 0.2], vertices: [11, 11]}, start: {translate: [0, 0, 0.1]}}
pins: [{vertices: [0, 10, 110, 120], motion: [{time: 0}, {time: 0.1, translate: [0, 0, -0.2]}]}]
obstacles: [{name: table, box: {min: [-0.1, -0.1, -0.1], max: [0.3, 0.3, 0]}}]
contact: {thickness: 2 mm, check: step}
time: {end: 0.1, frame_rate: 50, max_step: 0.01}
"""


def flying(shape):
    return f"obstacles: [{{name: {shape}, {SHAPES[shape]}, {THROUGH}}}]\n"


class Fast(running.Folder):
    def start(self, case, ranks):
        """Exit code, the message, the summary, and the folder of the run."""
        (self.folder / "stone.obj").write_text(OCTAHEDRON)
        (self.folder / "case.yaml").write_text(case)
        code, _, err = self.taut("run", "case.yaml", "--out", "run", "--overwrite", ranks=ranks, limit=LIMIT)
        run = self.folder / "run"
        return code, err, Run(run).summary, run

    def survives(self, case, ranks):
        """Its summary, of a run in which the cloth was carried along; that nothing intersects, the run tests itself."""
        code, err, summary, run = self.start(case, ranks)
        self.assertEqual((code, err), (0, ""))
        fastest = max(np.linalg.norm(running.frame(run, file)["velocities"], axis=1).max()
                      for file, _ in running.listed_frames(run))
        self.assertGreater(fastest, 0.8 * SPEED)
        return summary

    def fails(self, case, ranks, *names):
        """Ends with 3, names once where and one of `names`, and leaves whole frames, all of which are listed, and no
        others."""
        code, err, summary, run = self.start(case, ranks)
        self.assertEqual(code, 3, err)
        self.assertEqual((summary["status"], "taut: " + summary["reason"]), ("failed", err))
        self.assertRegex(err, r"^taut: at t = 0\.0\d+ s no step down to .* \(-?[\d.e-]+, -?[\d.e-]+, -?[\d.e-]+\) m")
        self.assertRegex(err, "|".join(names))
        frames = [f"frames/frame_{k:06}.h5" for k in range(summary["frames"])]
        self.assertGreater(len(frames), 1)
        self.assertEqual([file for file, _ in running.listed_frames(run)], frames)
        self.assertEqual(sorted(f"frames/{p.name}" for p in (run / "frames").iterdir()), frames)
        self.assert_readable(run)
        for name in ("obstacles.xdmf", "edges.xdmf"):
            self.assertEqual((run / name).read_text().count("<Time "), len(frames), name)


class FreeCloth(Fast):
    """Hangs on one vertex and gets out of the way."""

    def test_hit_by_a_ball(self):
        for ranks in RANKS:
            self.survives(FREE + flying("ball"), ranks)

    def test_hit_by_an_edge(self):
        for ranks in RANKS:
            self.assertGreater(self.survives(FREE + flying("stone"), ranks)["rejected_steps"], 0)


class CaughtCloth(Fast):
    """Cannot get out of the way."""

    def test_held_all_around(self):
        for ranks in RANKS:
            self.fails(HELD + flying("ball"), ranks, "ball")
        self.fails(HELD + flying("stone"), 2, "stone")

    def test_squeezed_against_the_floor(self):
        for ranks in RANKS:
            self.fails(SQUEEZED, ranks, "floor", "stamp")

    def test_dragged_through_a_table(self):
        for ranks in RANKS:
            self.fails(DRAGGED, ranks, "table")


if __name__ == "__main__":
    unittest.main()
