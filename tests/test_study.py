#!/usr/bin/env python3
"""scripts/study.py on its small versions, and that it goes on where it was: test_study.py PROGRAM"""
import csv
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

STUDY = Path(__file__).resolve().parent.parent / "scripts/study.py"
PROGRAM = None


def study(folder, *arguments, program=None):
    return subprocess.run([sys.executable, STUDY, *arguments, "--quick", "--out", folder, "--program", program or PROGRAM],
                          capture_output=True, text=True)


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


class Study(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def test_table_plot_and_verdict(self):
        done = study(self.folder, "figure-3")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("The claim holds here.", done.stdout)
        self.assertEqual((self.folder / "figure-3-quick.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertIn("The claim holds here.", (self.folder / "figure-3-quick.txt").read_text())
        rows = rows_of(self.folder / "figure-3-quick.csv")
        self.assertGreater(len(rows), 20)
        self.assertTrue(all(float(row["first"]) > 0 and row["machine"] for row in rows))

    def test_goes_on_where_it_was(self):
        done = study(self.folder, "shake-failures")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        path = self.folder / "shake-failures-quick.csv"
        whole, rows = path.read_text(), rows_of(path)
        self.assertEqual([row["status"] for row in rows[:4]], ["as in the paper"] * 4)
        path.write_text("".join(whole.splitlines(keepends=True)[:-1]))  # interrupted before its last point
        again = study(self.folder, "shake-failures")
        self.assertEqual(again.returncode, 0, again.stdout + again.stderr)
        ran = [line for line in again.stdout.splitlines() if line.startswith("case ")]
        self.assertEqual(len(ran), 1, again.stdout)
        self.assertIn(rows[-1]["method"], ran[0])
        self.assertEqual(path.read_text().splitlines()[:-1], whole.splitlines()[:-1])
        self.assertEqual(len(rows_of(path)), len(rows))

    def test_says_what_is_wrong(self):
        self.assertIn("no such program", study(self.folder, "figure-3", program="nowhere/taut").stderr)
        self.assertIn("invalid choice: 'figure-33'", study(self.folder, "figure-33").stderr)


if __name__ == "__main__":
    PROGRAM = str(Path(sys.argv[1]).resolve())
    unittest.main(argv=sys.argv[:1])
