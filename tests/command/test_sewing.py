#!/usr/bin/env python3
"""Two panels that are sewn into a tube around a post, then hang from their upper edge."""
import json
import os
import re
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
GATHERED = """\
panels:
  front: {translation: [0, 0.4, 0.1], vertices: [[-0.1, 0], [0.1, 0], [0.1, 0.15], [-0.1, 0.15]], edges: &edges [
    {endpoints: [0, 1]}, {endpoints: [1, 2]}, {endpoints: [2, 3]}, {endpoints: [3, 0]}]}
  back: {translation: [0, 0.4, -0.1], vertices: [[0.1, 0], [-0.1, 0], [-0.1, 0.15], [0.1, 0.15]], edges: *edges}
  skirt_front: {translation: [0, 0, 0.12], vertices: [[-0.2, 0], [0.2, 0], [0.2, 0.4], [-0.2, 0.4]], edges: *edges}
  skirt_back: {translation: [0, 0, -0.12], vertices: [[0.2, 0], [-0.2, 0], [-0.2, 0.4], [0.2, 0.4]], edges: *edges}
stitches:
  - [{panel: skirt_front, edge: 2}, {panel: front, edge: 0}]
  - [{panel: skirt_back, edge: 2}, {panel: back, edge: 0}]
  - [{panel: front, edge: 1}, {panel: back, edge: 3}]
  - [{panel: front, edge: 3}, {panel: back, edge: 1}]
  - [{panel: skirt_front, edge: 1}, {panel: skirt_back, edge: 3}]
  - [{panel: skirt_front, edge: 3}, {panel: skirt_back, edge: 1}]
"""
CASE = """\
name: tube
cloth: {pattern: tube.yaml, edge: 4 cm, fabric: cotton, panels: {back: {fabric: denim}}}
obstacles: [{capsule: {from: [0, 0, -0.3], to: [0, 0, 0.5], radius: 4 cm}}]
pins: [{label: waist, plane: [0, 0, 1]}]
sewing: {time: 0.4, force: 20, limit: 2, damping: 20, growth: 0.3}
contact: {thickness: 2 mm, check: step}
time: {end: 0.2, frame_rate: 20, max_step: 10 ms}
"""


def last_frame(run):
    file = sorted((run / "frames").iterdir())[-1]
    return frame(run, file.relative_to(run))


