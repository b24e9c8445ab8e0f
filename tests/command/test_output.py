#!/usr/bin/env python3
"""What a run writes is the same on any number of ranks."""
import json
import os
import signal
import struct
import unittest

import numpy as np

import running
from taut import Datasets, launch


def textured_sheet(turned):
    """The small case's sheet as OBJ, with warp along x, or turned: along y."""
    points = [(x / 10, y / 10) for y in range(11) for x in range(11)]
    faces = [(v, v + 1, v + 12, v + 11) for y in range(10) for v in range(11 * y + 1, 11 * y + 11)]
    return "".join([*(f"v {x} {y} 0\n" for x, y in points),
                    *(f"vt {y} {x}\n" if turned else f"vt {x} {y}\n" for x, y in points),
                    *("f " + " ".join(f"{v}/{v}" for v in face) + "\n" for face in faces)])


class Output(running.Folder):
    def mesh_of(self, ranks, *options):
        run = self.run_case(f"on-{ranks}", "--overwrite", "--set", "time.end=0.05", *options, ranks=ranks)
        return Datasets(run / "mesh.h5").read_all()

    def test_mesh_on_any_ranks(self):
        expected = self.mesh_of(1)
        self.assertEqual(len(np.unique(expected["constraints/yarn"])), 11 + 11)
        for ranks in (2, 3, 7):
            found = self.mesh_of(ranks)
            self.assertEqual(found.keys(), expected.keys())
            for name in expected.keys() - {"owner_rank"}:
                np.testing.assert_array_equal(found[name], expected[name], f"{name} on {ranks} ranks")

    def test_yarns_of_edges_and_faces(self):
        mesh = self.mesh_of(3)
        yarn, warp, weft = mesh["constraints/yarn"], mesh["cells/yarn_warp"], mesh["cells/yarn_weft"]
        of_edge = {tuple(edge): y for edge, y in zip(mesh["constraints/edges"], yarn)}
        for (v, w), y in of_edge.items():  # a yarn of the grid is a row or a column
            self.assertEqual(y, of_edge[(v - v % 11, v - v % 11 + 1)] if w == v + 1 else of_edge[(v % 11, v % 11 + 11)])
        for face, a, b in zip(mesh["faces"].reshape(-1, 4), warp, weft):
            self.assertEqual((a, b), (of_edge[(face[0], face[1])], of_edge[(face[0], face[3])]))

    def test_warp_and_weft_are_those_of_the_texture(self):
        (self.folder / "case.yaml").write_text(running.SMALL.replace("grid: {size: [1, 1], vertices: [11, 11]}",
                                                                     "mesh: sheet.obj"))
        found = []
        for along_y in (False, True):
            (self.folder / "sheet.obj").write_text(textured_sheet(along_y))
            mesh = self.mesh_of(2)
            found.append({**mesh, **Datasets(self.folder / "on-2/frames/frame_000001.h5").read_all()})
        plain, turned = found
        self.assertGreater(np.abs(plain["cells/strain_warp"] - plain["cells/strain_weft"]).max(), 1e-6)
        for name in ("yarn", "strain", "tension"):
            for one, other in (("warp", "weft"), ("weft", "warp")):
                np.testing.assert_allclose(turned[f"cells/{name}_{one}"], plain[f"cells/{name}_{other}"], 1e-6, 1e-9,
                                           err_msg=name)

    def test_the_threads_that_hang_are_strained(self):
        """Warp lies along x, weft along y; the cloth hangs by its side at x = 0, or by that at y = 0."""
        for hanging, across, turn, pinned in (("warp", "weft", [0, 1, 0], list(range(0, 121, 11))),
                                              ("weft", "warp", [-1, 0, 0], list(range(11)))):
            run = self.run_case(f"by-{hanging}", "--set", f"cloth.start.rotate={{axis: {turn}, angle: 90 deg}}",
                                "--set",
                                f"pins=[{{vertices: {pinned}}}]", "--set", "time.end=0.2")
            last = Datasets(run / "frames/frame_000004.h5").read_all()
            for field in ("strain", "tension"):
                along, other = last[f"cells/{field}_{hanging}"].mean(), last[f"cells/{field}_{across}"].mean()
                self.assertGreater(along, 5 * abs(other), field)

    def test_yarns_are_listed_for_paraview(self):
        self.mesh_of(1)
        self.assertIn("mesh.h5:/constraints/yarn<", (self.folder / "on-1/edges.xdmf").read_text())
        self.assertIn("mesh.h5:/cells/yarn_warp<", (self.folder / "on-1/frames.xdmf").read_text())

    def test_figures_of_a_partition(self):
        told = []
        for ranks in (1, 3):
            code, out, err = self.taut("partition", "case.yaml", "--ranks", "40", "--json", "figures.json", ranks=ranks)
            self.assertEqual((code, err), (0, ""))
            told.append((out, json.loads((self.folder / "figures.json").read_text())))
        self.assertEqual(told[0], told[1])
        out, figures = told[0]
        self.assertEqual((figures["ranks"], figures["method"], figures["yarns"]), (40, "metis", 22))
        self.assertAlmostEqual(figures["vertices"]["mean"], 121 / 40)
        self.assertEqual(figures["position_bytes"]["max"], 24 * figures["ghosts"]["max"])
        self.assertIn(f"121 vertices for 40 ranks, by metis\n  {figures['edge_cut']} edges cut", out)

    def test_counters(self):
        phases = {}
        for ranks in (1, 3):
            self.taut("run", "case.yaml", "--out", f"c-{ranks}", "--counters", "counters.json", "--set",
                      "time.end=0.05", "inextensibility.method=fast_projection",
                      ranks=ranks)
            counted = json.loads((self.folder / "counters.json").read_text())
            self.assertEqual((counted["ranks"], counted["steps"]), (ranks, 10))
            phases[ranks] = counted["phases"]
        for name in ("velocity", "projection", "output"):
            alone, together = phases[1][name], phases[3][name]
            self.assertEqual((alone["messages"]["sum"], alone["reductions"]["sum"]), (0, 0))
            self.assertGreater(together["messages"]["sum"], 0, name)
            self.assertGreater(together["seconds"]["mean"], 0)
        velocity = phases[3]["velocity"]
        self.assertGreaterEqual(velocity["entered"]["max"], 10)
        self.assertEqual(velocity["reductions"]["sum"],
                         3 * velocity["reductions"]["max"])  # everybody takes part in each
        self.assertGreaterEqual(velocity["reductions"]["max"], 2 * velocity["iterations"])  # two in an iteration of CG
        self.assertLessEqual(velocity["neighbours"]["max"], 2)
        self.assertEqual(phases[3]["contact"]["entered"]["max"], 0)

    def test_a_slurm_job_goes_on_with_its_run(self):
        environment = {**launch.ENVIRONMENT, "TAUT": launch.PROGRAM, "TAUT_LAUNCH": "env"}  # no srun here

        def submit(*words):
            done = running.script("slurm.sh", *words, cwd=self.folder, env=environment)
            return done.returncode, done.stdout, done.stderr
        first = submit("case.yaml", "--out", "job", "--set", "time.end=0.05")
        self.assertEqual(first[0], 0, first)
        again = submit("case.yaml", "--out", "job", "--set", "time.end=0.05")
        self.assertEqual(again[0], 0, again)
        self.assertIn("the run is complete", again[1])
        self.assertIn("the run is complete", submit("case.yaml", "--out=job")[1])
        self.assertEqual(submit("case.yaml")[0], 2)
        code, _, err = submit()
        self.assertEqual(code, 2)
        self.assertIn("It needs sbatch and srun", err)
        environment["TAUT_LAUNCH"] = "none-such"
        self.assertIn("none-such: not found; this is a job for Slurm", submit("case.yaml", "--out", "job")[2])

    def test_fields_that_nobody_asks_for_are_left_out(self):
        self.assertNotIn("constraints/yarn", self.mesh_of(1, "--set", "output.fields=[position]"))


