#!/usr/bin/env python3
"""scripts/plot on runs as they are, on half of one and on what is none."""
import unittest

import matplotlib.image
import numpy as np

import running

HEADER = ("step,time_s,dt_s,rejected,strain_max,strain_rms,projection_iterations,projection_ksp_iterations,"
          "velocity_ksp_iterations")


def plot(*arguments):
    done = running.script("plot", *arguments, timeout=60)
    return done.returncode, done.stdout.strip(), done.stderr.strip()


def panels(path, rows=3):
    """The parts of a picture: strain, iterations, energies, seconds, and with pins their forces."""
    image = matplotlib.image.imread(path)[:, :, :3]
    y, x = image.shape[0] // rows, image.shape[1] // 2
    names = ("strain", "iterations", "energies", "seconds", "forces")[:5 if rows == 3 else 4]
    return {name: image[k // 2 * y:(k // 2 + 1) * y, k % 2 * x:(k % 2 + 1) * x] for k, name in enumerate(names)}


def blue(panel):
    """Pixels of the first curve's colour, #1f77b4."""
    return int((np.abs(panel - np.array([0x1f, 0x77, 0xb4]) / 255).max(axis=2) < 0.15).sum())


class Plot(running.Folder):
    def test_draws_all(self):
        for rows, out, options in ((3, "result", ()), (2, "free", ("--set", "pins=[]"))):
            run = self.run_case(out, *options)
            self.assertEqual(plot(run), (0, str(run / "steps.png"), ""))
            for name, panel in panels(run / "steps.png", rows).items():
                self.assertGreater(blue(panel), 150 if rows == 3 else 20, name)

    def test_draws_what_the_table_holds(self):
        run = self.run_case("result")
        lines = (run / "steps.csv").read_text().splitlines()
        columns = lines[0].split(",")
        table = [line.split(",") for line in lines[1:]]
        for row in table:
            row[columns.index("kinetic_J")] = "1000"  # and so no curve but a line that does not rise
        (run / "steps.csv").write_text("\n".join([lines[0], *map(",".join, table)]) + "\n")
        before = panels(self.drawn(run, "before.png"))
        for k, row in enumerate(table):
            row[columns.index("kinetic_J")] = str(1000 + k % 7)
        (run / "steps.csv").write_text("\n".join([lines[0], *map(",".join, table)]) + "\n")
        after = panels(self.drawn(run, "after.png"))
        self.assertGreater(blue(after["energies"]), 3 * blue(before["energies"]))
        self.assertAlmostEqual(blue(after["strain"]) / blue(before["strain"]), 1, delta=0.05)

    def drawn(self, run, name):
        self.assertEqual(plot(run, "--output", self.folder / name)[0], 0)
        return self.folder / name

    def test_draws_a_run_that_was_cut_off(self):
        run = self.run_case("result")
        text = (run / "steps.csv").read_text()
        (run / "steps.csv").write_text(text[:text.rindex(",")])
        (run / "summary.json").unlink()
        self.assertEqual(plot(run)[0], 0)

    def refused(self, message):
        code, out, err = plot(self.folder)
        self.assertEqual((code, out), (1, ""))
        self.assertEqual(err, f"plot: {self.folder}/{message}")

    def test_no_run(self):
        self.refused("steps.csv: no such file; give the output folder of a run")

    def test_other_table(self):
        (self.folder / "steps.csv").write_text("a,b\n1,2\n")
        self.refused("steps.csv: no table of the steps of a run: it has no column time_s")

    def test_no_steps(self):
        (self.folder / "steps.csv").write_text(HEADER + "\n")
        self.refused("steps.csv: holds no steps yet")

    def test_no_numbers(self):
        (self.folder / "steps.csv").write_text(HEADER + "\n" + "1,2,3,4,five,6,7,8,9\n")
        self.refused("steps.csv: could not convert string to float: 'five'")

    def test_output_not_writable(self):
        run = self.run_case("result")
        code, _, err = plot(run, "--output", self.folder / "nowhere/steps.png")
        self.assertEqual(code, 1)
        self.assertIn("nowhere/steps.png: cannot be written", err)


if __name__ == "__main__":
    unittest.main()
