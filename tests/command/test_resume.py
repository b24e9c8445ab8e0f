#!/usr/bin/env python3
"""Runs that are stopped and go on, as a user sees it."""
import os
import shutil
import signal
import unittest

import h5py

import running
from running import Folder, listed_frames, rows, table
from taut import Run

# Solved so tightly that what is left to differ between numbers of ranks is far below a micrometre.
TIGHT = ("--", "-velocity_ksp_rtol", "1e-12", "-projection_ksp_rtol", "1e-12")
BY_PETSC = ("--set", "inextensibility.method=fast_projection")
DIRECT = ("--set", "velocity.solver=mumps", "--set", "inextensibility.solver=mumps")


def checkpoints(run):
    return sorted(path.name for path in (run / "checkpoint").iterdir())


def summary(run):
    return Run(run).summary


class Resume(Folder):
    def test_a_stopped_run_goes_on_as_if_unbroken(self):
        whole = self.run_case("whole")
        for sent in (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1):
            run = self.stop_run(f"stopped-{sent.name}", 12, sent=sent)
            stopped = summary(run)
            self.assertEqual(stopped["status"], "interrupted")
            self.assertEqual(stopped["steps"], rows(run))
            self.assertLess(stopped["end_time"], 0.5)
            code, out, err = self.taut("resume", run.name)
            self.assertEqual((code, err), (0, ""))
            self.assertIn(f"after step {stopped['steps']}", out)
            self.assert_same_run(run, whole)
            found, expected = summary(run), summary(whole)
            for key in ("seconds", "memory_bytes"):
                del found[key], expected[key]
            self.assertEqual(found, expected)
            self.assertFalse(list(run.rglob("*.part")))

    def test_on_other_ranks(self):
        for settings, solvers, tolerance in ((DIRECT, (), 1e-9), (BY_PETSC, TIGHT, 1e-6)):
            whole = self.run_case("whole", "--overwrite", *settings, *solvers, ranks=2)
            for before, after in ((2, 1), (1, 3)):
                out = f"from-{before}-{bool(solvers)}"
                run = self.stop_run(out, 12, *settings, *solvers, ranks=before)
                code, _, err = self.taut("resume", out, ranks=after)  # with the options of the run
                self.assertEqual((code, err), (0, ""))
                self.assert_same_run(run, whole, tolerance)
                self.assertEqual(summary(run)["ranks"], after)

    def test_stopped_again_and_again(self):
        longer = ("--set", "time.end=1.5")  # time for three stops, however late this test sees a step
        whole, run = self.run_case("whole", *longer), self.stop_run("run", 5, *longer)
        for _ in range(3):
            beyond = rows(run) + 10  # so it has taken up its work; before MPI stands a signal would end it
            job = running.Job(self.folder, ("resume", "run"))
            self.assertTrue(job.wait_for(lambda: rows(run) >= beyond))
            os.kill(job.ranks()[0], signal.SIGTERM)
            self.assertEqual(job.end()[0], 4)
        self.assertEqual(self.taut("resume", "run")[0], 0)
        self.assert_same_run(run, whole)

    def test_a_complete_run_says_so_and_goes_on_when_its_end_is_later(self):
        longer = self.run_case("longer", "--set", "time.end=0.6")
        run = self.run_case("run")
        before = {path: path.stat().st_mtime_ns for path in run.rglob("*.*")}
        code, out, _ = self.taut("resume", "run")
        self.assertEqual(code, 0)
        self.assertIn("run: the run is complete: it has reached its end at 0.5 s", out)
        self.assertEqual({path: path.stat().st_mtime_ns for path in run.rglob("*.*")}, before)
        code, out, err = self.taut("resume", "run", "--set", "time.end=0.6")
        self.assertEqual((code, err), (0, ""))
        self.assertIn("changed: time.end: 0.5 -> 0.6\n", out)
        self.assert_same_run(run, longer)

    def test_a_run_killed_behind_its_last_checkpoint_is_completed(self):
        whole, run = self.run_case("whole"), self.run_case("run")
        for file in ("summary.json", "frames.xdmf", "edges.xdmf"):  # which come after it
            (run / file).unlink()
        self.assertEqual(self.taut("resume", "run")[0], 0)
        self.assert_same_run(run, whole)
        self.assertTrue((run / "summary.json").exists())

    def test_an_end_between_frames_is_no_frame_of_the_longer_run(self):
        run = self.run_case("run", "--set", "time.end=0.07")
        self.assertEqual([t for _, t in listed_frames(run)], [0, 0.05, 0.07])
        self.assertEqual(self.taut("resume", "run", "--set", "time.end=0.15")[0], 0)
        self.assertEqual([round(t, 9) for _, t in listed_frames(run)], [0, 0.05, 0.1, 0.15])
        self.assert_readable(run)

    def test_changed_keys_are_told_and_written(self):
        run = self.stop_run("run", 12)
        code, out, err = self.taut("resume", "run", "--set", "inextensibility.strain=0.02", "--set",
                                   "gravity=[0, 0, -1]", "--set", "air={wind: [0, 1, 0]}", "--set",
                                   "pins.1.release=0.3")
        self.assertEqual((code, err), (0, ""))
        for line in ("inextensibility.strain: 0.01 -> 0.02", "gravity: [0, 0, -9.81] -> [0, 0, -1]",
                     "air.wind: none -> [0, 1, 0]", "pins.1.release: 0.25 -> 0.3"):
            self.assertIn(f"changed: {line}\n", out)
        self.assertIn("strain: 0.02", (run / "case.yaml").read_text())
        steps = table(run)
        self.assertEqual([int(r["step"]) for r in steps], list(range(1, len(steps) + 1)))
        self.assertEqual(steps[0]["air_drag_J"], "")
        self.assertNotEqual(steps[-1]["air_drag_J"], "")

    def test_what_cannot_change_is_refused(self):
        run = self.stop_run("run", 12)
        before = (run / "case.yaml").read_text()
        for setting, words in (
                ("cloth.grid.vertices=[9, 9]", "cloth.grid.vertices was [11, 11] and is [9, 9] now"),
                ("cloth.grid.size=[2, 1]", "cloth.grid.size was [1, 1] and is [2, 1] now"),
                ("cloth.start.translate=[0, 0, 1]", "cloth.start.translate was [0, 0, 0] and is [0, 0, 1] now"),
                ("time.frame_rate=30", "time.frame_rate was 20 and is 30 now, but a resumed run cannot change it: "
                                       "frames "
                                       "are numbered by it; leave it as it was, or start a new run"),
                ("pins.0.vertices=[1]", "pins.0.vertices was [0] and is [1] now"),
                ("pins=[{vertices: [0]}]", "pins.1.vertices was [10] and is none now"),
                ("time.max_stp=1", "unknown key 'max_stp'")):
            code, _, err = self.taut("resume", "run", "--set", setting)
            self.assertEqual(code, 2, setting)
            self.assertIn(words, err)
            self.assertEqual(err.count("taut:"), 1, err)
        self.assertEqual((run / "case.yaml").read_text(), before)
        self.assertEqual(summary(run)["status"], "interrupted")

    def test_another_mesh_under_the_same_name_is_refused(self):
        grid = [f"v {j / 10} {i / 10} 0\n" for i in range(11) for j in range(11)]
        faces = [f"f {a + 1} {a + 2} {a + 13} {a + 12}\n" for a in range(109) if a % 11 < 10]
        (self.folder / "cloth.obj").write_text("".join(grid + faces))
        mesh = ("--set", "cloth.mesh=cloth.obj")
        whole, run = self.run_case("whole", *mesh), self.stop_run("run", 12, *mesh)
        grid[60] = "v 0.5 0.51 0\n"
        (self.folder / "cloth.obj").write_text("".join(grid + faces))
        code, _, err = self.taut("resume", "run")
        self.assertEqual(code, 2)
        self.assertIn("/rest_positions: the mesh of the run has vertices in other places than the mesh of the case",
                      err)
        grid[60] = "v 0.5 0.5 0\n"
        (self.folder / "elsewhere.obj").write_text("".join(grid + faces))
        self.assertEqual(self.taut("resume", "run", "--set", f"cloth.mesh={self.folder}/elsewhere.obj")[0], 0)
        self.assert_same_run(run, whole)

    def test_several_cloths(self):
        cloths = ("--set", "cloths=[{name: large, grid: {size: [1, 1], vertices: [11, 11]}}, {grid: {size: [0.5, 0.5], "
                           "vertices: "
                  "[6, 6]}, start: {translate: [0, 0, 0.3]}, material: {density: 0.1}}]")
        whole, run = self.run_case("whole", *cloths), self.stop_run("run", 12, *cloths)
        for setting, words in (("cloths.1.grid.vertices=[7, 7]", "cloths.1.grid.vertices was [6, 6] and is [7, 7] now"),
                               ("cloths.0.start.translate=[0, 0, 1]",
                                "cloths.0.start.translate was [0, 0, 0] and is [0, 0, 1]"),
                               ("pins.0.cloth=large", "pins.0.cloth was none and is large now")):
            code, _, err = self.taut("resume", "run", "--set", setting)
            self.assertEqual(code, 2, setting)
            self.assertIn(words, err)
        self.assertEqual(self.taut("resume", "run")[0], 0)
        self.assert_same_run(run, whole)
        with h5py.File(run / "mesh.h5") as mesh:
            self.assertEqual(list(mesh["cells/cloth"]), 100 * [0] + 25 * [1])
        self.assertIn("large      121 vertices, 100 faces\n    cloth 1    36 vertices, 25 faces",
                      self.taut("info", "run")[1])