def point_cache(path):
    """The number of the first frame, and the positions of all frames (frames, vertices, 3)."""
    data = path.read_bytes()
    signature, version, vertices, start, per_frame, frames = struct.unpack_from("<12siiffi", data)
    assert (signature, version, per_frame) == (b"POINTCACHE2\0", 1, 1.0)
    return start, np.frombuffer(data, "<f4", 3 * vertices * frames, 32).reshape(frames, vertices, 3)


class PointCache(running.Folder):
    BOTH = ("--set", "output.formats=[xdmf, pc2]", "--set", "checkpoint.every_steps=10")

    def assert_of(self, run, first=0):
        """The point cache holds the positions of all frames of a run from `first` on."""
        start, positions = point_cache(run / "frames.pc2")
        self.assertEqual(start, first)
        expected = [running.frame(run, file)["positions"] for file, _ in running.listed_frames(run)[first:]]
        np.testing.assert_array_equal(positions, np.array(expected).astype("f4"))

    def test_holds_the_positions_of_frames_on_any_ranks(self):
        for ranks in (1, 3):
            self.assert_of(self.run_case(f"on-{ranks}", *self.BOTH, ranks=ranks))

    def test_goes_on_with_a_resumed_run(self):
        for sent in (signal.SIGTERM, signal.SIGKILL):
            run = self.folder / f"run-{sent}"
            job = running.Job(self.folder, ("run", "case.yaml", "--out", run.name, *self.BOTH), 3)
            self.assertTrue(job.wait_for(lambda: running.rows(run) >= 45))
            for pid in job.ranks():
                os.kill(pid, sent)
            job.end()
            self.assertGreater(len(point_cache(run / "frames.pc2")[1]), 3)
            self.assertEqual(self.taut("resume", run.name, ranks=2)[0], 0)
            self.assert_of(run)

    def test_overwrites_frames_after_the_checkpoint(self):
        run = self.run_case("run", *self.BOTH, "--set", "time.end=0.17")
        for checkpoint, end in (("step_000000034.h5", 0.4), ("step_000000070.h5", 0.5)):
            code, _, err = self.taut("resume", "run", "--checkpoint", f"run/checkpoint/{checkpoint}",
                                     "--set", f"time.end={end}")
            self.assertEqual((code, err), (0, ""))
            self.assert_of(run)

    def test_alone_and_begun_later(self):
        run = self.run_case("run", "--set", "time.end=0.1", "--set", "output.formats=[pc2]")
        self.assertEqual(list((run / "frames").iterdir()), [])
        self.assertEqual(len(point_cache(run / "frames.pc2")[1]), 3)
        self.assertIn("3 frames", self.taut("info", "run")[1])
        later = self.run_case("later", "--set", "time.end=0.1")
        self.assertEqual(self.taut("resume", "later", "--set", "time.end=0.2", *self.BOTH)[0], 0)
        self.assert_of(later, 3)

    def test_refuses_a_file_with_a_gap_and_is_replaced_as_a_whole(self):
        run = self.run_case("run", "--set", "time.end=0.1", *self.BOTH)
        (run / "frames.pc2").write_bytes((run / "frames.pc2").read_bytes()[:-1])
        code, _, err = self.taut("resume", "run", "--set", "time.end=0.2")
        self.assertEqual(code, 2)
        self.assertIn("run/frames.pc2: this is not the point cache of the run up to frame 3; put it back", err)
        code, _, err = self.taut("run", "case.yaml", "--out", "run", "--overwrite", "--set", "time.end=0.1")
        self.assertEqual((code, err), (0, ""))
        self.assertFalse((run / "frames.pc2").exists())