def last_positions(run):
    return last_frame(run)["positions"]


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

        self.assertEqual(json.loads(str(sewn["panels"])), ["front", "back"])
        self.assertEqual(json.loads(str(sewn["seams"])), ["front.1-back.3", "front.3-back.1"])
        np.testing.assert_array_equal(np.bincount(sewn["seams/of_vertices"] + 1)[1:], [seam, seam])
        self.assertEqual(set(sewn["cells/panel"]), {0, 1})
        waist = sewn["labels/vertices"]
        np.testing.assert_allclose(sewn["rest_positions"][waist, 2], 0.2, atol=2e-3)
        last = last_frame(run)
        out = self.taut("info", "run/case.yaml")[1]
        self.assertIn(f"{0.04 * 0.1503 + 0.04 * 0.324:.4g} kg", out)  # cotton and denim
        around = np.linalg.norm(last["positions"][:, :2], axis=1)
        np.testing.assert_allclose(last["clearance"], around - 0.04, atol=1e-6)
        texture = sewn["texture_of_vertices"]
        self.assertAlmostEqual(np.ptp(texture[:, 0]), 0.2, 6)  # along warp

    def test_a_wider_panel_below_another_is_gathered_to_it(self):
        """Both are in one plane, and there their edges would touch from the start."""
        below = """\
panels:
  yoke: {translation: [0, 0.22, 0], vertices: [[-0.1, 0], [0.1, 0], [0.1, 0.1], [-0.1, 0.1]], edges: &edges [
    {endpoints: [0, 1]}, {endpoints: [1, 2]}, {endpoints: [2, 3], label: top}, {endpoints: [3, 0]}]}
  skirt: {vertices: [[-0.15, 0], [0.15, 0], [0.15, 0.2], [-0.15, 0.2]], edges: [
    {endpoints: [0, 1]}, {endpoints: [1, 2]}, {endpoints: [2, 3]}, {endpoints: [3, 0]}]}
stitches: [[{panel: skirt, edge: 2}, {panel: yoke, edge: 0}]]
"""
        (self.folder / "tube.yaml").write_text(below)
        (self.folder / "case.yaml").write_text("""\
cloth: {pattern: tube.yaml, edge: 4 cm, fabric: cotton}
pins: [{label: top}]
sewing: {time: 0.4, limit: 2}
contact: {thickness: 0.5 mm, check: step}
time: {end: 0.05, frame_rate: 20}
""")
        run = self.sewn("run")
        for stage in (run / "sewing", run):
            self.assertEqual(Run(stage).summary["contact"]["intersections"], 0)

    def test_newton_sews_what_is_small_or_another_method_that_is_told(self):
        for method, told in (("newton", ()), ("fast_projection", ("--set", "sewing.method=fast_projection"))):
            code, out, err = self.taut("run", "case.yaml", "--out", method, *told)
            self.assertEqual((code, err), (0, ""))
            self.assertEqual(re.findall(r" frames, by (\w+),", out), [method, "fast_projection", "fast_projection"])
            self.assert_sound(self.folder / method)

    def test_a_pattern_goes_from_coarse_to_fine(self):
        coarse = self.sewn("coarse")
        code, _, err = self.taut("run", "case.yaml", "--from", "coarse", "--out", "fine", "--set", "cloth.edge=0.02",
                                 "--set", "time.end=0.1", ranks=2)
        self.assertEqual((code, err), (0, ""))
        summary = Run(self.folder / "fine").summary
        self.assertLessEqual(summary["strain"]["max"], 0.01)
        self.assertEqual(summary["contact"]["intersections"], 0)
        self.assertFalse((self.folder / "fine/sewing").exists())
        begun, old = frame(self.folder / "fine", "frames/frame_000000.h5")["positions"], last_positions(coarse)
        self.assertGreater(len(begun), 3 * len(old))
        for axis in range(3):
            self.assertAlmostEqual(begun[:, axis].min(), old[:, axis].min(), 2)
            self.assertAlmostEqual(begun[:, axis].max(), old[:, axis].max(), 2)

    def test_elastic_edges_and_what_is_fastened(self):
        (self.folder / "more.yaml").write_text(PATTERN.replace("back: {", "back: {points: {button: [0, 0.02]}, ")
                                               .replace("front: {", "front: {points: {hole: [0, 0.02]}, "))
        post = "obstacles=[{name: post, capsule: {from: [0, 0, -0.3], to: [0, 0, 0.5], radius: 2 cm}, " \
               "motion: [{time: 0}, {time: 1, translate: [0, 0, 1]}]}]"
        code, _, err = self.taut(
            "run", "case.yaml", "--out", "run", "--set", "cloth.pattern=more.yaml", "--set", "time.end=0.6", "--set",
            "cloth.elastic=[{label: waist, length: 80 %}]", "--set", "pins=[]", "--set", post, "--set",
            "attachments=[{label: waist, obstacle: post}, {label: button, to: hole, length: 5 cm, force: 20}]")
        self.assertEqual((code, err), (0, ""))
        run = self.folder / "run"
        self.assert_sound(run)
        mesh, last = frame(run, "mesh.h5"), last_frame(run)["positions"]
        names, offsets = json.loads(str(mesh["labels"])), mesh["labels/offsets"]
        label = {name: mesh["labels/vertices"][offsets[k]:offsets[k + 1]] for k, name in enumerate(names)}
        edges, lengths = mesh["constraints/edges"], mesh["constraints/rest_lengths"]
        is_waist = np.isin(edges, label["waist"]).all(axis=1)
        self.assertAlmostEqual(lengths[is_waist].sum(), 0.8 * 0.4, 6)
        now = np.linalg.norm(last[edges[is_waist, 0]] - last[edges[is_waist, 1]], axis=1).sum()
        self.assertLess(now, 1.05 * 0.8 * 0.4)  # of single triangles
        self.assertAlmostEqual(last[label["waist"], 2].mean(), 0.2 + 0.6, delta=0.02)  # went up with the post
        apart = np.linalg.norm(last[label["button"][0]] - last[label["hole"][0]])
        self.assertLess(apart, 0.052)

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
        self.assertTrue(job.end()[2].endswith("go on with: taut resume stopped"))
        run = self.folder / "stopped"
        self.assertFalse((run / "case.yaml").exists())
        code, out, err = self.taut("resume", "stopped", ranks=1)
        self.assertEqual((code, err), (0, ""))
        self.assertIn("resuming at t =", out)
        self.assert_sound(run)
        self.assertLess(np.abs(last_positions(run) - last_positions(whole)).max(), 2e-3)

    def test_a_body_stays_back_where_the_garment_is_too_tight(self):
        thick = "obstacles=[{name: post, capsule: {from: [0, 0, -0.3], to: [0, 0, 0.5], radius: 7 cm}}]"
        code, out, err = self.taut("run", "case.yaml", "--out", "run", "--set", thick)
        self.assertEqual((code, err), (0, ""))
        self.assert_sound(self.folder / "run")
        told = re.findall(r"post: [0-9]+ of its vertices stay back by up to ([0-9.]+) mm, at \(", out)
        self.assertEqual(len(told), 1, out)
        around = 1000 * 0.4 / (2 * np.pi)  # mm, of the tube
        self.assertGreater(float(told[0]), 70 - around)
        self.assertLess(float(told[0]), 70 - around + 15)
        code, _, err = self.taut("run", "case.yaml", "--from", "run", "--out", "fine", "--set", thick, "--set",
                                 "time.end=0.05", "--set", "cloth.edge=0.03", ranks=2)
        self.assertEqual((code, err), (0, ""))

    def test_a_fitting_that_was_stopped_goes_on_to_the_same_end(self):
        whole = self.sewn("whole")
        job = running.Job(self.folder, ("run", "case.yaml", "--out", "stopped"), 1)
        self.assertTrue(job.wait_for(lambda: rows(self.folder / "stopped/fitting") >= 10))
        os.kill(job.ranks()[0], signal.SIGTERM)
        job.end()
        self.assertEqual(self.taut("resume", "stopped", ranks=1)[0], 0)
        self.assertLess(np.abs(last_positions(self.folder / "stopped") - last_positions(whole)).max(), 1e-4)

    def test_a_seam_does_not_close_through_a_body(self):
        bar = "obstacles=[{name: bar, capsule: {from: [-0.3, 0, 0.05], to: [0.3, 0, 0.05], radius: 2 cm}}]"
        seam = "stitches: [[{panel: front, edge: 0}, {panel: back, edge: 0}]]"
        (self.folder / "tube.yaml").write_text(PATTERN[:PATTERN.index("stitches")] + seam)
        code, _, err = self.taut("run", "case.yaml", "--out", "run", "--set", "pins=[]", "--set", bar, "--set",
                                 "sewing.gravity=[0, 0, 15]", "--set", "sewing.bending=1e-4", "--set", "time.end=0.1")
        self.assertEqual((code, err), (0, ""))
        run = self.folder / "run"
        self.assert_sound(run)
        of_seam = frame(run, "mesh.h5")["seams/of_vertices"] >= 0
        self.assertLess(last_positions(run)[of_seam, 2].max(), 0.05)  # the panels were drawn up past the bar
        self.assertGreater(last_positions(run)[:, 2].max(), 0.15)

    def test_a_seam_that_cannot_close_is_named(self):
        code, _, err = self.taut("run", "case.yaml", "--set", "sewing.force=0.001", "--set", "sewing.limit=0.4")
        self.assertEqual(code, 3)
        self.assertRegex(err, r"seam front\.[13]-back\.[13] is still open by [0-9.]+ mm "
                              r"at \([-0-9.e]+, [-0-9.e]+, [-0-9.e]+\) m")

    # An edge that keeps its length stands in zigzags about the one that it is gathered to.
    def test_edges_are_gathered_to_half_their_length(self):
        (self.folder / "gathered.yaml").write_text(GATHERED)
        (self.folder / "gathered-case.yaml").write_text(
            "cloth: {pattern: gathered.yaml, edge: 3 cm, fabric: cotton}\nsewing: {}\n"
            "contact: {thickness: 0.5 mm, check: step}\ntime: {end: 0.04, frame_rate: 25}\n")
        code, _, err = self.taut("run", "gathered-case.yaml", "--out", "gathered")
        self.assertEqual((code, err), (0, ""))
        for run in (self.folder / "gathered/sewing", self.folder / "gathered"):
            self.assertEqual(Run(run).summary["status"], "completed")
        self.assertLess(Run(self.folder / "gathered/sewing").summary["end_time"], 4)  # of 6 s, the limit

    def test_uneven_seams_are_warned_of_before_anything_is_sewn(self):
        (self.folder / "long.yaml").write_text(PATTERN.replace("0.2]", "0.45]", 2))
        code, out, err = self.taut("check", "case.yaml", "--set", "cloth.pattern=long.yaml")
        self.assertEqual(code, 0)
        self.assertRegex(err, r"long\.yaml:6:5: seam front\.1-back\.3 joins edges of 0\.45 m and 0\.2 m, "
                              r"gathered 2\.2 : 1")

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
