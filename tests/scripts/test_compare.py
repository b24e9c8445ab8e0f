#!/usr/bin/env python3
"""scripts/compare-results, with the program and with one that has another gravity."""
import unittest

import running
from taut import launch


class Compare(running.Folder):
    def setUp(self):
        super().setUp()
        self.case = self.folder / "small"
        self.case.mkdir()
        (self.folder / "case.yaml").rename(self.case / "case.yaml")
        (self.case / "expected.yaml").write_text("options: {set: {time.end: 0.2}}\nchecks: []\n")
        self.other = self.folder / "other"
        self.other.write_text(f'#!/bin/sh\nexec {launch.PROGRAM} "$@" --set "gravity=[0, 0, -9]"\n')
        self.other.chmod(0o755)

    def compared(self, new, *options):
        """The exit code, and the rows in words."""
        done = running.script("compare-results", launch.PROGRAM, new, self.case, "--kept", self.folder / "kept",
                              *options)
        self.assertEqual(done.stderr, "")
        return done.returncode, [" ".join(line.split()[1:]) for line in done.stdout.splitlines()[1:-1]]

    def test_the_same(self):
        rows = [f"{ranks} equal to the last bit 40{how}" for ranks in (1, 3) for how in ("", " resumed")]
        self.assertEqual(self.compared(launch.PROGRAM, "--resume"), (0, rows))

    def test_another(self):
        code, rows = self.compared(self.other, "--ranks", "1")
        self.assertEqual(code, 1)
        self.assertRegex(rows[0], r"^1 0\.01\d* m 40$")  # (9.81 - 9) t² / 2

    def test_outcomes_are_kept(self):
        self.compared(self.other, "--ranks", "1")
        before = {path: path.stat().st_mtime_ns for path in (self.folder / "kept").iterdir()}
        self.assertEqual(len(before), 2)
        self.compared(self.other, "--ranks", "1")
        self.assertEqual({path: path.stat().st_mtime_ns for path in (self.folder / "kept").iterdir()}, before)


if __name__ == "__main__":
    unittest.main()