COMES_DOWN = """\
name: comes-down
cloths:
  - {name: low, grid: {size: [0.4, 0.4], vertices: [33, 33]}, start: {translate: [0, 0, 0.003]}}
  - {name: high, grid: {size: [0.4, 0.4], vertices: [33, 33]}, start: {translate: [0, 0, 0.05]}}
obstacles: [{plane: {}}]
contact: {thickness: 2 mm}
time: {end: 0.2, frame_rate: 20, max_step: 0.005}
"""


class CutAnew(Folder):
    def setUp(self):
        super().setUp()
        (self.folder / "case.yaml").write_text(COMES_DOWN)

    def test_a_run_is_cut_anew_where_cloth_comes_together(self):
        code, out, err = self.taut("run", "case.yaml", "--out", "whole", ranks=2)
        self.assertEqual((code, err), (0, ""))
        self.assertIn("cut anew by what is near each other now", out)
        whole = self.folder / "whole"
        self.assertEqual([int(r["step"]) for r in table(whole)], list(range(1, 41)))
        self.assertEqual(len(listed_frames(whole)), 5)
        self.assert_readable(whole)
        self.assertEqual(summary(whole)["steps"], 40)
        for steps in (10, 30):  # before it and behind it
            run = self.stop_run(f"stopped-{steps}", steps, ranks=2)
            code, out, err = self.taut("resume", run.name, ranks=2)
            self.assertEqual((code, err), (0, ""))
            self.assertEqual("cut anew" in out, steps == 10)
            self.assert_same_run(run, whole)
        run = self.stop_run("other", 30, ranks=2)
        code, out, err = self.taut("resume", run.name, "--set", "partition.method=stripes", ranks=2)
        self.assertEqual((code, err), (0, ""))
        self.assertIn("(0 edges cut", out)  # one square each
        self.assertNotIn("cut anew", out)

    def test_one_rank_has_nothing_to_cut(self):
        code, out, err = self.taut("run", "case.yaml", "--out", "one")
        self.assertEqual((code, err), (0, ""))
        self.assertNotIn("cut anew", out)


