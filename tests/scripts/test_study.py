#!/usr/bin/env python3
"""scripts/study.py on its small versions, and that it goes on where it was."""
import unittest

import running
from studies.table import read_rows


def study(folder, *arguments):
    return running.script("study.py", *arguments, "--quick", "--out", folder)


class Study(running.Temporary):
    def test_table_plot_and_verdict(self):
        done = study(self.folder, "figure-3")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("The claim holds here.", done.stdout)
        self.assertEqual((self.folder / "figure-3-quick.png").read_bytes()[:8], running.PNG)
        self.assertIn("The claim holds here.", (self.folder / "figure-3-quick.txt").read_text())
        rows = read_rows(self.folder / "figure-3-quick.csv")
        self.assertGreater(len(rows), 20)
        self.assertTrue(all(row["first"] > 0 and row["machine"] for row in rows))

    def test_goes_on_where_it_was(self):
        done = study(self.folder, "shake-failures")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        path = self.folder / "shake-failures-quick.csv"
        whole, rows = path.read_text(), read_rows(path)
        self.assertEqual([row["status"] for row in rows[:4]], ["as in the paper"] * 4)
        path.write_text("".join(whole.splitlines(keepends=True)[:-1]))  # interrupted before its last point
        again = study(self.folder, "shake-failures")
        self.assertEqual(again.returncode, 0, again.stdout + again.stderr)
        ran = [line for line in again.stdout.splitlines() if line.startswith("shake-failures: case ")]
        self.assertEqual(len(ran), 1, again.stdout)
        self.assertIn(rows[-1]["method"], ran[0])
        self.assertEqual(path.read_text().splitlines()[:-1], whole.splitlines()[:-1])
        self.assertEqual(len(read_rows(path)), len(rows))

    def test_says_what_is_wrong(self):
        self.assertIn("no such program", study(self.folder, "figure-3", "--program", "nowhere/taut").stderr)
        self.assertIn("invalid choice: 'figure-33'", study(self.folder, "figure-33").stderr)


if __name__ == "__main__":
    unittest.main()
