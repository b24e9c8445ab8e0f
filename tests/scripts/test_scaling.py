#!/usr/bin/env python3
"""scripts/scaling.py in its small version."""
import math
import unittest

import running
import scaling as script
from studies.table import read_rows


def scaling(folder, *words):
    return running.script("scaling.py", *words, "--quick", "--out", folder)


class Scaling(running.Temporary):
    def test_counts_then_predicts(self):
        for what in ("strong", "weak"):
            done = scaling(self.folder, what)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertEqual((self.folder / f"{what}-quick.png").read_bytes()[:8], running.PNG)
            rows = read_rows(self.folder / f"{what}-quick.csv")
            self.assertEqual([int(r["ranks"]) for r in rows if r["phase"] == "velocity"], [1, 2, 4, 8])
            for row in rows:
                alone = row["ranks"] == 1 or row["phase"] == "other"
                self.assertEqual(float(row["messages"]) > 0, not alone)
                self.assertTrue(row["machine"])
        done = scaling(self.folder, "model")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("messages: off by", (self.folder / "model-quick.txt").read_text())
        table = {int(r["ranks"]): r for r in read_rows(self.folder / "model-quick.csv")}
        self.assertEqual(float(table[1]["halos"]), 0)
        self.assertGreater(float(table[4096]["reductions"]), float(table[64]["reductions"]))
        for row in table.values():
            self.assertAlmostEqual(float(row["step"]), sum(float(row[k]) for k in ("work", "halos", "reductions")),
                                   delta=1e-6)
        slow = scaling(self.folder, "model", "--latency", "15e-6")
        self.assertEqual(slow.returncode, 0, slow.stderr)
        self.assertGreater(float(read_rows(self.folder / "model-quick.csv")[-1]["step"]),
                           2 * float(table[4096]["step"]))

    def test_says_what_is_wrong(self):
        self.assertIn("no such program", scaling(self.folder, "strong", "--program", "nowhere/taut").stderr)
        self.assertIn("strong-quick.csv: no such table; make it with scripts/scaling.py strong",
                      scaling(self.folder, "model").stderr)
        self.assertIn("bandwidth must be above 0", scaling(self.folder, "model", "--bandwidth", "0").stderr)


class Model(unittest.TestCase):
    def test_finds_the_coefficients_it_was_given(self):
        rows = [{"ranks": p, "iterations": 20.0 + p, "neighbours_of_part": 3.0 + p % 3, "yarn_segments": 40.0}
                for p in (1, 2, 4, 8, 16)]
        for row in rows:
            each = 1.5 * row["neighbours_of_part"] + 0.25 * math.sqrt(row["ranks"])
            row["messages"] = row["iterations"] * each
        found = script.fit("messages", rows)
        self.assertAlmostEqual(found["iterations x neighbours"], 1.5)
        self.assertAlmostEqual(found["iterations x sqrt ranks"], 0.25)

    def test_a_count_that_falls_has_no_negative_part(self):
        rows = [{"ranks": p, "iterations": 20.0, "reductions": 50.0 - p} for p in (1, 2, 4, 8)]
        self.assertTrue(all(c >= 0 for c in script.fit("reductions", rows).values()))


if __name__ == "__main__":
    unittest.main()
