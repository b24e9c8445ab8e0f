#!/usr/bin/env python3
"""Two panels that are sewn into a tube around a post, then hang from their upper edge."""
import os
import shutil
import signal
import unittest

import numpy as np

import running
from running import Temporary, frame, rows
from taut import Run

PATTERN = """\
panels:
  front: {translation: [0, 0, 0.08], vertices: [[-0.1, 0], [0.1, 0], [0.1, 0.2], [-0.1, 0.2]], edges: &edges [
    {endpoints: [0, 1]}, {endpoints: [1, 2]}, {endpoints: [2, 3], label: waist}, {endpoints: [3, 0]}]}
  back: {translation: [0, 0, -0.08], vertices: [[0.1, 0], [-0.1, 0], [-0.1, 0.2], [0.1, 0.2]], edges: *edges}
stitches:
  - [{panel: front, edge: 1}, {panel: back, edge: 3}]
  - [{panel: front, edge: 3}, {panel: back, edge: 1}]
"""
CASE = """\
name: tube
cloth: {pattern: tube.yaml, edge: 4 cm, fabric: cotton}
obstacles: [{capsule: {from: [0, 0, -0.3], to: [0, 0, 0.5], radius: 4 cm}}]
pins: [{label: waist, plane: [0, 0, 1]}]
sewing: {time: 0.4, force: 20, limit: 2, damping: 20, growth: 0.3}
contact: {thickness: 2 mm, check: step}
time: {end: 0.2, frame_rate: 20, max_step: 10 ms}
"""


def last_positions(run):
    file = sorted((run / "frames").iterdir())[-1]
    return frame(run, file.relative_to(run))["positions"]


class Sewing(Temporary):
    def setUp(self):
        super().setUp()
        (self.folder / "tube.yaml").write_text(PATTERN)
        (self.folder / "case.yaml").write_text(CASE)

    def taut(self, *arguments, ranks=1):
        return running.Job(self.folder, arguments, ranks).end(120)

    def sewn(self, name, ranks=1):
        code, _, err = self.taut("run", "case.yaml", "--out", name, ranks=ranks)
        self.assertEqual((code, err), (0, ""))
        return self.folder / name

    def assert_sound(self, run):
        for stage in (run / "sewing", run / "fitting", run):
            summary = Run(stage).summary
            self.assertEqual(summary["status"], "completed")
            self.assertLessEqual(summary["strain"]["max"], 0.01)
            self.assertEqual(summary["contact"]["intersections"], 0)

    def test_panels_become_one_cloth(self):
        run = self.sewn("run")
        self.assert_sound(run)
        unsewn, sewn = frame(run / "sewing", "mesh.h5"), frame(run, "mesh.h5")
        self.assertEqual(len(sewn["face_offsets"]), len(unsewn["face_offsets"]))
        seam = 6  # vertices of each of two seams
        self.assertEqual(len(sewn["rest_positions"]), len(unsewn["rest_positions"]) - 2 * seam)
        self.assertLess(np.ptp(last_positions(run)[:, 2]), 0.21)

    def test_any_number_of_ranks_sews_alike(self):
        first = last_positions(self.sewn("one"))
        for ranks in (2, 3):
            run = self.sewn(f"on-{ranks}", ranks)
            self.assert_sound(run)
            self.assertLess(np.abs(last_positions(run) - first).max(), 2e-3)

    def test_sewing_that_was_stopped_goes_on_to_the_end(self):
        whole = self.sewn("whole")
        job = running.Job(self.folder, ("run", "case.yaml", "--out", "stopped"), 2)
        self.assertTrue(job.wait_for(lambda: rows(self.folder / "stopped/sewing") >= 20))
        os.kill(job.ranks()[0], signal.SIGTERM)
        job.end()
        run = self.folder / "stopped"
        self.assertFalse((run / "case.yaml").exists())
        code, out, err = self.taut("resume", "stopped", ranks=1)
        self.assertEqual((code, err), (0, ""))
        self.assertIn("resuming at t =", out)
        self.assert_sound(run)
        self.assertLess(np.abs(last_positions(run) - last_positions(whole)).max(), 2e-3)

    def test_a_seam_that_cannot_close_is_named(self):
        code, _, err = self.taut("run", "case.yaml", "--set", "sewing.force=0.001", "--set", "sewing.limit=0.4")
        self.assertEqual(code, 3)
        self.assertRegex(err, r"seam front\.[13]-back\.[13] is still open by [0-9.]+ mm")

    def test_the_dressed_state_begins_another_run_and_goes_out(self):
        run = self.sewn("run")
        shutil.copy(self.folder / "case.yaml", self.folder / "walk.yaml")
        case = [line for line in CASE.splitlines() if not line.startswith(("sewing", "pins", "cloth"))]
        (self.folder / "walk.yaml").write_text("\n".join([*case, "cloth: {mesh: none.h5}"]) + "\n")
        code, _, err = self.taut("run", "walk.yaml", "--from", "run", "--out", "walk", "--set", "time.end=0.05")
        self.assertEqual((code, err), (0, ""))
        begun = frame(self.folder / "walk", "frames/frame_000000.h5")["positions"]
        np.testing.assert_array_equal(begun, last_positions(run))
        code, _, err = self.taut("export", "run", "--to", "tube.pc2", "--up", "y", "--unit", "cm", ranks=2)
        self.assertEqual((code, err), (0, ""))
        cache = (self.folder / "tube.pc2").read_bytes()
        vertices, frames = len(begun), len(list((run / "frames").iterdir()))
        self.assertEqual(len(cache), 32 + 12 * vertices * frames)
        last = np.frombuffer(cache[-12 * vertices:], np.float32).reshape(-1, 3)
        np.testing.assert_allclose(last, 100 * last_positions(run)[:, [0, 2, 1]] * [1, 1, -1], atol=1e-4)
        self.assertIn("\nvt ", (self.folder / "tube.obj").read_text())


if __name__ == "__main__":
    unittest.main()
