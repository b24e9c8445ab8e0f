#!/usr/bin/env python3
"""scripts/bench on small cloths; kernels and plain_xpbd stand beside the program."""
import json
import math
import subprocess
import unittest

from running import script
from taut import launch


def xpbd(*words):
    done = subprocess.run([launch.PROGRAM.parent / "plain_xpbd", *map(str, words)], capture_output=True, text=True)
    return json.loads(done.stdout) if done.returncode == 0 else done


class Bench(unittest.TestCase):
    def test_kernels(self):
        done = script("bench", "--kernels", "--side", "21")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("21 x 21 vertices, 840 constraints", done.stdout)
        rows = {line[:22].strip(): line[22:].split() for line in done.stdout.splitlines()}
        for kernel in ("velocity_assembly", "velocity_product", "projection_assembly", "yarn_apply"):
            self.assertGreater(float(rows[kernel][0]), 0)
        self.assertEqual(float(rows["CG, yarns"][-1]), 1)
        for direct in ("CHOLMOD", "MUMPS"):
            self.assertEqual(rows[direct][1], "1")
        for iterative in ("CG, yarns", "CG, ICC(0)", "CG, BoomerAMG"):
            self.assertGreater(int(rows[iterative][1]), 1)

    def test_contact_large(self):
        done = script("bench", "--contact-large", "--sides", "6", "--end", "0.1")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [line.strip("| ").split(" | ") for line in done.stdout.splitlines() if line.startswith("|")][2:]
        self.assertEqual([row[0] for row in rows], ["hang", "drape 5 %", "drape 1 %", "sphere-large", "pile"])
        self.assertEqual([row[1] for row in rows], ["36", "180", "180", "36", "36"])
        for row in rows:
            self.assertEqual(row[-1], "0")

    def test_baseline(self):
        done = script("bench", "--baseline", "--sides", "11", "--end", "0.3")
        self.assertEqual(done.returncode, 0, done.stderr)
        taut, other = (line.split() for line in done.stdout.splitlines() if line.strip().startswith("121 "))
        self.assertLessEqual(float(taut[3]), 1)
        self.assertLessEqual(float(other[4]), 1)
        self.assertIn("times the cost of Taut", done.stdout)


class PlainXpbd(unittest.TestCase):
    def test_falls_freely(self):
        """The middle of a sheet falls as if free, for waves from its pins have not come there: g t²/2, by symplectic
        Euler g t (t + h)/2."""
        h = 0.01 / 20
        self.assertAlmostEqual(xpbd(41, 20, 0.2)["depth"], 9.81 * 0.2 * (0.2 + h) / 2, delta=1e-3)

    def test_strain_falls_with_the_substeps(self):
        coarse, fine = xpbd(21, 40, 0.6), xpbd(21, 160, 0.6)
        self.assertLess(fine["strain"], coarse["strain"] / 2)
        self.assertLess(fine["depth"], math.sqrt(2))

    def test_says_how_it_is_called(self):
        self.assertEqual(xpbd(1, 10, 1).returncode, 2)
        self.assertEqual(xpbd(11).returncode, 2)


if __name__ == "__main__":
    unittest.main()
