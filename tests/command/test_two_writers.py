#!/usr/bin/env python3
"""Two programs for one folder: the second ends with exit code 2, the first goes on as if alone.

--repeat is how many pairs start at the same time (default 4).
"""
import argparse
import os
import shutil
import signal
import unittest

from running import Folder, Job, rows

OPTIONS = argparse.Namespace(repeat=4)
LONG = ("--set", "time.end=100")


class TwoWriters(Folder):
    def start(self, *arguments, ranks=1):
        job = Job(self.folder, arguments, ranks)
        self.addCleanup(job.kill_all)
        return job

    def start_long(self):
        """A run that goes on, and its folder."""
        job, run = self.start("run", "case.yaml", "--out", "run", *LONG), self.folder / "run"
        self.assertTrue(job.wait_for(lambda: rows(run) > 5))
        return job, run

    def assert_refused(self, *arguments, ranks=1):
        code, _, err = self.taut(*arguments, ranks=ranks)
        self.assertEqual(code, 2, err)
        self.assertRegex(err, r"^taut: run: process \d+ on \S+ is writing in this folder; wait until it has ended")

    def test_a_live_run_is_left_alone(self):
        job, run = self.start_long()
        before = {path: path.stat().st_ino for path in (run / "frames").glob("*.h5")}
        for ranks in (1, 2):
            self.assert_refused("resume", "run", ranks=ranks)
            self.assert_refused("run", "case.yaml", "--out", "run", "--overwrite", ranks=ranks)
        self.assertEqual({path: path.stat().st_ino for path in before}, before)
        os.kill(job.ranks()[0], signal.SIGTERM)
        self.assertEqual(job.end()[0], 4)
        self.assertFalse((run / "lock").exists())

    def test_the_lock_of_a_dead_owner_is_taken_over(self):
        whole = self.run_case("whole")
        job, run = self.start_long()
        pid = job.ranks()[0]
        job.kill_all()
        job.end()
        self.assertTrue((run / "lock").exists())
        code, out, err = self.taut("run", "case.yaml", "--out", "run", "--overwrite")
        self.assertEqual((code, err), (0, ""))
        self.assertRegex(out, rf"run: process {pid} on \S+ wrote here and ended without giving back its lock")
        self.assert_same_run(run, whole)
        self.assertFalse((run / "lock").exists())

    def test_pairs_that_start_at_the_same_time(self):
        whole, stopped = self.run_case("whole", ranks=2), self.stop_run("stopped", 12, ranks=2)
        for turn in range(OPTIONS.repeat):
            run = self.folder / "run"
            if turn % 2:
                shutil.copytree(stopped, run)
            words = ("resume", "run") if turn % 2 else ("run", "case.yaml", "--out", "run")
            jobs = [self.start(*words, ranks=2) for _ in range(2)]
            ends = [job.end() for job in jobs]
            with self.subTest(turn=turn, ends=ends):
                # The later of the two may come when the first has ended: then there is a run, or it is complete.
                self.assertIn(0, [code for code, _, _ in ends])
                for code, _, err in ends:
                    self.assertTrue(code == 0 or (code == 2 and "is writing in this folder" in err)
                                    or (code == 2 and "this folder holds a run already" in err))
                self.assert_same_run(run, whole)
            shutil.rmtree(run)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=4, help="pairs that start at the same time (default: 4)")
    parser.add_argument("--seed", help="without use: nothing here is random but the moments")
    OPTIONS, others = parser.parse_known_args()
    unittest.main(argv=[__file__, *others])
