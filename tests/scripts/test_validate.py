#!/usr/bin/env python3
"""A small version of a validation, which then goes on where it was: test_validate.py NAME [RANKS]"""
import csv
import sys
import unittest

import running

NAME, RANKS = (*sys.argv[1:], "1")[:2]
# by how the reference begins; else "met"
VERDICTS = {"no published band": "no reference", "not judged": "no reference"}


def validate(folder, name):
    return running.script("validate", name, "--quick", "--out", folder, "--ranks", RANKS)


class Validation(running.Temporary):
    def test_meets_what_is_expected(self):
        done = validate(self.folder, NAME)
        self.assertIn(f"## {NAME}", (self.folder / "table.md").read_text(), done.stdout + done.stderr)
        with open(self.folder / "table.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertTrue(rows)
        self.assertEqual({row["validation"] for row in rows}, {NAME})
        for row in rows:
            wanted = [verdict for words, verdict in VERDICTS.items() if row["reference"].startswith(words)] or ["met"]
            self.assertEqual(row["verdict"], wanted[0], row)
        self.assertEqual(done.returncode, int(any(row["verdict"] == "missed" for row in rows)),
                         done.stdout + done.stderr)
        self.assertEqual((self.folder / f"{NAME}.png").read_bytes()[:8], running.PNG)
        self.goes_on_where_it_was(done.stdout)

    def goes_on_where_it_was(self, first):
        """Without the rows of its last point, which begin alike, only that one is run again."""
        path = self.folder / f"{NAME}.csv"
        with open(path, newline="") as file:
            rows = list(csv.reader(file))
        with open(path, "w", newline="") as file:
            csv.writer(file).writerows(row for row in rows if row[:2] != rows[-1][:2])
        again = validate(self.folder, NAME)
        ran = [[line for line in out.splitlines() if line.startswith(NAME + ":")] for out in (first, again.stdout)]
        self.assertEqual(ran[1], ran[0][-1:], again.stderr)

    def test_says_what_is_wrong(self):
        self.assertIn("no validation is called free-falls; there are free-fall,",
                      validate(self.folder, "free-falls").stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