class Checkpoints(Folder):
    def test_are_written_when_asked_and_two_are_kept(self):
        never = "checkpoint={every_steps: 0, every_time: 0, every_wall: 0}"
        self.assertEqual(checkpoints(self.run_case("end", "--set", never)), ["step_000000100.h5"])
        by_steps = self.run_case("steps", "--set", never, "--set", "checkpoint.every_steps=7")
        self.assertEqual(checkpoints(by_steps), ["step_000000098.h5", "step_000000100.h5"])
        by_time = self.run_case("time", "--set", never, "--set", "checkpoint.every_time=0.16")
        self.assertEqual(checkpoints(by_time), ["step_000000096.h5", "step_000000100.h5"])
        by_wall = self.run_case("wall", "--set", never, "--set", "checkpoint.every_wall=1 us")
        self.assertEqual(checkpoints(by_wall), ["step_000000099.h5", "step_000000100.h5"])

    def test_an_earlier_one_can_be_chosen(self):
        whole = self.run_case("whole")
        run = self.run_case("run", "--set", "checkpoint.every_steps=43")
        code, out, err = self.taut("resume", "run", "--checkpoint", "run/checkpoint/step_000000086.h5")
        self.assertEqual((code, err), (0, ""))
        self.assertIn("resuming at t = 0.43 s, after step 86\n", out)
        self.assert_same_run(run, whole)

    def test_a_broken_one_gives_way_to_the_one_before(self):
        whole = self.run_case("whole")
        for fault in ("truncated", "empty", "foreign"):
            run = self.run_case(f"run-{fault}", "--set", "checkpoint.every_steps=43")
            last = run / "checkpoint/step_000000100.h5"
            self.spoil(last, fault)
            code, out, err = self.taut("resume", run.name)
            self.assertEqual(code, 0, err)
            self.assertIn(f"taut: {run.name}/checkpoint/step_000000100.h5: ", err)
            self.assertIn(f"; going back to {run.name}/checkpoint/step_000000086.h5", err)
            self.assertIn("after step 86", out)
            self.assert_same_run(run, whole)

    def test_no_sound_one_ends_with_the_file_and_a_cure(self):
        run = self.run_case("run", "--set", "checkpoint.every_steps=43")
        for file in (run / "checkpoint").iterdir():
            self.spoil(file, "truncated")
        code, _, err = self.taut("resume", "run")
        self.assertEqual(code, 2)
        self.assertIn("run/checkpoint/step_000000086.h5: it does not end with its checksum", err.splitlines()[-1])
        code, _, err = self.taut("resume", "run", "--checkpoint", "case.yaml")
        self.assertEqual(code, 2)
        self.assertIn("case.yaml: it does not end with its checksum", err)

    @staticmethod
    def spoil(file, fault):
        if fault == "foreign":
            with h5py.File(file, "w") as h5:
                h5["positions"] = [[0.0, 0.0, 0.0]]
        else:
            with open(file, "r+b") as raw:
                raw.truncate(file.stat().st_size // 2 if fault == "truncated" else 0)

    def test_cut_off_before_the_first_it_begins_anew(self):
        whole = self.run_case("whole")
        run = self.run_case("run")
        shutil.rmtree(run / "checkpoint")
        code, out, err = self.taut("resume", "run")
        self.assertEqual((code, err), (0, ""))
        self.assertIn("run: the run was cut off before its first checkpoint: it begins anew\n", out)
        self.assert_same_run(run, whole)

    def test_a_folder_without_a_run(self):
        code, _, err = self.taut("resume", "nowhere")
        self.assertEqual((code, err), (2, "taut: nowhere: holds no run (no case.yaml); start one with taut run CASE "
                                          "--out "
                                          "nowhere"))

    def test_frames_that_were_removed_are_not_listed(self):
        run = self.stop_run("run", 45)
        (run / "frames/frame_000001.h5").unlink()
        self.assertEqual(self.taut("resume", "run")[0], 0)
        self.assertEqual([file for file, _ in listed_frames(run)],
                         [f"frames/frame_{k:06}.h5" for k in range(11) if k != 1])
        self.assert_readable(run)

    def test_info_tells_of_it(self):
        self.stop_run("run", 12)
        self.assertIn("taut resume run", self.taut("info", "run")[1])


if __name__ == "__main__":
    unittest.main()
