#!/usr/bin/env python3
"""The package taut: what it reads of runs, and cases that it changes."""
import subprocess
import sys
import unittest

import numpy as np

import running
from taut import Run, RunError, launch, read_case, write_case


class Package(running.Folder):
    def test_reads_a_run(self):
        run = Run(self.run_case("result"))
        self.assertTrue(run.completed)
        self.assertEqual(run.summary["vertices"], 121)
        self.assertEqual(len(run.frames), 11)
        self.assertEqual([frame.time for frame in run.frames], [time for _, time in run.listed_frames()])
        last = run.frames[-1]
        self.assertEqual(last.positions.shape, (121, 3))
        self.assertEqual(last.velocities.shape, (121, 3))
        edges, rest = run.mesh["constraints/edges"], run.mesh["constraints/rest_lengths"]
        lengths = np.linalg.norm(np.diff(last.positions[edges], axis=1)[:, 0], axis=1)
        np.testing.assert_allclose(last["strain"], lengths / rest - 1, atol=1e-12)
        self.assertIn("strain", last)
        self.assertNotIn("weather", last)
        self.assertEqual(len(run.steps["time_s"]), run.summary["steps"])
        self.assertAlmostEqual(run.steps["time_s"][-1], 0.5)

    def test_a_case_is_changed(self):
        case = read_case(self.folder / "case.yaml")
        write_case(self.folder / "case.yaml", {**case, "gravity": [0, 0, 1]})
        run = Run(self.run_case("result"))
        self.assertEqual(run.case["gravity"], [0, 0, 1])
        self.assertGreater(run.frames[-1].positions[:, 2].mean(), 0.05)

    def test_fields_have_names_and_units(self):
        run = Run(self.run_case("result"))
        fields = run.frames[-1].fields
        self.assertEqual(fields["velocities"], ((121, 3), "m/s"))
        self.assertEqual(fields["tension"], ((220,), "N"))
        self.assertEqual(fields["strain"].unit, "")
        self.assertEqual(run.mesh.fields["constraints/rest_lengths"], ((220,), "m"))
        said = subprocess.run([sys.executable, "-m", "taut", run.folder], capture_output=True, text=True, check=True)
        self.assertIn('run.frames[-1]["reactions"]  121 x 3  N\n', said.stdout)
        self.assertRegex(said.stdout, r"run.steps\[...\] of \d+ steps: step, time_s, dt_s")
        self.assertEqual(subprocess.run([sys.executable, "-m", "taut", "/none"], capture_output=True,
                                        check=False).returncode, 1)

    def test_a_folder_without_a_run(self):
        run = Run(self.folder)
        self.assertEqual((run.summary, run.status, run.frames), (None, "killed", []))
        with self.assertRaisesRegex(RunError, "steps.csv: no such file; give the output folder of a run"):
            print(run.steps)

    def test_what_is_not_there_is_told_with_what_is(self):
        run = Run(self.run_case("result"))
        for ask, words in ((lambda: run.steps["depth"], "there is no column depth; there are step, time_s"),
                           (lambda: run.frames[0]["tensions"], "has no tensions; there are ")):
            with self.assertRaises(KeyError) as caught:
                ask()
            self.assertIn(words, str(caught.exception))
        with self.assertRaisesRegex(RunError, "nope: no such folder"):
            print(Run(self.folder / "nope").frames)

    def test_words_that_start_the_program(self):
        self.assertEqual(launch.command("taut", "info", 1), ["taut", "info", "1"])
        self.assertEqual(launch.command("taut", "info", ranks=3), [*launch.LAUNCHER, "-n", "3", "taut", "info"])
        self.assertEqual(launch.settings({"gravity": [0, 0, -1]}), ["--set", "gravity=[0, 0, -1]"])


if __name__ == "__main__":
    unittest.main()