class Start(running.Folder):
    def begin(self, out, obstacle, *options, ranks=1):
        return self.taut("run", "case.yaml", "--out", out, "--set", "time.end=0.05", "--set", f"obstacles=[{obstacle}]",
                         *options,
                         ranks=ranks)

    def test_that_intersects(self):
        ball, untangle = "{sphere: {centre: [0.5, 0.5, -0.297], radius: 0.3}}", ("--set", "contact.start=untangle")
        code, _, err = self.begin("refused", ball)
        self.assertEqual(code, 2)
        self.assertIn("give contact.start: untangle", err)
        for ranks in (1, 3):
            code, out, err = self.begin(f"free-{ranks}", ball, *untangle, ranks=ranks)
            self.assertEqual((code, err), (0, ""))
            self.assertIn("the start intersected, and was untangled after ", out)
        code, _, err = self.begin("hopeless", "{plane: {point: [0.5, 0, 0], normal: [1, 0, 0]}}", *untangle, ranks=2)
        self.assertEqual(code, 3)
        self.assertIn("case.yaml: contact.start: the start could not be untangled after 100 rounds", err)
        self.assertTrue((self.folder / "hopeless.findings.vtp").exists())
        self.assertFalse((self.folder / "hopeless").exists())


if __name__ == "__main__":
    unittest.main()
