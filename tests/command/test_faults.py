#!/usr/bin/env python3
"""What may befall a run on two ranks, and that nothing is lost.

--repeat is how often ranks are killed at random moments (default 4): one of them at odd turns, all and the launcher at
even ones.
"""
import argparse
import contextlib
import os
import random
import shutil
import signal
import subprocess
import time
import unittest

import h5py
import numpy as np

from running import Folder, Job, rows
from taut import launch

OPTIONS = argparse.Namespace(repeat=4, seed=None)
# Many frames and checkpoints, so that a random moment often lies within the writing of one.
BUSY = ("--set", "time.end=0.2", "--set", "time.frame_rate=50", "--set", "checkpoint.every_steps=4")


class Faults(Folder):
    def start(self, *options, out="run", ranks=2):
        """A run on two ranks and its folder."""
        return Job(self.folder, ("run", "case.yaml", "--out", out, *options), ranks), self.folder / out

    def resume(self, run, *options):
        code, out, err = self.taut("resume", run.name, *options, ranks=2)
        self.assertEqual(code, 0, err)
        return out

    def assert_only_one_message(self, err, *words):
        self.assertEqual(err.count("taut:"), 1, err)
        for word in words:
            self.assertIn(word, err)


class Killed(Faults):
    def test_at_random_moments(self):
        seed = OPTIONS.seed if OPTIONS.seed is not None else random.randrange(10**6)
        chance = random.Random(seed)
        whole = self.run_case("whole", *BUSY, ranks=2)
        cut = 0
        for turn in range(OPTIONS.repeat):
            with self.subTest(seed=seed, turn=turn):
                cut += self.kill_and_resume(whole, chance, turn)
        print(f"killed {OPTIONS.repeat} times, {cut} of them within the run (seed {seed})")
        self.assertGreater(cut, 0, "no run was killed before its end")

    def kill_and_resume(self, whole, chance, turn):
        """Whether the run was killed before its end."""
        job, run = self.start(*BUSY)
        steps = chance.randrange(rows(whole))
        job.wait_for(lambda: (run / "case.yaml").exists() and rows(run) >= steps)
        time.sleep(chance.uniform(0, 0.02))  # about two steps, and what is written at the end of one
        ranks = job.ranks()
        victims = ranks if turn % 2 else [*ranks, job.process.pid]
        for pid in chance.sample(victims, 1 if turn % 2 and victims else len(victims)):
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        code, _, _ = job.end(limit=10)
        if (run / "frames.xdmf").exists():
            self.assert_readable(run)
        self.resume(run)
        self.assert_same_run(run, whole)
        shutil.rmtree(run)
        return code != 0


@contextlib.contextmanager
def small_disk(folder):
    """A file system of its own for a folder."""
    folder.mkdir(parents=True)
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=20m", "tmpfs", folder], check=True)
    try:
        yield
    finally:
        subprocess.run(["umount", folder], check=True)


def fill_up(file):
    """Leaves no room on the disk of `file`, which is appended to."""
    block = bytes(1 << 20)
    with open(file, "ab", buffering=0) as out:
        while block:
            try:
                out.write(block)
            except OSError:
                block = block[:len(block) // 2]


def may_mount():
    """Root in a container may not."""
    if os.geteuid() != 0 or not shutil.which("unshare"):
        return False
    return subprocess.run(["unshare", "-m", "mount", "-t", "tmpfs", "tmpfs", "/mnt"], stderr=subprocess.DEVNULL,
                          check=False).returncode == 0


@unittest.skipUnless(may_mount(), "only root can mount a small file system")
class DiskFull(Faults):
    """The run ends with exit code 2 and one message; when there is room again it goes on."""

    def fill(self, place):
        """What the run says when the disk of `place` is full, and what it does when it is resumed."""
        long = (*BUSY, "--set", "time.end=0.4")  # not over before the disk is full
        whole = self.run_case("whole", *long, ranks=2)
        filler = self.folder / "run" / place / "filler"
        with small_disk(filler.parent):
            job, run = self.start(*long)
            self.assertTrue(job.wait_for(lambda: rows(run) > 10))
            # Again and again: a checkpoint that gives way to the next leaves its room to the one after.
            job.wait_for(lambda: fill_up(filler))
            code, _, err = job.end()
            self.assertEqual(code, 2, err)
            self.assert_only_one_message(err, "No space left on device", "has room")
            self.assertFalse(list(run.rglob("*.part")))
            self.assert_readable(run)
            self.assertLess(rows(run), rows(whole))
            filler.unlink()
            out = self.resume(run)
            self.assert_same_run(run, whole)
        return err, out

    def test_during_a_frame(self):
        err, _ = self.fill("frames")
        self.assertRegex(err, r"run/frames/frame_0000\d\d.h5: ")

    def test_during_a_checkpoint(self):
        err, out = self.fill("checkpoint")
        self.assertRegex(err, r"run/checkpoint/step_0000000\d\d.h5: ")
        self.assertIn("resuming at t = ", out)

    def test_during_anything(self):
        self.fill(".")


class Removed(Faults):
    def test_output_folder(self):
        job, run = self.start("--set", "time.end=100")
        self.assertTrue(job.wait_for(lambda: rows(run) > 20))
        run.rename(self.folder / "gone")
        code, _, err = job.end(limit=10)
        self.assertEqual(code, 2, err)
        self.assert_only_one_message(err.lower(), "run/", "no such file or directory", "check that the folder exists")
        self.assertFalse(run.exists())


class OneRank(Faults):
    """A fault on one rank alone ends the whole job within 5 s."""

    def assert_memory_ends(self, megabytes, *options):
        """On the second rank, which may take so many of addresses: about 400 are the program and its libraries."""
        case = ["run", "case.yaml", "--out", "run", *options]
        # mpirun starts each rank with its own command.
        limited = ["bash", "-c", f'ulimit -v {megabytes}000; exec "$0" "$@"', launch.PROGRAM, *case]
        words = [*launch.LAUNCHER, "-n", "1", launch.PROGRAM, *case, ":", "-n", "1", *limited]
        job = subprocess.Popen(words, cwd=self.folder, env=launch.ENVIRONMENT, text=True, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE)
        with job:
            assert job.stderr is not None
            message = next((line for line in job.stderr if line.startswith("taut:")), "none")
            code = job.wait(timeout=5)
        self.assertEqual(message.strip(),
                         "taut: rank 1: not enough memory; use more ranks on more machines, or a smaller mesh")
        self.assertEqual(code, 1)
        self.assertFalse((self.folder / "run").exists())

    def test_out_of_memory(self):
        self.assert_memory_ends(500, "--set", "cloth.grid.vertices=[1500, 1500]")

    def test_out_of_memory_while_a_file_is_open(self):
        """Closing it is for all ranks together."""
        n = 1500
        number = np.arange(n * n).reshape(n, n)
        with h5py.File(self.folder / "cloth.h5", "w") as file:
            file["rest_positions"] = np.stack([number.ravel() // n / n, number.ravel() % n / n, 0.0 * number.ravel()],
                                              axis=1)
            file["faces"] = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]],
                                     axis=2).ravel()
            file["face_offsets"] = np.arange(0, 4 * (n - 1)**2 + 1, 4)
        self.assert_memory_ends(460, "--set", "cloth.mesh=cloth.h5")


class Signals(Faults):
    def test_sent_to_the_launcher(self):
        """mpirun passes SIGUSR1 on and returns what the ranks do."""
        whole = self.run_case("whole", ranks=2)
        job, run = self.start()
        self.assertTrue(job.wait_for(lambda: rows(run) > 10))
        os.kill(job.process.pid, signal.SIGUSR1)
        code, _, err = job.end()
        self.assertEqual(code, 4, err)
        self.assertIn("go on with: taut resume run", err)
        self.resume(run)
        self.assert_same_run(run, whole)


class MeshFile(Faults):
    """Meshes in HDF5 that are not what they should be: exit code 2, the file, and a cure."""

    def refused(self, *words):
        job, run = self.start("--set", "cloth.mesh=cloth.h5")
        code, _, err = job.end(limit=10)
        self.assertEqual(code, 2, err)
        self.assert_only_one_message(err, "taut: cloth.h5: ", *words)
        self.assertFalse(run.exists())

    def test_truncated(self):
        whole = self.run_case("whole", "--set", "time.end=0.01") / "mesh.h5"
        for share in (0.0, 0.3, 0.99):
            (self.folder / "cloth.h5").write_bytes(whole.read_bytes()[:int(share * whole.stat().st_size)])
            self.refused("cannot be opened as HDF5", "check that this is the right file and that it is complete")

    def test_foreign(self):
        (self.folder / "cloth.h5").write_text("v 0 0 0\n")
        self.refused("cannot be opened as HDF5")
        with h5py.File(self.folder / "cloth.h5", "w") as file:
            file["weather"] = [1.0, 2.0]
        self.refused("/rest_positions cannot be read: the file has no such dataset")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=4, help="kills at random moments (default: 4)")
    parser.add_argument("--seed", type=int, help="of the random moments (default: another each time, told at the end)")
    OPTIONS, others = parser.parse_known_args()
    unittest.main(argv=[__file__, *others])
